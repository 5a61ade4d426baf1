"""Figures of the page on the edge method."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import acutance as ac
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.report.paper import BLUE, FAINT, INK, PALETTE, VERMILION, new_page
from acutance.targets.straight import lsf_prior as prior
from acutance.targets.straight.spline import combine, edge_and_line_weights
from acutance.targets.straight.tuned import FAMILY_LOG_AMPLITUDES, LOG_AMPLITUDE

__all__ = ["measured_and_truth", "prior_directions", "what_truncation_does"]

_TWO_SIDED_95 = 1.96


def measured_and_truth() -> Figure:
    """One noisy edge: samples, curves with 95 % intervals, and the truth."""
    sensor = ac.simulate.reference_systems()["sharpened"]
    image, truth = ac.simulate.edge(
        sensor, angle_deg=6, shape=(40, 40), snr=70, rng=np.random.default_rng(7)
    )
    found = ac.measure_edge(image)
    figure = new_page(10.4, 7.1)
    (esf, lsf), (mtf, error) = figure.subplots(2, 2)

    s = found.details.distance_px
    near = np.abs(s) < 5
    esf.plot(s[near], found.details.value[near], ".", ms=3, color=FAINT, label="pixels")
    for axes, curve, true in ((esf, found.esf, truth.esf), (lsf, found.lsf, truth.lsf)):
        _draw_band(axes, curve.distance_px, curve.value, curve.std, 5.0)
        near = np.abs(true.distance_px) < 5
        axes.plot(true.distance_px[near], true.value[near], "--", color=VERMILION, lw=1.3,
                  label="truth")  # fmt: skip
        axes.set_xlabel("normal distance, px")
    esf.set(title="ESF", ylabel="edge response")
    lsf.set(title="LSF", ylabel="1/px")
    _draw_band(mtf, found.mtf.freq_cpp, found.mtf.value, found.mtf.std, 1.0)
    mtf.plot(truth.mtf.freq_cpp, truth.mtf.value, "--", color=VERMILION, lw=1.3, label="truth")
    mtf.set(title="MTF", xlabel="frequency, cycles per pixel", ylabel="MTF", xlim=(0, 1))
    difference = found.mtf.value - truth.mtf.value
    error.fill_between(found.mtf.freq_cpp, -_TWO_SIDED_95 * found.mtf.std,
                       _TWO_SIDED_95 * found.mtf.std, color=BLUE, alpha=0.2, lw=0,
                       label="95 % interval")  # fmt: skip
    error.plot(found.mtf.freq_cpp, difference, color=BLUE, label="measured minus true")
    error.axhline(0, color=VERMILION, ls="--", lw=1.3)
    error.set(title="Error of the MTF", xlabel="frequency, cycles per pixel", xlim=(0, 1))
    for axes in (esf, lsf, mtf, error):
        axes.legend()
    esf.legend(loc="upper left")
    return figure


def _draw_band(axes, x, value, std, reach) -> None:
    near = np.abs(x) <= reach
    x, value, half = x[near], value[near], _TWO_SIDED_95 * std[near]
    axes.fill_between(x, value - half, value + half, color=BLUE, alpha=0.25, lw=0,
                      label="95 % interval")  # fmt: skip
    axes.plot(x, value, color=BLUE, label="measured")


def prior_directions() -> Figure:
    """Draws from the prior: how an LSF may differ from a Gaussian through a pixel, and how much."""
    blur = GaussianPixel(0.4)
    known = prior.directions(blur)
    tail = prior.tail_spline()
    u = np.linspace(-6, 6, 601)
    cell, _, slopes = edge_and_line_weights(u)
    rng = np.random.default_rng(4)
    names = (*FAMILY_LOG_AMPLITUDES, "detail", "tail")
    figure = new_page(10.4, 7.2)
    panels = figure.subplots(3, 4, sharex=True, sharey=True)
    plain = blur.width_px * blur.lsf(u * blur.width_px)
    for k, (axes, name) in enumerate(zip(panels.flat[: len(names)], names, strict=True)):
        own = np.flatnonzero(known.block == prior.FIRST_BLOCK + k)
        start = float(np.exp(LOG_AMPLITUDE[k]))
        amplitude = 1.0 if name in FAMILY_LOG_AMPLITUDES else 0.05
        for color in PALETTE[:3]:
            share = amplitude * rng.standard_normal(own.size)
            drawn = known.esf[:, own] @ share + tail * (known.tail[own] @ share)
            axes.plot(u, combine(cell, slopes, drawn), color=color, lw=1.5)
        axes.plot(u, 0.1 * plain, color=FAINT, lw=1, ls="--")
        axes.set_title(f"{name}, {amplitude:g} ({start:.2g})")
    for spare in panels.flat[len(names) :]:
        spare.set_visible(False)
    panels[-2, -1].tick_params(labelbottom=True)
    for axes in (*panels[-1, :-1], panels[-2, -1]):
        axes.set_xlabel("distance, widths")
    figure.supylabel("correction of the LSF, per width", fontsize=10)
    dashed = "dashed: a tenth of\nthe Gaussian\nthrough a pixel"
    panels[0, 0].text(0.02, 0.98, dashed, transform=panels[0, 0].transAxes, color=FAINT,
                      fontsize=8.5, va="top")  # fmt: skip
    return figure


def what_truncation_does() -> Figure:
    """An LSF cut off at a distance raises the whole MTF: three systems with wings."""
    figure = new_page(10.4, 3.7)
    panels = figure.subplots(1, 3, sharey=True)
    systems = ac.simulate.reference_systems()
    for axes, name in zip(panels, ("gaussian", "halo", "diffraction"), strict=True):
        truth = systems[name].response()
        x, y = truth.lsf.distance_px, truth.lsf.value
        freq = np.linspace(0, 0.5, 51)
        true = np.interp(freq, truth.mtf.freq_cpp, truth.mtf.value)
        for color, reach in zip(PALETTE, (2.0, 3.0, 5.0, 8.0), strict=False):
            near = np.abs(x) <= reach + 1e-9
            waves = np.exp(-2j * np.pi * freq[:, None] * x[near])
            cut = np.abs(np.trapezoid(waves * y[near], x[near], axis=1))
            axes.plot(freq, 100 * (cut / cut[0] / true - 1), color=color, label=f"±{reach:g} px")
        axes.axhline(0, color=INK, lw=0.8)
        axes.set(title=name, xlabel="frequency, cycles per pixel")
    panels[0].set_ylabel("error of the MTF, %")
    panels[0].legend(title="LSF cut at", loc="upper left")
    return figure
