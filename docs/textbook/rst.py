"""Small pieces of reStructuredText."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import indent

__all__ = ["heading", "list_table"]


def heading(text: str, line: str = "=") -> str:
    return f"{text}\n{line * len(text)}\n"


def list_table(
    head: Sequence[str], rows: Sequence[Sequence[str]], widths: Sequence[int] | None = None
) -> str:
    """A table with one header row; cells may hold any text, also of several lines."""
    lines = [".. list-table::", "   :header-rows: 1"]
    if widths is not None:
        lines.append(f"   :widths: {' '.join(map(str, widths))}")
    lines.append("")
    for row in (head, *rows):
        for i, cell in enumerate(row):
            mark = "* - " if i == 0 else "  - "
            lines.append("   " + mark + indent(cell, " " * 7).lstrip() if cell else "   " + mark)
    return "\n".join(lines) + "\n"
