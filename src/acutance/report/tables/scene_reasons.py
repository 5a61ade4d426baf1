"""The table of why edges of a scene are left out."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from acutance.report.html import Table
from acutance.report.labels import MISSING, format_number
from acutance.scan.left_out import left_out_by_reason

if TYPE_CHECKING:
    from acutance.scan.edge_table import EdgeTable

__all__ = ["reasons_table"]

_ROWS = 14


def reasons_table(edges: EdgeTable, most: int = _ROWS) -> Table:
    """Edges that are not used, by verdict and check or kind of error, the most frequent first.

    Parameters
    ----------
    edges : EdgeTable
        Of one band or several.
    most : int, optional
        Rows; all others are one.
    """
    columns = edges.columns()
    unused = ~columns["used"]
    pairs = zip(
        columns["verdict"][unused].tolist(), columns["reason"][unused].tolist(), strict=True
    )
    found = left_out_by_reason(pairs, partial(format_number, digits=3))
    rows = [
        (str(one.edges), one.verdict, one.check or MISSING, one.reason[:1].upper() + one.reason[1:])
        for one in found[:most]
    ]
    rest = sum(one.edges for one in found[most:])
    if rest:
        rows.append((str(rest), "", "", f"{len(found) - most} other reasons"))
    return Table(
        ("edges", "verdict", "check", "why; numbers are medians"), tuple(rows), "rlll",
        title="Edges left out", page_only=True,
        notes=(
            "Every edge counts once, with what is gravest. Those without a check could not be "
            "measured.",
        ),
    )  # fmt: skip
