"""What the steps of the published methods do to the MTF, in closed form and measured."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import acutance as ac
from acutance.report.paper import INK, PALETTE, VERMILION, new_page
from acutance.targets.straight import METHODS

__all__ = ["errors_of_methods", "gains_of_steps", "local_polynomial_gain"]

_MARKS = ("o", "s", "^", "D", "v")


def local_polynomial_gain(freq_cpp: np.ndarray, order: int, window_px: float = 1.0) -> np.ndarray:
    """Gain of a polynomial fitted in a sliding window and read at the window's centre."""
    x = (np.arange(2000) + 0.5) / 2000 - 0.5
    powers = np.stack([x**k for k in range(order + 1)])
    kernel = np.linalg.solve(powers @ powers.T, np.eye(order + 1)[0]) @ powers
    return np.cos(2 * np.pi * window_px * freq_cpp[:, None] * x) @ kernel


def gains_of_steps() -> Figure:
    """Single steps: relative change of the MTF they cause, whatever comes after them."""
    freq = np.linspace(0, 0.5, 101)
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()])
    mtf = np.abs(sensor.otf(freq, 0.0))
    figure = new_page(10.4, 4.2)
    left, middle, right = figure.subplots(1, 3)

    p, rows = 0.98, 40
    steps = {
        "bins of 1/4 px": np.sinc(freq / 4),
        "central difference, 1/4 px": np.sinc(freq / 2),
        "difference, 1/20 px": np.sinc(freq / 20),
        "local polynomial, order 2": local_polynomial_gain(freq, 2),
        "local polynomial, order 4": local_polynomial_gain(freq, 4),
        "smoothing spline, p = 0.98, 40 rows": 1
        / (1 + (1 - p) / p * (2 * np.pi * freq) ** 4 / rows),
    }
    for i, (name, gain) in enumerate(steps.items()):
        left.plot(freq, 100 * (gain - 1), color=PALETTE[i], label=name)
    left.set(title="Smoothing and differences", ylabel="change of the MTF, %")
    left.legend(loc="lower left")

    x = sensor.lsf().distance_px
    lsf = sensor.lsf().value
    for i, width in enumerate((8.0, 10.0, 16.0)):
        taper = np.where(np.abs(x) < width / 2, 0.5 * (1 + np.cos(2 * np.pi * x / width)), 0.0)
        waves = np.cos(2 * np.pi * freq[:, None] * x)
        seen = np.trapezoid(waves * (lsf * taper), x, axis=1)
        middle.plot(freq, 100 * (seen / seen[0] / mtf - 1), color=PALETTE[i],
                    label=f"Hann window of {width:g} px")  # fmt: skip
    middle.set(title="Windows")
    middle.legend()

    for i, angle in enumerate((6.0, 14.0, 20.0)):
        cosine = np.cos(np.radians(angle))
        rowwise = np.abs(sensor.otf(freq / cosine, 0.0))
        divided = np.abs(sensor.otf(freq / cosine**2, 0.0))
        right.plot(freq, 100 * (rowwise / mtf - 1), color=PALETTE[i], label=f"{angle:g}°")
        right.plot(freq, 100 * (divided / mtf - 1), color=PALETTE[i], ls="--")
    right.set(title="Distance along the row")
    right.legend(title="solid: no cosine\ndashed: divided by it")
    for axes in (left, middle, right):
        axes.set_xlabel("frequency, cycles per pixel")
        axes.axhline(0, color=INK, lw=0.8)
    return figure


def errors_of_methods() -> Figure:
    """Error of every method on edges without noise: 6 and 13 degrees, four systems."""
    systems = ac.simulate.reference_systems()
    figure = new_page(10.4, 7.2)
    panels = figure.subplots(2, 4, sharex=True, sharey="row")
    for row, angle in zip(panels, (6.0, 13.0), strict=True):
        for axes, name in zip(row, ("gaussian", "halo", "sharpened", "diffraction"), strict=True):
            image, truth = ac.simulate.edge(systems[name], angle_deg=angle, shape=(60, 60))
            for i, method in enumerate(METHODS):
                found = ac.measure_edge(image, method=method)
                inside = truth.mtf.freq_cpp <= 0.5
                error = 100 * (found.mtf.value - truth.mtf.value)[inside]
                axes.plot(
                    truth.mtf.freq_cpp[inside], error, label=method, lw=1.5,
                    color=VERMILION if method == "spline" else PALETTE[(0, 2, 3, 4)[i - 1]],
                    marker=_MARKS[i], ms=4, markevery=(2 * i, 10),
                )  # fmt: skip
            axes.set_title(f"{name}, {angle:g}°")
            axes.axhline(0, color=INK, lw=0.8)
        row[0].set_ylabel("error of the MTF, hundredths")
    for axes in panels[1]:
        axes.set_xlabel("frequency, c/px")
    panels[0][0].legend(loc="upper left")
    for row in panels:
        row[0].set_ylim(-6.5, 9)
    return figure
