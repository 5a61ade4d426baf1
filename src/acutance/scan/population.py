"""The sensor under the objects: what all edges of a scene share, and how soft the objects are.

An edge of nature is the sensor's blur times its object's own. The transfer function of edge i,
whose normal lies in bin b of directions, is

    f_i = H_b(f) exp(-2 pi^2 tau_i^2 f^2),

with H_b the sensor's and tau_i the softness of the object. Objects are ideal (tau = 0) with some
probability, else soft, tau being drawn from half-normal distributions of several sizes; a small
share of the edges is of any kind (too sharp, as beside a bright rim). What the pixels of an edge
say of f_i is normal (`acutance.targets.otf_likelihood`). Softness is summed over a grid, and so
every edge gives a mixture of normal likelihoods of H_b.

At a guess of H the mixture has the gradient of the expected log likelihood (A. P. Dempster, N. M.
Laird, D. B. Rubin, J. R. Stat. Soc. B 39, 1977, 1), and its curvature is the expected information
less what the hidden softness costs, the covariance of the gradients (T. A. Louis, J. R. Stat. Soc.
B 44, 1982, 226).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = [
    "PARTS",
    "SOFT_SCALES_PX",
    "EdgeLikelihoods",
    "Membership",
    "expected_information",
    "fit_shares",
    "memberships",
    "observed_information",
    "share_std",
]

SOFT_SCALES_PX: Final = (0.4, 0.8, 1.6)
"""Sizes of the half-normal distributions of softness. A narrower one would be a sensor a little
sharper, under objects that are all a little soft: no edges tell the two apart."""
PARTS: Final = ("ideal", *(f"soft {scale:g} px" for scale in SOFT_SCALES_PX), "strange")
"""What an edge may be."""
_SOFTNESS_PX: Final[Floats] = np.concatenate([
    np.arange(0.0, 0.4, 0.04), np.arange(0.4, 1.0, 0.08), np.arange(1.0, 4.01, 0.25)
])  # fmt: skip


def _soft_density() -> Floats:
    width = np.gradient(_SOFTNESS_PX)
    width[0] *= 0.5
    density = np.exp(-0.5 * (_SOFTNESS_PX / np.array(SOFT_SCALES_PX)[:, None]) ** 2) * width
    return np.asarray(density / density.sum(axis=1, keepdims=True))


_SOFT: Final[Floats] = _soft_density()
"""Probability of every softness of the grid in every soft part, (3, t)."""
_FREE: Final[Floats] = np.linalg.svd(np.ones((1, len(PARTS))))[2][1:]
"""Directions in which shares may change: their sum is one."""
_STRANGE: Final = 100.0
"""Variance of strange edges, in units of that of the pixels."""
_PSEUDO_COUNTS: Final[Floats] = np.array([1.0, 0.2, 0.2, 0.2, 0.2])
"""Edges that each part has before any is seen: some objects are ideal."""
_SETTLED: Final = 1e-4
_MAX_PASSES: Final = 200


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
    """

    freq_cpp: Floats
    root: Floats
    value: Floats
    rank: Floats
    bin: NDArray[np.intp]
    normal_deg: Floats

    def turned(self, gain: Floats) -> EdgeLikelihoods:
        """Likelihoods of the sensor along the bins, of edges that see `gain` (n, k) times that."""
        return replace(self, root=self.root * np.hstack([gain, gain])[:, :, None])

    @cached_property
    def blur(self) -> Floats:
        """Transfer function of objects of every softness of the grid, (t, 2 k)."""
        one = np.exp(-2 * (np.pi * np.outer(_SOFTNESS_PX, self.freq_cpp)) ** 2)
        return np.hstack([one, one])

    def off(self, otf: Floats) -> Floats:
        """``root.T @ f - value`` of every edge and softness, (n, t, r), of sensors (b, 2 k)."""
        seen = self.root * otf[self.bin][:, :, None]
        return np.asarray(self.blur @ seen - self.value[:, None, :])


class Membership(NamedTuple):
    """What n edges are, at a guess of the sensor and the shares.

    Attributes
    ----------
    softness : (n, t) array
        Probability of every softness of the grid, of edges that are not strange.
    part : (n, 5) array
        Probability of `PARTS`.
    log_likelihood : float
        Of all edges.
    """

    softness: Floats
    part: Floats
    log_likelihood: float

    @property
    def softness_px(self) -> Floats:
        """Mean softness of every edge, (n,)."""
        return np.asarray(self.softness @ _SOFTNESS_PX / np.maximum(self.softness.sum(1), 1e-12))

    @property
    def weight(self) -> Floats:
        """Information by softness that every edge gives, (n, t): strange ones give little."""
        weight = self.softness.copy()
        weight[:, 0] += self.part[:, -1] / _STRANGE
        return weight


def fit_shares(edges: EdgeLikelihoods, otf: Floats, share: Floats) -> tuple[Floats, Membership]:
    """Shares of the parts for a given sensor (b, 2 k), and what the edges are."""
    power = -0.5 * np.sum(edges.off(otf) ** 2, axis=2)
    for _ in range(_MAX_PASSES):
        member = memberships(edges, power, share)
        counts = member.part.sum(axis=0) + _PSEUDO_COUNTS
        updated = counts / counts.sum()
        moved = float(np.abs(updated - share).max())
        share = updated
        if moved < _SETTLED:
            break
    return share, member


def memberships(edges: EdgeLikelihoods, power: Floats, share: Floats) -> Membership:
    """What the edges are, given their log likelihoods (n, t) by softness and the shares (5,)."""
    soft = share[1:-1] @ _SOFT
    with np.errstate(divide="ignore"):
        log_soft = power + np.log(soft)
    log_ideal = power[:, :1] + np.log(share[0])
    lost = 0.5 * edges.rank * np.log(_STRANGE)
    log_strange = power[:, :1] / _STRANGE + (np.log(share[-1]) - lost)[:, None]
    every = np.hstack([log_soft, log_ideal, log_strange])
    largest = every.max(axis=1, keepdims=True)
    odds = np.exp(every - largest)
    whole = odds.sum(axis=1, keepdims=True)
    chance = odds / whole
    softness, ideal, strange = chance[:, :-2], chance[:, -2:-1], chance[:, -1:]
    part = np.hstack([ideal, softness @ _soft_parts(share).T, strange])
    softness = softness.copy()
    softness[:, 0] += ideal[:, 0]
    return Membership(softness, part, float(np.sum(largest) + np.sum(np.log(whole))))


def _soft_parts(share: Floats) -> Floats:
    """Probability of every soft part, of a soft object of every softness, (3, t)."""
    return np.asarray(share[1:-1, None] * _SOFT / np.maximum(share[1:-1] @ _SOFT, 1e-300))


def expected_information(edges: EdgeLikelihoods, member: Membership) -> tuple[Floats, Floats]:
    """Information (b, 2 k, 2 k) about the sensor, and its product with the likeliest (b, 2 k).

    If it were known what the edges are: the function that expectation and maximisation maximises.
    """
    bins, blur, weight = int(edges.bin.max()) + 1, edges.blur, member.weight
    size = blur.shape[1]
    information, projection = np.zeros((bins, size, size)), np.zeros((bins, size))
    for one, root, value, own in zip(edges.bin, edges.root, edges.value, weight, strict=True):
        information[one] += ((blur.T * own) @ blur) * (root @ root.T)
        projection[one] += (own @ blur) * (root @ value)
    return information, projection


def observed_information(
    edges: EdgeLikelihoods, otf: Floats, member: Membership, share: Floats
) -> tuple[Floats, Floats]:
    """Information about the sensor in all directions, and the gradient of the log likelihood.

    What the edges are is integrated out, and so are the shares of the parts.

    Returns
    -------
    information : (b * 2 k, b * 2 k) array
    gradient : (b * 2 k,) array
    """
    complete, _ = expected_information(edges, member)
    bins, size = otf.shape
    whole = np.zeros((bins * size, bins * size))
    gradient = np.zeros((bins, size))
    by_share = np.zeros((bins * size, share.size))
    off = edges.off(otf)
    within = _soft_parts(share)
    for b in range(bins):
        place = slice(b * size, (b + 1) * size)
        whole[place, place] = complete[b]
    for i, b in enumerate(edges.bin):
        place = slice(b * size, (b + 1) * size)
        # Gradients of the log likelihood by the sensor, for every softness.
        slopes = -(off[i] @ edges.root[i].T) * edges.blur
        own, part = member.softness[i], member.part[i]
        ideal, strange = part[0], part[-1]
        soft = own.copy()
        soft[0] -= ideal
        mean = own @ slopes + strange * slopes[0] / _STRANGE
        whole[place, place] -= (slopes.T * own) @ slopes - np.outer(mean, mean)
        whole[place, place] -= strange * np.outer(slopes[0], slopes[0]) / _STRANGE**2
        gradient[b] += mean
        by_part = np.vstack([
            ideal * slopes[0], (within * soft) @ slopes, strange * slopes[0] / _STRANGE
        ])  # fmt: skip
        by_share[place] += ((by_part - part[:, None] * mean) / share[:, None]).T
    return whole - _of_shares(member, share, by_share), gradient.ravel()


def _of_shares(member: Membership, share: Floats, by_share: Floats) -> Floats:
    """What not knowing the shares takes from the information about the sensor."""
    crossed = by_share @ _FREE.T
    information = _share_information(member, share)
    return np.asarray(crossed @ np.linalg.solve(information, crossed.T))


def _share_information(member: Membership, share: Floats) -> Floats:
    """What the edges and the prior say of the shares, in the directions of `_FREE`."""
    scaled = member.part / share
    return np.asarray(_FREE @ (scaled.T @ scaled + np.diag(_PSEUDO_COUNTS / share**2)) @ _FREE.T)


def share_std(member: Membership, share: Floats) -> Floats:
    """Standard deviations of the shares, the sensor being known, (5,)."""
    inverse = np.linalg.inv(_share_information(member, share))
    return np.asarray(np.sqrt(np.diagonal(_FREE.T @ inverse @ _FREE)))
