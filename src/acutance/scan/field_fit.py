"""How much the blur of a sensor changes over the field of view, as far as its edges show.

Fields of all degrees and sizes are compared by their evidence, the edges' likelihood with the
amounts integrated out (MacKay, Information Theory, Inference, and Learning Algorithms, 2003,
chapter 28): none, linear or quadratic; with the shape of the transfer function kept or not; of
amounts that are drawn from normal distributions of several widths. The result is their mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.scan.blur_modes import (
    BLUR_MODES,
    COMMON_MODES,
    ModesFit,
    edge_modes,
    fit_modes,
)
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.field import DEGREES, field_polynomials
from acutance.scan.information import gain_terms
from acutance.scan.population import fit_shares

__all__ = ["FieldFit", "fit_field"]

_STD_PX2: Final = (0.004, 0.015, 0.06, 0.2)
"""Widths of the amounts' distributions, px^2."""
_WIDE_PX2: Final = 0.3
"""Width of the one for the first fit, from which the others follow."""
_EDGES_EACH: Final = 10
"""Edges that a hypothesis needs for each of its amounts: a few soft objects are a field, too."""
_HEATS: Final = (4.0, 2.0)
"""Deviations of the edges are widened by these, one after the other, for a first guess."""
_CHANCE_CONSTANT: Final = 0.5
"""Before any edge is seen."""


class FieldFit(NamedTuple):
    """The change over the field.

    Attributes
    ----------
    middle : (5, 4) array
        Means of the polynomials over the edges, by mode.
    amount : (20,) array
    root : (20, r) array
        Factor of its covariance.
    chance_constant : float
    log_gain : (n, k) array
        What it does to every edge.
    common : (3,) array
        How much more than was guessed the sensor is blurred everywhere.
    """

    middle: Floats
    amount: Floats
    root: Floats
    chance_constant: float
    log_gain: Floats
    common: Floats


class _Field(NamedTuple):
    """One hypothesis: which amounts are not zero, and how wide their distribution is."""

    active: NDArray[np.bool_]
    std: float


def fit_field(
    edges: EdgeLikelihoods,
    otf: Floats,
    share: Floats,
    x: Floats,
    y: Floats,
    before: FieldFit | None = None,
) -> FieldFit:
    """Fit the change of the blur over the field.

    Parameters
    ----------
    edges : EdgeLikelihoods
    otf : (b, 2 k) array
        The sensor in the middle of the edges.
    share : (p,) array
        Of the parts of the population.
    x, y : (n,) arrays
        Places of the edges, -1 to 1 over the field.
    before : FieldFit, optional
        A first guess, under which the edges tell where their middle is.

    Returns
    -------
    FieldFit
        Of few edges nothing is asked: the chance of no change is what it was before.
    """
    along = edge_modes(edges.normal_deg, edges.freq_cpp)
    polynomials = field_polynomials(x, y)
    seen = edges if before is None else edges.turned(np.exp(before.log_gain))
    middle = _middle(seen, otf, share, along, polynomials)
    modes = (polynomials[:, :, None] - middle)[:, None] * along[:, :, None]
    modes = modes.reshape(*along.shape[:2], -1)
    fields = [one for one in _hypotheses() if _EDGES_EACH * one.active.sum() <= edges.size]
    if not fields:
        nothing = np.zeros(modes.shape[2])
        return FieldFit(
            middle, nothing, np.zeros((nothing.size, 0)), _CHANCE_CONSTANT, modes @ nothing,
            np.zeros(COMMON_MODES),
        )  # fmt: skip
    asked = np.any([one.active for one in fields], axis=0)
    both = np.concatenate([along[:, :, :COMMON_MODES], modes[:, :, asked]], axis=2)
    std = np.where(np.arange(both.shape[2]) < COMMON_MODES, np.inf, _WIDE_PX2)
    if before is None:
        starts = [np.zeros(std.size), _cooled(edges, otf, share, both, std)]
    else:
        starts = [np.concatenate([np.zeros(COMMON_MODES), before.amount[asked]])]
    fits = [fit_modes(edges, otf, share, both, start=start, std=std) for start in starts]
    fit = max(fits, key=lambda one: one.log_posterior)
    constant = fit_modes(edges, otf, share, along[:, :, :COMMON_MODES])
    fields = [one._replace(active=one.active[asked]) for one in fields]
    mean, covariance, chance = _mean(fit, constant.log_posterior, fields)
    size, axes = np.linalg.eigh(covariance)
    amount, root = np.zeros(asked.size), np.zeros((asked.size, size.size))
    amount[asked], root[asked] = mean, axes * np.sqrt(np.maximum(size, 0.0))
    return FieldFit(middle, amount, root, chance, modes @ amount, fit.amount[:COMMON_MODES])


def _cooled(
    edges: EdgeLikelihoods, otf: Floats, share: Floats, modes: Floats, std: Floats
) -> Floats:
    """A guess of the amounts from edges that are thought to be less exact than they are.

    A soft corner of the field then does not pass for soft objects in it (deterministic annealing;
    K. Rose, Proc. IEEE 86, 1998, 2210).
    """
    amount = np.zeros(std.size)
    for heat in _HEATS:
        amount = fit_modes(edges.rougher(heat), otf, share, modes, start=amount, std=std).amount
    return amount


def _middle(
    edges: EdgeLikelihoods, otf: Floats, share: Floats, along: Floats, polynomials: Floats
) -> Floats:
    """Means of the polynomials, every edge weighted by what it tells of a mode, (5, 4)."""
    weights = np.zeros((edges.size, along.shape[2]))
    member = fit_shares(edges, otf, share)
    for terms in gain_terms(member):
        own = along[terms.edges]
        weights[terms.edges] = np.sum(own * (terms.information @ own), axis=1)
    weights = np.maximum(weights, 0.0)
    return np.asarray(polynomials.T @ weights / np.maximum(weights.sum(axis=0), 1e-12))


def _without_common(information: Floats) -> Floats:
    """Information about the field if the sensor's own blur is not known."""
    common, own = slice(0, COMMON_MODES), slice(COMMON_MODES, None)
    whole = information[common, common] + np.eye(COMMON_MODES)
    crossed = information[own, common]
    return np.asarray(information[own, own] - crossed @ np.linalg.solve(whole, crossed.T))


def _hypotheses() -> list[_Field]:
    degree = np.repeat(DEGREES, len(BLUR_MODES))
    changes_shape = np.tile(np.arange(len(BLUR_MODES)) == len(BLUR_MODES) - 1, len(DEGREES))
    return [
        _Field((degree <= most) & (shape | ~changes_shape), std)
        for most, shape, std in product((1, 2), (False, True), _STD_PX2)
    ]


def _mean(
    fit: ModesFit, log_constant: float, fields: Sequence[_Field]
) -> tuple[Floats, Floats, float]:
    """Mean and covariance of the amounts over all hypotheses, and the chance of no change.

    The likelihood of a field is that of its quadratic form about the fit; that of no change is
    exact, and far from it.
    """
    found, size = fit.amount[COMMON_MODES:], fit.amount.size - COMMON_MODES
    value, axes = np.linalg.eigh(_without_common(fit.information))
    information = (axes * np.maximum(value, 0.0)) @ axes.T
    # The wide prior's pull ends where the edges' begins.
    pull = (information + np.eye(size) / _WIDE_PX2**2) @ found
    at_nothing = fit.log_posterior - 0.5 * float(found @ pull)
    means, covariances = np.zeros((len(fields) + 1, size)), np.zeros((len(fields) + 1, size, size))
    scores = np.full(len(fields) + 1, log_constant)
    for i, field in enumerate(fields, start=1):
        on = np.flatnonzero(field.active)
        posterior = information[np.ix_(on, on)] + np.eye(on.size) / field.std**2
        inverse = np.linalg.inv(posterior)
        means[i, on] = inverse @ pull[on]
        covariances[i][np.ix_(on, on)] = inverse
        narrowed = np.linalg.slogdet(posterior)[1] + 2 * on.size * np.log(field.std)
        scores[i] = at_nothing + 0.5 * (pull[on] @ means[i, on] - narrowed)
    odds = np.exp(scores - scores.max())
    odds *= np.r_[_CHANCE_CONSTANT, np.full(len(fields), (1 - _CHANCE_CONSTANT) / len(fields))]
    odds /= odds.sum()
    mean = odds @ means
    away = means - mean
    spread = np.einsum("h,hij->ij", odds, covariances) + (away.T * odds) @ away
    return mean, spread, float(odds[0])
