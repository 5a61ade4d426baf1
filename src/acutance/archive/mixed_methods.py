"""The note of a table whose means are over measurements of several methods together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

__all__ = ["mixed_methods_notes"]


def mixed_methods_notes(words: Mapping[str, Sequence[str]], by: Sequence[str]) -> Iterator[str]:
    """The note, if there are several methods, or kinds, and the rows do not part them.

    Parameters
    ----------
    words : mapping of str to sequence of str
        Kind and method of every measurement.
    by : sequence of str
        What the table is grouped by.
    """
    if "method" in by:
        return
    found = sorted(set(zip(words["kind"], words["method"], strict=True)))
    kinds = {kind for kind, _ in found}
    if len(found) > (len(kinds) if "kind" in by else 1):
        yield (
            f"Measurements by {len(found)} methods stand in these means together "
            f"({', '.join(map(' '.join, found))}), and methods may differ: group by them (--by "
            f"{','.join((*by, 'method'))}), or select one (--method, --kind)."
        )
