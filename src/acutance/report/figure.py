"""The figure of any result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from acutance.arguments import require_class
from acutance.report.check_words import count_failed_checks, write_found
from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.figures.bars import bars_panels
from acutance.report.figures.biresolution import biresolution_panels
from acutance.report.figures.combined import combined_panels
from acutance.report.figures.comparison import comparison_figure
from acutance.report.figures.curves import curve_panels
from acutance.report.figures.panel import Panel
from acutance.report.figures.points import points_panels
from acutance.report.figures.scene import scene_panels
from acutance.report.figures.star import star_panels
from acutance.report.figures.straight import straight_panels
from acutance.report.figures.target import target_figure
from acutance.report.figures.writing import FONT_SIZE, ROW_HEIGHT, write_below, write_grid
from acutance.report.labels import (
    describe_image,
    describe_measurement,
    measurement_metric_words,
    spread_name,
    word_estimate,
)
from acutance.report.paper import INK, NAME_WITH_ROOM, VERMILION, new_page, split_page, styled
from acutance.report.tables.measurement import numbers_of
from acutance.targets import TargetResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.curves.grid import Floats
    from acutance.targets.measurement import Measurement

__all__ = ["KIND_PANELS", "draw", "measurement_figure", "panel_figure", "panels"]

KIND_PANELS: dict[str, Callable[[Any], tuple[Panel, ...]]] = {
    "bars": bars_panels,
    "biresolution": biresolution_panels,
    "combined": combined_panels,
    "points": points_panels,
    "scene": scene_panels,
    "star": star_panels,
}
"""What each kind of target draws after its curves; edges and pulses draw all by themselves."""

WIDTH_IN = 13.0
PANEL_IN = (4.4, 4.0)
ROW_IN = 4.3
LINE_IN = FONT_SIZE * ROW_HEIGHT / 72
LINES_WITH_ROOM, LINES_BESIDE_DRAWING = 16, 24
TITLE_IN = 0.4
FAILED = "✗"
CHECK_COLUMNS, CHECK_PLACES = 3, (0.0, 0.07, 0.74, 0.97)


def draw(
    result: Result,
    *,
    backdrop: Floats | None = None,
    origin: tuple[int, int] = (0, 0),
) -> Figure:
    """The figure of any result.

    Parameters
    ----------
    result : Measurement, TargetResult, Comparison or sequence of Measurement
        Several measurements of one target are compared.
    backdrop : (rows, cols) array, optional
        Of all edges of a target: the pixels to draw them on; without it the measured regions are
        put together. Of a scene: a quick look at what was scanned, of any size.
    origin : (int, int), optional
        Row and column of the backdrop's first pixel in the whole image.

    Returns
    -------
    matplotlib.figure.Figure
        With its own Agg canvas; save it with `save_figure` or ``figure.savefig``.
    """
    found = as_result(result)
    if isinstance(found, TargetResult):
        return target_figure(found, backdrop=backdrop, origin=origin)
    if isinstance(found, Comparison):
        return comparison_figure(found)
    return measurement_figure(found, backdrop=backdrop)


def panels(measurement: Measurement, *, backdrop: Floats | None = None) -> tuple[Panel, ...]:
    """Every drawing of a measurement, its MTF first.

    After `without_details` those that need pixels are left out.

    Parameters
    ----------
    measurement : Measurement
    backdrop : (rows, cols) array, optional
        Of a scene: see `draw`.
    """
    require_class("Measurement", measurement=measurement)
    if measurement.kind in ("edge", "pulse"):
        return straight_panels(measurement)  # type: ignore[arg-type]
    if measurement.kind == "scene":
        return (*curve_panels(measurement), *scene_panels(measurement, backdrop))  # type: ignore[arg-type]
    kind = KIND_PANELS.get(measurement.kind)
    return (*curve_panels(measurement), *(kind(measurement) if kind else ()))


def panel_figure(panel: Panel) -> Figure:
    """A drawing by itself, for a paper or a slide.

    Parameters
    ----------
    panel : Panel
        One of `panels`.

    Returns
    -------
    matplotlib.figure.Figure
        4.4 inches wide and 4 high, in letters of 9 points; a wide drawing as on the page of all.

    Examples
    --------
    >>> mtf = panels(edge)[0]  # doctest: +SKIP
    >>> save_figure(panel_figure(mtf), f"{mtf.name}.pdf")  # doctest: +SKIP
    """
    require_class("Panel", panel=panel)
    with styled():
        figure = new_page(*((WIDTH_IN, panel.height_in) if panel.wide else PANEL_IN))
        panel.draw(figure)
    return figure


def measurement_figure(measurement: Measurement, *, backdrop: Floats | None = None) -> Figure:
    """One page, 13 inches wide, with every drawing of a measurement, its numbers and checks."""
    numbers, checks = _number_rows(measurement), _check_rows(measurement)
    rows, last = _arranged(panels(measurement, backdrop=backdrop))
    heights = [max(panel.height_in for panel in row) for row in rows]
    lines = max(len(numbers), len(checks) + 2)
    # A long list beside a drawing leaves half of the sheet empty: it gets a row of columns.
    are_apart = last is not None and lines > LINES_BESIDE_DRAWING
    lines = len(numbers) if are_apart else lines
    last_in = ROW_IN + LINE_IN * max(0, lines - LINES_WITH_ROOM)
    below_in = LINE_IN * (len(_columns(checks)[0]) + 4) if are_apart else 0.0
    with styled():
        figure = new_page(WIDTH_IN, sum(heights) + last_in + below_in + TITLE_IN)
        below = [below_in] if are_apart else []
        heights = [*heights, last_in, *below]
        parts = split_page(figure, len(heights), 1, heights=heights)
        for part, row in zip(parts, rows, strict=False):
            for place, panel in zip(split_page(part, 1, len(row)), row, strict=True):
                panel.draw(place)
        if last is not None and are_apart:
            drawing, beside = split_page(parts[-2], 1, 2)
            last.draw(drawing)
            _write_numbers(beside.subplots(), measurement, numbers)
            _write_columns(parts[-1], measurement, checks)
        else:
            _draw_last(parts[-1], measurement, last, numbers, checks)
        figure.suptitle(
            f"{describe_measurement(measurement)}\n{describe_image(measurement, NAME_WITH_ROOM)}",
            x=0.012, ha="left", fontsize=11,
        )  # fmt: skip
    return figure


def _arranged(drawn: Sequence[Panel]) -> tuple[list[tuple[Panel, ...]], Panel | None]:
    """Rows of three, of a rest of two one of two; wide panels have their own.

    A rest of one is returned by itself: it stands with the numbers and checks.
    """
    narrow = [panel for panel in drawn if not panel.wide]
    rest = len(narrow) % 3
    rows = [tuple(narrow[i : i + 3]) for i in range(0, len(narrow) - rest, 3)]
    if rest == 2:
        rows.append(tuple(narrow[-2:]))
    rows += [(panel,) for panel in drawn if panel.wide]
    return rows, narrow[-1] if rest == 1 else None


def _draw_last(
    page: FigureBase,
    measurement: Measurement,
    panel: Panel | None,
    numbers: Sequence[Sequence[str]],
    checks: Sequence[Sequence[str]],
) -> None:
    """Numbers and checks, with one more drawing where there is a rest of one."""
    if panel is None:
        left, right = split_page(page, 1, 2, widths=(1.35, 0.9))
    else:
        drawing, left, right = split_page(page, 1, 3, widths=(0.95, 1.35, 0.9))
        panel.draw(drawing)
    _write_numbers(left.subplots(), measurement, numbers)
    _write_checks(right.subplots(), measurement, checks)


def _number_rows(measurement: Measurement) -> list[tuple[str, ...]]:
    """Label, unit, and value ± std by measured direction; of one direction also the interval."""
    found = numbers_of(measurement)
    if len(found) == 1:
        rows: list[tuple[str, ...]] = [("", "", "value ± std", "95 % interval")]
    else:
        rows = [("", "", *found)]
    for name in next(iter(found.values())):
        words = measurement_metric_words(measurement, name)
        # The title says that all of them are of a ratio: there is no room for it in every line.
        label = words.label.replace("MTF ratio low/high", "Ratio").replace(" of the ratio", "")
        cells = [word_estimate(numbers[name]) for numbers in found.values()]
        shown = [cell.value_and_std for cell in cells]
        if len(cells) == 1:
            shown.append(cells[0].short_interval)
        rows.append((label, words.unit, *shown))
    return rows


def _check_rows(measurement: Measurement) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [("", "", "found", "asked")]
    for check in measurement.checks:
        mark = "✓" if check.passed else FAILED
        rows.append((mark, check.name, write_found(check, 3), check.asked))
    return rows


def _write_numbers(axes: Axes, measurement: Measurement, rows: Sequence[Sequence[str]]) -> None:
    write_grid(axes, rows, places=(0.0, 0.35, 0.68, 1.0), align="llrr")
    axes.set_title(spread_name(measurement, "Numbers"))


def _columns(checks: Sequence[Sequence[str]]) -> list[list[Sequence[str]]]:
    """The list of checks in three columns as long as each other, each with the header."""
    header, *rows = checks
    size = -(-len(rows) // CHECK_COLUMNS)
    return [[header, *rows[i : i + size]] for i in range(0, len(rows), size)]


def _write_columns(
    page: FigureBase, measurement: Measurement, checks: Sequence[Sequence[str]]
) -> None:
    """The checks in columns, and below the first how many failed."""
    columns = _columns(checks)
    for i, (part, rows) in enumerate(zip(split_page(page, 1, len(columns)), columns, strict=True)):
        axes = part.subplots()
        colors = [VERMILION if row[0] == FAILED else INK for row in rows]
        write_grid(axes, rows, places=CHECK_PLACES, align="llrr", colors=colors)
        axes.set_title(" " if i else f"Checks: {measurement.verdict.word}")
        if not i:
            _write_count(axes, measurement, len(rows))


def _write_checks(axes: Axes, measurement: Measurement, rows: Sequence[Sequence[str]]) -> None:
    colors = [VERMILION if row[0] == FAILED else INK for row in rows]
    if measurement.checks:
        write_grid(axes, rows, places=CHECK_PLACES, align="llrr", colors=colors)
    else:
        axes.axis("off")
    axes.set_title(f"Checks: {measurement.verdict.word}" if measurement.checks else "Checks")
    _write_count(axes, measurement, len(rows) if measurement.checks else 0)


def _write_count(axes: Axes, measurement: Measurement, rows: int) -> None:
    write_below(
        axes, count_failed_checks([measurement]), rows=rows,
        color=INK if measurement.trusted else VERMILION,
    )  # fmt: skip
