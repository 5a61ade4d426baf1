"""Sharpness of a sensor over the field of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.curves.grid import Floats
from acutance.report.figures.panel import Panel
from acutance.report.labels import word_estimate
from acutance.report.paper import INK
from acutance.report.tables.scene import word_chance

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

    from acutance.scan import SceneMeasurement

__all__ = ["field_panel"]

_CELLS = 60
"""Of the longer side of the maps."""
_MIN_RANGE = 0.02
"""Of the colours: less is no change that should look like one."""
_LEVELS = 6


def field_panel(measurement: SceneMeasurement) -> Panel:
    """Maps of the MTF at Nyquist across and along."""
    chance = word_chance(measurement.field.chance_constant)
    return Panel(
        "Sharpness over the field",
        "MTF at Nyquist of the sensor at every place of what was scanned, across and along track "
        "in the same colours (light: sharper), with lines of equal MTF. Numbers: value ± standard "
        f"deviation in the middle of equal parts. The chance that nothing changes: {chance}.",
        lambda page: _draw(page, measurement),
        wide=True,
        height_in=5.0,
    )


def _draw(page: FigureBase, measurement: SceneMeasurement) -> None:
    row, col, height, width = measurement.field.roi
    extent = (col - 0.5, col + width - 0.5, row + height - 0.5, row - 0.5)
    longer = max(height, width)
    rows, cols = measurement.field.grid(
        *(max(2, round(_CELLS * size / longer)) for size in (height, width))
    )
    maps = {name: _map(measurement, rows, cols, deg) for name, deg in measurement.axes_deg.items()}
    low, high = _range(list(maps.values()))
    places = measurement.over_field(*measurement.options["places"])
    all_axes = page.subplots(1, 2)
    for axes, (name, mtf) in zip(all_axes, maps.items(), strict=True):
        shown = axes.imshow(
            mtf, cmap="viridis", vmin=low, vmax=high, extent=extent, interpolation="bilinear"
        )
        if np.ptp(mtf) > 1e-3:
            axes.contour(cols, rows, mtf, _LEVELS, colors=["white"], linewidths=0.7, alpha=0.7)
        for place in places:
            words = word_estimate(getattr(place, name).mtf_nyquist)
            axes.text(
                place.col, place.row, f"{words.value}\n± {words.std}", ha="center", va="center",
                fontsize=8, color=INK,
                bbox={"facecolor": "white", "alpha": 0.8, "linewidth": 0, "pad": 1.5},
            )  # fmt: skip
        axes.set(xlabel="column", ylabel="row", title=f"MTF at Nyquist, {name}")
        axes.locator_params(nbins=5)
        axes.grid(visible=False)
    page.colorbar(shown, ax=list(all_axes), shrink=0.8, label="MTF at Nyquist")
    chance = word_chance(measurement.field.chance_constant)
    page.suptitle(
        f"Sharpness over the field: the chance that nothing changes is {chance}",
        x=0.012, ha="left", fontsize=11, fontweight="bold",
    )  # fmt: skip


def _map(measurement: SceneMeasurement, rows: Floats, cols: Floats, normal_deg: float) -> Floats:
    """MTF at Nyquist in one direction on a grid, (rows, cols)."""
    row, col = (one.ravel() for one in np.meshgrid(rows, cols, indexing="ij"))
    found = measurement.mtf_nyquist_at(row, col, np.full(row.size, normal_deg))
    return found.reshape(rows.size, cols.size)


def _range(maps: list[Floats]) -> tuple[float, float]:
    """Ends of the colours."""
    low, high = float(np.min(maps)), float(np.max(maps))
    lacking = 0.5 * max(_MIN_RANGE - (high - low), 0.0)
    return low - lacking, high + lacking
