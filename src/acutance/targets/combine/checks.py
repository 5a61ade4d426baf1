"""Do the measurements agree, and do they tell enough?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.combine.fit import CombinedFit
from acutance.targets.combine.inputs import MeasuredInput
from acutance.targets.combine.options import CombineLimits
from acutance.targets.measurement import Check
from acutance.targets.straight.check_data import at_least, at_most

__all__ = ["check_combination", "count_directions", "direction_gap_deg"]

_DISTINCT_DEG = 15.0
_SAME_LINE_PX = 3.0
_SAME_LINE_DEG = 5.0


def check_combination(
    inputs: Sequence[MeasuredInput],
    fit: CombinedFit,
    limits: CombineLimits,
    without_gsd: Sequence[str] = (),
) -> tuple[Check, ...]:
    """All checks of a combination.

    Parameters
    ----------
    inputs : sequence of MeasuredInput
    fit : CombinedFit
    limits : CombineLimits
    without_gsd : sequence of str, optional
        Names of measurements without a GSD among others that have one.
    """
    return (
        _agreement(fit, limits),
        _worst(inputs, fit, limits),
        _plain(fit, limits),
        at_least(
            "directions", count_directions(inputs), limits.directions,
            "rotation and asymmetry are only told by the prior with fewer directions: add an edge "
            "at 30 to 60 degrees, points or a star",
        ),
        _failed(inputs, limits),
        _shared(inputs, limits),
        at_most(
            "assumed_covariance", sum(not one.covariance_known for one in inputs),
            limits.assumed_covariance,
            "without covariance, errors at frequencies within 0.08 c/px are taken to be alike: "
            "write the JSON again with this version",
        ),
        at_most(
            "unknown_gsd", len(without_gsd), limits.unknown_gsd,
            "measurements without a GSD among others that have one"
            + (f": {', '.join(without_gsd)}" if without_gsd else "")
            + "; nothing tells that their pixels are the same, so state the GSD when measuring, "
            "or of all when combining",
        ),
    )  # fmt: skip


def _agreement(fit: CombinedFit, limits: CombineLimits) -> Check:
    found = fit.total
    widened = (
        f"all deviations were widened by the Birge ratio {fit.birge_ratio:.2f}"
        if fit.birge_ratio > 1
        else "no deviation was widened"
    )
    return at_least(
        "agreement", found.p_value, limits.agreement,
        f"chance of a larger chi-square than {found.value:.0f}, {found.expected:.0f} being "
        f"expected if the measurements agree within their deviations; {widened}",
    )  # fmt: skip


def _worst(inputs: Sequence[MeasuredInput], fit: CombinedFit, limits: CombineLimits) -> Check:
    """The smallest of n chances has to be n times larger."""
    chances = [one.p_value for one in fit.members]
    worst = int(np.nanargmin(chances)) if np.isfinite(chances).any() else 0
    value = min(1.0, len(chances) * chances[worst])
    member = fit.members[worst]
    return at_least(
        "worst_member", value, limits.agreement,
        f"{inputs[worst].name} fits least: its chi-square is {member.value:.0f}, "
        f"{member.expected:.0f} being expected; leave it out or find what ails it",
    )  # fmt: skip


def _plain(fit: CombinedFit, limits: CombineLimits) -> Check:
    plain = fit.plain
    added = (
        f"a smooth departure of {100 * fit.departure:.1f} % of the logarithm of the MTF was "
        "added, and its uncertainty is part of every deviation"
        if fit.departure > 0
        else "no departure was added"
    )
    return at_least(
        "plain_sensor", plain.p_value, limits.plain_sensor,
        f"no product of Gaussian, detector, smear, halo, charge trail and aperture holds the "
        f"curves: the best has chi-square {plain.value:.0f}, {plain.expected:.0f} being expected; "
        f"{added}; parameters are only a description",
    )  # fmt: skip


def _failed(inputs: Sequence[MeasuredInput], limits: CombineLimits) -> Check:
    failed = [f"{one.name} ({', '.join(one.failed_checks)})" for one in inputs if one.failed_checks]
    return at_most(
        "failed_inputs", len(failed), limits.failed_inputs,
        "measurements with a failed check of their own"
        + (f": {'; '.join(failed)}" if failed else ""),
    )  # fmt: skip


def _shared(inputs: Sequence[MeasuredInput], limits: CombineLimits) -> Check:
    pairs = [
        f"{other.name} and {one.name}"
        for i, one in enumerate(inputs)
        for other in inputs[:i]
        if _same_target(one, other)
    ]
    return at_most(
        "shared_targets", len(pairs), limits.shared_targets,
        "the same pixels count only once, or the deviations become too small"
        + (f": {'; '.join(pairs)}" if pairs else ""),
    )  # fmt: skip


def _same_target(one: MeasuredInput, other: MeasuredInput) -> bool:
    """Whether two measurements took the same target of the same image."""
    if one.path is None or (one.path, one.kind) != (other.path, other.kind):
        return False
    if len(one.place) != len(other.place):
        return False
    if len(one.place) == 3:
        turn = abs((one.place[2] - other.place[2] + 180) % 360 - 180)
        apart = np.hypot(one.place[0] - other.place[0], one.place[1] - other.place[1])
        return bool(turn < _SAME_LINE_DEG and apart < _SAME_LINE_PX)
    return one.place == other.place


def _directions(inputs: Sequence[MeasuredInput]) -> Floats:
    """All directions, 0 to 180 degrees, sorted."""
    return np.sort(np.concatenate([one.slices.normal_deg for one in inputs]) % 180.0)


def count_directions(inputs: Sequence[MeasuredInput]) -> int:
    """How many directions differ from one another by 15 degrees."""
    turns = _directions(inputs)
    chosen = [turns[0]]
    for turn in turns[1:]:
        if all(_apart(turn, other) > _DISTINCT_DEG for other in chosen):
            chosen.append(turn)
    return len(chosen)


def direction_gap_deg(inputs: Sequence[MeasuredInput]) -> float:
    """Largest angle between any two directions."""
    turns = _directions(inputs)
    return max(_apart(one, other) for one in turns for other in turns)


def _apart(one: float, other: float) -> float:
    turn = abs(one - other) % 180.0
    return float(min(turn, 180.0 - turn))
