"""A covariance factor in an eighth of its bytes: rows of exact length, their directions rounded.

The length of a row is a standard deviation, the angle between two rows a correlation.
"""

from __future__ import annotations

import lzma
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["RoundedRows", "principal_axes"]

_STEP = 1e-3
"""Components of unit vectors are rounded to multiples of it: standard deviations between two places
of a curve change by some ten-thousandths, those of differences of places by some thousandths."""


@dataclass(frozen=True, eq=False)
class RoundedRows(ShortRepr):
    """The rows of a factor (n, k).

    Parameters
    ----------
    length : (n,) array
        Standard deviations.
    steps : (n, k) int array
        Directions, as multiples of a small step.
    """

    length: Floats
    steps: NDArray[np.int16]

    @classmethod
    def of(cls, factor: Floats) -> RoundedRows:
        """The rows of a factor; the fewer of its entries are large, the fewer bytes they take."""
        length, unit = _lengths_and_directions(factor)
        return cls(length, np.rint(unit / _STEP).astype("<i2"))

    def factor(self) -> Floats:
        """The factor (n, k): its rows have the exact lengths."""
        return np.asarray(_lengths_and_directions(self.steps)[1] * self.length[:, None])

    def __getstate__(self) -> dict[str, Any]:
        # Column by column, and all low bytes before all high ones: what is similar is adjacent.
        planes = np.ascontiguousarray(self.steps.T).view(np.uint8).reshape(-1, 2).T
        packed = self.steps.shape, lzma.compress(planes.tobytes())
        return {"length": self.length, "steps": packed}

    def __setstate__(self, state: dict[str, Any]) -> None:
        (n, k), packed = state["steps"]
        planes = np.frombuffer(lzma.decompress(packed), np.uint8).reshape(2, -1)
        steps = np.ascontiguousarray(planes.T).view("<i2").reshape(k, n).T
        vars(self).update(length=state["length"], steps=steps)


def principal_axes(factor: Floats, lost: float = 0.0) -> Floats:
    """Axes in the space of latent variables, by how much they correlate the rows of a factor.

    Parameters
    ----------
    factor : (n, k) array
    lost : float, optional
        How much of its variance each row may lose.

    Returns
    -------
    (k, m) array
        As few orthonormal axes as that allows: ``factor @ axes`` is the narrower factor.
    """
    unit = _lengths_and_directions(factor)[1]
    axes = np.linalg.svd(unit, full_matrices=False)[2].T
    kept = np.cumsum((unit @ axes)[:, ::-1] ** 2, axis=1).max(axis=0)[::-1] > lost
    return np.asarray(axes[:, kept])


def _lengths_and_directions(rows: NDArray[Any]) -> tuple[Floats, Floats]:
    """Lengths of rows and unit vectors along them; zeros where there is none."""
    length = np.asarray(np.linalg.norm(rows.astype(float), axis=1))
    return length, rows / np.where(length > 0, length, 1.0)[:, None]
