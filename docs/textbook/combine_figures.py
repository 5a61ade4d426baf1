"""Figures of the page on combining measurements."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import acutance as ac
from acutance.report.paper import BLUE, FAINT, INK, ORANGE, PALETTE, VERMILION, new_page
from acutance.targets import Measurement
from acutance.targets.combine import CombinedMeasurement, CombineOptions

__all__ = ["FIGURES", "correction", "slices_and_plane"]

_TWO_SIDED_95 = 1.96
_EDGES = ((6.0, "across"), (7.0, "along"), (30.0, "across"), (-30.0, "along"))


def _edges(sensor: ac.Sensor, seed: int) -> list[Measurement]:
    rng = np.random.default_rng(seed)
    found = []
    for angle, orientation in _EDGES:
        image, _ = ac.simulate.edge(
            sensor, angle_deg=angle, orientation=orientation, shape=(40, 40), dark=200,
            bright=1200, snr=70, rng=rng,
        )  # fmt: skip
        found.append(ac.measure_edge(image))
    return found


def slices_and_plane() -> Figure:
    """Four edges of an elliptical sensor, each a slice, and the OTF through all of them."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.36, 0.5), ac.optics.Detector()])
    edges = _edges(sensor, 3)
    combined = ac.combine(edges)
    figure = new_page(10.4, 3.9)
    plane, direction, numbers = figure.subplots(1, 3, width_ratios=(1.0, 1.15, 1.0))
    _draw_plane(plane, combined, edges)
    _draw_directions(direction, combined, edges, sensor)
    _draw_gain(numbers, combined, edges, sensor)
    return figure


def _draw_plane(axes: Axes, combined: CombinedMeasurement, edges: list[Measurement]) -> None:
    freq = np.linspace(-0.7, 0.7, 71)
    u, v = (grid.ravel() for grid in np.meshgrid(freq, freq))
    modulus = np.abs(combined.otf.model.otf(u, v)).reshape(71, 71)
    lines = axes.contour(freq, freq, modulus, (0.1, 0.3, 0.5, 0.7, 0.9), colors=[FAINT])
    axes.clabel(lines, fmt="%g", fontsize=8)
    for edge, color in zip(edges, PALETTE, strict=False):
        x, y = (0.7 * part for part in edge.line.normal)
        axes.plot([-x, x], [-y, y], color=color)
    axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=INK, lw=0.8)
    axes.set(
        title="Four slices of one OTF", xlabel="across, c/px", ylabel="along, c/px",
        aspect="equal", xlim=(-0.7, 0.7), ylim=(0.7, -0.7),
    )  # fmt: skip


def _draw_directions(
    axes: Axes, combined: CombinedMeasurement, edges: list[Measurement], sensor: ac.Sensor
) -> None:
    """MTF at Nyquist against direction."""
    turns = np.linspace(-50.0, 130.0, 73)
    u, v = 0.5 * np.cos(np.radians(turns)), 0.5 * np.sin(np.radians(turns))
    value = np.abs(combined.otf.model.otf(u, v))
    half = _TWO_SIDED_95 * np.linalg.norm(combined.otf.model.factor(u, v).real, axis=1)
    axes.fill_between(turns, value - half, value + half, color=BLUE, alpha=0.25, lw=0)
    axes.plot(turns, value, color=BLUE, label="combined, 95 %")
    axes.plot(turns, np.abs(sensor.otf(u, v)), color=INK, ls="--", lw=1.2, label="truth")
    for edge, color in zip(edges, PALETTE, strict=False):
        turn = (edge.line.normal_deg + 50.0) % 180.0 - 50.0
        number = edge.mtf_nyquist
        axes.errorbar(
            turn, number.value, yerr=_TWO_SIDED_95 * number.std, fmt="o", color=color, capsize=3
        )
    for turn in (0, 90):
        axes.axvline(turn, color=FAINT, lw=0.8, ls=":")
    axes.set(title="MTF at Nyquist by direction", xlabel="direction, degrees from the rows")
    axes.set_xticks([-45, 0, 45, 90])
    axes.legend(loc="upper right")


def _draw_gain(
    axes: Axes, combined: CombinedMeasurement, edges: list[Measurement], sensor: ac.Sensor
) -> None:
    """Measured less true at Nyquist."""
    rows = [
        *((f"edge {edge.line.normal_deg % 180:.0f}°", edge.mtf_nyquist,
           sensor.response_along(edge.line.normal_deg)) for edge in edges),
        ("combined, 0°", combined.across.mtf_nyquist, sensor.response()),
        ("combined, 90°", combined.along.mtf_nyquist, sensor.response(0.0, "along")),
    ]  # fmt: skip
    colors = [*PALETTE[: len(edges)], INK, INK]
    for i, ((_, number, true), color) in enumerate(zip(rows, colors, strict=True)):
        axes.errorbar(
            number.value - true.mtf_nyquist.value, i, xerr=_TWO_SIDED_95 * number.std, fmt="o",
            color=color, capsize=3,
        )  # fmt: skip
    axes.axvline(0, color=FAINT, lw=1)
    axes.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    axes.set(title="Error", xlabel="MTF at Nyquist, measured minus true")
    axes.invert_yaxis()


def correction() -> Figure:
    """A sensor that diffracts: forced through a Gaussian, and with all that is tried."""
    sensor = ac.simulate.reference_systems()["diffraction"]
    edges = _edges(sensor, 5)
    forced = ac.combine(edges, options=CombineOptions(forms=(("gaussian",),)))
    free = ac.combine(edges)
    freq = np.linspace(0.02, 0.8, 79)
    none = np.zeros_like(freq)
    true = np.abs(sensor.otf(freq, none))
    figure = new_page(10.4, 3.6)
    left, right = figure.subplots(1, 2)
    plain = forced.plain_sensor
    left.plot(freq, true, color=INK, ls="--", label="truth")
    best = min(forced.sensor.forms, key=lambda one: one.share)
    gauss = np.abs(best.form.otf(np.array(best.correction.parameters), freq, none))
    left.plot(
        freq, gauss, color=ORANGE, label=f"Gaussian, chi² {plain.value:.0f}/{plain.expected:.0f}"
    )
    _draw_band(left, freq, free, BLUE, "all forms")
    left.set(title="MTF across", xlabel="frequency, c/px", ylim=(0, 1.02))
    left.legend()
    right.plot(freq, gauss - true, color=ORANGE)
    value = np.abs(free.otf.model.otf(freq, none))
    half = _TWO_SIDED_95 * np.linalg.norm(free.otf.model.factor(freq, none).real, axis=1)
    right.fill_between(freq, value - half - true, value + half - true, color=BLUE, alpha=0.25, lw=0)
    right.plot(freq, value - true, color=BLUE)
    right.axhline(0, color=FAINT, lw=1)
    right.axvline(0.5, color=VERMILION, lw=1, ls=":")
    right.set(title="Measured minus true", xlabel="frequency, c/px")
    return figure


def _draw_band(
    axes: Axes, freq: np.ndarray, found: CombinedMeasurement, color: str, label: str
) -> None:
    none = np.zeros_like(freq)
    value = np.abs(found.otf.model.otf(freq, none))
    half = _TWO_SIDED_95 * np.linalg.norm(found.otf.model.factor(freq, none).real, axis=1)
    axes.fill_between(freq, value - half, value + half, color=color, alpha=0.25, lw=0)
    axes.plot(freq, value, color=color, label=label)


FIGURES: dict[str, Callable[[], Figure]] = {
    "combine-slices": slices_and_plane,
    "combine-correction": correction,
}
