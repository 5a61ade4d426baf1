"""Drawings of a restoration filter: the sheet that shows what it does and what it costs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.arguments import require_class, require_floats
from acutance.curves.grid import Floats
from acutance.report.figures.curves import COLORS, band_edges, mark_frequencies
from acutance.report.figures.panel import Panel
from acutance.report.labels import word_estimate, write_fixed
from acutance.report.paper import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    SHADE,
    VERMILION,
    new_page,
    split_page,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from acutance.curves import Estimate
    from acutance.restoration import RestorationFilter

__all__ = ["before_after_figure", "restoration_figure", "restoration_panels"]

_ESF_REACH_PX = 6.0
_KERNEL_REACH_PX = 7
_HEADROOM = 1.12
_LEGEND_ROOM = 1.3
_WIDTH_IN, _ROW_IN = 13.0, 4.4


def restoration_panels(filter: RestorationFilter) -> tuple[Panel, ...]:
    """Every drawing of the sheet.

    Parameters
    ----------
    filter : RestorationFilter
    """

    def on_axes(draw: Callable[[Axes, RestorationFilter], None]) -> Callable[[FigureBase], None]:
        return lambda page: draw(page.subplots(), filter)

    return (
        Panel(
            "MTF before and after",
            "Dashed: the sensor. Full: with the filter, as predicted. 95 % bands of the "
            "measurement. What lies beyond Nyquist is aliased, and amplified with the rest.",
            on_axes(_draw_mtf),
        ),
        Panel(
            "Edge before and after",
            "The edge spread function: dashed the sensor, full with the filter. Shaded: the "
            "overshoot; the lobes beyond it are its ringing.",
            on_axes(_draw_esf),
        ),
        Panel(
            "The trade",
            "What kernels of this size and kind give for the noise they cost; the chosen one is "
            "marked. Changes of NIIRS are those of GIQE 4.",
            lambda page: _draw_trade(page, filter),
        ),
        Panel(
            "Noise spectrum",
            "Standard deviation of white noise by frequency, after the filter over before.",
            on_axes(_draw_noise),
        ),
        Panel(
            "Noise correlation",
            "Correlation of the noise of two pixels after the filter, by their distance.",
            on_axes(_draw_correlation),
        ),
        Panel(
            "The kernel",
            "Its weights, of a large one the middle; blue is positive, red negative. Colours "
            "follow the square root.",
            on_axes(_draw_kernel),
        ),
    )


def restoration_figure(filter: RestorationFilter) -> Figure:
    """All drawings of a filter on one sheet.

    Parameters
    ----------
    filter : RestorationFilter
    """
    require_class("RestorationFilter", filter=filter)
    panels = restoration_panels(filter)
    with styled():
        figure = new_page(_WIDTH_IN, 2 * _ROW_IN + 0.5)
        for part, panel in zip(split_page(figure, 2, 3), panels, strict=True):
            panel.draw(part)
        figure.suptitle(
            f"Restoration: {filter.method} kernel of {filter.size} by {filter.size} pixels, noise "
            f"gain {filter.noise_gain:.2f}",
            fontsize=12.5, fontweight="bold", x=0.01, ha="left",
        )  # fmt: skip
    return figure


def before_after_figure(before: Floats, after: Floats, titles: tuple[str, str]) -> Figure:
    """The same pixels before and after a filter, side by side in the same greys.

    Parameters
    ----------
    before, after : (rows, cols) array
    titles : (str, str)
    """
    before, after = require_floats("before", before), require_floats("after", after)
    low, high = np.nanpercentile(before, (0.5, 99.5))
    with styled():
        figure = new_page(12.0, 0.6 + 5.8 * before.shape[0] / before.shape[1])
        for axes, pixels, title in zip(figure.subplots(1, 2), (before, after), titles, strict=True):
            axes.imshow(pixels, cmap="gray", vmin=low, vmax=high, interpolation="nearest")
            axes.set_title(title)
            axes.set_axis_off()
    return figure


def _draw_mtf(axes: Axes, filter: RestorationFilter) -> None:
    top = max(
        float(band_edges(value, std)[1].max())
        for one in filter.after.directions.values()
        for _, value, std in [one.curve("mtf")]
    )
    gsd = filter.gsd_m
    # Room for the words above the curves.
    square = gsd[0] if gsd is not None and gsd[0] == gsd[1] else None
    mark_frequencies(axes, square, _HEADROOM * max(1.0, top))
    lines = []
    for i, (name, after) in enumerate(filter.after.directions.items()):
        before = filter.before.directions[name]
        freq, value, std = before.curve("mtf")
        axes.plot(freq, value, color=COLORS[name], linewidth=1.2, dashes=(5, 2))
        freq, value, std = after.curve("mtf")
        low, high = band_edges(value, std)
        axes.fill_between(
            freq, np.maximum(low, 0.0), high, color=COLORS[name], alpha=0.22, linewidth=0
        )
        axes.plot(freq, value, color=COLORS[name], dashes=(9, 3) if i else (1, 0))
        lines.append((
            f"{name}, at Nyquist\n{word_estimate(before.mtf_nyquist).value} →\n"
            f"{word_estimate(after.mtf_nyquist).value_and_std}", COLORS[name],
        ))  # fmt: skip
    for i, (text, color) in enumerate(lines):
        axes.text(0.985, 0.955 - 0.2 * i, text, transform=axes.transAxes, ha="right", va="top",
                  color=color)  # fmt: skip
    axes.set_title("MTF before and after")


def _draw_esf(axes: Axes, filter: RestorationFilter) -> None:
    for i, (name, after) in enumerate(filter.after.directions.items()):
        place, value, _ = filter.before.directions[name].curve("esf")
        axes.plot(place, value, color=COLORS[name], linewidth=1.2, dashes=(5, 2))
        place, value, std = after.curve("esf")
        low, high = band_edges(value, std)
        axes.fill_between(place, low, high, color=COLORS[name], alpha=0.22, linewidth=0)
        axes.plot(place, value, color=COLORS[name], dashes=(9, 3) if i else (1, 0))
        axes.text(
            0.97, 0.46 - 0.155 * i, f"{name}, overshoot\n"
            f"{_percent(after.overshoot)} %",
            transform=axes.transAxes, ha="right", va="top", color=COLORS[name],
        )  # fmt: skip
    worst = filter.after.overshoot.value
    for low_level, high_level in ((1.0, 1.0 + worst), (-worst, 0.0)):
        axes.axhspan(low_level, high_level, color=SHADE, linewidth=0, zorder=0)
    for level in (0.0, 1.0):
        axes.axhline(level, color=FAINT, linewidth=0.8)
    axes.set(
        xlim=(-_ESF_REACH_PX, _ESF_REACH_PX), xlabel="distance along the normal [px]",
        ylabel="ESF", title="Edge before and after",
    )  # fmt: skip


def _percent(share: Estimate) -> str:
    """A share in percent; without a deviation one decimal has to do."""
    percent = 100 * share
    return word_estimate(percent).value_and_std if share.std > 0 else write_fixed(percent.value, 1)


def _draw_trade(page: FigureBase, filter: RestorationFilter) -> None:
    rows, gain = filter.trade, filter.noise_gain
    gains = np.array([row["noise_gain"] for row in rows])
    upper, middle, lower = page.subplots(3, 1, sharex=True)
    for name in ("across", "along"):
        column = np.array([row[f"mtf_nyquist_{name}"] for row in rows])
        upper.plot(gains, column, color=COLORS[name], dashes=(6, 2) if name == "along" else (1, 0))
        chosen = filter.after.directions[name].mtf_nyquist.value
        upper.plot(gain, chosen, "o", color=COLORS[name], markersize=5)
    upper.set_ylabel("MTF at Nyquist")
    middle.plot(gains, [100 * row["overshoot"] for row in rows], color=ORANGE)
    middle.plot(gain, 100 * filter.after.overshoot.value, "o", color=ORANGE, markersize=5)
    middle.set_ylabel("overshoot [%]")
    if filter.niirs_change:
        lower.plot(gains, [row["niirs_change"] for row in rows], color=GREEN)
        lower.plot(gain, filter.niirs_change[4].value, "o", color=GREEN, markersize=5)
    else:
        lower.text(0.5, 0.5, "no SNR is known", transform=lower.transAxes, ha="center", color=FAINT)
    lower.set(xlabel="noise gain", ylabel="change of NIIRS", xscale="log")
    ticks = [tick for tick in (0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0) if tick <= 1.05 * gains.max()]
    lower.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    lower.minorticks_off()
    for axes in (upper, middle, lower):
        axes.axvline(gain, color=INK, linewidth=0.8, dashes=(4, 3))
    upper.set_title("The trade")
    page.align_ylabels([upper, middle, lower])


def _draw_noise(axes: Axes, filter: RestorationFilter) -> None:
    freq = np.linspace(0.0, 0.5, 101)
    nothing = np.zeros(freq.size)
    for name, (u, v) in (("across", (freq, nothing)), ("along", (nothing, freq))):
        if filter.along_track == "x":
            u, v = v, u
        axes.plot(freq, np.abs(filter.otf(u, v)), color=COLORS[name], label=name,
                  dashes=(6, 2) if name == "along" else (1, 0))  # fmt: skip
    diagonal = np.abs(filter.otf(freq, freq))
    axes.plot(freq, diagonal, color=FAINT, linewidth=1.2, label="both (diagonal)")
    axes.axhline(1.0, color=FAINT, linewidth=0.8)
    axes.axhline(filter.noise_gain, color=INK, linewidth=1, dashes=(4, 3),
                 label=f"noise gain {filter.noise_gain:.2f}")  # fmt: skip
    top = max(float(np.max(line.get_ydata())) for line in axes.get_lines())
    axes.legend(loc="upper left", ncols=2)
    axes.set(
        xlim=(0, 0.5), xlabel="frequency [cycles/pixel]", ylabel="noise, after / before",
        title="Noise spectrum",
    )  # fmt: skip
    axes.set_ylim(0.0, _LEGEND_ROOM * top)


def _draw_correlation(axes: Axes, filter: RestorationFilter) -> None:
    found = filter.noise_correlation
    middle = found.shape[0] // 2
    reach = min(middle, 8)
    own = slice(middle, middle + reach + 1)
    across, along = found[middle, own], found[own, middle]
    if filter.along_track == "x":
        across, along = along, across
    shift = np.arange(reach + 1)
    style: dict[str, Any] = {"markersize": 4.5, "linewidth": 1.2}
    axes.plot(shift, across, "o-", color=BLUE, label="across", **style)
    axes.plot(shift, along, "s", color=VERMILION, label="along", dashes=(5, 2), **style)
    axes.plot(shift, np.diag(found)[own], "^:", color=FAINT, label="both (diagonal)", **style)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.legend(loc="upper right")
    axes.set(xlabel="shift [px]", ylabel="correlation", title="Noise correlation")


def _draw_kernel(axes: Axes, filter: RestorationFilter) -> None:
    middle, reach = filter.margin_px, min(filter.margin_px, _KERNEL_REACH_PX)
    kernel = filter.kernel[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1]
    shown = np.sign(kernel) * np.sqrt(np.abs(kernel))
    top, side = float(np.abs(shown).max()), reach + 0.5
    axes.imshow(shown, cmap="RdBu", vmin=-top, vmax=top, extent=(-side, side, side, -side))
    for row in range(max(0, reach - 2), min(kernel.shape[0], reach + 3)):
        for col in range(max(0, reach - 2), min(kernel.shape[0], reach + 3)):
            # Without the zero before the point two neighbours do not touch.
            number = write_fixed(float(kernel[row, col]), 2).replace("0.", ".", 1)
            color = "white" if abs(shown[row, col]) > 0.6 * top else INK
            axes.text(col - reach, row - reach, number, ha="center", va="center", fontsize=5.2,
                      color=color)  # fmt: skip
    axes.grid(visible=False)
    axes.set(xlabel="columns [px]", ylabel="rows [px]", title="The kernel")
