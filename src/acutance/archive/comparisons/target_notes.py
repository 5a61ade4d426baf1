"""What has to be said of few targets."""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from acutance.archive.comparisons.groups import MeasuredGroup

__all__ = ["target_notes"]


def target_notes(first: MeasuredGroup, second: MeasuredGroup) -> Iterator[str]:
    """Groups of one or two targets, or of two sites: what is peculiar to these stays."""
    targets, sites = (
        [_count(own(group)) for group in (first, second)] for own in (_targets, _sites)
    )
    names = first.name, second.name
    if of := _with(1, targets, names):
        one = f"{of}: one target, and" if of in names else f"One target of {of}:"
        yield f"{one} what is peculiar to it is part of the difference."
    for what, counts in (("target", targets), ("site", sites)):
        of = _with(2, counts, names)
        if of:
            two = f"{of}: two {what}s, which" if of in names else f"Two {what}s of {of}: two"
            yield f"{two} hardly show how much {what}s differ."
            return


def _targets(group: MeasuredGroup) -> list[Hashable | None]:
    return list(group.target)


def _sites(group: MeasuredGroup) -> list[Hashable | None]:
    return [None if one is None else one[0] for one in group.target]


def _count(words: list[Hashable | None]) -> int:
    """How many there are; 0 where that is not known."""
    return 0 if None in words else len(set(words))


def _with(count: int, counts: list[int], names: tuple[str, str]) -> str:
    found = [name for name, own in zip(names, counts, strict=True) if own == count]
    return "each group" if len(found) == 2 else "".join(found)
