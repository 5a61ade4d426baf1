"""Figures of the studies of noise: values and errors over the SNR."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.paper import BLUE, GREEN, INK, VERMILION, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.studies import StudyResult, Table

__all__ = ["ESTIMATOR_COLORS", "ESTIMATOR_WORDS", "ground_noise_figure", "snr_figure"]

ESTIMATOR_COLORS = {"published": VERMILION, "ours": BLUE}
ESTIMATOR_WORDS = {"published": "published (sdsu-2005)", "ours": "ours (spline)"}
_MARKERS = {"published": "*", "ours": "o"}
_SIZES = {"published": 5.0, "ours": 3.2}

_LONG_AXIS = 4.0
"""Largest over smallest SNR of an axis from which a decade's ticks are three at least."""


def snr_figure(result: StudyResult) -> Figure:
    """System noise, as Figure 3.8: every estimate over its SNR, and below it the rms error.

    Parameters
    ----------
    result : StudyResult
        Of the study "snr".
    """
    with styled():
        figure = new_page(11.0, 7.6)
        axes = figure.subplots(2, 2, sharex=True, height_ratios=(3, 2))
        for column, target in enumerate(("edge", "pulse")):
            levels = result.table.where(target=target)
            trials = result.tables["trials"].where(target=target)
            _draw_values(axes[0, column], trials["snr"], trials, float(levels["truth"][0]))
            _draw_errors(axes[1, column], levels, result.options.limit_percent)
            _mark_minimum(axes[1, column], result, levels, f"minimum_snr_{target}_")
            size = result.options.width_px
            kind = "Edge" if target == "edge" else f"Pulse of {size:g} px"
            dark, bright = getattr(result.options, f"{target}_dn")
            axes[0, column].set_title(f"{kind}, {bright:g} on {dark:g} DN")
            axes[1, column].set_xlabel("SNR")
        _share_y(axes)
        _plain_ticks(axes[1, 0])
        figure.suptitle(
            f"System noise at {result.options.angle_deg:g}°: {len(result.tables['trials'])} images",
            fontsize=12.5, fontweight="bold", x=0.01, ha="left",
        )  # fmt: skip
        return figure


def ground_noise_figure(result: StudyResult) -> Figure:
    """Uneven ground, as Figure 3.11: every estimate over its SNR, and the rms error.

    Parameters
    ----------
    result : StudyResult
        Of the study "ground-noise".
    """
    with styled():
        figure = new_page(8.4, 7.6)
        axes = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        trials, table = result.tables["trials"], result.table
        by_difference = dict(zip(table["difference_dn"], table["snr"], strict=True))
        snr = np.array([by_difference[d] for d in trials["pulse_dn"] - trials["ground_dn"]])
        _draw_values(axes[0], snr, trials, float(table["truth"][0]))
        _draw_errors(axes[1], table, result.options.limit_percent)
        _mark_minimum(axes[1], result, table, "minimum_snr_")
        runs, contrasts = result.options.runs, len(result.options.levels_dn)
        axes[0].set_title(f"Pulse on uneven ground: {contrasts} contrasts, {runs} runs each")
        axes[1].set_xlabel("SNR")
        _plain_ticks(axes[1])
        return figure


def _draw_values(axes: Axes, snr: Floats, trials: Table, truth: float) -> None:
    for name, color in ESTIMATOR_COLORS.items():
        axes.plot(
            snr,
            trials[f"{name}_mtf_nyquist"],
            _MARKERS[name],
            color=color,
            markersize=_SIZES[name],
            markeredgewidth=0,
            alpha=0.4 if len(trials) > 300 else 0.75,
            rasterized=len(trials) > 300,
            label=ESTIMATOR_WORDS[name],
        )
    axes.axhline(truth, color=INK, linewidth=1.4, label=f"truth {truth:.4f}")
    axes.set(xscale="log", ylabel="MTF at Nyquist")
    axes.set_ylim(0.4 * truth, 1.6 * truth)
    _count_missing(axes, trials)
    legend = axes.legend(loc="lower right")
    for handle in legend.legend_handles:
        if handle is not None:
            handle.set_alpha(1.0)


def _count_missing(axes: Axes, trials: Table) -> None:
    """Say what the frame does not show: estimates beyond it, and refusals."""
    low, high = axes.get_ylim()
    lines = []
    for name in ESTIMATOR_COLORS:
        value = trials[f"{name}_mtf_nyquist"]
        refused = int(np.isnan(value).sum())
        outside = int(np.sum((value < low) | (value > high)))
        if refused or outside:
            lines.append(f"{name}: {outside} beyond the frame, {refused} refused")
    text = "\n".join(lines)
    axes.text(0.98, 0.98, text, transform=axes.transAxes, ha="right", va="top", fontsize=8.5)


def _plain_ticks(axes: Axes) -> None:
    """SNR in plain numbers on a logarithmic axis that is drawn, evenly spread on a short one."""
    from matplotlib.ticker import AutoLocator, FuncFormatter, LogLocator, NullFormatter

    low, high = axes.get_xlim()
    by_decade = LogLocator(subs=(1.0, 2.0, 3.0, 5.0, 7.0))
    axes.xaxis.set_major_locator(by_decade if high > _LONG_AXIS * low else AutoLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _draw_errors(axes: Axes, levels: Table, limit_percent: float) -> None:
    for name, color in ESTIMATOR_COLORS.items():
        axes.plot(
            levels["snr"],
            levels[f"{name}_rms_percent"],
            color=color,
            marker=".",
            linewidth=1.2,
            markersize=4,
        )
    axes.axhline(limit_percent, color=GREEN, linewidth=1.2, dashes=(5, 3))
    axes.set(ylabel="rms error [%]", yscale="log", ylim=(0.3, 100))
    axes.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    axes.minorticks_off()


def _mark_minimum(axes: Axes, result: StudyResult, levels: Table, prefix: str) -> None:
    """Where each estimator comes below the limit."""
    found = {one.name: one.value for one in result.findings}
    limit_percent = result.options.limit_percent
    for line, name in enumerate(ESTIMATOR_COLORS):
        snr, answer = found.get(f"{prefix}{name}"), "refused"
        if snr is not None:
            answer = f"SNR {snr:.0f}" if np.isfinite(snr) else "not reached"
            if snr == levels["snr"].min():
                answer = f"at most {answer}"
            axes.axvline(snr, color=ESTIMATOR_COLORS[name], linewidth=1, dashes=(2, 2))
        # Errors fall with the SNR: the upper right corner is free of curves.
        axes.text(
            0.98, 0.97 - 0.11 * line,
            f"{ESTIMATOR_WORDS[name]} below {limit_percent:g} %: {answer}",
            transform=axes.transAxes, ha="right", va="top", color=ESTIMATOR_COLORS[name],
            fontsize=8.5, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip


def _share_y(axes: Any) -> None:
    for row in axes:
        row[1].sharey(row[0])
        row[1].set_ylabel("")
