"""The covariance of a kernel's coefficients: what the pixels, the noise and the regions give."""

from __future__ import annotations

import lzma
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.pair.tile import Complexes

__all__ = ["KernelCovariance"]

_STEPS = {
    "posterior": 4e-4, "scatter": 1.6e-3, "white": 2e-3, "beyond": 2e-2, "reference_noise": 1e-2,
}  # fmt: skip
"""What entries of packed factors are rounded to, relative to a typical deviation of the OTF. There
are a hundred or two of them to a deviation, which they change by some thousandths, below 0.1 cycles
per pixel by some hundredths."""


@dataclass(frozen=True, eq=False)
class KernelCovariance(ShortRepr):
    """Factors of covariances of the coefficients, (k, ...) each.

    Parameters
    ----------
    posterior : (k, m) array
        Of the posterior.
    reference_noise : (k, 1) array
        Change of the coefficients for one standard deviation of the reference's noise power.
    scatter : (k, regions) array
        What the residuals of every region would move the coefficients by, about the mean of all.
    white : (k, k) array
        Of the covariance that white residuals would give.
    beyond : (k, q) array
        Of what light from beyond the image does, whose ground is not known.
    size : (k,) array, optional
        Where the factors were rounded, how much the OTF changes with every coefficient.
    steps : mapping of str to float, optional
        What the entries of every factor, times `size`, are multiples of.
    """

    posterior: Floats
    reference_noise: Floats
    scatter: Floats
    white: Floats
    beyond: Floats
    size: Floats | None = None
    steps: Mapping[str, float] | None = None

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

    def packed(self, slopes: Complexes) -> KernelCovariance:
        """The same covariance rounded, so that it is stored in 30 kB instead of a thousand.

        Parameters
        ----------
        slopes : (n, k) array
            Derivatives by the coefficients of the OTF all over its plane.
        """
        size = np.sqrt(np.mean(np.abs(slopes) ** 2, axis=0))
        # Whole powers of two need a byte each.
        size = 2.0 ** np.rint(np.log2(np.where(size > 0, size, 1.0)))
        factors = {name: _triangular(getattr(self, name)) for name in _STEPS}
        steps = {
            name: _STEPS[name] * (math.sqrt(float(np.mean(_power(slopes @ factor)))) or 1.0)
            for name, factor in factors.items()
        }
        rounded = {
            name: _factor(_multiples(factor, steps[name], size), steps[name], size)
            for name, factor in factors.items()
        }
        return replace(self, **rounded, size=size, steps=steps)

    def __getstate__(self) -> dict[str, Any]:
        state = super().__getstate__()
        if self.size is None or self.steps is None:
            return state
        for name, step in self.steps.items():
            multiples = _multiples(state[name], step, self.size)
            # Byte by byte: those of one weight follow each other.
            planes = np.ascontiguousarray(multiples.reshape(-1, 1).view(np.uint8).T)
            state[name] = multiples.shape, lzma.compress(planes.tobytes())
        state["size"] = np.log2(self.size).astype("<i1")
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        if state["size"] is not None:
            state["size"] = 2.0 ** state["size"].astype(float)
        for name, step in (state["steps"] or {}).items():
            shape, stored = state[name]
            planes = np.frombuffer(lzma.decompress(stored), np.uint8).reshape(4, -1)
            multiples = np.ascontiguousarray(planes.T).view("<i4").reshape(shape)
            state[name] = _factor(multiples, step, state["size"])
        vars(self).update(state)


def _multiples(factor: Floats, step: float, size: Floats) -> NDArray[np.int32]:
    """A factor, times the size of the coefficients, in whole steps."""
    return np.ascontiguousarray(np.rint(factor * (size / step)[:, None]), "<i4")


def _factor(multiples: NDArray[np.int32], step: float, size: Floats) -> Floats:
    return np.asarray(multiples * (step / size)[:, None])


def _power(factor: Complexes) -> Floats:
    return np.asarray((np.abs(factor) ** 2).sum(axis=1))


def _triangular(factor: Floats) -> Floats:
    """The lower triangular factor of the same covariance, if that is narrower: zeros are cheap."""
    k, m = factor.shape
    return factor if m < k else np.linalg.qr(factor.T)[1].T
