"""How checks are put into words: what they found, which failed, the verdict of several targets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.report.labels import format_number
from acutance.targets.check import MAX_RATIO, Verdict, verdict_of
from acutance.targets.check_table import QUESTIONS

if TYPE_CHECKING:
    from acutance.targets.check import Check
    from acutance.targets.measurement import Measurement
    from acutance.targets.record import Record

__all__ = ["common_verdict", "count_failed_checks", "failed_by_check", "write_found"]

_RATIOS = frozenset(
    {
        "contrast_snr", "peak_snr", "quantisation", "sample_phases", "source_misfit", "spacing_px",
        "width_sigmas", *(
            f"uniformity_{side}" for side in ("dark", "bright", "before", "behind", "target")
        ),
    }
)  # fmt: skip
"""Checks whose value is no larger than `MAX_RATIO`, which stands for all beyond it."""
_MAX_DIGITS = 8


def write_found(check: Check, digits: int = 4) -> str:
    """What a check found, as a number.

    One that fails keeps so many digits that it is not rounded to its limit; the largest value
    that a ratio can have is written as a bound.

    Parameters
    ----------
    check : Check
    digits : int, optional
        Significant digits, if they are enough.
    """
    if check.name in _RATIOS and check.value >= MAX_RATIO:
        return f"≥ {MAX_RATIO:.0f}"
    limit = f"{check.limit:g}"
    tried = (format_number(check.value, more) for more in range(digits, _MAX_DIGITS + 1))
    return next((one for one in tried if check.passed or one != limit), limit)


def common_verdict(measurements: Sequence[Measurement]) -> Verdict:
    """The verdict of all checks of several targets: that of the worst, and how many failed."""
    word = verdict_of(check for one in measurements for check in one.checks).word
    return Verdict(word, count_failed_checks(measurements))


def failed_by_check(measurements: Sequence[Measurement]) -> tuple[tuple[str, str, str], ...]:
    """Every check that failed: its name, the edges with what was found, what it means.

    Parameters
    ----------
    measurements : sequence of Measurement
        Counted from 1.
    """
    found: dict[str, list[tuple[int, Check]]] = {}
    for number, one in enumerate(measurements, start=1):
        for check in one.failed_checks:
            found.setdefault(check.name, []).append((number, check))
    return tuple(
        (
            name,
            ", ".join(f"{number} ({write_found(check, 3)})" for number, check in failed)
            + f"; asked {failed[0][1].asked}",
            _meaning(name, [check.message for _, check in failed], len(measurements)),
        )
        for name, failed in found.items()
    )


def _meaning(name: str, messages: Sequence[str], count: int) -> str:
    """What was found, where all edges share it, as what lies in their region; else the advice."""
    shared = len(messages) == count > 1 and len(set(messages)) == 1
    return messages[0] if shared or name not in QUESTIONS else QUESTIONS[name].advice


def count_failed_checks(measurements: Sequence[Measurement | Record]) -> str:
    """How many checks passed or failed, as a sentence."""
    total = sum(len(one.checks) for one in measurements)
    failed = sum(len(one.failed_checks) for one in measurements)
    if total == 0:
        return "No checks were made."
    if failed:
        return f"{failed} of {total} checks failed."
    return "The only check passed." if total == 1 else f"All {total} checks passed."
