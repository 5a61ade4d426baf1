"""Drawings of a combination: every curve with the combined one, residuals, directions."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from acutance.report.figures.curves import MTF_LEVELS, axis_labels
from acutance.report.figures.panel import Panel, on_axes
from acutance.report.paper import FAINT, INK, PALETTE, split_page

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

    from acutance.targets.combine import CombinedMeasurement, CombinedPart

__all__ = ["combined_panels"]

COLUMNS = 4
ROW_IN = 2.7
MAX_STDS = 4.0
REACH_CPP = 0.8


def combined_panels(measurement: CombinedMeasurement) -> tuple[Panel, ...]:
    """What a combination adds to its page: directions, agreement, every curve with its residual."""
    rows = math.ceil(len(measurement.parts) / COLUMNS)
    return (
        Panel(
            "Directions",
            "Contours of the combined MTF over the plane of frequencies, and the slices it was "
            "made of; dotted: measurements of all directions.",
            on_axes(_draw_directions, measurement),
            is_target=True,
        ),
        Panel(
            "MTF at Nyquist, one by one",
            "What each measurement found along its own direction, minus the combined MTF there, "
            "with its 95 % interval; the grey bar is that of the combined value.",
            on_axes(_draw_agreement, measurement),
        ),
        Panel(
            "Residuals",
            "Each measurement minus the combined MTF, in standard deviations of both together. "
            "Neighbouring frequencies are correlated, and what a measurement leaves to its prior "
            "counts as well: chi-square is of the pixels alone.",
            on_axes(_draw_residuals, measurement),
        ),
        Panel(
            "Every measurement",
            "Measured MTF with its 95 % band (colour), and the combined MTF in the same direction "
            "(black).",
            lambda page: _draw_curves(page, measurement),
            wide=True,
            height_in=0.4 + ROW_IN * rows,
        ),
    )


def color_of(number: int) -> str:
    """The colour of a measurement, counted from 0."""
    return PALETTE[number % len(PALETTE)]


def _draw_directions(axes: Axes, measurement: CombinedMeasurement) -> None:
    freq = np.linspace(-REACH_CPP, REACH_CPP, 81)
    u, v = (grid.ravel() for grid in np.meshgrid(freq, freq))
    modulus = np.abs(measurement.otf.model.otf(u, v)).reshape(freq.size, freq.size)
    lines = axes.contour(freq, freq, modulus, MTF_LEVELS, colors=[FAINT], linewidths=0.9)
    axes.clabel(lines, fmt="%g", fontsize=7.5)
    for i, part in enumerate(measurement.parts):
        reach = float(part.freq_cpp[-1])
        for turn in np.radians(part.normal_deg):
            x, y = reach * math.cos(turn), reach * math.sin(turn)
            axes.plot(
                [-x, x], [-y, y], color=color_of(i),
                linestyle=":" if part.has_all_directions else "-",
                linewidth=1.1 if part.has_all_directions else 1.8,
            )  # fmt: skip
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=INK, lw=0.9)
    axes.set(
        xlim=(-REACH_CPP, REACH_CPP), ylim=(REACH_CPP, -REACH_CPP),
        **axis_labels(measurement, "c/px"), title="Directions; square: Nyquist",
    )  # fmt: skip
    axes.set_aspect("equal")
    axes.grid(visible=False)


def _draw_agreement(axes: Axes, measurement: CombinedMeasurement) -> None:
    parts = measurement.parts
    for i, part in enumerate(parts):
        off = part.own.value - part.combined.value
        half = 1.96 * part.combined.std
        axes.fill_betweenx([i - 0.32, i + 0.32], -half, half, color="#d5dae0", linewidth=0)
        axes.errorbar(
            off, i, xerr=1.96 * part.own.std, fmt="o", color=color_of(i), capsize=3, markersize=5
        )
    axes.axvline(0.0, color=FAINT, linewidth=0.9)
    axes.set_yticks(range(len(parts)), [_label(part) for part in parts])
    axes.set_ylim(len(parts) - 0.5, -0.5)
    axes.set(xlabel="MTF at Nyquist, own − combined", title="At Nyquist, one by one")
    axes.grid(visible=False, axis="y")
    axes.locator_params(axis="x", nbins=4)


def _label(part: CombinedPart) -> str:
    name = part.name
    return name if len(name) <= 20 else f"{name[:19]}…"


def _draw_residuals(axes: Axes, measurement: CombinedMeasurement) -> None:
    axes.axhspan(-1.96, 1.96, color="#eceff2", linewidth=0)
    axes.axhline(0.0, color=FAINT, linewidth=0.9)
    for i, part in enumerate(measurement.parts):
        std = np.hypot(part.std, part.fitted_std)
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.where(std > 0, (part.value - part.fitted) / std, 0.0)
        for row in off:
            axes.plot(
                part.freq_cpp, np.clip(row, -MAX_STDS, MAX_STDS),
                color=color_of(i), linewidth=1.3 if len(off) == 1 else 0.8,
            )  # fmt: skip
            for marker, beyond in (("^", row > MAX_STDS), ("v", row < -MAX_STDS)):
                axes.plot(
                    part.freq_cpp[beyond], np.clip(row[beyond], -MAX_STDS, MAX_STDS),
                    color=color_of(i), marker=marker, markersize=4, linestyle="",
                )  # fmt: skip
    axes.set(
        xlim=(0, REACH_CPP), ylim=(-1.05 * MAX_STDS, 1.05 * MAX_STDS),
        xlabel="frequency [c/px]", ylabel="standard deviations (triangles: beyond)",
        title="Own − combined",
    )  # fmt: skip


def _draw_curves(page: FigureBase, measurement: CombinedMeasurement) -> None:
    parts = measurement.parts
    columns = min(len(parts), COLUMNS)
    rows = math.ceil(len(parts) / columns)
    for i, (place, part) in enumerate(zip(split_page(page, rows, columns), parts, strict=False)):
        axes = place.subplots()
        for value, std, fitted in zip(part.value, part.std, part.fitted, strict=True):
            axes.fill_between(
                part.freq_cpp, value - 1.96 * std, value + 1.96 * std, color=color_of(i),
                alpha=0.3 if len(part.value) == 1 else 0.12, linewidth=0,
            )  # fmt: skip
            axes.plot(part.freq_cpp, value, color=color_of(i), linewidth=1.3)
            axes.plot(part.freq_cpp, fitted, color=INK, linewidth=0.9, linestyle="--")
        axes.set(xlim=(0, REACH_CPP), ylim=(0, 1.02), xlabel="frequency [c/px]")
        axes.set_title(_label(part), fontsize=9.5)
        found = part.chi_square
        where = "all directions" if part.has_all_directions else f"normal {part.direction}"
        axes.text(
            0.97, 0.95,
            f"{where}\nchi² {found.value:.1f}, expected {found.expected:.1f}",
            transform=axes.transAxes, ha="right", va="top", fontsize=8.5,
        )  # fmt: skip
