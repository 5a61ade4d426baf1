"""Figure of the study of width corrections: curves before and after, and the widths found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.paper import BLUE, FAINT, GREEN, INK, VERMILION, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.studies import StudyResult, Table

__all__ = ["width_correction_figure"]

_CORRECTED = {"published": ("smoothest ratio", GREEN), "ours": ("joint fit", BLUE)}


def width_correction_figure(result: StudyResult) -> Figure:
    """MTF before and after the correction, as Figures 3.20 to 3.23, and the widths found.

    Parameters
    ----------
    result : StudyResult
        Of the study "width-correction".
    """
    with styled():
        cases = result.options.cases
        figure = new_page(11.0, 3.9 * len(cases))
        axes = figure.subplots(len(cases), 2, squeeze=False, width_ratios=(3, 2))
        for (left, right), case in zip(axes, cases, strict=True):
            _draw_curves(left, result.tables["curves"], case.date)
            left.set_title(f"{case.date}: stated {case.stated_m:g} m, true {case.corrected_m:g} m")
            trials = result.tables["trials"].where(date=case.date)
            _draw_widths(right, trials, result.options.gsd_m, case.stated_m, case.corrected_m)
            right.set_title(f"Widths found at SNR {case.snr:g}")
        return figure


def _draw_curves(axes: Axes, curves: Table, date: str) -> None:
    freq = curves["freq_cpp"]
    axes.plot(freq, curves[f"truth_{date}"], color=INK, linewidth=3.6, alpha=0.3, label="truth")
    axes.plot(freq, curves[f"stated_{date}"], color=VERMILION, label="published, stated width")
    axes.plot(freq, curves[f"smoothed_{date}"], color=GREEN, linewidth=1.4, dashes=(5, 2),
              label="published, smoothest ratio")  # fmt: skip
    axes.plot(freq, curves[f"ours_{date}"], color=BLUE, linewidth=1.3, label="ours, joint fit")
    for place in (0.3, 0.4):
        axes.axvline(place, color=FAINT, linewidth=0.9, dashes=(4, 3))
    axes.set(xlabel="frequency [c/px]", ylabel="MTF", xlim=(0, 0.5), ylim=(0, 1.1))
    axes.legend(loc="lower left")


def _draw_widths(axes: Axes, trials: Table, gsd_m: float, stated_m: float, true_m: float) -> None:
    widths = {name: gsd_m * trials[f"{name}_width_px"] for name in _CORRECTED}
    widths = {name: width[np.isfinite(width)] for name, width in widths.items()}
    everything = np.concatenate([*widths.values(), [stated_m, true_m]])
    low, high = np.percentile(everything, (0.5, 99.5))
    margin = 0.05 * (high - low)
    bins = np.linspace(min(low, stated_m) - margin, max(high, true_m) + margin, 32)
    for name, width in widths.items():
        words, color = _CORRECTED[name]
        axes.hist(width, bins=bins.tolist(), color=color, alpha=0.6, label=words)
    axes.axvline(true_m, ymax=0.84, color=INK, linewidth=1.4, label="true")
    axes.axvline(stated_m, ymax=0.84, color=VERMILION, linewidth=1.4, dashes=(4, 2), label="stated")
    top = axes.get_ylim()[1]
    axes.set(xlabel="width of the tarp [m]", ylabel="images", ylim=(0, 1.3 * top))
    axes.legend(loc="upper center", ncols=4, fontsize=8, columnspacing=1.0, handlelength=1.3)
