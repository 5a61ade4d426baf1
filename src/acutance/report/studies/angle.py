"""Figure of the study of angles: the published under-estimate taken apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.report.paper import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    VERMILION,
    new_page,
    styled,
)
from acutance.report.studies.snr import ESTIMATOR_WORDS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.curves.grid import Floats
    from acutance.studies import StudyResult, Table

__all__ = ["angle_figure"]

_TERMS = {
    "window": ("1 px window, 2nd degree", ORANGE),
    "width": ("width not divided by the cosine", PURPLE),
    "row_distance": ("distance along the row", GREEN),
    "rest": ("the rest", FAINT),
}


def angle_figure(result: StudyResult) -> Figure:
    """Noise-free pulses over the angle, as Figure 3.12, and where the error comes from.

    Parameters
    ----------
    result : StudyResult
        Of the study "angle".
    """
    with styled():
        figure = new_page(11.0, 4.9)
        left, right = figure.subplots(1, 2)
        _draw_values(left, result.table, result.tables["trials"])
        _draw_terms(right, result.table)
        for axes in (left, right):
            if len(result.table) == 1:
                # A line through one point is not seen.
                for line in axes.lines:
                    line.set(marker="o", linestyle="none")
            axes.legend(loc="lower left")
        return figure


def _draw_values(axes: Axes, table: Table, trials: Table) -> None:
    angle = table["angle_deg"]
    axes.plot(
        trials["angle_deg"], trials["published"], ".", color=VERMILION, markersize=2.2, alpha=0.35,
        rasterized=True,
    )  # fmt: skip
    axes.plot(angle, table["truth"], color=INK, linewidth=3.4, alpha=0.35, label="truth")
    axes.plot(angle, table["ours"], color=BLUE, linewidth=1.3, label=ESTIMATOR_WORDS["ours"])
    axes.plot(angle, table["order_4_normal"], color=GREEN, linewidth=1.2, dashes=(1, 1.5),
              label="published, causes removed")  # fmt: skip
    axes.plot(angle, table["cosine_corrected"], color=PURPLE, linewidth=1.2, dashes=(5, 2),
              label="published, width divided by the cosine")  # fmt: skip
    axes.plot(angle, table["published"], color=VERMILION, label=ESTIMATOR_WORDS["published"])
    drawn = ("published", "truth", "ours", "order_4_normal", "cosine_corrected")
    low, high = _range(*(table[name] for name in drawn), trials["published"])
    axes.set(
        xlabel="angle of the pulse [°]", ylabel="MTF at Nyquist",
        title="MTF at Nyquist without noise", ylim=(low - 0.012, high + 0.008),
    )  # fmt: skip


def _draw_terms(axes: Axes, table: Table) -> None:
    angle = table["angle_deg"]
    for name, (words, color) in _TERMS.items():
        axes.plot(angle, table[f"{name}_percent"], color=color, label=words)
        predicted = f"{name}_predicted_percent"
        if predicted in table.columns:
            axes.plot(angle, table[predicted], color=INK, linewidth=1, dashes=(2, 2))
    axes.plot([], [], color=INK, linewidth=1, dashes=(2, 2), label="closed form of each")
    axes.plot(angle, table["published_percent"], color=VERMILION, label="all of it: published")
    axes.plot(angle, table["ours_percent"], color=BLUE, linewidth=1.3, label="ours")
    low, high = _range(
        *(table[f"{name}_percent"] for name in ("published", "ours", *_TERMS)),
        *(table[name] for name in table.columns if name.endswith("_predicted_percent")),
    )
    span = high - low
    under = float(np.nanmean(table["published_percent"])) < 0
    axes.set(
        xlabel="angle of the pulse [°]", ylabel="error of the MTF at Nyquist [%]",
        title=f"Where the {'under' if under else 'over'}-estimate comes from",
        # An under-estimate leaves room for the legend by itself.
        ylim=(low - (0.12 if under else 0.8) * span, high + 0.1 * span),
    )  # fmt: skip


def _range(*columns: Floats) -> tuple[float, float]:
    """From the least to the largest number of some columns."""
    values = np.concatenate(columns)
    return float(np.nanmin(values)), float(np.nanmax(values))
