"""Combinations of a trend: steps and their places, season, tails, scatter, target deviation.

Each gives a normal density of the coefficients, and a weight by prior and evidence.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from acutance.archive.trends.design import Design
from acutance.archive.trends.images import ImageMeans
from acutance.archive.trends.steps import (
    MAX_STEPS,
    StepSets,
    possible_places,
    weigh_steps,
)
from acutance.archive.trends.target_effects import EffectsGiven
from acutance.archive.trends.tuned import (
    DEGREES,
    EVENT_STDS,
    SCATTER,
    SEASON_PROBABILITY,
    STEP_STD,
)
from acutance.curves.grid import Floats
from acutance.numerics.student_regression import (
    ScatterNodes,
    StudentModel,
    scatter_nodes,
    step_evidences,
)

__all__ = ["Combination", "DriftFamily", "State", "TargetStds", "drift_family"]

_FEW_IMAGES: Final = 12
_NODES_OF_FEW: Final[Floats] = np.linspace(-3.6, 5.4, 16)
"""Of few images the scatter has a long tail upwards."""
_NODES: Final[Floats] = np.linspace(-2.4, 2.8, 5)
_SETS: Final = 40
_COVERED: Final = 0.97
_UNLIKELY: Final = 4.0
"""Logarithm by which the weight of a deviation of events or targets is less than the best, to be
left out."""


class State(NamedTuple):
    """Season, degrees of freedom; relative deviations of steps at events, and between targets."""

    season: bool
    degrees: float
    event_std: float
    target_std: float


TargetStds = Mapping[float, tuple[EffectsGiven, float]]
"""Effects by their relative deviation, with its prior probability."""


@dataclass(frozen=True, eq=False)
class Combination:
    """Steps in some gaps, and a state.

    Attributes
    ----------
    share : float
        Of all combinations of a family.
    state : State
    low, high : (3,) array
        Years between which each step lies; ``nan`` where there is none.
    nodes : ScatterNodes
        The densities, at several scatters.
    effect : (j,) array
        What targets add to the images.
    """

    share: float
    state: State
    low: Floats
    high: Floats
    nodes: ScatterNodes
    effect: Floats


@dataclass(frozen=True, eq=False)
class DriftFamily:
    """All combinations with one prior of the drift, or without a drift.

    Attributes
    ----------
    drifts : bool
    log_evidence : float
    step_probability : (4,) array
        Of 0 to 3 steps.
    nodes : list of Combination
    """

    drifts: bool
    log_evidence: float
    step_probability: Floats
    nodes: list[Combination]


class _Model(NamedTuple):
    """The regression of a state, the effects in it, and the logarithm of its prior."""

    regression: StudentModel
    effects: EffectsGiven
    log_prior: float


def _model(
    images: ImageMeans, design: Design, unit: float, drift_std: float, state: State,
    effects: EffectsGiven,
) -> StudentModel:  # fmt: skip
    value = (images.value - effects.shift) / unit
    columns = np.hstack([design.columns(images.when), effects.columns / unit])
    precision = design.precision(
        drift_std=drift_std, season=state.season, event_std=state.event_std
    )
    spread = 1.4826 * float(np.median(np.abs(value - np.median(value))))
    return StudentModel(
        columns, value, images.variance / unit**2,
        np.append(precision, np.ones(effects.columns.shape[1])), state.degrees, SCATTER,
        float(np.log(max(0.8 * spread, 0.003))),
    )  # fmt: skip


def _states(targets: TargetStds, events: int) -> Iterator[tuple[State, float]]:
    """Every state, and its log prior with what images say by themselves of their targets."""
    seasons = {False: 1 - SEASON_PROBABILITY, True: SEASON_PROBABILITY}
    steps = EVENT_STDS if events else {max(EVENT_STDS): 1.0}
    for (season, chance), degrees, (event_std, steep), (std, (effects, own)) in product(
        seasons.items(), DEGREES, steps.items(), targets.items()
    ):
        log_prior = float(np.log(own * steep * chance / len(DEGREES)))
        yield State(season, degrees, event_std, std), log_prior + effects.log_evidence


def drift_family(
    images: ImageMeans, design: Design, unit: float, drift_std: float, targets: TargetStds
) -> DriftFamily:
    """Weigh all combinations with one prior of the drift.

    Parameters
    ----------
    images : ImageMeans
    design : Design
    unit : float
        What coefficients are multiples of.
    drift_std : float
        Of the prior of the drift a year; 0 for none.
    targets : mapping
        Effects by their relative deviation, with its prior probability.
    """
    places = possible_places(images.when, np.array([event.year for event in design.events]))
    models = {
        state: _Model(
            _model(images, design, unit, drift_std, state, targets[state.target_std][0]),
            targets[state.target_std][0], log_prior,
        )
        for state, log_prior in _states(targets, len(design.events))
    }  # fmt: skip
    few = places._replace(most=min(places.most, 1))
    first = {state: _log_sum(weigh_steps(model.regression, few)) + model.log_prior
             for state, model in models.items()}  # fmt: skip
    likeliest = max(first, key=lambda state: first[state])
    models = _likely(models, first)
    found = weigh_steps(models[likeliest].regression, places)
    log_weight = np.full(MAX_STEPS + 1, -np.inf)
    combinations: list[tuple[float, Combination]] = []
    for sets in found:
        own, log_sum = _of_sets(sets, images, design.size, unit, models)
        log_weight[sets.steps.shape[1]] = log_sum
        combinations += own
    highest = float(log_weight.max())
    weight = np.exp(log_weight - highest)
    total = float(weight.sum())
    nodes = [replace(node, share=float(np.exp(log_one - highest)) / total)
             for log_one, node in combinations]  # fmt: skip
    return DriftFamily(drift_std > 0, highest + float(np.log(total)), weight / total, nodes)


def _likely(models: dict[State, _Model], first: Mapping[State, float]) -> dict[State, _Model]:
    """The models without deviations of events and targets that no season or tail makes likely."""
    best: dict[tuple[float, float], float] = {}
    for state, log_one in first.items():
        stds = state.event_std, state.target_std
        best[stds] = max(log_one, best.get(stds, -np.inf))
    least = max(best.values()) - _UNLIKELY
    return {
        state: model for state, model in models.items()
        if best[state.event_std, state.target_std] >= least
    }  # fmt: skip


def _log_sum(found: list[StepSets]) -> float:
    """Log of the summed weights."""
    return float(logsumexp(np.concatenate([sets.log_weight for sets in found])))


def _of_sets(
    sets: StepSets, images: ImageMeans, columns: int, unit: float, models: dict[State, _Model]
) -> tuple[list[tuple[float, Combination]], float]:
    """The combinations with k steps at the likeliest places, scaled to all places; their sum."""
    log_all = _log_sum([sets])
    order = np.argsort(-sets.log_weight, kind="stable")
    covered = np.cumsum(np.exp(sets.log_weight[order] - log_all))
    enough = int(np.searchsorted(covered, _COVERED)) + 1
    best = order[: min(enough, _SETS)]
    log_missing = -float(np.log(covered[best.size - 1]))
    log_each = np.array([
        step_evidences(model.regression, sets.steps[best], 1 / STEP_STD**2) + model.log_prior
        for model in models.values()
    ]) + sets.log_prior[best] + log_missing  # fmt: skip
    log_sum = float(logsumexp(log_each))
    places = _NODES_OF_FEW if images.size <= _FEW_IMAGES else _NODES
    found = []
    for (state, model), row in zip(models.items(), log_each, strict=True):
        for log_one, steps in zip(row, sets.steps[best], strict=True):
            if log_one - log_sum > np.log(3e-4):
                nodes = scatter_nodes(_with_steps(model.regression, steps), places)
                nodes, effect = _without_effects(nodes, model.effects, columns)
                low, high = _years(images, steps)
                found.append((float(log_one), Combination(0.0, state, low, high, nodes, effect)))
    return found, log_sum


def _with_steps(model: StudentModel, steps: NDArray[np.int64]) -> StudentModel:
    after = np.arange(model.value.size)[:, None] >= steps[None, :]
    return replace(
        model, columns=np.hstack([model.columns, after]),
        precision=np.concatenate([model.precision, np.full(steps.size, 1 / STEP_STD**2)]),
    )  # fmt: skip


def _without_effects(
    nodes: ScatterNodes, effects: EffectsGiven, columns: int
) -> tuple[ScatterNodes, Floats]:
    """The densities of all other coefficients, and the mean of the effects in the images."""
    end = columns + effects.columns.shape[1]
    if end == columns:
        return nodes, effects.shift
    mean = nodes.share @ nodes.mode[:, columns:end]
    kept = [*range(columns), *range(end, nodes.mode.shape[1])]
    # A normal density without some of its coefficients is that of the others.
    own = replace(nodes, mode=nodes.mode[:, kept], covariance=nodes.covariance[:, kept][:, :, kept])
    return own, effects.shift + effects.columns @ mean


def _years(images: ImageMeans, steps: NDArray[np.int64]) -> tuple[Floats, Floats]:
    low, high = np.full(MAX_STEPS, np.nan), np.full(MAX_STEPS, np.nan)
    low[: steps.size], high[: steps.size] = images.when[steps - 1], images.when[steps]
    return low, high
