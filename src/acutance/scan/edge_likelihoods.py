"""What the pixels of the edges of a scene say of their transfer functions, and of their objects."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.softness_sums import likeliest_variances, object_likelihoods, softness_powers

__all__ = ["EdgeLikelihoods", "FactorLikelihoods", "chunks"]

_CHUNK = 256
"""Edges at once: arrays of edges by softness by frequency stay small."""


def chunks(size: int) -> Iterator[slice]:
    """Some of so many edges at a time."""
    for start in range(0, size, _CHUNK):
        yield slice(start, min(start + _CHUNK, size))


class FactorLikelihoods(NamedTuple):
    """What the pixels of n edges say of a real factor x of their transfer functions.

    Minus twice the log likelihood is ``x^T quadratic[i] x - 2 pull[i] x`` and a constant.

    Attributes
    ----------
    quadratic : (n, m, m) array
    pull : (n, m) array
    falls : (m,) array
        Fall of the logarithm of the factor by the variance of a blur, 1 / px^2.
    """

    quadratic: Floats
    pull: Floats
    falls: Floats

    def likeliest_variances(self, tried_px2: Floats) -> tuple[Floats, Floats]:
        """Variance of each object's softness and its deviation, (n,), from the best of (c,)."""
        return likeliest_variances(*self, tried_px2)

    def powers(self, first_px: Floats, width_px: Floats, cells: int) -> Floats:
        """``x^T quadratic x - 2 pull x`` of ideal objects and in cells of softness, (n, t + 1)."""
        return softness_powers(*self, first_px, width_px, cells)

    def chosen(self, some: slice) -> FactorLikelihoods:
        """Of some edges."""
        return FactorLikelihoods(self.quadratic[some], self.pull[some], self.falls)


@dataclass(frozen=True, eq=False)
class EdgeLikelihoods:
    """What the pixels of n edges say of their transfer functions f; real parts stand first.

    Minus twice the log likelihood is ``f^T information[i] f - 2 pull[i] f + square[i]``.

    Attributes
    ----------
    freq_cpp : (k,) array
    information : (n, 2 k, 2 k) array
    pull : (n, 2 k) array
        Its product with the likeliest transfer function.
    square : (n,) array
        Sum of the squares of what the pixels say, in standard deviations.
    rank : (n,) array
        Number of values that the pixels of each edge say.
    bin : (n,) int array
        Bin of directions of each.
    normal_deg : (n,) array
        Its own direction, -90 to 90.
    gain : (n, k) array
        What each sees, over the sensor along its bin.
    """

    freq_cpp: Floats
    information: Floats
    pull: Floats
    square: Floats
    rank: Floats
    bin: NDArray[np.intp]
    normal_deg: Floats
    gain: Floats

    @classmethod
    def of_roots(
        cls,
        freq_cpp: Floats,
        root: Floats,
        value: Floats,
        rank: Floats,
        number: NDArray[np.intp],
        normal_deg: Floats,
    ) -> EdgeLikelihoods:
        """Of edges that see the sensor along their bins.

        Parameters
        ----------
        freq_cpp : (k,) array
        root : (n, 2 k, r) array
            ``root[i].T @ f - value[i]`` is off by one standard deviation in every value.
        value : (n, r) array
        rank, number, normal_deg : (n,) array
        """
        gain = np.ones((rank.size, freq_cpp.size))
        pull, square = (root @ value[:, :, None])[:, :, 0], np.sum(value**2, axis=1)
        information = root @ np.swapaxes(root, 1, 2)
        return cls(freq_cpp, information, pull, square, rank, number, normal_deg, gain)

    @property
    def size(self) -> int:
        """Number of edges."""
        return int(self.rank.size)

    def turned(self, gain: Floats) -> EdgeLikelihoods:
        """Likelihoods of the sensor along the bins, of edges that see `gain` (n, k) times that."""
        return replace(self, gain=self.gain * gain)

    def chosen(self, some: NDArray[np.intp]) -> EdgeLikelihoods:
        """Some of the edges."""
        names = ("information", "pull", "square", "rank", "bin", "normal_deg", "gain")
        return replace(self, **{name: getattr(self, name)[some] for name in names})

    def rougher(self, heat: float) -> EdgeLikelihoods:
        """The same edges, their standard deviations so many times larger."""
        names = ("information", "pull", "square")
        return replace(self, **{name: getattr(self, name) / heat**2 for name in names})

    @property
    def falls(self) -> Floats:
        """Fall of the logarithm of a transfer function by the variance of a blur, (k,), 1/px^2."""
        return np.asarray(2 * np.pi**2 * self.freq_cpp**2)

    def of_objects(self, otf: Floats) -> FactorLikelihoods:
        """Likelihoods of the transfer functions of the objects under a sensor (b, 2 k)."""
        seen = otf[self.bin] * np.hstack([self.gain, self.gain])
        quadratic = np.empty((self.size, self.freq_cpp.size, self.freq_cpp.size))
        pull = np.empty_like(self.gain)
        object_likelihoods(self.information, self.pull, seen, quadratic, pull)
        return FactorLikelihoods(quadratic, pull, self.falls)

    def of_sensor(self, some: slice) -> FactorLikelihoods:
        """Likelihoods of the sensor along the bin times the object, (2 k), of some edges."""
        gain = np.hstack([self.gain[some]] * 2)
        quadratic = gain[:, :, None] * self.information[some] * gain[:, None]
        return FactorLikelihoods(quadratic, gain * self.pull[some], np.tile(self.falls, 2))
