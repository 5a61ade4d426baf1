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

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.edge_likelihoods import EdgeLikelihoods, FactorLikelihoods, chunks
from acutance.scan.shares import likeliest_shares, log_prior, sectors_of
from acutance.scan.softness import NEARLY_IDEAL_PX, STRANGE, below_steps
from acutance.scan.softness_sums import cell_chances

__all__ = ["Membership", "SoftnessGrid", "fit_shares", "softness_grid"]

_COARSE_PX2: Final[Floats] = np.array([
    0.0, 0.01, 0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.9, 1.4, 2.0, 3.0, 4.5, 7.0, 11.0, 16.0
])  # fmt: skip
"""Variances from which the likeliest softness of an edge is sought."""
_CELLS: Final = 24
_TINY: Final = 1e-300
_REACH: Final = 5.0
"""The grid of an edge covers so many standard deviations of its softness."""


class SoftnessGrid(NamedTuple):
    """Equal cells of the softness that each of n objects may have, in px.

    Attributes
    ----------
    first_px : (n,) array
        Middle of the first cell.
    width_px : (n,) array
    """

    first_px: Floats
    width_px: Floats

    @property
    def middle_px(self) -> Floats:
        """Middles of all cells, (n, t)."""
        return self.first_px[:, None] + self.width_px[:, None] * np.arange(_CELLS)

    def chances(self, some: slice) -> Floats:
        """Probability of every law in the cells of some edges, (n, p - 2, t)."""
        return cell_chances(*below_steps(), self.first_px[some], self.width_px[some], _CELLS)


def softness_grid(objects: FactorLikelihoods) -> SoftnessGrid:
    """Cells about what the pixels of every edge allow."""
    middle, std = objects.likeliest_variances(_COARSE_PX2)
    low = np.sqrt(np.maximum(middle - _REACH * std, 0.0))
    high = np.sqrt(np.maximum(middle + _REACH * std, std))
    width = (high - low) / _CELLS
    return SoftnessGrid(low + 0.5 * width, width)


@dataclass(frozen=True, eq=False)
class Membership:
    """What n edges are, at a guess of the sensor and the shares.

    Attributes
    ----------
    objects : FactorLikelihoods
        What the pixels say of the objects under that sensor.
    grid : SoftnessGrid
    sector : (n,) int array
    share : (g, p) array
        Of the parts, in every sector of directions.
    odds : (n, t + 1) array
        Likelihood of every softness, over the largest of the edge; the first is of an ideal object.
    by_part : (n, p) array
        Likelihood of every part of the population, over the same.
    log_likelihood : float
        Of all edges.
    log_posterior : float
        The same, the prior of the shares counted.
    """

    objects: FactorLikelihoods
    grid: SoftnessGrid
    sector: NDArray[np.intp]
    share: Floats
    odds: Floats
    by_part: Floats
    log_likelihood: float
    log_posterior: float

    @property
    def softness_px(self) -> Floats:
        """Softness that each may have, (n, t + 1); the first is 0, of an ideal object."""
        return np.pad(self.grid.middle_px, ((0, 0), (1, 0)))

    @cached_property
    def part(self) -> Floats:
        """Probability of `softness.PARTS`, (n, p)."""
        odds = self.by_part * self.share[self.sector]
        return np.asarray(odds / odds.sum(axis=1, keepdims=True))

    @cached_property
    def chance(self) -> Floats:
        """Probability of each softness, of edges that are not strange, (n, t + 1)."""
        own = self.share[self.sector]
        chance = self.odds * own[:, :1]
        for some in chunks(self.sector.size):
            soft = own[some, None, 1:-1] @ self.grid.chances(some)
            chance[some, 1:] = self.odds[some, 1:] * soft[:, 0]
        return np.asarray(chance / np.sum(self.by_part * own, axis=1, keepdims=True))

    @property
    def mean_px(self) -> Floats:
        """Mean softness of every edge, (n,)."""
        whole = np.maximum(self.chance.sum(axis=1), _TINY)
        return np.asarray(np.sum(self.chance * self.softness_px, axis=1) / whole)

    @property
    def ideal(self) -> Floats:
        """Probability that the object of every edge counts as ideal, (n,)."""
        width = self.grid.width_px[:, None]
        below = np.clip((NEARLY_IDEAL_PX - self.grid.middle_px) / width + 0.5, 0.0, 1.0)
        return np.asarray(self.chance[:, 0] + np.sum(below * self.chance[:, 1:], axis=1))

    @cached_property
    def weight(self) -> Floats:
        """Information by softness that every edge gives, (n, t + 1): strange ones give little."""
        weight = self.chance.copy()
        weight[:, 0] += self.part[:, -1] / STRANGE
        return weight

    def within(self, some: slice) -> Floats:
        """Probability of every law by softness of some edges, being soft ones, (n, p - 2, t)."""
        by_law = self.share[self.sector[some], 1:-1, None] * self.grid.chances(some)
        return np.asarray(by_law / np.maximum(by_law.sum(axis=1, keepdims=True), _TINY))


def fit_shares(edges: EdgeLikelihoods, otf: Floats, share: Floats) -> Membership:
    """What the edges are under a given sensor (b, 2 k), from a first guess of the shares (g, p)."""
    objects = edges.of_objects(otf)
    grid = softness_grid(objects)
    power = -0.5 * (objects.powers(*grid, _CELLS) + edges.square[:, None])
    log_strange = power[:, 0] / STRANGE - 0.5 * edges.rank * np.log(STRANGE)
    largest = np.maximum(power.max(axis=1), log_strange)
    odds = np.exp(power - largest[:, None])
    strange = np.exp(log_strange - largest)
    by_law = np.concatenate([
        (grid.chances(some) @ odds[some, 1:, None])[:, :, 0] for some in chunks(edges.size)
    ])  # fmt: skip
    by_part = np.column_stack([odds[:, 0], by_law, strange])
    sector = sectors_of(edges.normal_deg)
    share = likeliest_shares(by_part, sector, share)
    whole = np.sum(by_part * share[sector], axis=1)
    log_likelihood = float(np.sum(largest) + np.sum(np.log(whole)))
    log_posterior = log_likelihood + log_prior(share)
    return Membership(objects, grid, sector, share, odds, by_part, log_likelihood, log_posterior)
