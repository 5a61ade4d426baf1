"""One 2-D measurement on one page: curves of both directions, maps, numbers, checks."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from acutance.report.grids import FONT_SIZE, ROW_HEIGHT, write_below, write_grid
from acutance.report.page import INK, NAME_WITH_ROOM, VERMILION, new_page, split_page, styled
from acutance.report.plane_panels import (
    PlanePanel,
    draw_plane_lsf,
    draw_plane_mtf,
    draw_psf,
    draw_transfer_map,
)
from acutance.report.quantity import spread_name, transfer_name
from acutance.report.wording import (
    count_failed_checks,
    describe_plane,
    describe_plane_image,
    format_number,
    metric_words,
    word_estimate,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.targets import Measurement2d

__all__ = ["plane_figure", "plane_panels"]

WIDTH_IN = 13.0
ROW_IN = 4.3
LINE_IN = FONT_SIZE * ROW_HEIGHT / 72
LINES_WITH_ROOM = 16


def plane_panels(measurement: Measurement2d) -> tuple[PlanePanel, ...]:
    """The drawings every 2-D measurement has: MTF, LSF, PSF and the MTF as a map."""

    def on_axes(draw: Callable[[Axes, Measurement2d], None]) -> Callable[[FigureBase], None]:
        return lambda page: draw(page.subplots(), measurement)

    transfer = transfer_name(measurement)
    return (
        PlanePanel(
            transfer_name(measurement, "Modulation transfer function"),
            f"The {transfer} across and along with their 95 % bands. What the image holds beyond "
            "Nyquist is aliased.",
            on_axes(draw_plane_mtf),
        ),
        PlanePanel(
            spread_name(measurement, "Line spread function"),
            "The PSF integrated over the other direction, with its full width at half.",
            on_axes(draw_plane_lsf),
        ),
        PlanePanel(
            spread_name(measurement, "Point spread function"),
            "Light of a point with the pixel's area included, in percent of its peak.",
            on_axes(draw_psf),
        ),
        PlanePanel(
            f"{transfer} over the plane",
            "The modulus of the 2-D transfer function in all directions.",
            on_axes(draw_transfer_map),
        ),
    )


def plane_figure(measurement: Measurement2d, extra_panels: Sequence[PlanePanel] = ()) -> Figure:
    """One page (13 inches wide) of a 2-D measurement.

    Parameters
    ----------
    measurement : Measurement2d
    extra_panels : sequence of PlanePanel, optional
        Drawings of the method's own; three of them share a row, a wide one has its own.

    Returns
    -------
    matplotlib.figure.Figure
        With its own Agg canvas; save it with `save_figure` or ``figure.savefig``.
    """
    transfer, lsf, psf, plane = plane_panels(measurement)
    words = _number_rows(measurement), _check_rows(measurement)
    lines = max(len(rows) for rows in words)
    numbers_in = max(ROW_IN, ROW_IN + LINE_IN * (lines - LINES_WITH_ROOM))
    rows = [((transfer, lsf, psf), ROW_IN), *_rows_of(extra_panels)]
    heights = [height for _, height in rows]
    with styled():
        figure = new_page(WIDTH_IN, sum(heights) + numbers_in + 0.4)
        parts = split_page(figure, len(rows) + 1, 1, heights=[*heights, numbers_in])
        for part, (panels, _) in zip(parts, rows, strict=False):
            if panels[0].wide:
                panels[0].draw(part)
                continue
            for place, panel in zip(split_page(part, 1, 3), panels, strict=False):
                panel.draw(place)
        numbers, map_, checks = split_page(parts[-1], 1, 3, widths=(1.35, 0.95, 0.9))
        _write_numbers(numbers.subplots(), measurement, words[0])
        plane.draw(map_)
        _write_checks(checks.subplots(), measurement, words[1])
        figure.suptitle(
            f"{describe_plane(measurement)}\n{describe_plane_image(measurement, NAME_WITH_ROOM)}",
            x=0.012, ha="left", fontsize=11,
        )  # fmt: skip
    return figure


def _rows_of(panels: Sequence[PlanePanel]) -> list[tuple[tuple[PlanePanel, ...], float]]:
    """Wide panels in a row of their own, the others three by three."""
    narrow = [panel for panel in panels if not panel.wide]
    rows = [tuple(narrow[3 * i : 3 * i + 3]) for i in range(math.ceil(len(narrow) / 3))]
    rows += [(panel,) for panel in panels if panel.wide]
    return [(row, max(panel.height_in for panel in row)) for row in rows]


def _number_rows(measurement: Measurement2d) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [("", "", "across", "along")]
    across, along = measurement.across.metrics(), measurement.along.metrics()
    for name in across:
        words = metric_words(name)
        # The title says that all of them are of a ratio: there is no room for it in every line.
        label = words.label.replace("MTF at", "Ratio at") if measurement.is_ratio else words.label
        cells = (word_estimate(one[name]).value_and_std for one in (across, along))
        rows.append((label, words.unit, *cells))
    return rows


def _check_rows(measurement: Measurement2d) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [("", "", "found", "asked")]
    for check in measurement.checks:
        mark = "✓" if check.passed else "✗"
        rows.append((mark, check.name, format_number(check.value, 3), check.limit))
    return rows


def _write_numbers(axes: Axes, measurement: Measurement2d, rows: Sequence[Sequence[str]]) -> None:
    write_grid(axes, rows, places=(0.0, 0.33, 0.69, 1.0), align="llrr")
    axes.set_title(spread_name(measurement, "Numbers") + ", value ± std")


def _write_checks(axes: Axes, measurement: Measurement2d, rows: Sequence[Sequence[str]]) -> None:
    colors = [INK, *(INK if check.passed else VERMILION for check in measurement.checks)]
    if measurement.checks:
        write_grid(axes, rows, places=(0.0, 0.07, 0.74, 1.0), align="llrr", colors=colors)
    else:
        axes.axis("off")
    axes.set_title("Checks" if measurement.trusted else "Checks: not all passed")
    write_below(
        axes,
        count_failed_checks([measurement]),
        rows=len(rows) if measurement.checks else 0,
        color=INK if measurement.trusted else VERMILION,
    )
