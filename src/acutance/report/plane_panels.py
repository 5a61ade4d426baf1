"""Drawings of a 2-D measurement: both directions in one plane of axes, PSF and MTF as maps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.page import BLUE, FAINT, INK, SHADE, VERMILION
from acutance.report.panels import TWO_SIDED_95, band_edges, mark_frequencies
from acutance.report.quantity import spread_name, transfer_name
from acutance.report.wording import word_estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.curves import Mtf, Response
    from acutance.targets import Measurement2d

__all__ = [
    "PlanePanel",
    "draw_plane_lsf",
    "draw_plane_mtf",
    "draw_psf",
    "draw_residuals",
    "draw_transfer_map",
]

COLORS = {"across": BLUE, "along": VERMILION}
LEVELS = (0.02, 0.05, 0.1, 0.25, 0.5, 0.75)
MTF_LEVELS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
LEAST_REACH_PX = 2.0
MOST_REACH_PX = 5.0
MOST_SIGMAS = 4.0


@dataclass(frozen=True)
class PlanePanel:
    """A drawing that a method adds to the page of its measurement.

    Parameters
    ----------
    title, caption : str
        What stands over and under it in a report.
    draw : function of a figure or a part of one
    wide : bool, optional
        Whether it takes a whole row of the page.
    height_in : float, optional
        Height of its row in inches.
    """

    title: str
    caption: str
    draw: Callable[[FigureBase], None]
    wide: bool = False
    height_in: float = 4.3


def _directions(measurement: Measurement2d) -> dict[str, Response]:
    return {"across": measurement.across, "along": measurement.along}


def reach_px(measurement: Measurement2d) -> float:
    """How far from the middle a drawing of the PSF or of an LSF goes."""
    widths = [one.fwhm_px.value for one in _directions(measurement).values()]
    widest = max((width for width in widths if np.isfinite(width)), default=LEAST_REACH_PX)
    return float(np.clip(2.2 * widest, LEAST_REACH_PX, MOST_REACH_PX))


def draw_plane_mtf(axes: Axes, measurement: Measurement2d) -> None:
    """The MTF across and along from 0 to 1 c/px with their 95 % bands."""
    directions = _directions(measurement)
    tops = (band_edges(one.mtf.value, one.mtf.std)[1].max() for one in directions.values())
    gsds = {one.gsd_m for one in directions.values()}
    mark_frequencies(axes, gsds.pop() if len(gsds) == 1 else None, float(max(tops)))
    for i, (name, one) in enumerate(directions.items()):
        _draw_curve(axes, one.mtf, COLORS[name])
        number = word_estimate(one.mtf_nyquist).value_and_std
        axes.text(
            0.985, 0.955 - 0.155 * i, f"{name}, at Nyquist\n{number}",
            transform=axes.transAxes, ha="right", va="top", color=COLORS[name],
        )  # fmt: skip
    axes.set(
        ylabel=transfer_name(measurement),
        title=transfer_name(measurement, "Modulation transfer function"),
    )


def _draw_curve(axes: Axes, mtf: Mtf, color: str) -> None:
    low, high = band_edges(mtf.value, mtf.std)
    axes.fill_between(mtf.freq_cpp, low, high, color=color, alpha=0.25, linewidth=0)
    axes.plot(mtf.freq_cpp, mtf.value, color=color)
    here = mtf(0.5)
    axes.errorbar(
        0.5, here.value, yerr=TWO_SIDED_95 * here.std, fmt="o", color=color, markersize=4,
        capsize=3, linewidth=1.3, zorder=4,
    )  # fmt: skip


def draw_plane_lsf(axes: Axes, measurement: Measurement2d) -> None:
    """The LSF across and along with their 95 % bands and the FWHM."""
    top, low_end = 0.0, 0.0
    for i, (name, one) in enumerate(_directions(measurement).items()):
        low, high = band_edges(one.lsf.value, one.lsf.std)
        axes.fill_between(
            one.lsf.distance_px, low, high, color=COLORS[name], alpha=0.25, linewidth=0
        )
        axes.plot(one.lsf.distance_px, one.lsf.value, color=COLORS[name])
        axes.text(
            0.985, 0.955 - 0.155 * i,
            f"{name}, FWHM\n{word_estimate(one.fwhm_px).value_and_std} px",
            transform=axes.transAxes, ha="right", va="top", color=COLORS[name],
        )  # fmt: skip
        top, low_end = max(top, float(high.max())), min(low_end, float(low.min()))
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    reach = 1.8 * reach_px(measurement)
    axes.set(
        xlim=(-reach, reach),
        ylim=(min(-0.05 * top, 1.05 * low_end), 1.12 * top),
        xlabel="distance [px]",
        ylabel="LSF [1/px]",
        title=spread_name(measurement, "Line spread function"),
    )


def draw_psf(axes: Axes, measurement: Measurement2d) -> None:
    """The PSF as a map with contours at shares of its peak, rows downwards."""
    reach = reach_px(measurement)
    distance, psf = measurement.psf(reach, reach / 60)
    share = psf / psf.max()
    _draw_map(axes, distance, share, "Blues", floor=min(0.0, float(share.min())))
    lines = axes.contour(distance, distance, share, LEVELS, colors=[INK], linewidths=0.9)
    axes.clabel(lines, fmt=_percent, fontsize=7.5)
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=VERMILION, lw=1.1)
    name = "PSF of the ratio, %" if measurement.is_ratio else "PSF, % of its peak"
    axes.set(xlabel="across [px]", ylabel="along [px]", title=f"{name}; red: one pixel")


def draw_transfer_map(axes: Axes, measurement: Measurement2d) -> None:
    """The MTF over the plane of frequencies up to 0.7 c/px, with the square of Nyquist."""
    freq: Floats = np.asarray(np.linspace(-0.7, 0.7, 71))
    u, v = (grid.ravel() for grid in np.meshgrid(freq, freq))
    modulus = np.abs(measurement.otf.model.otf(u, v)).reshape(freq.size, freq.size)
    _draw_map(axes, freq, modulus, "Blues", floor=0.0)
    lines = axes.contour(freq, freq, modulus, MTF_LEVELS, colors=[INK], linewidths=0.9)
    axes.clabel(lines, fmt="%g", fontsize=7.5)
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=VERMILION, lw=1.1)
    title = transfer_name(measurement) + "; red: Nyquist"
    axes.set(xlabel="across [c/px]", ylabel="along [c/px]", title=title)


def draw_residuals(
    axes: Axes, residual_sigmas: Floats, row: int, col: int, unused: str = SHADE
) -> None:
    """Residuals in standard deviations, their axes counting pixels from (row, col).

    Pixels that were not used are NaN and get a colour of their own.
    """
    import matplotlib

    height, width = residual_sigmas.shape
    shown = axes.imshow(
        np.ma.masked_invalid(residual_sigmas),
        cmap=matplotlib.colormaps["RdBu_r"].with_extremes(bad=unused),
        vmin=-MOST_SIGMAS, vmax=MOST_SIGMAS, interpolation="nearest",
        extent=(col - 0.5, col + width - 0.5, row + height - 0.5, row - 0.5),
    )  # fmt: skip
    axes.figure.colorbar(shown, ax=axes, shrink=0.8, label="standard deviations")
    axes.grid(visible=False)
    axes.set(xlabel="column", ylabel="row", title="Residuals")


def _draw_map(axes: Axes, places: Floats, values: Floats, colors: str, *, floor: float) -> None:
    half = 0.5 * (places[1] - places[0])
    low, high = float(places[0] - half), float(places[-1] + half)
    axes.imshow(
        np.sqrt(np.maximum(values, 0.0)), cmap=colors, vmin=floor, vmax=1.35,
        extent=(low, high, high, low), interpolation="nearest",
    )  # fmt: skip
    axes.grid(visible=False)
    axes.set_aspect("equal")


def _percent(share: float) -> str:
    return f"{100 * share:.0f}"
