"""Drawings of a bi-resolution measurement: coherence, kernel, residuals, map, iterations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.figures.curves import COLORS, axis_labels
from acutance.report.figures.panel import Panel, on_axes, required
from acutance.report.figures.pixels import draw_residual_map
from acutance.report.labels import transfer_name
from acutance.report.paper import BLUE, FAINT, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.targets.pair import BiresolutionMeasurement

__all__ = ["biresolution_panels"]

MIN_COHERENCE = 0.05
KERNEL_PX = 3.0


def biresolution_panels(measurement: BiresolutionMeasurement) -> tuple[Panel, ...]:
    """Spectra, kernel, residuals and map: all need what `without_details` takes away."""
    if measurement.details is None:
        return ()
    return (
        Panel(
            "Spectra",
            "The transfer between the two images by the ratio of spectra (dots) and by the fitted "
            "kernel (lines), with the coherence (dashed): the share of the low image that the high "
            "one explains.",
            on_axes(_draw_spectra, measurement),
        ),
        Panel(
            "Kernel",
            "Weights of the high image's samples around a low pixel, in percent of the largest; "
            "blue positive, red negative.",
            on_axes(_draw_kernel, measurement),
        ),
        Panel(
            "Residuals",
            "Low image minus the blurred high one, in standard deviations. What is left out is "
            "yellow. Structures of the scene mean that the two images show different things.",
            on_axes(_draw_residual, measurement),
        ),
        Panel(
            "Map of local statistics",
            f"Every region on its own: {transfer_name(measurement)} at Nyquist across and along, "
            "shift against the whole (arrows, enlarged), and residuals.",
            lambda page: _draw_map(page, measurement),
            wide=True,
            height_in=3.6,
        ),
    )


def _draw_spectra(axes: Axes, measurement: BiresolutionMeasurement) -> None:
    top = 1.05
    fit, spectra = required(measurement.details).fit, required(measurement.details).spectra
    for axis in measurement.directions:
        color = COLORS[axis]
        of_columns = (axis == "across") == (measurement.image.along_track == "y")
        freq: Floats = np.asarray(np.linspace(0.0, measurement.ratio[1] / 2, 120))
        nothing = np.zeros(freq.size)
        u, v = (freq, nothing) if of_columns else (nothing, freq)
        zero = np.zeros(1)
        total = (fit.basis.transfer(zero, zero) @ fit.beta)[0].real
        kernel = np.abs(fit.basis.transfer(u, v) @ fit.beta) / total
        axes.plot(freq, kernel, color=color, label=f"kernel {axis}")
        top = max(top, 1.1 * float(kernel.max()))
        if spectra is None:
            continue
        found, coherence = spectra.along_axis("across" if of_columns else "along")
        axes.plot(found, coherence, color=color, ls="--", lw=1.1, label=f"coherence {axis}")
        transfer = spectra.transfer
        middle = transfer.shape[0] // 2, transfer.shape[1] // 2
        row, column = transfer[middle[0], middle[1] :], transfer[middle[0] :, middle[1]]
        line = row if of_columns else column
        shown = (coherence > MIN_COHERENCE) & (found > 0.04)
        ratio = np.abs(line[shown]) / total
        axes.plot(found[shown], ratio, "o", ms=3, color=color, label=f"spectral ratio {axis}")
    axes.axvline(0.5, color=FAINT, lw=0.8)
    axes.text(0.505, 0.99 * top, "Nyquist", color=FAINT, va="top")
    axes.set(
        xlim=(0, min(1.0, measurement.ratio[1] / 2)), ylim=(0, top),
        xlabel="frequency [cycles per low pixel]", title="Spectra: MTF_low / MTF_high",
    )  # fmt: skip
    axes.legend(loc="upper right", bbox_to_anchor=(1.0, 0.93), fontsize=7.5)


def _draw_kernel(axes: Axes, measurement: BiresolutionMeasurement) -> None:
    fit = required(measurement.details).fit
    taps = fit.kernel.taps
    down = fit.grid.down.places_px + fit.basis.down.shift_px
    across = fit.grid.across.places_px + fit.basis.across.shift_px
    rows, cols = np.abs(down) <= KERNEL_PX, np.abs(across) <= KERNEL_PX
    part = 100 * taps[np.ix_(rows, cols)] / taps.max()
    # The kernel is the taps seen from the other side.
    part, x, y = part[::-1, ::-1], -across[cols][::-1], -down[rows][::-1]
    half = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    axes.imshow(
        part, cmap="RdBu", vmin=-100, vmax=100, interpolation="nearest",
        extent=(x[0] - half[0], x[-1] + half[0], y[-1] + half[1], y[0] - half[1]),
    )  # fmt: skip
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=INK, lw=1.1)
    axes.grid(visible=False)
    axes.set(
        **axis_labels(measurement, "low px"), title="Kernel on the high samples; box: low pixel",
    )  # fmt: skip


def _draw_residual(axes: Axes, measurement: BiresolutionMeasurement) -> None:
    noise = measurement.residual_std or 1.0
    shown = required(measurement.details).residuals
    draw_residual_map(
        axes, shown.values / noise, shown.box.row, shown.box.col, step=shown.step,
        unused="#f4d03f",
    )  # fmt: skip


def _draw_map(page: FigureBase, measurement: BiresolutionMeasurement) -> None:
    local = measurement.local
    name = "Ratio" if measurement.is_ratio else "MTF"
    # Axes of one grid are equally large, be there a scale of colours beside them or not.
    parts = page.subplots(1, 4, gridspec_kw={"wspace": 0.1})
    for part, axis in zip(parts, measurement.directions, strict=False):
        mtf, std = measurement.local_mtf_nyquist(axis)
        typical = float(np.nanmedian(std)) if np.isfinite(std).any() else float("nan")
        _draw_field(
            part,
            mtf,
            f"{name} at Nyquist {axis}",
            f"each ± {typical:.3f}",
            "viridis",
        )
    _draw_shifts(parts[2], local.shift_row_px, local.shift_col_px)
    _draw_field(parts[3], local.residual, "Residual", "", "magma_r", "DN of the low image")


def _draw_field(
    axes: Axes, field: Floats, title: str, below: str, colors: str, unit: str = ""
) -> None:
    shown = axes.imshow(np.ma.masked_invalid(field), cmap=colors, interpolation="nearest")
    axes.figure.colorbar(shown, ax=axes, shrink=0.8, label=unit)
    axes.set(title=title, xlabel=below)
    _frame(axes)


def _frame(axes: Axes) -> None:
    """A frame all around: regions are counted, and have no axis."""
    axes.grid(visible=False)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[["top", "right"]].set_visible(True)


def _draw_shifts(axes: Axes, down: Floats, across: Floats) -> None:
    rows, cols = np.meshgrid(*(np.arange(size) for size in down.shape), indexing="ij")
    length = np.hypot(down, across)
    usable = np.isfinite(length)
    longest = float(np.max(length[usable])) if usable.any() else 0.0
    if longest > 0:
        axes.quiver(
            cols[usable], rows[usable], across[usable], down[usable], angles="xy",
            scale_units="xy", scale=longest / 0.48, color=BLUE, width=0.008,
        )  # fmt: skip
    axes.set(
        xlim=(-0.5, down.shape[1] - 0.5), ylim=(down.shape[0] - 0.5, -0.5), aspect="equal",
        title="Local shifts", xlabel=f"longest {longest:.3f} low px",
    )  # fmt: skip
    _frame(axes)
