"""The fitted OTF in a twentieth of its size: its covariance rounded where it makes no difference.

The coefficients of the modes are uncertain by far more than the optical transfer function (OTF),
whose errors they cancel between them. So the covariance is rounded in other coordinates, in which
the values of the OTF at the frequencies it is used at are orthonormal: there a small error of an
element is a small one of the OTF.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.otf_modes import HIGHEST_CPP, Complexes, MeanOtf
from acutance.numerics.shape_error import ShapeError
from acutance.targets.periodic.otf_model import FittedOtf, all_modes

__all__ = ["PackedOtf"]

_STEP: Final = 3e-7
"""Elements of the OTF's factor are rounded to this: deviations change by 0.2 % at most."""
_GRID_STEPS: Final = 40
_RIDGE: Final = 1e-13


@dataclass(frozen=True)
class PackedOtf:
    """An OTF with its covariance (`acutance.curves.OtfModel`), packed for pickling.

    Attributes
    ----------
    mean : MeanOtf
        Mean of the OTF.
    beta : tuple of float
        Coefficients of its modes and of the processes'.
    steps : bytes
        Compressed triangular factor of the covariance, by the level, in steps of 3e-7.
    shape_error : ShapeError, optional
        Of a shape that the modes do not follow.
    """

    mean: MeanOtf
    beta: tuple[float, ...]
    steps: bytes
    shape_error: ShapeError | None = None

    @classmethod
    def of(cls, fitted: FittedOtf) -> PackedOtf:
        """Pack a fitted OTF."""
        root = _orthonormal_root(fitted.mean, fitted.beta.size)
        factor = root @ fitted.beta_factor / fitted.level
        upper = np.asarray(np.linalg.qr(factor.T, mode="r"))
        steps = np.round(upper.T[np.tril_indices(len(upper))] / _STEP).astype("<i4")
        packed = zlib.compress(steps.tobytes(), 9)
        return cls(fitted.mean, tuple(fitted.beta.tolist()), packed, fitted.shape_error)

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return HIGHEST_CPP

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,)."""
        return self._fitted.otf(u_cpp, v_cpp)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k)."""
        return self._fitted.factor(u_cpp, v_cpp)

    @cached_property
    def _fitted(self) -> FittedOtf:
        beta = np.array(self.beta)
        steps = np.frombuffer(zlib.decompress(self.steps), "<i4")
        triangle = np.zeros((beta.size, beta.size))
        triangle[np.tril_indices(beta.size)] = _STEP * steps
        factor = np.asarray(
            np.linalg.solve(_orthonormal_root(self.mean, beta.size), triangle), float
        )
        level = FittedOtf(self.mean, beta, factor).level
        return FittedOtf(self.mean, beta, level * factor, self.shape_error)

    def __getstate__(self) -> dict[str, object]:
        names = "mean", "beta", "steps", "shape_error"
        return {name: getattr(self, name) for name in names}


@cache
def _orthonormal_root(mean: MeanOtf, size: int) -> Floats:
    """Root of the modes' mean products over frequencies, (size, size), triangular."""
    freq = np.linspace(-HIGHEST_CPP, HIGHEST_CPP, 2 * _GRID_STEPS + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(freq, freq[_GRID_STEPS:]))
    modes = all_modes(mean, size, u, v)
    products = (modes.real.T @ modes.real + modes.imag.T @ modes.imag) / u.size
    ridge = _RIDGE * float(np.trace(products))
    return np.asarray(np.linalg.cholesky(products + ridge * np.eye(size)).T)
