"""Figure of a plan: expected errors over rows, angle and width."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.paper import BLUE, FAINT, GREEN, ORANGE, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.studies import StudyResult, Table

__all__ = ["plan_figure"]

_METRICS = {"mtf_nyquist": "MTF at Nyquist", "rer": "RER", "fwhm_px": "FWHM [px]"}
_VARIED = {
    "rows": ("rows", "rows across the target"),
    "angle": ("angle_deg", "angle [°]"),
    "width": ("target_width_px", "width of the pulse [px]"),
}


def plan_figure(result: StudyResult) -> Figure:
    """Expected standard deviation of every metric, over what a team may choose.

    Parameters
    ----------
    result : StudyResult
        Of `acutance.studies.plan_target`.
    """
    table = result.table
    varied = [name for name in _VARIED if len(table.where(varied=name))]
    with styled():
        figure = new_page(1.0 + 3.6 * len(varied), 8.4)
        axes = figure.subplots(
            len(_METRICS), len(varied), squeeze=False, sharex="col", sharey="row"
        )
        for line, (metric, words) in zip(axes, _METRICS.items(), strict=True):
            for place, name in zip(line, varied, strict=True):
                column, _ = _VARIED[name]
                _draw(place, table.where(varied=name), column, metric)
            line[0].set_ylabel(f"error of {words}")
            line[0].set_ylim(0, _top(table, metric))
        for place, name in zip(axes[-1], varied, strict=True):
            place.set_xlabel(_VARIED[name][1])
        for place, name in zip(axes[-1], varied, strict=True):
            if name == "rows":
                # Halves of a row are no design.
                place.locator_params("x", integer=True, steps=[1, 2, 5, 10])
        axes[0, 0].legend(loc="best")
        name = result.options.sensor_name
        sensor = f" for {name}" if name else ""
        width = float(table["target_width_px"][0])
        across = f" {width:.3g} px wide" if np.isfinite(width) else ""
        figure.suptitle(
            f"{result.title}{sensor}: {table['rows'][0]:.0f} rows{across} at "
            f"{table['angle_deg'][0]:g}°, SNR {result.options.snr:g}",
            fontsize=12.5, fontweight="bold", x=0.01, ha="left",
        )  # fmt: skip
        return figure


def _top(table: Table, metric: str) -> float:
    """Upper end of an axis: one useless design must not press the others flat."""
    names = [f"{metric}_{kind}" for kind in ("bound", "rms", "stated")]
    if metric == "mtf_nyquist":
        names.append("mtf_nyquist_free")
    values = np.concatenate([table[name] for name in names])
    values = values[np.isfinite(values)]
    return 1.1 * float(min(values.max(), 4 * np.median(values)))


def _draw(axes: Axes, rows: Table, column: str, metric: str) -> None:
    x = rows[column]
    if metric == "mtf_nyquist":
        axes.plot(x, rows["mtf_nyquist_free"], color=FAINT, marker="v", markersize=4,
                  label="bound, free LSF")  # fmt: skip
    axes.plot(x, rows[f"{metric}_bound"], color=ORANGE, marker="^", markersize=4,
              label="bound, known shape")  # fmt: skip
    if np.isfinite(rows[f"{metric}_rms"]).any():
        axes.plot(x, rows[f"{metric}_stated"], color=GREEN, linewidth=1.3, dashes=(4, 2),
                  label="stated by our estimator")  # fmt: skip
        axes.plot(x, rows[f"{metric}_rms"], color=BLUE, marker="o", markersize=4,
                  label="rms error, simulated")  # fmt: skip
