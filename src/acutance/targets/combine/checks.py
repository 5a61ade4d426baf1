"""Do the measurements agree, and do they determine a 2-D optical transfer function (OTF)?"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.geometry.angles import axis_difference
from acutance.targets.check import Check, Limits, answer
from acutance.targets.combine.combined_measurement import CombinedPart
from acutance.targets.combine.fit import CombinedFit
from acutance.targets.combine.inputs import MeasuredInput
from acutance.targets.combine.shared_pixels import pairs_of_same_pixels

__all__ = ["COMBINE_CHECKS", "check_combination", "count_directions", "direction_gap_deg"]

COMBINE_CHECKS = (
    "agreement", "worst_member", "plain_sensor", "correction", "beyond_members", "directions",
    "failed_inputs", "shared_targets", "assumed_covariance", "unknown_gsd",
)  # fmt: skip
"""Names of all checks of a combination."""

_DISTINCT_DEG = 15.0
_SURE_STDS = 2.0
_NO_CHANCE = 1e-30
"""Chances below are none, as normal errors have them, and which is the least tells nothing."""


def check_combination(
    inputs: Sequence[MeasuredInput],
    fit: CombinedFit,
    parts: Sequence[CombinedPart],
    limits: Limits,
    without_gsd: Sequence[str] = (),
) -> tuple[Check, ...]:
    """All checks of a combination.

    Parameters
    ----------
    inputs : sequence of MeasuredInput
    fit : CombinedFit
    parts : sequence of CombinedPart
        The measurements beside the combination.
    limits : mapping of str to float
        Limits the caller changed.
    without_gsd : sequence of str, optional
        Names of measurements without a GSD among others that have one.
    """
    failed = [f"{one.name} ({', '.join(one.warnings)})" for one in inputs if one.warnings]
    assumed = [one.name for one in inputs if not one.covariance_known]
    directions = count_directions(inputs)
    return (
        _agreement(fit, limits),
        _worst(inputs, fit, limits),
        _plain(fit, limits),
        _correction(inputs, fit, limits),
        _beyond(parts, limits),
        answer("directions", directions, f"{directions} directions were measured", limits),
        _counted("failed_inputs", failed, "whose own checks failed", limits),
        _shared(inputs, limits),
        _counted("assumed_covariance", assumed, "without covariance", limits),
        _counted("unknown_gsd", without_gsd, "without a GSD", limits),
    )


def _counted(
    name: str, named: Sequence[str], what: str, limits: Limits, noun: str = "measurement"
) -> Check:
    """A check that counts measurements, or pairs of them, with their names."""
    listed = f": {'; '.join(named)}" if named else ""
    plural = "" if len(named) == 1 else "s"
    found = f"{len(named) or 'no'} {noun}{plural} {what}{listed}"
    return answer(name, len(named), found, limits)


def _agreement(fit: CombinedFit, limits: Limits) -> Check:
    found = fit.total
    widened = (
        f"all deviations were widened by the Birge ratio {fit.otf.birge_ratio:.2f}"
        if fit.otf.birge_ratio > 1
        else "no deviation was widened"
    )
    return answer(
        "agreement", found.p_value,
        f"chi-square is {_size(found.value)}, {_size(found.expected)} being expected if the "
        f"measurements agree within their deviations (p {found.p_value:.2g}); {widened}", limits,
    )  # fmt: skip


def _size(chi_square: float) -> str:
    """A chi-square in words: of scans less than one may be expected."""
    return f"{chi_square:.2g}" if chi_square < 10 else f"{chi_square:.0f}"


def _worst(inputs: Sequence[MeasuredInput], fit: CombinedFit, limits: Limits) -> Check:
    """The smallest of n chances has to be n times larger."""
    worst = _fits_least(fit)
    member = fit.members[worst]
    return answer(
        "worst_member", min(1.0, len(fit.members) * member.p_value),
        f"{inputs[worst].name} fits least: its chi-square is {_size(member.value)}, "
        f"{_size(member.expected)} being expected", limits,
    )  # fmt: skip


def _fits_least(fit: CombinedFit) -> int:
    """Which measurement has the smallest chance; of those that have none, the largest chi-square
    over what is expected."""

    def order(place: int) -> tuple[float, float]:
        one = fit.members[place]
        if not math.isfinite(one.p_value):
            return math.inf, 0.0
        return max(one.p_value, _NO_CHANCE), -one.value / one.expected

    return min(range(len(fit.members)), key=order)


def _plain(fit: CombinedFit, limits: Limits) -> Check:
    plain = fit.plain
    return answer(
        "plain_sensor", plain.p_value,
        "the best product of Gaussian, detector, smear, halo, charge trail and aperture has "
        f"chi-square {_size(plain.value)}, {_size(plain.expected)} being expected", limits,
    )  # fmt: skip


def _correction(inputs: Sequence[MeasuredInput], fit: CombinedFit, limits: Limits) -> Check:
    share, least = fit.otf.correction_share, _fits_least(fit)
    found = (
        f"a smooth correction of {100 * share:.1f} % of the log MTF was added, and its uncertainty "
        f"is part of every deviation; {inputs[least].name} fits least, p = "
        f"{fit.members[least].p_value:.2g}"
        if share > 0
        else "no correction was added"
    )
    return answer("correction", share, found, limits)


def _beyond(parts: Sequence[CombinedPart], limits: Limits) -> Check:
    """Whether the combination lies between its members: a mean of whatever kind does.

    Of each counts the mean of its MTF up to Nyquist, and how far that may be off by its deviations.
    """
    below = [one.freq_cpp <= NYQUIST_CPP for one in parts]
    off = np.array([
        np.mean((one.value - one.fitted)[:, some]) for one, some in zip(parts, below, strict=True)
    ])  # fmt: skip
    std = np.array([np.mean(one.std[:, some]) for one, some in zip(parts, below, strict=True)])
    under, over = (float(np.min(side * off - _SURE_STDS * std)) for side in (1, -1))
    value = max(under, over, 0.0)
    found = (
        f"in the mean up to Nyquist the MTF lies {value:.3f} {'below' if under > 0 else 'above'} "
        "that of every measurement"
        if value > 0
        else "the MTF lies between those of the measurements"
    )
    return answer("beyond_members", value, found, limits)


def _shared(inputs: Sequence[MeasuredInput], limits: Limits) -> Check:
    """Pairs of the same pixels; of arrays in memory nothing tells which image they are of."""
    found = _counted(
        "shared_targets", pairs_of_same_pixels(inputs), "of the same pixels", limits, "pair"
    )
    unknown = sum(one.image.path is None for one in inputs)
    if unknown < 2:
        return found
    message = (
        f"{found.message}; {unknown} measurements are of arrays in memory, which are not compared"
    )
    return replace(found, message=message)


def _directions(inputs: Sequence[MeasuredInput]) -> Floats:
    """All directions, 0 to 180 degrees, sorted."""
    return np.sort(np.concatenate([one.slices.normal_deg for one in inputs]) % 180.0)


def count_directions(inputs: Sequence[MeasuredInput]) -> int:
    """How many directions differ from one another by 15 degrees."""
    turns = _directions(inputs)
    chosen = [turns[0]]
    for turn in turns[1:]:
        if all(axis_difference(turn, other) > _DISTINCT_DEG for other in chosen):
            chosen.append(turn)
    return len(chosen)


def direction_gap_deg(inputs: Sequence[MeasuredInput]) -> float:
    """Largest angle between any two directions."""
    turns = _directions(inputs)
    return float(max(axis_difference(one, other) for one in turns for other in turns))
