"""Steps at unknown dates: which sets of places are worth weighing, and their prior.

A set of k places is as probable beforehand as the gaps between images in which its steps would
lie are long, and k steps as a Poisson number in the time that was watched. All single places and
pairs are weighed; of many images pairs are sought on every few of them first, then around the
best. Sets of three are the best pairs with any third place.
"""

from __future__ import annotations

from itertools import combinations
from math import log
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.tuned import (
    MIN_IMAGES_BY_STEPS,
    MIN_SEGMENT,
    STEP_STD,
    STEPS_PER_YEAR,
)
from acutance.curves.grid import Floats
from acutance.numerics.student_regression import StudentModel, step_evidences

__all__ = ["MAX_STEPS", "Places", "StepSets", "possible_places", "weigh_steps"]

MAX_STEPS: Final = len(MIN_IMAGES_BY_STEPS)
_ALL_PAIRS: Final = 60
"""Places up to which all pairs are weighed."""
_COARSE: Final = 24
_BEST: Final = 10

Steps = NDArray[np.int64]


class Places(NamedTuple):
    """Where a step may be.

    Attributes
    ----------
    first : (m,) int array
        The first image after it.
    log_gap : (m,) array
        Log of the gap before that image, over the time that was watched.
    years : float
        The time that was watched.
    most : int
        Steps that so many images may show.
    """

    first: Steps
    log_gap: Floats
    years: float
    most: int


class StepSets(NamedTuple):
    """Sets of k places and how probable each is, k included.

    Attributes
    ----------
    steps : (m, k) int array
    log_prior, log_evidence : (m,) array
    """

    steps: Steps
    log_prior: Floats
    log_evidence: Floats

    @property
    def log_weight(self) -> Floats:
        """Log of prior times evidence, (m,)."""
        return self.log_prior + self.log_evidence


def possible_places(when: Floats, stated: Floats) -> Places:
    """Gaps between images that a step may lie in.

    Parameters
    ----------
    when : (j,) array
        In the order of time.
    stated : (e,) array
        Dates of stated events: the gap that holds one has its step already.
    """
    most = sum(when.size >= least for least in MIN_IMAGES_BY_STEPS)
    years = float(when[-1] - when[0])
    first = np.arange(MIN_SEGMENT, when.size - MIN_SEGMENT + 1)
    gap = when[first] - when[first - 1]
    taken = [(when[first - 1] < year) & (year <= when[first]) for year in stated]
    is_free = (gap > 0) & ~np.any(taken, axis=0) if taken else gap > 0
    first, gap = first[is_free], gap[is_free]
    return Places(first, np.log(gap / max(years, 1e-9)), years, most if first.size else 0)


def _log_prior(steps: Steps, places: Places) -> Floats:
    """Of sets of k places and of k."""
    count = steps.shape[1]
    expected = STEPS_PER_YEAR * places.years
    log_gap = np.full(int(places.first.max()) + 1 if places.first.size else 1, -np.inf)
    log_gap[places.first] = places.log_gap
    # The Poisson number's 1 / k! goes with the k! orders in which places may be named.
    return np.asarray(-expected + count * log(expected) + log_gap[steps].sum(axis=1))


def weigh_steps(model: StudentModel, places: Places) -> list[StepSets]:
    """Sets of 0, 1, 2, ... places with their log weights."""
    none = np.zeros((1, 0), np.int64)
    found = [_weighed(model, none, places)]
    if places.most >= 1:
        found.append(_weighed(model, places.first[:, None], places))
    if places.most >= 2:
        found.append(_weighed(model, _pairs(model, places, found[1]), places))
    if places.most >= 3 and found[2].steps.size:
        found.append(_weighed(model, _with_any_other(_best(found[2]), places), places))
    return [sets for sets in found if sets.steps.shape[0]]


def _weighed(model: StudentModel, steps: Steps, places: Places) -> StepSets:
    log_prior = _log_prior(steps, places) if steps.size else np.zeros(steps.shape[0])
    if steps.shape[1] == 0:
        log_prior = np.full(1, -STEPS_PER_YEAR * places.years)
    return StepSets(steps, log_prior, step_evidences(model, steps, 1 / STEP_STD**2))


def _best(sets: StepSets) -> Steps:
    order = np.argsort(-sets.log_weight, kind="stable")
    return np.asarray(sets.steps[order[:_BEST]])


def _apart(steps: Steps) -> Steps:
    """Sets in order, once each, whose steps are far enough from one another."""
    ordered = np.unique(np.sort(steps, axis=1), axis=0)
    return np.asarray(ordered[(np.diff(ordered, axis=1) >= MIN_SEGMENT).all(axis=1)])


def _pairs(model: StudentModel, places: Places, single: StepSets) -> Steps:
    first = places.first
    if first.size <= _ALL_PAIRS:
        return _apart(np.array(list(combinations(first.tolist(), 2)), np.int64).reshape(-1, 2))
    stride = -(-first.size // _COARSE)
    coarse = first[stride // 2 :: stride].tolist()
    pairs = _apart(np.array(list(combinations(coarse, 2)), np.int64).reshape(-1, 2))
    best = _best(_weighed(model, pairs, places))
    near = [
        np.column_stack([np.repeat(_around(first, one, stride), 2 * stride + 1),
                         np.tile(_around(first, other, stride), 2 * stride + 1)])
        for one, other in best[:3]
    ]  # fmt: skip
    return _apart(np.concatenate([pairs, *near, _with_any_other(_best(single), places)]))


def _around(first: Steps, place: int, reach: int) -> Steps:
    """Places up to `reach` from one, as many as that for any."""
    at = int(np.searchsorted(first, place))
    return np.asarray(first[np.clip(np.arange(at - reach, at + reach + 1), 0, first.size - 1)])


def _with_any_other(steps: Steps, places: Places) -> Steps:
    """Every set with one more place, any."""
    repeated = np.repeat(steps, places.first.size, axis=0)
    other = np.tile(places.first, steps.shape[0])
    return _apart(np.column_stack([repeated, other]))
