"""Shares of the objects that are ideal, soft or strange, by the direction of their borders.

Objects of one direction may be softer than those of another: rows of fields and the roads between
them, the shadow side of roofs, a slope towards the sun. Were their shares the same by assumption,
such a softness would pass for the sensor's blur of that direction. So every sector of directions
has shares of its own.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.scan.softness import FREE, PARTS, PSEUDO_COUNTS

__all__ = [
    "SECTORS",
    "SECTOR_DEG",
    "START",
    "likeliest_shares",
    "log_prior",
    "sectors_of",
    "share_covariances",
    "share_information",
]

SECTORS: Final = 8
"""About across, along and six directions between them."""
SECTOR_DEG: Final[Floats] = np.linspace(0.0, 180.0, SECTORS, endpoint=False)
"""Middle of every sector, (g,)."""
_SOFT_LAWS: Final = len(PARTS) - 2
START: Final[Floats] = np.tile([0.6, *(_SOFT_LAWS * [0.3 / _SOFT_LAWS]), 0.1], (SECTORS, 1))
"""Shares of the parts before any edge is seen, (g, p)."""
_BEFORE: Final[Floats] = PSEUDO_COUNTS / SECTORS
"""Edges that each part of a sector has before any is seen."""
_SETTLED: Final = 1e-4
_MAX_PASSES: Final = 200


def sectors_of(normal_deg: Floats) -> NDArray[np.intp]:
    """Sector of every direction, the first about the columns' axis, (n,)."""
    return np.asarray(np.rint(normal_deg * (SECTORS / 180.0)) % SECTORS, np.intp)


def likeliest_shares(by_part: Floats, sector: NDArray[np.intp], share: Floats) -> Floats:
    """Shares (g, p) that make the edges likeliest, from a first guess; likelihoods (n, p) by part.

    Every sector by itself.
    """
    return np.array([_likeliest(by_part[sector == g], own, _BEFORE) for g, own in enumerate(share)])


def log_prior(share: Floats) -> float:
    """Logarithm of the prior density of shares (g, p), but for a constant."""
    return float(np.sum(np.log(share) @ _BEFORE))


@compiled
def _likeliest(by_part: Floats, first: Floats, before: Floats) -> Floats:
    """The likeliest shares of a sector, (p,), by expectation and maximisation."""
    edges, parts = by_part.shape
    share, counts = first.copy(), np.empty(parts)
    for _ in range(_MAX_PASSES):
        counts[:] = 0.0
        for i in range(edges):
            whole = 0.0
            for j in range(parts):
                whole += by_part[i, j] * share[j]
            for j in range(parts):
                counts[j] += by_part[i, j] / whole
        moved, total = 0.0, 0.0
        for j in range(parts):
            counts[j] = share[j] * counts[j] + before[j]
            total += counts[j]
        for j in range(parts):
            moved = max(moved, abs(counts[j] / total - share[j]))
            share[j] = counts[j] / total
        if moved < _SETTLED:
            break
    return share


def share_information(part: Floats, sector: NDArray[np.intp], share: Floats) -> Floats:
    """What edges and prior say of every sector's shares, along `softness.FREE`, (g, p - 1, p - 1).

    Parameters
    ----------
    part : (n, p) array
        Probability of every part.
    sector : (n,) int array
    share : (g, p) array
    """
    scaled = part / share[sector]
    own = [scaled[sector == g] for g in range(SECTORS)]
    prior = [np.diag(_BEFORE / one**2) for one in share]
    return np.array([
        FREE @ (one.T @ one + before) @ FREE.T for one, before in zip(own, prior, strict=True)
    ])  # fmt: skip


def share_covariances(part: Floats, sector: NDArray[np.intp], share: Floats) -> Floats:
    """Covariance of the shares of every sector, the sensor being known, (g, p, p)."""
    own = np.linalg.inv(share_information(part, sector, share))
    return np.asarray(FREE.T @ own @ FREE)
