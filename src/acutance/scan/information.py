"""What the edges of a scene say of their sensor at a guess of it: gradient and information.

At a guess of H the mixture of an edge's likelihoods has the gradient of the expected log
likelihood (A. P. Dempster, N. M. Laird, D. B. Rubin, J. R. Stat. Soc. B 39, 1977, 1), and its
curvature is the expected information less what the hidden softness costs, the covariance of the
gradients (T. A. Louis, J. R. Stat. Soc. B 44, 1982, 226).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.scan.edge_likelihoods import EdgeLikelihoods, FactorLikelihoods, chunks
from acutance.scan.population import Membership
from acutance.scan.shares import SECTORS, share_information
from acutance.scan.softness import FREE, STRANGE
from acutance.scan.softness_sums import softness_terms, weighted_by_bin

__all__ = [
    "EdgeTerms",
    "expected_information",
    "gain_terms",
    "mode_information",
    "observed_information",
    "sensor_terms",
]


class EdgeTerms(NamedTuple):
    """Derivatives of the log likelihood of some edges by m unknowns.

    Attributes
    ----------
    edges : slice
    slopes : (n, t + 1, m) array
        Gradients for every softness.
    complete : (n, m, m) array
        Information if it were known what the edges are.
    chance : (n, t + 1) array
        Probability of each softness, of edges that are not strange.
    strange : (n,) array
        Probability of strange ones.
    """

    edges: slice
    slopes: Floats
    complete: Floats
    chance: Floats
    strange: Floats

    @property
    def if_strange(self) -> Floats:
        """Gradients of strange edges, (n, m)."""
        return np.asarray(self.slopes[:, 0] / STRANGE)

    @property
    def gradient(self) -> Floats:
        """What the edges are being integrated out, (n, m)."""
        return (self.chance[:, None] @ self.slopes)[:, 0] + self.strange[:, None] * self.if_strange

    @property
    def information(self) -> Floats:
        """What the edges are being integrated out, (n, m, m)."""
        missing = _turned(self.slopes * self.chance[:, :, None]) @ self.slopes
        missing += self.strange[:, None, None] * _squares(self.if_strange)
        return np.asarray(self.complete - missing + _squares(self.gradient))


def sensor_terms(edges: EdgeLikelihoods, otf: Floats, member: Membership) -> Iterator[EdgeTerms]:
    """Derivatives by the sensor along their bins (2 k) of all edges, some at a time.

    Parameters
    ----------
    edges : EdgeLikelihoods
    otf : (b, 2 k) array
    member : Membership
        At that sensor.
    """
    for some in chunks(edges.size):
        yield _terms(edges.of_sensor(some), otf[edges.bin[some]], member, some)


def gain_terms(member: Membership) -> Iterator[EdgeTerms]:
    """Derivatives by the logarithm of what each edge sees (k) of all edges, some at a time."""
    for some in chunks(member.sector.size):
        objects = member.objects.chosen(some)
        yield _terms(objects, np.ones_like(objects.pull), member, some)


def _terms(
    likelihoods: FactorLikelihoods, sensor: Floats, member: Membership, some: slice
) -> EdgeTerms:
    """Derivatives by a sensor (n, m), of some edges whose likelihoods are of it."""
    first, width = member.grid.first_px[some], member.grid.width_px[some]
    slopes, complete = softness_terms(*likelihoods, sensor, first, width, member.weight[some])
    return EdgeTerms(some, slopes, complete, member.chance[some], member.part[some, -1])


def mode_information(member: Membership, modes: Floats) -> tuple[Floats, Floats]:
    """Gradient by the amounts of modes, (q,), and the information about them, (q, q).

    What the edges are is integrated out, and so are the shares of the parts.

    Parameters
    ----------
    member : Membership
    modes : (n, k, q) array
        Change of the logarithm of what every edge sees by a unit of every mode.
    """
    size = modes.shape[2]
    pull, information = np.zeros(size), np.zeros((size, size))
    crossed = np.zeros((SECTORS, size, member.share.shape[1]))
    for terms in gain_terms(member):
        own = modes[terms.edges]
        slopes = terms.slopes @ own
        terms = terms._replace(slopes=slopes)
        gradient, weighted = terms.gradient, slopes * terms.chance[:, :, None]
        pull += gradient.sum(axis=0)
        information += _flat(own).T @ _flat(terms.complete @ own) + gradient.T @ gradient
        information -= _flat(weighted).T @ _flat(slopes)
        information -= (terms.if_strange * terms.strange[:, None]).T @ terms.if_strange
        np.add.at(crossed, member.sector[terms.edges], _crossed_with_shares(terms, member))
    return pull, information - _cost_of_shares(crossed, member)


def _cost_of_shares(crossed: Floats, member: Membership) -> Floats:
    """Information about unknowns (q, q) that not knowing the shares takes.

    Parameters
    ----------
    crossed : (g, q, p) array
        Sums over the edges of every sector of `_crossed_with_shares`.
    member : Membership
    """
    free = crossed @ FREE.T
    known = share_information(member.part, member.sector, member.share)
    return np.asarray(np.sum(free @ np.linalg.solve(known, _turned(free)), axis=0))


def _crossed_with_shares(terms: EdgeTerms, member: Membership) -> Floats:
    """Covariance of the gradients by unknowns and by the shares of the parts, (n, m, p).

    Parameters
    ----------
    terms : EdgeTerms
        Of some edges.
    member : Membership
        Of all of them.
    """
    part = member.part[terms.edges]
    weighted = terms.slopes * terms.chance[:, :, None]
    strange = terms.strange[:, None] * terms.if_strange
    by_law = member.within(terms.edges) @ weighted[:, 1:]
    by_part = np.concatenate([weighted[:, :1], by_law, strange[:, None]], axis=1)
    share = member.share[member.sector[terms.edges]]
    covariance = by_part - part[:, :, None] * terms.gradient[:, None]
    return _turned(covariance / share[:, :, None])


def _turned(matrices: Floats) -> Floats:
    return np.swapaxes(matrices, 1, 2)


def _flat(matrices: Floats) -> Floats:
    """All rows of matrices (n, r, q), (n * r, q)."""
    return matrices.reshape(-1, matrices.shape[2])


def _squares(vectors: Floats) -> Floats:
    return np.asarray(vectors[:, :, None] * vectors[:, None])


def expected_information(edges: EdgeLikelihoods, member: Membership) -> tuple[Floats, Floats]:
    """Information (b, 2 k, 2 k) about the sensor, and its product with the likeliest (b, 2 k).

    If it were known what the edges are: the function that expectation and maximisation maximises.
    """
    bins, size = int(edges.bin.max()) + 1, edges.pull.shape[1]
    information, projection = np.zeros((bins, size, size)), np.zeros((bins, size))
    weighted_by_bin(
        edges.information, edges.pull, edges.gain, edges.falls, *member.grid, member.weight,
        edges.bin, information, projection,
    )  # fmt: skip
    return information, projection


def observed_information(edges: EdgeLikelihoods, otf: Floats, member: Membership) -> Floats:
    """Information about the sensor in all directions, (b * 2 k, b * 2 k).

    What the edges are is integrated out, and so are the shares of the parts.
    """
    bins, size = otf.shape
    own = np.zeros((bins, size, size))
    by_share = np.zeros((SECTORS, bins, size, member.share.shape[1]))
    for terms in sensor_terms(edges, otf, member):
        where = edges.bin[terms.edges]
        np.add.at(own, where, terms.information)
        crossed = _crossed_with_shares(terms, member)
        np.add.at(by_share, (member.sector[terms.edges], where), crossed)
    whole = np.zeros((bins, size, bins, size))
    whole[np.arange(bins), :, np.arange(bins)] = own
    cost = _cost_of_shares(by_share.reshape(SECTORS, bins * size, -1), member)
    return np.asarray(whole.reshape(bins * size, -1) - cost)
