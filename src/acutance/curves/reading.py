"""A number read from curves, before its standard deviation is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from acutance.curves.estimate import Estimate
from acutance.curves.grid import Floats

__all__ = ["UNDEFINED", "Reading", "estimates", "stacked"]


class Reading(NamedTuple):
    """A number, and how the latent variables of its curves move it.

    Attributes
    ----------
    value : float
        ``nan`` where the number does not exist.
    row : (k,) array
        What a unit of each latent variable adds to it, to first order; k = 1 where it does not
        exist.
    lowest : float, optional
        What the number cannot fall below.
    """

    value: float
    row: Floats
    lowest: float | None = None

    def estimate(self) -> Estimate:
        """With its standard deviation, where the latent variables are independent."""
        (found,) = estimates([self], self.row[None], None)
        return found


UNDEFINED = Reading(math.nan, np.array([math.nan]))
"""Of a number that does not exist."""


def stacked(readings: Sequence[Reading], columns: int) -> Floats:
    """Rows of several numbers of the same curves, (n, columns)."""
    rows = np.empty((len(readings), columns))
    for row, reading in zip(rows, readings, strict=True):
        row[:] = reading.row
    return rows


def estimates(readings: Sequence[Reading], rows: Floats, latent: Floats | None) -> list[Estimate]:
    """Several numbers of the same curves with their standard deviations.

    Parameters
    ----------
    readings : sequence of Reading
    rows : (n, k) array
        Of all of them, `stacked`.
    latent : (k, m) array or None
        Factor of the covariance of the latent variables; ``None`` where they are independent.
    """
    errors = rows if latent is None else rows @ latent
    stds = np.sqrt(np.einsum("ij,ij->i", errors, errors)).tolist()
    return [
        Estimate(reading.value, std, reading.lowest)
        for reading, std in zip(readings, stds, strict=True)
    ]
