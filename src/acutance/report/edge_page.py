"""One measurement of an edge or a pulse, every step of it drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.report.grids import FONT_SIZE, ROW_HEIGHT, write_below, write_grid
from acutance.report.page import INK, NAME_WITH_ROOM, VERMILION, new_page, split_page, styled
from acutance.report.panels import draw_cut, draw_esf, draw_lsf, draw_mtf, draw_residuals
from acutance.report.pulse_panels import draw_prf
from acutance.report.wording import (
    count_failed_checks,
    describe_image,
    describe_line,
    format_number,
    metric_words,
    numbers_of,
    word_estimate,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.targets.measurement import Measurement

__all__ = ["edge_figure", "panel_figures"]

CHECKS_WITH_ROOM = 13
CHECK_IN = FONT_SIZE * ROW_HEIGHT / 72


def edge_figure(measurement: Measurement) -> Figure:
    """One page (13 x 8.6 inches, higher for many checks) with every step of an edge or a pulse.

    Parameters
    ----------
    measurement : Measurement

    Returns
    -------
    matplotlib.figure.Figure
        With its own Agg canvas; save it with `save_figure` or ``figure.savefig``.
    """
    with styled():
        more_in = CHECK_IN * max(0, len(measurement.checks) - CHECKS_WITH_ROOM)
        figure = new_page(13.0, 8.6 + more_in)
        upper, lower = split_page(figure, 2, 1, heights=(4.3, 4.3 + more_in))
        left, middle, right = split_page(upper, 1, 3, widths=(0.95, 1.15, 1.0))
        draw_cut(left.subplots(), measurement)
        _draw_samples(middle, measurement)
        draw_lsf(right.subplots(), measurement)
        curve, numbers, checks = split_page(lower, 1, 3, widths=(1.1, 1.25, 0.85))
        draw_mtf(curve.subplots(), measurement)
        _write_numbers(numbers.subplots(), measurement)
        _write_checks(checks.subplots(), measurement)
        figure.suptitle(
            f"{measurement.kind.capitalize()} by {measurement.method}, "
            f"{measurement.orientation}: {describe_line(measurement)}\n"
            f"{describe_image(measurement, NAME_WITH_ROOM)}",
            x=0.012,
            ha="left",
            fontsize=11,
        )
    return figure


def panel_figures(measurement: Measurement) -> dict[str, Figure]:
    """The drawings of `edge_figure` one by one, for a page that arranges them itself.

    Keys are "mtf", "target", "esf" (of a pulse "prf") and "lsf".
    """
    samples = "esf" if measurement.width_px is None else "prf"
    with styled():
        figures = {name: new_page(6.0, 4.3) for name in ("mtf", "target", samples, "lsf")}
        draw_mtf(figures["mtf"].subplots(), measurement)
        draw_cut(figures["target"].subplots(), measurement)
        _draw_samples(figures[samples], measurement)
        draw_lsf(figures["lsf"].subplots(), measurement)
    return figures


def _draw_samples(page: FigureBase, measurement: Measurement) -> None:
    """Every pixel along the normal, and what the fit leaves of it."""
    values, residuals = page.subplots(2, 1, sharex=True, height_ratios=(2.4, 1.0))
    if measurement.width_px is None:
        draw_esf(values, measurement)
    else:
        draw_prf(values, measurement, measurement.width_px)
    draw_residuals(residuals, measurement)


def _write_numbers(axes: Axes, measurement: Measurement) -> None:
    rows = [("", "", "value ± std", "95 % interval")]
    for name, estimate in numbers_of(measurement).items():
        words, number = metric_words(name), word_estimate(estimate)
        rows.append((words.label, words.unit, number.value_and_std, number.interval))
    write_grid(axes, rows, places=(0.0, 0.35, 0.68, 1.0), align="llrr")
    axes.set_title("Numbers")


def _write_checks(axes: Axes, measurement: Measurement) -> None:
    rows = [("", "", "found", "asked")]
    colors = [INK]
    for check in measurement.checks:
        mark = "✓" if check.passed else "✗"
        rows.append((mark, check.name, format_number(check.value, 3), check.limit))
        colors.append(INK if check.passed else VERMILION)
    if measurement.checks:
        write_grid(axes, rows, places=(0.0, 0.07, 0.72, 1.0), align="llrr", colors=colors)
    else:
        axes.axis("off")
    axes.set_title("Checks" if measurement.trusted else "Checks: not all passed")
    write_below(
        axes,
        count_failed_checks([measurement]),
        rows=len(rows) if measurement.checks else 0,
        color=INK if measurement.trusted else VERMILION,
    )
