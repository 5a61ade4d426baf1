"""The drawing of a pulse as its pixels show it, on axes it is handed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.page import BLUE, VERMILION
from acutance.report.panels import draw_pixels, reach_px
from acutance.report.wording import word_estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from acutance.curves import Estimate
    from acutance.targets.measurement import Measurement

__all__ = ["draw_prf"]


def draw_prf(axes: Axes, measurement: Measurement, width_px: Estimate) -> None:
    """The samples along the normal, the fitted pulse response, both sides and the width."""
    samples, reach = measurement.samples, reach_px(measurement)
    draw_pixels(axes, samples)
    order = np.argsort(samples.distance_px)
    fitted = samples.value - samples.residual
    axes.plot(samples.distance_px[order], fitted[order], color=BLUE, label="fitted PRF")
    low, high = min(0.0, float(fitted.min())), max(1.0, float(fitted.max()))
    bottom, at = low - 0.12 * (high - low), high + 0.12 * (high - low)
    for side in (0.0, width_px.value):
        axes.plot([side, side], [bottom, at], color=VERMILION, linewidth=1.2, dashes=(4, 3))
    axes.annotate(
        "",
        (width_px.value, at),
        (0.0, at),
        arrowprops={"arrowstyle": "<|-|>", "color": VERMILION, "shrinkA": 0, "shrinkB": 0},
    )
    axes.text(
        0.5 * width_px.value,
        at + 0.03 * (high - low),
        "w",
        color=VERMILION,
        ha="center",
        va="bottom",
    )
    axes.set(
        xlim=(-reach, width_px.value + reach),
        ylim=(bottom, high + 0.3 * (high - low)),
        ylabel="response",
        title=f"Pulse response, w = {word_estimate(width_px).value_and_std} px",
    )
    axes.legend(loc="upper right")
