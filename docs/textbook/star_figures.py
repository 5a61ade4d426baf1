"""Figures and tables of the page on bars and stars."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import acutance as ac
from acutance.geometry.bar_group import Bars
from acutance.report.paper import (
    BLUE,
    FAINT,
    INK,
    ORANGE,
    PURPLE,
    VERMILION,
    new_page,
)
from acutance.targets.periodic import BarsOptions, StarOptions

__all__ = ["FIGURES", "finite_bars", "measured_bars", "measured_star", "what_levels_do"]

_SYSTEMS = ac.simulate.reference_systems()


@cache
def _star(system: str, cycles: int, *, levels: bool) -> tuple[Any, Any]:
    """A square star of a system, measured, and its truth."""
    image, truth = ac.simulate.star(
        _SYSTEMS[system], cycles=cycles, wave="square", radius_px=52.0, shape=(120, 120),
        centre=(59.3, 60.2), snr=100, rng=np.random.default_rng(5),
    )  # fmt: skip
    options = StarOptions(wave="square")
    if levels:
        options = StarOptions(wave="square", dark=200.0, bright=1200.0, level_std=1.4)
    return ac.measure_star(image, cycles=cycles, options=options), truth


@cache
def _bars(system: str) -> tuple[Any, Any]:
    """Groups of bars of a system, measured, and their truth."""
    image, truth = ac.simulate.bars(
        _SYSTEMS[system], angle_deg=6.0, periods_px=(10, 6, 4, 3, 2.5, 2, 1.6), count=4, snr=100,
        rng=np.random.default_rng(5),
    )  # fmt: skip
    options = BarsOptions(dark=200.0, bright=1200.0, level_std=1.4)
    return ac.measure_bars(image, options=options), truth


def measured_star() -> Figure:
    """A star with its aliased centre, its rings and the joint fit, and the truth."""
    found, truth = _star("diffraction", 36, levels=True)
    figure = new_page(10.4, 4.3)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.5))
    left.imshow(found.details.pixels, cmap="gray", interpolation="nearest")
    angle = np.linspace(0.0, 2 * math.pi, 721)
    aliased = found.star.radius_at(0.5) * np.maximum(np.abs(np.sin(angle)), np.abs(np.cos(angle)))
    left.plot(
        found.star.col + aliased * np.cos(angle), found.star.row + aliased * np.sin(angle),
        color=VERMILION,
    )  # fmt: skip
    left.set_title("Aliased within the red curve")
    _bare(left)
    radius = np.linspace(4.0, 52.0, 400)
    right.plot(
        radius, truth.mtf_mean(found.star.cycles / (2 * math.pi * radius)), color=INK, ls="--",
        label="truth",
    )  # fmt: skip
    mtf = found.mean_mtf
    right.plot(found.star.radius_at(1.0) / mtf.freq_cpp[1:], mtf.value[1:], color=BLUE,
               label="joint fit")  # fmt: skip
    rings = found.rings
    right.plot(found.star.radius_at(1.0) / rings.freq_cpp, rings.modulation, ".", color=ORANGE,
               label="ring by ring")  # fmt: skip
    right.axvline(found.nyquist_px, color=VERMILION, lw=1.0)
    right.text(found.nyquist_px, 1.0, " Nyquist", color=VERMILION, va="top")
    right.set(xlim=(0, 52), ylim=(0, 1.02), xlabel="radius, px", title="MTF against radius")
    right.legend(loc="lower right")
    return figure


def _bare(axes: Axes) -> None:
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])


def what_levels_do() -> Figure:
    """Standard deviation of the mean MTF with and without stated levels, by cycles of the star."""
    figure = new_page(10.4, 3.8)
    axes = figure.subplots()
    for cycles, color in ((36, BLUE), (12, ORANGE)):
        for levels, style in ((True, "-"), (False, "--")):
            found, _ = _star("gaussian", cycles, levels=levels)
            words = "levels stated" if levels else "levels fitted"
            axes.plot(
                found.mean_mtf.freq_cpp, found.mean_mtf.std, color=color, ls=style,
                label=f"{cycles} cycles, {words}",
            )  # fmt: skip
    axes.axvline(0.5, color=FAINT, lw=0.8)
    axes.set(
        xlim=(0, 0.8), yscale="log", ylim=(2e-4, 0.1), xlabel="cycles per pixel",
        title="Standard deviation of the mean MTF, star of 52 px",
    )  # fmt: skip
    marks = (0.0003, 0.001, 0.003, 0.01, 0.03)
    axes.set_yticks(marks, [f"{mark:g}" for mark in marks])
    axes.set_yticks([], minor=True)
    axes.legend(ncols=2, loc="upper right")
    return figure


def measured_bars() -> Figure:
    """Groups of bars, one profile, and MTF by every reading, and the truth."""
    found, truth = _bars("sharpened")
    figure = new_page(10.4, 4.3)
    left, middle, right = figure.subplots(1, 3, width_ratios=(0.42, 1.0, 1.3))
    left.imshow(found.details.pixels, cmap="gray", interpolation="nearest")
    left.set_title("Groups")
    _bare(left)
    group, profile = found.groups[2], found.details.profiles[2]
    order = np.argsort(profile.across_px)
    middle.plot(profile.across_px, profile.value, ".", ms=3, color=FAINT, label="pixels")
    middle.plot(profile.across_px[order], profile.fitted[order], color=BLUE, label="fit")
    middle.set(xlabel="distance along the normal, px", ylim=(-0.3, 1.6),
               title=f"The group of {group.freq_cpp:.2f} c/px")  # fmt: skip
    middle.legend(loc="upper right", ncols=2)
    true = truth.response.mtf
    right.plot(true.freq_cpp, true.value, color=INK, ls="--", label="truth")
    curve = found.normal_response.mtf
    right.plot(curve.freq_cpp, curve.value, color=BLUE, label="joint fit")
    freq = [one.freq_cpp for one in found.groups]
    right.plot(freq, [one.reading.ctf for one in found.groups], "s", ms=5, color=PURPLE,
               label="CTF")  # fmt: skip
    right.plot(freq, [one.coltman for one in found.groups], "x", ms=6, color=VERMILION,
               label="Coltman")  # fmt: skip
    right.plot(freq, [one.reading.modulation for one in found.groups], "o", ms=4, color=ORANGE,
               label="sinusoid")  # fmt: skip
    right.axvline(0.5, color=FAINT, lw=0.8)
    right.set(xlim=(0, 0.8), ylim=(0, 1.6), xlabel="cycles per pixel", title="MTF along the normal")
    right.legend(ncols=2, loc="upper right")
    return figure


def finite_bars() -> Figure:
    """Spectra of groups of 3 and 15 bars: what a finite group shows."""
    figure = new_page(10.4, 3.6)
    axes = figure.subplots()
    freq = np.linspace(0.001, 1.0, 2000)
    for count, color in ((3, BLUE), (15, ORANGE)):
        bars = Bars(0.0, 0.0, 0.0, 5.0, count, 40.0)
        spectrum = np.abs(bars.spectrum(freq)) / (0.5 * count * bars.period_px)
        axes.plot(freq, spectrum, color=color, label=f"{count} bars", lw=1.4)
    axes.set(
        xlim=(0, 1), ylim=(0, 1.02), xlabel="cycles per pixel",
        title="Spectrum of bars with a period of 5 px, share of their area",
    )  # fmt: skip
    axes.legend()
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "star-measured": measured_star,
    "star-levels": what_levels_do,
    "bars-measured": measured_bars,
    "bars-finite": finite_bars,
}
