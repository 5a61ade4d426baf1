"""Drawings that every measurement has: MTF and LSF by direction, PSF and MTF as maps."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.curves import Otf2d
from acutance.curves.grid import Floats, crossing
from acutance.curves.metrics import NYQUIST_CPP
from acutance.geometry.line import axis_names
from acutance.report.figures.panel import Panel, on_axes
from acutance.report.labels import spread_name, transfer_name, word_estimate
from acutance.report.paper import BLUE, FAINT, GREEN, INK, SHADE, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from acutance.curves import Estimate, Lsf, Mtf
    from acutance.targets.measurement import Measurement

__all__ = [
    "COLORS",
    "MTF_LEVELS",
    "TWO_SIDED_95",
    "axis_labels",
    "band_edges",
    "curve_panels",
    "draw_lsf",
    "draw_mtf",
    "draw_psf",
    "draw_transfer_map",
    "mark_frequencies",
    "reach_px",
]

TWO_SIDED_95 = 1.959964
COLORS = {"across": BLUE, "along": VERMILION}
_DASHES: dict[str, Any] = {"along": {"dashes": (6, 2)}}
"""Where both directions agree, the first is seen between the dashes of the second."""
MTF_LEVELS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
PSF_LEVELS = (0.02, 0.05, 0.1, 0.25, 0.5, 0.75)
MIN_REACH_PX, MAX_REACH_PX = 2.0, 5.0
LINE_STEP = 0.155
"""Height of a note of two lines, of the axes' height."""


def curve_panels(measurement: Measurement) -> tuple[Panel, ...]:
    """MTF and LSF; of a measurement in two dimensions also the PSF and the MTF as a map."""
    transfer = transfer_name(measurement)
    mtf = Panel(
        transfer_name(measurement, "Modulation transfer function"),
        f"The {transfer} with its 95 % band. What the image holds beyond Nyquist is aliased.",
        on_axes(draw_mtf, measurement),
    )
    lsf = Panel(
        spread_name(measurement, "Line spread function"),
        "The derivative of the edge spread function, with its full width at half maximum.",
        on_axes(draw_lsf, measurement),
    )
    if not isinstance(measurement.transfer, Otf2d):
        return mtf, lsf
    return (
        mtf,
        lsf,
        Panel(
            spread_name(measurement, "Point spread function"),
            "Light of a point with the pixel's area included, in percent of its peak.",
            on_axes(draw_psf, measurement),
        ),
        Panel(
            f"{transfer} in all directions",
            "The modulus of the transfer function over the plane of frequencies.",
            on_axes(draw_transfer_map, measurement),
        ),
    )


def band_edges(value: Floats, std: Floats) -> tuple[Floats, Floats]:
    """Lower and upper edge of the 95 % band."""
    return value - TWO_SIDED_95 * std, value + TWO_SIDED_95 * std


def draw_mtf(axes: Axes, measurement: Measurement, max_top: float = math.inf) -> None:
    """The MTF of every direction from 0 to 1 c/px with its 95 % band.

    A direction that was not measured is dashed and has no number. `max_top` ends the axis below
    spikes.
    """
    directions = measurement.directions
    tops = (band_edges(one.mtf.value, one.mtf.std)[1].max() for one in directions.values())
    gsds = {one.gsd_m for one in directions.values()}
    top = min(float(max(tops)), max_top)
    mark_frequencies(axes, gsds.pop() if len(gsds) == 1 else None, top)
    notes: list[tuple[str, str]] = []
    for name, one in directions.items():
        color = COLORS[name]
        if name not in measurement.measured_directions:
            axes.plot(one.mtf.freq_cpp, one.mtf.value, color=color, lw=1, linestyle=":")
            notes.append((f"{name}: not measured,\nfollows from the prior", color))
            continue
        _draw_curve(axes, one.mtf, color, _DASHES.get(name, {}) if len(directions) > 1 else {})
        notes.append((f"{name}, at Nyquist\n{word_estimate(one.mtf_nyquist).value_and_std}", color))
    if len(directions) == 1:
        notes += _mark_mtf50(axes, next(iter(directions.values())).mtf50_cpp)
    _write_notes(axes, notes)
    axes.set(
        ylabel=transfer_name(measurement),
        title=transfer_name(measurement, "Modulation transfer function"),
    )


def _draw_curve(axes: Axes, mtf: Mtf, color: str, style: dict[str, Any]) -> None:
    low, high = band_edges(mtf.value, mtf.std)
    axes.fill_between(
        mtf.freq_cpp, np.maximum(low, 0.0), high, color=color, alpha=0.25, linewidth=0
    )
    axes.plot(mtf.freq_cpp, mtf.value, color=color, **style)
    here = mtf(NYQUIST_CPP)
    axes.errorbar(
        NYQUIST_CPP, here.value, yerr=TWO_SIDED_95 * here.std, fmt="o", color=color, markersize=4,
        capsize=3, linewidth=1.3, zorder=4,
    )  # fmt: skip


def _mark_mtf50(axes: Axes, mtf50: Estimate) -> list[tuple[str, str]]:
    if not (math.isfinite(mtf50.value) and mtf50.value <= 1.0):
        return []
    place = mtf50.value
    axes.plot([0.0, place, place], [0.5, 0.5, 0.0], color=GREEN, linewidth=1, dashes=(4, 3))
    axes.plot(place, 0.5, "o", color=GREEN, markersize=5)
    return [(f"MTF50\n{word_estimate(mtf50).value_and_std} c/px", GREEN)]


def _write_notes(axes: Axes, notes: list[tuple[str, str]]) -> None:
    """Notes of two lines each in the upper right corner, one below the other."""
    for i, (text, color) in enumerate(notes):
        axes.text(
            0.985, 0.955 - LINE_STEP * i, text, transform=axes.transAxes, ha="right", va="top",
            color=color,
        )  # fmt: skip


def draw_lsf(axes: Axes, measurement: Measurement) -> None:
    """The LSF of every measured direction with its 95 % band and the FWHM."""
    top, bottom = 0.0, 0.0
    notes = []
    directions = measurement.directions
    for name in measurement.measured_directions:
        one, color = directions[name], COLORS[name]
        low, high = band_edges(one.lsf.value, one.lsf.std)
        axes.fill_between(one.lsf.distance_px, low, high, color=color, alpha=0.25, linewidth=0)
        style = _DASHES.get(name, {}) if len(directions) > 1 else {}
        axes.plot(one.lsf.distance_px, one.lsf.value, color=color, **style)
        notes.append((f"{name}, FWHM\n{word_estimate(one.fwhm_px).value_and_std} px", color))
        top, bottom = max(top, float(high.max())), min(bottom, float(low.min()))
        if len(directions) == 1:
            _mark_fwhm(axes, one.lsf)
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    _write_notes(axes, notes)
    reach = 1.8 * reach_px(measurement)
    distance = "along the normal " if len(directions) == 1 else ""
    axes.set(
        xlim=(-reach, reach),
        ylim=(min(-0.05 * top, 1.05 * bottom), 1.12 * top),
        xlabel=f"distance {distance}[px]",
        ylabel="LSF [1/px]",
        title=spread_name(measurement, "Line spread function"),
    )


def _mark_fwhm(axes: Axes, lsf: Lsf) -> None:
    peak = int(np.argmax(lsf.value))
    half, at = 0.5 * float(lsf.value[peak]), float(lsf.distance_px[peak])
    left, right = (crossing(lsf.distance_px, lsf.value, half, at, way) for way in (-1, 1))
    if math.isnan(left) or math.isnan(right):
        return
    axes.annotate(
        "", (right, half), (left, half),
        arrowprops={"arrowstyle": "<|-|>", "color": GREEN, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip


def reach_px(measurement: Measurement) -> float:
    """How far from the middle a drawing of the PSF or of an LSF goes."""
    widths = [one.fwhm_px.value for one in measurement.directions.values()]
    widest = max((width for width in widths if np.isfinite(width)), default=MIN_REACH_PX)
    return float(np.clip(2.2 * widest, MIN_REACH_PX, MAX_REACH_PX))


def draw_psf(axes: Axes, measurement: Measurement) -> None:
    """The PSF as a map with contours at shares of its peak, rows downwards."""
    reach = reach_px(measurement)
    distance, psf = measurement.psf(reach, reach / 60)
    share = psf / psf.max()
    _draw_map(axes, distance, share, floor=min(0.0, float(share.min())))
    lines = axes.contour(distance, distance, share, PSF_LEVELS, colors=[INK], linewidths=0.9)
    axes.clabel(lines, fmt=_percent, fontsize=7.5)
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=VERMILION, lw=1.1)
    name = "PSF of the ratio, %" if measurement.is_ratio else "PSF, % of its peak"
    axes.set(**axis_labels(measurement, "px"), title=f"{name}; red: one pixel")


def draw_transfer_map(axes: Axes, measurement: Measurement) -> None:
    """The MTF over the plane of frequencies up to 0.7 c/px, with the square of Nyquist."""
    freq: Floats = np.asarray(np.linspace(-0.7, 0.7, 71))
    u, v = (grid.ravel() for grid in np.meshgrid(freq, freq))
    modulus = np.abs(measurement.otf.model.otf(u, v)).reshape(freq.size, freq.size)
    _draw_map(axes, freq, modulus, floor=0.0)
    lines = axes.contour(freq, freq, modulus, MTF_LEVELS, colors=[INK], linewidths=0.9)
    axes.clabel(lines, fmt="%g", fontsize=7.5)
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=VERMILION, lw=1.1)
    title = transfer_name(measurement) + "; red: Nyquist"
    axes.set(**axis_labels(measurement, "c/px"), title=title)


def axis_labels(measurement: Measurement, unit: str) -> dict[str, str]:
    """What the axes of a map are called: x across track, unless x was declared along track."""
    x, y = axis_names(measurement.image.along_track)
    return {"xlabel": f"{x} [{unit}]", "ylabel": f"{y} [{unit}]"}


def _draw_map(axes: Axes, places: Floats, values: Floats, *, floor: float) -> None:
    half = 0.5 * (places[1] - places[0])
    low, high = float(places[0] - half), float(places[-1] + half)
    axes.imshow(
        np.sqrt(np.maximum(values, 0.0)), cmap="Blues", vmin=floor, vmax=1.35,
        extent=(low, high, high, low), interpolation="bilinear",
    )  # fmt: skip
    axes.grid(visible=False)
    axes.set_aspect("equal")


def _percent(share: float) -> str:
    return f"{100 * share:.0f}"


def mark_frequencies(axes: Axes, gsd_m: float | None, top: float) -> None:
    """Axes of an MTF from 0 to 1 c/px: Nyquist, the aliased region, cycles/m when known.

    `top` is the largest value to be drawn; a sharpened image exceeds 1.
    """
    axes.axvspan(NYQUIST_CPP, 1.0, color=SHADE, linewidth=0, zorder=0)
    axes.axvline(NYQUIST_CPP, color=INK, linewidth=1, dashes=(5, 3))
    for text, place, height in (("Nyquist", NYQUIST_CPP - 0.012, 0.955), ("aliased", 0.985, 0.55)):
        axes.text(
            place, height, text, transform=axes.get_xaxis_transform(), ha="right", va="top",
            color=FAINT, fontsize=8.5,
        )  # fmt: skip
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.05 * max(1.0, top)))
    axes.set(xlabel="frequency [cycles/pixel]", ylabel="MTF")
    if gsd_m is not None:
        second = axes.secondary_xaxis("top", functions=(_scaling(1.0 / gsd_m), _scaling(gsd_m)))
        second.set_xlabel("frequency [cycles/m]")


def _scaling(factor: float) -> Callable[[Any], Any]:
    """Multiply by `factor`: one direction of a second axis."""
    return lambda value: np.asarray(value) * factor
