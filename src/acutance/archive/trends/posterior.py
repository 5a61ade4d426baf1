"""The posterior of a trend: normal densities of its coefficients, weighed by evidence.

Whether there is a drift, a season, how many steps there are and where, how heavy the tails of the
scatter are and how large it is: each combination gives a normal density of the coefficients
(`acutance.numerics.student_regression`), and a weight. Rate and level are read from the
combinations with a drift, because a drift may always be there: what is taken for none has made
intervals of small drifts too short (83 % instead of 95 % held 1 % a year). Steps are weighed
against drifts with the possibility that there is none.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.design import Design
from acutance.archive.trends.images import ImageMeans
from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.archive.trends.steps import (
    MAX_STEPS,
    StepSets,
    possible_places,
    weigh_steps,
)
from acutance.archive.trends.tuned import (
    DEGREES,
    DRIFT_STDS_PER_YEAR,
    SCATTER,
    SEASON_PROBABILITY,
    STEP_STD,
)
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.student_regression import (
    ScatterNodes,
    StudentModel,
    scatter_nodes,
    step_evidences,
)

__all__ = ["TrendPosterior", "trend_posterior"]

_FEW_IMAGES: Final = 12
_NODES_OF_FEW: Final[Floats] = np.linspace(-3.6, 5.4, 16)
"""Of few images the scatter has a long tail upwards."""
_NODES: Final[Floats] = np.linspace(-2.4, 2.8, 5)
_SETS: Final = 40
_COVERED: Final = 0.97
_MAX_NODES: Final = 300
_KEPT: Final = 0.9995


@dataclass(frozen=True, eq=False)
class TrendPosterior(ShortRepr):
    """Normal densities of the coefficients, relative to a unit; p of the design, then 3 steps.

    Attributes
    ----------
    design : Design
    unit : float
        What the coefficients are multiples of.
    share : (q,) array
        Sums to 1.
    drifts : (q,) bool array
        Whether the density allows a drift.
    has_season : (q,) bool array
    step_low, step_high : (q, 3) array
        Years between which each step lies; ``nan`` where there is none.
    mode : (q, p + 3) array
    covariance : (q, p + 3, p + 3) array
    scatter : (q,) array
        Scale of the scatter between images.
    degrees : (q,) array
    hypothesis : (2, 4) array
        Probability of a drift with 0, 1, 2, 3 steps (first row), and of none with them.
    """

    design: Design
    unit: float
    share: Floats
    drifts: NDArray[np.bool_]
    has_season: NDArray[np.bool_]
    step_low: Floats
    step_high: Floats
    mode: Floats
    covariance: Floats
    scatter: Floats
    degrees: Floats
    hypothesis: Floats

    @property
    def step_probability(self) -> Floats:
        """Probability of 0, 1, 2, 3 steps, (4,)."""
        return np.asarray(self.hypothesis.sum(axis=0))

    @property
    def steady_probability(self) -> float:
        """Probability of neither a drift nor a step."""
        return float(self.hypothesis[1, 0])

    @property
    def steps(self) -> NDArray[np.int64]:
        """Number of steps of every density, (q,)."""
        return np.asarray(np.isfinite(self.step_low).sum(axis=1))

    def those(self, mask: NDArray[np.bool_]) -> TrendPosterior:
        """The densities of a mask, their shares made to sum to 1."""
        share = self.share[mask]
        return replace(
            self, share=share / share.sum(), drifts=self.drifts[mask],
            has_season=self.has_season[mask], step_low=self.step_low[mask],
            step_high=self.step_high[mask], mode=self.mode[mask],
            covariance=self.covariance[mask], scatter=self.scatter[mask],
            degrees=self.degrees[mask],
        )  # fmt: skip

    def drifting(self) -> TrendPosterior:
        """The densities that allow a drift, with the probabilities of steps that all have."""
        found = self.those(self.drifts)
        own = np.bincount(found.steps, found.share, minlength=MAX_STEPS + 1)
        share = found.share * (self.step_probability / np.maximum(own, 1e-12))[found.steps]
        return replace(found, share=share / share.sum())

    def rows(self, when: Floats, *, season: bool = True) -> Floats:
        """What the coefficients are multiplied by at some dates, (q, n, p + 3)."""
        fixed = self.design.columns(when, season=season)
        middle = 0.5 * (self.step_low + self.step_high)
        with np.errstate(invalid="ignore"):
            after = (when[None, :, None] >= middle[:, None, :]).astype(float)
        repeated = np.broadcast_to(fixed, (self.share.size, *fixed.shape))
        return np.concatenate([repeated, after], axis=2)

    def rows_each(self, when: Floats) -> Floats:
        """The same, without the season, at a date of its own for every density, (q, p + 3)."""
        fixed = self.design.columns(when, season=False)
        with np.errstate(invalid="ignore"):
            after = when[:, None] >= 0.5 * (self.step_low + self.step_high)
        return np.column_stack([fixed, after])

    def of(self, rows: Floats) -> tuple[Floats, Floats]:
        """Means and standard deviations of sums of coefficients, (q, n) each.

        Parameters
        ----------
        rows : (q, n, p + 3) array
        """
        mean = np.einsum("qni,qi->qn", rows, self.mode)
        variance = np.einsum("qni,qij,qnj->qn", rows, self.covariance, rows)
        return self.unit * mean, self.unit * np.sqrt(np.maximum(variance, 0.0))

    def rate(self, when: float) -> NormalMixture:
        """The density of the drift per year at a date."""
        row = np.zeros(self.mode.shape[1])
        slopes = self.design.slopes(when)
        row[: slopes.size] = slopes
        mean, std = self.of(np.broadcast_to(row, (self.share.size, 1, row.size)))
        return NormalMixture(self.share, mean[:, 0], std[:, 0])

    def coefficient(self, index: int) -> NormalMixture:
        """The density of one coefficient."""
        std = np.sqrt(self.covariance[:, index, index])
        return NormalMixture(self.share, self.unit * self.mode[:, index], self.unit * std)


def trend_posterior(images: ImageMeans, design: Design) -> TrendPosterior:
    """Weigh all combinations and keep those that matter.

    Parameters
    ----------
    images : ImageMeans
    design : Design
    """
    unit = _unit(images.value)
    prior = {**DRIFT_STDS_PER_YEAR, 0.0: 1 - sum(DRIFT_STDS_PER_YEAR.values())}
    families = [_family(images, design, unit, drift_std) for drift_std in prior]
    log_total = np.array([family.log_evidence for family in families]) + np.log([*prior.values()])
    weight = np.exp(log_total - log_total.max())
    weight /= weight.sum()
    each = weight[:, None] * np.array([family.step_probability for family in families])
    hypothesis = np.array([each[:-1].sum(axis=0), each[-1]])
    return _joined(families, weight, design, unit, hypothesis)


def _unit(value: Floats) -> float:
    """The level; of numbers about 0 what they differ by, ten times."""
    median = float(np.median(value))
    scatter = 1.4826 * float(np.median(np.abs(value - median)))
    return max(abs(median), 10 * scatter) or 1.0


@dataclass(frozen=True, eq=False)
class _Node:
    """Combination of steps, season and degrees: its share and densities."""

    share: float
    season: bool
    degrees: float
    low: Floats
    high: Floats
    nodes: ScatterNodes


@dataclass(frozen=True, eq=False)
class _Family:
    """All combinations with one prior of the drift, or without a drift."""

    drifts: bool
    log_evidence: float
    step_probability: Floats
    nodes: list[_Node]


def _model(
    images: ImageMeans, design: Design, unit: float, drift_std: float, season: bool, degrees: float
) -> StudentModel:
    value = images.value / unit
    columns = design.columns(images.when)
    spread = 1.4826 * float(np.median(np.abs(value - np.median(value))))
    return StudentModel(
        columns, value, images.variance / unit**2,
        design.precision(drift_std=drift_std, season=season), degrees, SCATTER,
        float(np.log(max(0.8 * spread, 0.003))),
    )  # fmt: skip


def _states() -> Iterator[tuple[bool, float, float]]:
    """Season, degrees of freedom and their log prior."""
    for season in (False, True):
        chance = SEASON_PROBABILITY if season else 1 - SEASON_PROBABILITY
        for degrees in DEGREES:
            yield season, degrees, float(np.log(chance / len(DEGREES)))


_Models = dict[tuple[bool, float], tuple[StudentModel, float]]
"""By season and degrees of freedom, with the log prior of these."""


def _family(images: ImageMeans, design: Design, unit: float, drift_std: float) -> _Family:
    places = possible_places(images.when, np.array([event.year for event in design.events]))
    models = {
        (season, degrees): (_model(images, design, unit, drift_std, season, degrees), log_prior)
        for season, degrees, log_prior in _states()
    }
    few = places._replace(most=min(places.most, 1))
    first = {state: _log_sum(weigh_steps(model, few)) + log_prior
             for state, (model, log_prior) in models.items()}  # fmt: skip
    likeliest = max(first, key=lambda state: first[state])
    found = weigh_steps(models[likeliest][0], places)
    log_weight = np.full(MAX_STEPS + 1, -np.inf)
    combinations: list[tuple[float, _Node]] = []
    for sets in found:
        own, log_sum = _of_sets(sets, images, models)
        log_weight[sets.steps.shape[1]] = log_sum
        combinations += own
    highest = float(log_weight.max())
    weight = np.exp(log_weight - highest)
    total = float(weight.sum())
    nodes = [replace(node, share=float(np.exp(log_one - highest)) / total)
             for log_one, node in combinations]  # fmt: skip
    return _Family(drift_std > 0, highest + float(np.log(total)), weight / total, nodes)


def _log_sum(found: list[StepSets]) -> float:
    """Log of the summed weights."""
    log_weight = np.concatenate([sets.log_weight for sets in found])
    highest = float(log_weight.max())
    return highest + float(np.log(np.exp(log_weight - highest).sum()))


def _of_sets(
    sets: StepSets, images: ImageMeans, models: _Models
) -> tuple[list[tuple[float, _Node]], float]:
    """The combinations with k steps at the likeliest places, scaled to all places; their sum."""
    log_all = _log_sum([sets])
    order = np.argsort(-sets.log_weight, kind="stable")
    covered = np.cumsum(np.exp(sets.log_weight[order] - log_all))
    enough = int(np.searchsorted(covered, _COVERED)) + 1
    best = order[: min(enough, _SETS)]
    log_missing = -float(np.log(covered[best.size - 1]))
    log_each = np.array([
        step_evidences(model, sets.steps[best], 1 / STEP_STD**2) + log_prior
        for model, log_prior in models.values()
    ]) + sets.log_prior[best] + log_missing  # fmt: skip
    highest = float(log_each.max())
    log_sum = highest + float(np.log(np.exp(log_each - highest).sum()))
    places = _NODES_OF_FEW if images.size <= _FEW_IMAGES else _NODES
    found = []
    for (season, degrees), row in zip(models, log_each, strict=True):
        model = models[season, degrees][0]
        for log_one, steps in zip(row, sets.steps[best], strict=True):
            if log_one - log_sum > np.log(3e-4):
                nodes = scatter_nodes(_with_steps(model, steps), places)
                low, high = _years(images, steps)
                found.append((float(log_one), _Node(0.0, season, degrees, low, high, nodes)))
    return found, log_sum


def _with_steps(model: StudentModel, steps: NDArray[np.int64]) -> StudentModel:
    after = np.arange(model.value.size)[:, None] >= steps[None, :]
    return replace(
        model, columns=np.hstack([model.columns, after]),
        precision=np.concatenate([model.precision, np.full(steps.size, 1 / STEP_STD**2)]),
    )  # fmt: skip


def _years(images: ImageMeans, steps: NDArray[np.int64]) -> tuple[Floats, Floats]:
    low, high = np.full(MAX_STEPS, np.nan), np.full(MAX_STEPS, np.nan)
    low[: steps.size], high[: steps.size] = images.when[steps - 1], images.when[steps]
    return low, high


def _joined(
    families: list[_Family], weight: Floats, design: Design, unit: float, hypothesis: Floats
) -> TrendPosterior:
    """All densities of both families, without those of no weight."""
    size = design.size + MAX_STEPS
    parts = [(family.drifts, part, node) for family, part in zip(families, weight, strict=True)
             for node in family.nodes]  # fmt: skip
    share = np.concatenate([part * node.share * node.nodes.share for _, part, node in parts])
    order = np.argsort(-share, kind="stable")
    enough = int(np.searchsorted(np.cumsum(share[order]) / share.sum(), _KEPT)) + 1
    best = order[: min(enough, _MAX_NODES)]
    # Densities with a drift answer for rate and level, however probable they are.
    own = np.concatenate([np.full(node.nodes.share.size, drifts) for drifts, _, node in parts])
    drifting = order[own[order]]
    enough = int(np.searchsorted(np.cumsum(share[drifting]) / share[drifting].sum(), _KEPT)) + 1
    best = np.unique(np.concatenate([best, drifting[: min(enough, _MAX_NODES)]]))
    mode, covariance = np.zeros((share.size, size)), np.zeros((share.size, size, size))
    at = 0
    for _, _, node in parts:
        count, own_size = node.nodes.mode.shape
        mode[at : at + count, :own_size] = node.nodes.mode
        # The inverse of a factor is symmetric but for rounding.
        symmetric = 0.5 * (node.nodes.covariance + node.nodes.covariance.transpose(0, 2, 1))
        covariance[at : at + count, :own_size, :own_size] = symmetric
        at += count

    def column(values: list[float | Floats | bool]) -> Floats:
        sizes = [node.nodes.share.size for _, _, node in parts]
        return np.asarray(np.repeat(np.array(values), sizes, axis=0)[best])

    return TrendPosterior(
        design, unit, share[best] / share[best].sum(), own[best],
        column([node.season for _, _, node in parts]).astype(bool),
        column([node.low for _, _, node in parts]), column([node.high for _, _, node in parts]),
        mode[best], covariance[best],
        unit * np.concatenate([node.nodes.scatter for _, _, node in parts])[best],
        column([node.degrees for _, _, node in parts]), hypothesis,
    )  # fmt: skip
