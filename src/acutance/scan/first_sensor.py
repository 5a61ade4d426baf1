"""Which start leads to the likeliest sensor of a scene, and which others are nearly as likely.

The likelihood of few edges has several tops. First guesses, made likelier in a free shape, are
followed to their ends (`acutance.scan.sensor_turns`); some of many edges decide.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.execution import results_in_turn
from acutance.scan.blur_modes import (
    ALL_AROUND,
    COMMON_MODES,
    changed,
    edge_modes,
    fit_modes,
    quartic_modes,
)
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.population import fit_shares
from acutance.scan.sensor_turns import AS_LIKELY, SAME, SensorState, along_bins, apart, settled
from acutance.scan.shares import START
from acutance.targets.combine.sensor_forms import SCENE_FORMS

__all__ = ["Rival", "first_sensor", "some_of_each"]

_BLUR_STARTS_PX2: Final = (-0.03, -0.015, 0.0, 0.015, 0.03, 0.05)
"""Blur that is added to first guesses: the sharpest edges are so by their noise, too."""
_APART: Final = 0.03
"""Root mean square difference of the MTF, up to Nyquist, by which starts differ: those nearer to
one another lead to one end. The likelihoods of few edges have tops that are nearer."""
_MANY: Final = 150
"""So many edges are not few."""
_MOST_FOLLOWED: Final = 8
"""So many starts are followed to their end, the likeliest of those that differ. In 25 scenes of
60 to 90 edges under a sensor that is sharper along the diagonals four led to the likeliest end of
all; the likeliest start alone did in sixteen. Under one behind a kernel the sixth did."""
_ENOUGH_EDGES: Final = 600
_LIKELIER: Final = 3.0
"""By so much in the log likelihood another sensor has to be likelier than that of a better start:
less is what a form of more terms gains."""
_FAR: Final = 10.0
"""By so much an edge, in the log likelihood, a start may lie behind another: those that led to a
likelier sensor in the end lay behind by 5 at most (benchmarks/scenes.py, twenty scenes)."""
_FREE_PX2: Final = 0.1
"""Prior standard deviation of the modes by which first guesses may change."""
_WORTHWHILE_S: Final = 10.0
"""Other processes take some seconds of a core until they begin."""


class Rival(NamedTuple):
    """Another sensor to which guesses led.

    Attributes
    ----------
    behind : float
        By so much its log likelihood is smaller.
    apart : float
        Root mean square difference of both MTFs over all directions, up to Nyquist.
    """

    behind: float
    apart: float


def first_sensor(
    edges: EdgeLikelihoods, normal_deg: Floats, guesses: Sequence[Floats], workers: int = 1
) -> tuple[SensorState, tuple[SensorState, ...], tuple[Rival, ...]]:
    """The likeliest sensor to which guesses lead, others nearly as likely, and further rivals.

    Without a change over the field. Of many edges no other is as likely.

    Parameters
    ----------
    edges : EdgeLikelihoods
    normal_deg : (b,) array
        Mean direction of every bin.
    guesses : sequence of (b, 2 k) arrays
        First guesses of the OTF in every direction, real parts first.
    workers : int, optional
        Processes that follow guesses, if that takes long; the sensor is the same.
    """
    some = some_of_each(edges.bin)
    best, *others = _ends(edges.chosen(some), normal_deg, guesses, workers)
    if some.size < edges.size and best.combined is not None:
        # So many edges stand behind each that chose.
        rivals = _rivals(best, others, edges.size / some.size, edges.freq_cpp)
        best = best._replace(along=along_bins(edges, normal_deg, best.combined.unwidened))
        return settled(edges, normal_deg, best, np.zeros_like(edges.gain)), (), rivals
    as_likely = [
        one
        for one in others
        if one.settled and one.log_likelihood > best.log_likelihood - AS_LIKELY
    ]
    less_likely = [one for one in others if all(one is not other for other in as_likely)]
    tops = _different([best, *as_likely], SAME, edges.freq_cpp)[1:]
    return best, tuple(tops), _rivals(best, less_likely, 1.0, edges.freq_cpp)


def _rivals(
    best: SensorState, others: Sequence[SensorState], per_edge: float, freq_cpp: Floats
) -> tuple[Rival, ...]:
    """How far other ends are from the best one, each edge that chose standing for several."""
    return tuple(
        Rival(
            per_edge * (best.log_likelihood - one.log_likelihood),
            apart(one.otf, best.otf, freq_cpp),
        )
        for one in others
    )


def some_of_each(number: NDArray[np.intp]) -> NDArray[np.intp]:
    """Edges by which a start is chosen: every m-th of each bin of directions.

    All of them, of few; of many 600 to 1200, and few more where bins are sparse.
    """
    step = max(number.size // _ENOUGH_EDGES, 1)
    own = (np.flatnonzero(number == b)[::step] for b in range(int(number.max()) + 1))
    return np.sort(np.concatenate(list(own)))


def _ends(
    edges: EdgeLikelihoods, normal_deg: Floats, guesses: Sequence[Floats], workers: int
) -> list[SensorState]:
    """Sensors to which the guesses lead, or led until they were given up; the likeliest first."""
    least = _APART * min(1.0, math.sqrt(edges.size / _MANY))
    starts = _different(_starts(edges, normal_deg, guesses), least, edges.freq_cpp)
    first, *others = starts[:_MOST_FOLLOWED]
    began = time.perf_counter()
    best = settled(edges, normal_deg, first, np.zeros_like(edges.gain))
    is_long = len(others) * (time.perf_counter() - began) > _WORTHWHILE_S
    ends = [best]
    while others:
        # Each is followed beside the best one of those before it.
        follow = partial(_followed, edges, normal_deg, best)
        found = results_in_turn(follow, others, workers=min(workers, len(others)) if is_long else 1)
        for end in found:
            others = others[1:]
            if apart(end.otf, best.otf, edges.freq_cpp) < SAME:
                continue
            ends.append(end)
            if end.log_likelihood > best.log_likelihood + _LIKELIER:
                best = end
                break
        found.close()
    return [best, *(one for one in ends if one is not best)]


def _followed(
    edges: EdgeLikelihoods, normal_deg: Floats, rival: SensorState, start: SensorState
) -> SensorState:
    """The end of a start, in the forms of a rival, too."""
    start = start._replace(combined=rival.combined)
    return settled(edges, normal_deg, start, np.zeros_like(edges.gain), rival)


def _different(some: Sequence[SensorState], least: float, freq_cpp: Floats) -> list[SensorState]:
    """Those that differ from all before them."""
    found: list[SensorState] = []
    for one in some:
        if all(apart(one.otf, other.otf, freq_cpp) > least for other in found):
            found.append(one)
    return found


def _starts(
    edges: EdgeLikelihoods, normal_deg: Floats, guesses: Sequence[Floats]
) -> list[SensorState]:
    """The likeliest sensors near the guesses, of free shape; the likeliest first.

    The likelihood has several tops where few edges are sharp: a soft sensor whose sharpest edges
    are noise, and a sharp one under soft objects.
    """
    blurs = edge_modes(normal_deg, edges.freq_cpp)
    near: list[SensorState] = []
    tried = (
        [changed(guess, blurs[:, :, ALL_AROUND] * blur) for blur in _BLUR_STARTS_PX2]
        for guess in guesses
    )
    likeliest = [
        max(some, key=lambda one: fit_shares(edges, one, START).log_likelihood) for some in tried
    ]
    for start, modes in product(likeliest, _free_modes(normal_deg, edges.freq_cpp)):
        fit = fit_modes(edges, start, START, modes[edges.bin], std=_FREE_PX2)
        otf = changed(start, modes @ fit.amount)
        near.append(
            SensorState(
                otf, fit.share, SCENE_FORMS, None, edges, fit.log_posterior, 0, settled=False
            )
        )
    near.sort(key=lambda one: -one.log_likelihood)
    least = near[0].log_likelihood - _FAR * edges.size
    return [one for one in near if one.log_likelihood >= least]


def _free_modes(normal_deg: Floats, freq_cpp: Floats) -> tuple[Floats, Floats]:
    """Ways in which a guess may change, (b, k, q): without and with those that turn four times.

    Kernels of rows and columns make a sensor as sharp as they are along neither: along the
    diagonals. Where few edges show it, a guess that may follow is led astray.
    """
    modes, quartic = edge_modes(normal_deg, freq_cpp), quartic_modes(normal_deg, freq_cpp)
    few = np.concatenate([modes, quartic[:, :, :COMMON_MODES]], axis=2)
    return few, np.concatenate([modes, quartic], axis=2)
