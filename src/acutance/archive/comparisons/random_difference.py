"""A difference of two groups as their images show it, before what does not average out."""

from __future__ import annotations

from dataclasses import dataclass

from acutance.archive.comparisons.degrees import StdPart
from acutance.archive.comparisons.pairing import Basis

__all__ = ["RandomDifference"]


@dataclass(frozen=True)
class RandomDifference:
    """First minus second, before what does not average out is added.

    Attributes
    ----------
    basis : str
    value : float
    part : StdPart
    level : float
        Mean of both.
    scatter : float or None
        Of the differences between images, beyond their stated deviations.
    images : (int, int)
        Of the first group and of the second.
    notes : tuple of str
    """

    basis: Basis
    value: float
    part: StdPart
    level: float
    scatter: float | None
    images: tuple[int, int]
    notes: tuple[str, ...] = ()
