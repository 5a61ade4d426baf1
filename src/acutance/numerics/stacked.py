"""Complex values as real ones: real parts over imaginary parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["stacked", "unstacked"]

Complexes = NDArray[np.complex128]


def stacked(values: Complexes) -> Floats:
    """Real parts (n, ...), then imaginary parts, (2 n, ...)."""
    return np.concatenate([values.real, values.imag], axis=0)


def unstacked(values: Floats) -> Complexes:
    """Complex values (n, ...) of stacked ones, (2 n, ...)."""
    n = len(values) // 2
    found = np.empty((n, *values.shape[1:]), complex)
    found.real, found.imag = values[:n], values[n:]
    return found
