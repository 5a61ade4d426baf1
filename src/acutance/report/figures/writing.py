"""Rows and columns of text written on axes."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from acutance.report.paper import FAINT, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["write_below", "write_grid"]

FONT_SIZE = 9.0
ROW_HEIGHT = 1.65
LINE_LENGTH = 46


def write_grid(
    axes: Axes,
    rows: Sequence[Sequence[str]],
    *,
    places: Sequence[float],
    align: str,
    colors: Sequence[str] | None = None,
    marks: Sequence[str] | None = None,
    fontsize: float = FONT_SIZE,
) -> None:
    """Write a table from the top of the axes down; the first row is its header.

    Parameters
    ----------
    axes : Axes
        Emptied of spines and ticks.
    rows : sequence of sequences of str
    places : sequence of float
        Where each column is anchored, 0..1 of the axes' width.
    align : str
        One letter a column: ``"l"`` starts at its place, ``"r"`` ends there.
    colors : sequence of str, optional
        One a row.
    marks : sequence of str, optional
        Colours of the first column, one a row, where it differs from the rest.
    fontsize : float, optional
        In points; rows are 1.65 times as high.
    """
    axes.axis("off")
    for i, row in enumerate(rows):
        color = FAINT if i == 0 else (colors[i] if colors else INK)
        for j, (text, place, side) in enumerate(zip(row, places, align, strict=True)):
            if not text:
                continue
            axes.annotate(
                text,
                (place, 1.0),
                (0.0, -fontsize * (0.8 + ROW_HEIGHT * i)),
                xycoords="axes fraction",
                textcoords="offset points",
                ha="left" if side == "l" else "right",
                va="center",
                fontsize=fontsize,
                color=marks[i] if marks and j == 0 else color,
                annotation_clip=False,
            ).set_in_layout(False)


def write_below(axes: Axes, text: str, *, rows: int, color: str = INK) -> None:
    """Write a paragraph under a grid of `rows` rows."""
    axes.annotate(
        textwrap.fill(text, LINE_LENGTH),
        (0.0, 1.0),
        (0.0, -FONT_SIZE * ROW_HEIGHT * (rows + 0.4)),
        xycoords="axes fraction",
        textcoords="offset points",
        va="top",
        fontsize=FONT_SIZE,
        color=color,
        linespacing=1.4,
    ).set_in_layout(False)
