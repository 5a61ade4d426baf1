"""The covariance of a kernel's coefficients: what the pixels, the noise and the regions give."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.pair.tile import Complexes

__all__ = ["KernelCovariance"]

_STEP = 1e-6
"""What entries of packed factors are rounded to, as errors of the OTF. Some hundred of them make a
deviation of 0.001 to 0.01: it is kept to one or two ten-thousandths."""
_FACTORS = ("posterior", "scatter", "white")


@dataclass(frozen=True, eq=False)
class KernelCovariance(ShortRepr):
    """Factors of covariances of the coefficients, (k, ...) each.

    Parameters
    ----------
    posterior : (k, m) array
        Of the posterior.
    reference_noise : (k,) array
        Change of the coefficients for one standard deviation of the reference's noise power.
    scatter : (k, regions) array
        What the residuals of every region would move the coefficients by, about the mean of all.
    white : (k, k) array
        Of the covariance that white residuals would give.
    step : (k,) array, optional
        What the entries are multiples of, row by row, where they were rounded.
    """

    posterior: Floats
    reference_noise: Floats
    scatter: Floats
    white: Floats
    step: Floats | None = None

    @property
    def regions(self) -> int:
        """How many regions there are."""
        return int(self.scatter.shape[1])

    def excess(self, slopes: Complexes) -> Floats:
        """Variance by the scatter of regions over that of white residuals, (n,).

        Parameters
        ----------
        slopes : (n, k) array
            Derivatives of what it is the variance of, by the coefficients.
        """
        found = _power(slopes @ self.scatter) * self.regions / (self.regions - 1)
        expected = _power(slopes @ self.white)
        return np.where(expected > 0, found / np.where(expected > 0, expected, 1.0), 1.0)

    def packed(self, size: Floats) -> KernelCovariance:
        """The same covariance rounded, so that it is stored in 30 kB instead of 700.

        Parameters
        ----------
        size : (k,) array
            How much the OTF changes with every coefficient.
        """
        step = _STEP / np.where(size > 0, size, 1.0)
        posterior, scatter, white = (
            np.rint(_triangular(one) / step[:, None]) * step[:, None]
            for one in (self.posterior, self.scatter, self.white)
        )
        return KernelCovariance(posterior, self.reference_noise, scatter, white, step)

    def __getstate__(self) -> dict[str, Any]:
        state = {name: getattr(self, name) for name in (*_FACTORS, "reference_noise", "step")}
        if self.step is None:
            return state
        return {**state, **{name: _stored(state[name], self.step) for name in _FACTORS}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        if state["step"] is not None:
            state |= {name: _restored(state[name], state["step"]) for name in _FACTORS}
        vars(self).update(state)


def _power(factor: Complexes) -> Floats:
    return np.asarray((np.abs(factor) ** 2).sum(axis=1))


def _triangular(factor: Floats) -> Floats:
    """The lower triangular factor of the same covariance, if that is narrower: zeros are cheap."""
    k, m = factor.shape
    return factor if m < k else np.linalg.qr(factor.T)[1].T


def _stored(factor: Floats, step: Floats) -> tuple[tuple[int, ...], bytes]:
    """Shape, and the multiples of the step byte by byte: those of one weight follow each other."""
    multiples = np.rint(factor / step[:, None]).astype("<i4")
    planes = np.ascontiguousarray(multiples.reshape(-1, 1).view(np.uint8).T)
    return factor.shape, zlib.compress(planes.tobytes(), 9)


def _restored(stored: tuple[tuple[int, ...], bytes], step: Floats) -> Floats:
    shape, multiples_by_byte = stored
    planes = np.frombuffer(zlib.decompress(multiples_by_byte), np.uint8).reshape(4, -1)
    multiples = np.ascontiguousarray(planes.T).view("<i4").reshape(shape)
    return np.asarray(multiples * step[:, None])
