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
from acutance.scan.population import EdgeLikelihoods, Membership
from acutance.scan.shares import SECTORS, share_information
from acutance.scan.softness import FREE, STRANGE

__all__ = [
    "EdgeTerms",
    "cost_of_shares",
    "crossed_with_shares",
    "edge_terms",
    "expected_information",
    "observed_information",
]


class EdgeTerms(NamedTuple):
    """Derivatives of the log likelihood of some edges by the sensor along their bins.

    Attributes
    ----------
    edges : slice
    slopes : (n, t + 1, 2 k) array
        Gradients for every softness.
    gradient : (n, 2 k) array
    information : (n, 2 k, 2 k) array
        What the edges are being integrated out.
    """

    edges: slice
    slopes: Floats
    gradient: Floats
    information: Floats


def edge_terms(edges: EdgeLikelihoods, otf: Floats, member: Membership) -> Iterator[EdgeTerms]:
    """Gradient and observed information of all edges, some at a time.

    Parameters
    ----------
    edges : EdgeLikelihoods
    otf : (b, 2 k) array
    member : Membership
        At that sensor.
    """
    for some in edges.chunks():
        blur = edges.blur(member.softness_px[some] ** 2)
        # Gradients of the log likelihood by the sensor, for every softness.
        slopes = -(edges.off(otf, some, blur) @ _turned(edges.seen_root(some))) * blur
        chance, strange = member.chance[some], member.part[some, -1:]
        weighted, if_strange = slopes * chance[:, :, None], slopes[:, 0] / STRANGE
        mean = weighted.sum(axis=1) + strange * if_strange
        missing = _turned(weighted) @ slopes - _squares(mean)
        missing += strange[:, :, None] * _squares(if_strange)
        complete = _complete(edges, some, blur, member.weight[some])
        yield EdgeTerms(some, slopes, mean, complete - missing)


def cost_of_shares(crossed: Floats, member: Membership) -> Floats:
    """Information about unknowns (q, q) that not knowing the shares takes.

    Parameters
    ----------
    crossed : (g, q, p) array
        Sums over the edges of every sector of `crossed_with_shares`.
    member : Membership
    """
    free = crossed @ FREE.T
    known = share_information(member.part, member.sector, member.share)
    return np.asarray(np.sum(free @ np.linalg.solve(known, _turned(free)), axis=0))


def crossed_with_shares(terms: EdgeTerms, member: Membership, slopes: Floats) -> Floats:
    """Covariance of the gradients by unknowns and by the shares of the parts, (n, q, p).

    Parameters
    ----------
    terms : EdgeTerms
        Of some edges.
    member : Membership
        Of all of them.
    slopes : (n, t + 1, q) array
        Gradients of these edges by the unknowns, for every softness.
    """
    part, chance = member.part[terms.edges], member.chance[terms.edges]
    weighted = slopes * chance[:, :, None]
    strange = part[:, -1:] * slopes[:, 0] / STRANGE
    mean = weighted.sum(axis=1) + strange
    by_law = np.einsum("pnt,ntq->npq", member.within(terms.edges), weighted[:, 1:])
    by_part = np.concatenate([weighted[:, :1], by_law, strange[:, None]], axis=1)
    share = member.share[member.sector[terms.edges]]
    return np.asarray(_turned((by_part - part[:, :, None] * mean[:, None]) / share[:, :, None]))


def _complete(edges: EdgeLikelihoods, some: slice, blur: Floats, weight: Floats) -> Floats:
    """Information of some edges if it were known what they are, (n, 2 k, 2 k)."""
    root = edges.seen_root(some)
    return np.asarray((_turned(blur * weight[:, :, None]) @ blur) * (root @ _turned(root)))


def _turned(matrices: Floats) -> Floats:
    return np.swapaxes(matrices, 1, 2)


def _squares(vectors: Floats) -> Floats:
    return np.asarray(vectors[:, :, None] * vectors[:, None])


def expected_information(edges: EdgeLikelihoods, member: Membership) -> tuple[Floats, Floats]:
    """Information (b, 2 k, 2 k) about the sensor, and its product with the likeliest (b, 2 k).

    If it were known what the edges are: the function that expectation and maximisation maximises.
    """
    bins, size = int(edges.bin.max()) + 1, edges.root.shape[1]
    information, projection = np.zeros((bins, size, size)), np.zeros((bins, size))
    for some in edges.chunks():
        blur, weight = edges.blur(member.softness_px[some] ** 2), member.weight[some]
        pull = np.einsum("nkr,nr->nk", edges.seen_root(some), edges.value[some])
        np.add.at(projection, edges.bin[some], np.einsum("nt,ntk->nk", weight, blur) * pull)
        np.add.at(information, edges.bin[some], _complete(edges, some, blur, weight))
    return information, projection


def observed_information(edges: EdgeLikelihoods, otf: Floats, member: Membership) -> Floats:
    """Information about the sensor in all directions, (b * 2 k, b * 2 k).

    What the edges are is integrated out, and so are the shares of the parts.
    """
    bins, size = otf.shape
    own = np.zeros((bins, size, size))
    by_share = np.zeros((SECTORS, bins, size, member.share.shape[1]))
    for terms in edge_terms(edges, otf, member):
        where = edges.bin[terms.edges]
        np.add.at(own, where, terms.information)
        crossed = crossed_with_shares(terms, member, terms.slopes)
        np.add.at(by_share, (member.sector[terms.edges], where), crossed)
    whole = np.zeros((bins, size, bins, size))
    whole[np.arange(bins), :, np.arange(bins)] = own
    cost = cost_of_shares(by_share.reshape(SECTORS, bins * size, -1), member)
    return np.asarray(whole.reshape(bins * size, -1) - cost)
