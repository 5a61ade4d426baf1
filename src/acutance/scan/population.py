"""The sensor under the objects: what all edges of a scene share, and how soft the objects are.

An edge of nature is the sensor's blur times its object's own. The transfer function of edge i,
whose normal lies in bin b of directions, is

    f_i = H_b(f) exp(-2 pi^2 tau_i^2 f^2),

with H_b the sensor's and tau_i the softness of the object. Objects are ideal (tau = 0) with some
probability, else soft (`acutance.scan.softness`); a small share of the edges is of any kind (too
sharp, as beside a bright rim). What the pixels of an edge say of f_i is normal
(`acutance.targets.otf_likelihood`). Softness is summed over a grid, and so every edge gives a
mixture of normal likelihoods of H_b. The grid of an edge covers the softness that its pixels allow;
laws of softness have their probability of every cell of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.shares import likeliest_shares, sectors_of
from acutance.scan.softness import NEARLY_IDEAL_PX, STRANGE, law_chances

__all__ = [
    "EdgeLikelihoods",
    "Membership",
    "fit_shares",
    "softness_grid",
]

_CHUNK: Final = 256
"""Edges at once: arrays of edges by softness by frequency stay small."""
_COARSE_PX2: Final[Floats] = np.array([
    0.0, 0.01, 0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.9, 1.4, 2.0, 3.0, 4.5, 7.0, 11.0, 16.0
])  # fmt: skip
"""Variances from which the likeliest softness of an edge is sought."""
_STEPS: Final = 4
_LEAST_PX2, _MOST_PX2 = -0.2, 30.0
_GRID: Final = 24
_TINY: Final = 1e-300
_REACH: Final = 5.0
"""The grid of an edge covers so many standard deviations of its softness."""


@dataclass(frozen=True, eq=False)
class EdgeLikelihoods:
    """What the pixels of n edges say of their transfer functions; real parts stand first.

    Minus twice the logarithm is the sum of squares of ``root[i].T @ f - value[i]``.

    Attributes
    ----------
    freq_cpp : (k,) array
    root : (n, 2 k, r) array
        Columns that an edge does not have are zero.
    value : (n, r) array
    rank : (n,) array
        Number of columns of each edge.
    bin : (n,) int array
        Bin of directions of each.
    normal_deg : (n,) array
        Its own direction, -90 to 90.
    gain : (n, k) array
        What each sees, over the sensor along its bin.
    """

    freq_cpp: Floats
    root: Floats
    value: Floats
    rank: Floats
    bin: NDArray[np.intp]
    normal_deg: Floats
    gain: Floats

    @property
    def size(self) -> int:
        """Number of edges."""
        return int(self.rank.size)

    def turned(self, gain: Floats) -> EdgeLikelihoods:
        """Likelihoods of the sensor along the bins, of edges that see `gain` (n, k) times that."""
        return replace(self, gain=self.gain * gain)

    def chosen(self, some: NDArray[np.intp]) -> EdgeLikelihoods:
        """Some of the edges."""
        names = ("root", "value", "rank", "bin", "normal_deg", "gain")
        return replace(self, **{name: getattr(self, name)[some] for name in names})

    def seen_root(self, some: slice) -> Floats:
        """Root of the likelihoods of the sensor along the bins, of some edges, (n, 2 k, r)."""
        gain = self.gain[some]
        return np.asarray(self.root[some] * np.hstack([gain, gain])[:, :, None])

    def chunks(self) -> Iterator[slice]:
        """Some edges at a time."""
        for start in range(0, self.size, _CHUNK):
            yield slice(start, min(start + _CHUNK, self.size))

    def blur(self, variance_px2: Floats) -> Floats:
        """Transfer function of objects of some softness (n, t), (n, t, 2 k)."""
        one = np.exp(-2 * np.pi**2 * variance_px2[:, :, None] * self.freq_cpp**2)
        return np.concatenate([one, one], axis=2)

    def off(self, otf: Floats, some: slice, blur: Floats) -> Floats:
        """``root.T @ f - value`` of some edges, (n, t, r); otf (b, 2 k), blur (n, t, 2 k)."""
        seen = self.seen_root(some) * otf[self.bin[some]][:, :, None]
        return np.asarray(blur @ seen - self.value[some][:, None, :])


def softness_grid(edges: EdgeLikelihoods, otf: Floats) -> tuple[Floats, Floats]:
    """Softness that every edge may have under a sensor (b, 2 k), in px.

    Returns
    -------
    softness_px : (n, t) array
        Middles of equal parts of what the edge allows.
    width_px : (n,) array
        Of the parts.
    """
    parts = [_likeliest(edges, otf, some) for some in edges.chunks()]
    middle, std = (np.concatenate(column) for column in zip(*parts, strict=True))
    low = np.sqrt(np.maximum(middle - _REACH * std, 0.0))
    high = np.sqrt(np.maximum(middle + _REACH * std, std))
    width = (high - low) / _GRID
    return low[:, None] + width[:, None] * (np.arange(_GRID) + 0.5), width


def _likeliest(edges: EdgeLikelihoods, otf: Floats, some: slice) -> tuple[Floats, Floats]:
    """Likeliest variance of the softness of some edges, and its standard deviation, (n,) each.

    It is below zero for an edge that is sharper than the sensor.
    """
    root = edges.seen_root(some) * otf[edges.bin[some]][:, :, None]
    tried = np.broadcast_to(_COARSE_PX2, (len(root), _COARSE_PX2.size))
    power = np.sum(edges.off(otf, some, edges.blur(tried)) ** 2, axis=2)
    variance = _COARSE_PX2[np.argmin(power, axis=1)]
    falls = np.tile(-2 * np.pi**2 * edges.freq_cpp**2, 2)
    for _ in range(_STEPS):
        blur = edges.blur(variance[:, None])
        off = (blur @ root)[:, 0] - edges.value[some]
        slope = ((blur * falls) @ root)[:, 0]
        information = np.maximum(np.sum(slope * slope, axis=1), 1e-3)
        step = -np.sum(slope * off, axis=1) / information
        variance = np.clip(variance + step, _LEAST_PX2, _MOST_PX2)
    return variance, 1 / np.sqrt(information)


class Membership(NamedTuple):
    """What n edges are, at a guess of the sensor and the shares.

    Attributes
    ----------
    share : (g, p) array
        Of the parts, in every sector of directions.
    sector : (n,) int array
    softness_px : (n, t + 1) array
        Softness that each may have; the first is 0, of an ideal object.
    width_px : (n,) array
        Of the cells about the others.
    laws : (p - 2, n, t) array
        Probability of the cells by every law.
    chance : (n, t + 1) array
        Probability of each softness, of edges that are not strange.
    part : (n, p) array
        Probability of `softness.PARTS`.
    log_likelihood : float
        Of all edges.
    """

    share: Floats
    sector: NDArray[np.intp]
    softness_px: Floats
    width_px: Floats
    laws: Floats
    chance: Floats
    part: Floats
    log_likelihood: float

    @property
    def mean_px(self) -> Floats:
        """Mean softness of every edge, (n,)."""
        whole = np.maximum(self.chance.sum(axis=1), _TINY)
        return np.asarray(np.sum(self.chance * self.softness_px, axis=1) / whole)

    @property
    def ideal(self) -> Floats:
        """Probability that the object of every edge counts as ideal, (n,)."""
        width = self.width_px[:, None]
        below = np.clip((NEARLY_IDEAL_PX - self.softness_px[:, 1:]) / width + 0.5, 0.0, 1.0)
        return np.asarray(self.chance[:, 0] + np.sum(below * self.chance[:, 1:], axis=1))

    @property
    def weight(self) -> Floats:
        """Information by softness that every edge gives, (n, t + 1): strange ones give little."""
        weight = self.chance.copy()
        weight[:, 0] += self.part[:, -1] / STRANGE
        return weight

    def within(self, some: slice) -> Floats:
        """Probability of every law by softness of some edges, being soft ones, (p - 2, n, t)."""
        share = self.share[self.sector[some]]
        by_law = share.T[1:-1, :, None] * self.laws[:, some]
        return np.asarray(by_law / np.maximum(by_law.sum(axis=0), _TINY))


def fit_shares(edges: EdgeLikelihoods, otf: Floats, share: Floats) -> Membership:
    """What the edges are under a given sensor (b, 2 k), from a first guess of the shares (g, p)."""
    soft_px, width_px = softness_grid(edges, otf)
    softness_px = np.hstack([np.zeros((edges.size, 1)), soft_px])
    power = np.concatenate([
        -0.5 * np.sum(edges.off(otf, some, edges.blur(softness_px[some] ** 2)) ** 2, axis=2)
        for some in edges.chunks()
    ])  # fmt: skip
    log_strange = power[:, 0] / STRANGE - 0.5 * edges.rank * np.log(STRANGE)
    largest = np.maximum(power.max(axis=1), log_strange)
    odds = np.exp(power - largest[:, None])
    strange = np.exp(log_strange - largest)
    laws = _law_chances(soft_px, width_px)
    by_law = np.einsum("pnt,nt->np", laws, odds[:, 1:])
    by_part = np.column_stack([odds[:, 0], by_law, strange])
    sector = sectors_of(edges.normal_deg)
    share = likeliest_shares(by_part, sector, share)
    own = share[sector]
    whole = np.sum(by_part * own, axis=1)
    soft = np.einsum("np,pnt->nt", own[:, 1:-1], laws)
    chance = odds * np.hstack([own[:, :1], soft]) / whole[:, None]
    return Membership(
        share, sector, softness_px, width_px, laws, chance, by_part * own / whole[:, None],
        float(np.sum(largest) + np.sum(np.log(whole))),
    )  # fmt: skip


def _law_chances(softness_px: Floats, width_px: Floats) -> Floats:
    """Probability of every law in cells (n, t) about their middles, (p - 2, n, t)."""
    half = 0.5 * width_px[:, None]
    return law_chances(np.hstack([softness_px - half, softness_px[:, -1:] + half]))
