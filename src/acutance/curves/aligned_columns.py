"""Rows of words in columns, as text: for what is printed."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["align_columns"]


def align_columns(rows: Sequence[Sequence[str]], align: str, indent: str = "  ") -> str:
    """Lay rows out in columns two spaces apart.

    Parameters
    ----------
    rows : sequence of sequences of str
        All of the same length.
    align : str
        One letter a column: ``"l"`` or ``"r"``.
    indent : str, optional
        What every line starts with.
    """
    widths = [max(len(row[i]) for row in rows) for i in range(len(align))]
    lines = []
    for row in rows:
        cells = [
            cell.ljust(width) if side == "l" else cell.rjust(width)
            for cell, width, side in zip(row, widths, align, strict=True)
        ]
        lines.append((indent + "  ".join(cells)).rstrip())
    return "\n".join(lines)
