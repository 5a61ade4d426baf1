"""Families of sensors as directions of a two-dimensional transfer function.

A family is the principal directions in which its optical transfer functions (OTF) depart from a
Gaussian through a pixel, in the states of `otf_modes` and in units of the mean's width. They were
learned from `acutance.optics.FAMILIES` (`learn_otf`). A prior gives every family an amplitude that
the data determine.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["FAMILY_LOG_AMPLITUDES", "FamilyDirections", "family_directions"]

FAMILY_LOG_AMPLITUDES: Final = {
    "telescope": -0.5,
    "halo": -1.5,
    "trail": -3.0,
    "smear": -3.0,
    "sharpened": -3.0,
    "restored": -3.0,
    "resampled": -3.0,
}
"""Expected amplitude of every family of sensors relative to that of its own population: light of
every sensor goes through an aperture, few have the other causes. What is interpolated at one phase,
or compensated and interpolated, departs along directions of these."""


class FamilyDirections(NamedTuple):
    """The directions of all families.

    Attributes
    ----------
    states : (r, k) array
        Coefficients of the states for every direction.
    family : (k,) int array
        Which family every direction belongs to, in the order of `FAMILY_LOG_AMPLITUDES`.
    log_amplitude : (f,) array
        Expected amplitude of every family.
    """

    states: Floats
    family: NDArray[np.intp]
    log_amplitude: Floats


@cache
def family_directions() -> FamilyDirections:
    """The directions of all families, as they were learned."""
    path = files("acutance.numerics").joinpath("otf_families.npz")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as learned:
        parts = [learned[name].astype(float) for name in FAMILY_LOG_AMPLITUDES]
    sizes = [part.shape[1] for part in parts]
    family = np.repeat(np.arange(len(sizes)), sizes)
    return FamilyDirections(np.hstack(parts), family, np.array([*FAMILY_LOG_AMPLITUDES.values()]))
