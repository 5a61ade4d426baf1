"""Figure of the study of widths: what a wrong width does, and what the joint fit finds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.paper import BLUE, FAINT, GREEN, INK, VERMILION, new_page, styled
from acutance.report.studies.snr import ESTIMATOR_WORDS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.studies import StudyResult, Table

__all__ = ["width_figure"]

_ENDS = (VERMILION, GREEN)
_MAX_SHOWN = 2.0
"""Larger values at Nyquist, as shares of the truth, are beyond the frame."""


def width_figure(result: StudyResult) -> Figure:
    """Spectra, values at Nyquist and deformed curves, as Figures 3.13 to 3.19 and 3.24.

    Parameters
    ----------
    result : StudyResult
        Of the study "width".
    """
    with styled():
        figure = new_page(12.6, 7.6)
        top, bottom = figure.subplots(2, 3)
        options = result.options
        _draw_spectra(top[0], options.widths_px, options.nominal_px)
        _draw_nyquist(top[1], result.table.where(error="measured"), "stated_px")
        _draw_nyquist(top[2], result.table.where(error="true"), "true_px")
        low, high = _displayed(options.widths_px)
        _draw_curves(bottom[0], result.tables["curves"], low, options.nominal_px)
        _draw_curves(bottom[1], result.tables["curves"], high, options.nominal_px)
        _draw_widths(bottom[2], result.table)
        return figure


def _displayed(widths_px: tuple[float, ...]) -> tuple[float, float]:
    """The stated widths of Figures 3.18 and 3.19, or the nearest there are: 2.8 and 3.2."""
    nearest = [min(widths_px, key=lambda width: abs(width - wanted)) for wanted in (2.8, 3.2)]
    return nearest[0], nearest[1]


def _draw_spectra(axes: Axes, widths_px: tuple[float, ...], nominal_px: float) -> None:
    freq = np.linspace(0, 0.6, 241)
    ends = (min(widths_px), max(widths_px))
    for width, color in zip(ends, _ENDS, strict=True):
        axes.plot(freq, np.abs(np.sinc(width * freq)), color=color, label=f"{width:g} px")
    axes.plot(freq, np.abs(np.sinc(nominal_px * freq)), color=INK, label=f"{nominal_px:g} px")
    axes.set(
        xlabel="frequency [c/px]", ylabel="|sinc(w f)|", title="Spectra of the pulses",
        xlim=(0, 0.6), ylim=(0, 1.02),
    )  # fmt: skip
    axes.axvline(0.5, color=FAINT, linewidth=0.9, dashes=(4, 3))
    axes.text(0.505, 0.45, "Nyquist", color=FAINT, fontsize=8.5)
    axes.legend(loc="upper right")


def _draw_nyquist(axes: Axes, rows: Table, column: str) -> None:
    words = {"stated_px": "stated width", "true_px": "true width"}
    width = rows[column]
    axes.plot(width, rows["truth_0.5"], color=INK, linewidth=3.4, alpha=0.35, label="truth")
    axes.plot(width, rows["ours_0.5"], color=BLUE, marker="o", markersize=3.5, linewidth=1.2,
              label=ESTIMATOR_WORDS["ours"])  # fmt: skip
    axes.plot(width, rows["published_0.5"], color=VERMILION, marker="*", linewidth=1.2,
              label=ESTIMATOR_WORDS["published"])  # fmt: skip
    nominal = int(np.argmin(np.abs(rows["true_px"] - rows["stated_px"])))
    closed = rows["published_0.5"][nominal] * rows["ratio_gain_0.5"]
    axes.plot(width, closed, color=INK, linewidth=1, dashes=(2, 2), label="closed form")
    other = "true" if column == "stated_px" else "stated"
    published = rows["published_0.5"]
    # At a zero of the pulse's spectrum the ratio has no bounds.
    top = _MAX_SHOWN * float(np.max(rows["truth_0.5"]))
    beyond = int(np.sum(published > top))
    values = np.concatenate([np.minimum(published, top), rows["truth_0.5"]])
    span = float(np.ptp(values))
    if beyond:
        axes.text(0.98, 0.97, f"published: {beyond} beyond the frame", transform=axes.transAxes,
                  ha="right", va="top", fontsize=8.5)  # fmt: skip
    axes.set(
        xlabel=f"{words[column]} [px]", ylabel="MTF at Nyquist",
        title=f"{words[column].capitalize()} varied, {other} {rows[f'{other}_px'][0]:g} px",
        ylim=(float(values.min()) - 0.95 * span, float(values.max()) + 0.2 * span),
    )  # fmt: skip
    axes.legend(loc="lower left", ncols=2)


def _draw_curves(axes: Axes, curves: Table, stated_px: float, true_px: float) -> None:
    freq = curves["freq_cpp"]
    name = f"measured_{stated_px:g}"
    axes.plot(freq, curves["truth"], color=INK, linewidth=3.4, alpha=0.35, label="truth")
    axes.plot(
        freq, curves[f"ours_{name}"], color=BLUE, linewidth=1.3, label=ESTIMATOR_WORDS["ours"]
    )
    axes.plot(
        freq, curves[f"published_{name}"], color=VERMILION, label=ESTIMATOR_WORDS["published"]
    )
    for place in (0.3, 0.4):
        axes.axvline(place, color=FAINT, linewidth=0.9, dashes=(4, 3))
    axes.set(
        xlabel="frequency [c/px]", ylabel="MTF", xlim=(0, 0.5), ylim=(0, 1.3),
        title=f"Stated {stated_px:g} px, true {true_px:g} px",
    )  # fmt: skip
    axes.legend(loc="lower left")


def _draw_widths(axes: Axes, table: Table) -> None:
    measured, true = (table.where(error=error) for error in ("measured", "true"))
    axes.plot(
        measured["stated_px"], measured["ours_width_px"], "o", color=BLUE, markersize=5,
        label="stated width varied",
    )  # fmt: skip
    axes.plot(
        true["true_px"], true["ours_width_px"], "s", color=GREEN, markersize=5,
        label="true width varied",
    )  # fmt: skip
    ends = np.array([table["true_px"].min(), table["true_px"].max()])
    axes.plot(ends, ends, color=INK, linewidth=1, dashes=(2, 2))
    axes.axhline(measured["true_px"][0], color=INK, linewidth=1, dashes=(2, 2))
    axes.set(
        xlabel="varied width [px]", ylabel="width found by the joint fit [px]",
        title="The joint fit finds the true width",
    )  # fmt: skip
    axes.plot([], [], color=INK, linewidth=1, dashes=(2, 2), label="truth")
    axes.legend(loc="upper left")
