"""What has to be said of few targets."""

from __future__ import annotations

from collections.abc import Iterator

from acutance.archive.comparisons.groups import MeasuredGroup

__all__ = ["target_notes"]


def target_notes(first: MeasuredGroup, second: MeasuredGroup) -> Iterator[str]:
    """Groups of one or two targets: what is peculiar to these is not told from the group."""
    if of := _with_targets(1, first, second):
        yield f"One target of {of}: what is peculiar to it is part of the difference."
    if of := _with_targets(2, first, second):
        yield (
            f"Two targets of {of}: two hardly show how much targets differ, and the interval is as "
            "wide as that makes it."
        )


def _with_targets(count: int, first: MeasuredGroup, second: MeasuredGroup) -> str:
    names = [
        group.name
        for group in (first, second)
        if None not in group.target and len(set(group.target)) == count
    ]
    return "each group" if len(names) == 2 else "".join(names)
