"""Families of sensors as directions of a two-dimensional transfer function.

A family is the principal directions in which its optical transfer functions (OTF) depart from a
Gaussian through a pixel, in the states of `otf_modes` and in units of the mean's width. They were
learned from `acutance.optics.FAMILIES` (`learn_otf`). A prior gives every family an amplitude that
the data determine.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.optics import FAMILIES

__all__ = ["FamilyDirections", "family_directions"]


class FamilyDirections(NamedTuple):
    """The directions of all families.

    Attributes
    ----------
    states : (r, k) array
        Coefficients of the states for every direction.
    family : (k,) int array
        Which family every direction belongs to, in the order of `acutance.optics.FAMILIES`.
    """

    states: Floats
    family: NDArray[np.intp]


@cache
def family_directions() -> FamilyDirections:
    """The directions of all families, as they were learned."""
    path = files("acutance.numerics").joinpath("otf_families.npz")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as learned:
        parts = [learned[name].astype(float) for name in FAMILIES]
    sizes = [part.shape[1] for part in parts]
    return FamilyDirections(np.hstack(parts), np.repeat(np.arange(len(sizes)), sizes))
