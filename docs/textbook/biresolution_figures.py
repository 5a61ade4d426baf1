"""Figures and tables of the bi-resolution method."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import acutance as ac
from acutance.report.paper import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, VERMILION, new_page
from acutance.simulate import NativeGrid

__all__ = ["FIGURES", "measured_pair", "products", "what_limits"]

_SYSTEMS = ac.simulate.reference_systems()
_REFERENCE = _SYSTEMS["gaussian"]


@cache
def _pair(system: str, ratio: float, snr: float = 100.0) -> tuple[np.ndarray, np.ndarray, object]:
    return ac.simulate.pair(
        _SYSTEMS[system], _REFERENCE, ratio=ratio, shape=(128, 128), shift_px=(0.7, -1.3), gain=1.2,
        offset=40.0, snr=snr, rng=np.random.default_rng(11),
    )  # fmt: skip


def measured_pair() -> Figure:
    """A pair, and the MTF by both estimators, and the truth."""
    low, high, truth = _pair("smeared", 2.0)
    figure = new_page(10.4, 4.0)
    left, middle, right = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.35))
    _show(left, low, 0.5, "Low image")
    _show(middle, high, 0.5, "High image, twice as fine")
    true = truth.response().mtf
    right.plot(true.freq_cpp, true.value, color=INK, ls="--", label="truth")
    methods = {"kernel-fit": BLUE, "spectral-ratio": ORANGE}
    for method, color in methods.items():
        m = ac.measure_biresolution(low, high, reference_mtf=_REFERENCE, method=method)
        mtf = m.across.mtf
        right.plot(mtf.freq_cpp, mtf.value, color=color, label=method)
        right.fill_between(
            mtf.freq_cpp, mtf.value - 1.96 * mtf.std, mtf.value + 1.96 * mtf.std, color=color,
            alpha=0.25, lw=0,
        )  # fmt: skip
    right.axvline(0.5, color=FAINT, lw=0.8)
    right.text(0.51, 1.06, "Nyquist", color=FAINT, va="top")
    right.set(
        title="MTF across", xlabel="cycles per low pixel", xlim=(0, 1), ylim=(0, 1.08)
    )  # fmt: skip
    right.legend()
    return figure


def _show(axes: Axes, image: np.ndarray, share: float, title: str) -> None:
    """A corner of an image."""
    rows, cols = (int(share * size) for size in image.shape)
    axes.imshow(image[:rows, :cols], cmap="gray", interpolation="nearest")
    axes.set_title(title)
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])


def what_limits() -> Figure:
    """Ratio of moduli, ratio of cross spectra, and the coherence, for a low sensor that aliases."""
    low, high, truth = _pair("sharpened", 3.0)
    m = ac.measure_biresolution(low, high)
    spectra = m.details.spectra
    freq, coherence = spectra.along_axis("across")
    row, col = spectra.cross.shape[0] // 2, spectra.cross.shape[1] // 2
    strip = slice(row - 2, row + 3)
    cross = spectra.cross[strip, col:].sum(axis=0)
    power_low, power_high = (one[strip, col:].sum(axis=0) for one in (spectra.low, spectra.high))
    shown = (freq > 0.04) & (freq <= 0.75)
    gain = m.gain
    figure = new_page(10.4, 4.0)
    left, right = figure.subplots(1, 2)
    true = np.abs(truth.ratio_otf(freq, 0 * freq))
    left.plot(freq[shown], true[shown], color=INK, ls="--", label="truth: MTF_low / MTF_high")
    left.plot(freq[shown], np.sqrt(power_low / power_high)[shown] / gain, color=VERMILION,
              label="ratio of the spectra's moduli")  # fmt: skip
    left.plot(freq[shown], np.abs(cross / power_high)[shown] / gain, "o", ms=4, color=ORANGE,
              label="cross spectrum over power")  # fmt: skip
    left.plot(m.across.mtf.freq_cpp, m.across.mtf.value, color=BLUE, label="kernel fit")
    left.axvline(0.5, color=FAINT, lw=0.8)
    left.set(
        xlim=(0, 0.75), ylim=(0, 1.8), title="Aliasing adds to the ratio of moduli",
        xlabel="cycles per low pixel",
    )  # fmt: skip
    left.legend(loc="upper left")
    right.plot(freq, coherence, color=GREEN, label="squared coherence")
    inside = freq <= 0.75
    nyquist_high = np.abs(_REFERENCE.otf(freq / 3.0, 0 * freq))
    right.plot(freq[inside], nyquist_high[inside], color=PURPLE, label="MTF of the high sensor")
    right.axvline(0.5, color=FAINT, lw=0.8)
    right.text(0.51, 1.06, "Nyquist", color=FAINT, va="top")
    right.set(
        xlim=(0, 0.75), ylim=(0, 1.08), title="What there is to go by",
        xlabel="cycles per low pixel",
    )  # fmt: skip
    right.legend(loc="lower left")
    return figure


def products() -> Figure:
    """A pair of products: what interpolation from turned native grids leaves of both sensors."""
    native = NativeGrid()
    sensor, reference = (ac.Sensor([ac.optics.Gaussian(x), ac.optics.Detector()])
                         for x in (0.32, 0.4262))  # fmt: skip
    low, high, truth = ac.simulate.pair(
        sensor, reference, ratio=2, shape=(160, 160), snr=150, native=native,
        rng=np.random.default_rng(12),
    )  # fmt: skip
    m = ac.measure_biresolution(low, high)
    freq = np.linspace(0, 0.8, 161)
    figure = new_page(10.4, 4.0)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, name in zip(panels, ("across", "along"), strict=True):
        u, v = (freq, 0 * freq) if name == "across" else (0 * freq, freq)
        before = sensor.otf(u, v) / reference.otf(u / 2, v / 2)
        axes.plot(freq, native.otf(u, v), color=GREEN, lw=1.0, label="the interpolation alone")
        axes.plot(freq, before, color=ORANGE, label="truth before the interpolation")
        axes.plot(freq, np.abs(truth.ratio_otf(u, v)), color=INK, ls="--",
                  label="truth of the products")  # fmt: skip
        mtf = getattr(m, name).mtf
        axes.plot(mtf.freq_cpp, mtf.value, color=BLUE, label="measured, with 95 % interval")
        axes.fill_between(mtf.freq_cpp, mtf.value - 1.96 * mtf.std, mtf.value + 1.96 * mtf.std,
                          color=BLUE, alpha=0.25, lw=0)  # fmt: skip
        axes.axvline(0.5, color=FAINT, lw=0.8)
        axes.set(title=f"MTF_low / MTF_high, {name}", xlabel="cycles per low pixel",
                 xlim=(0, 0.8), ylim=(0, 1.08))  # fmt: skip
    panels[0].legend(loc="lower left")
    return figure


FIGURES = {
    "biresolution-pair": measured_pair,
    "biresolution-limits": what_limits,
    "biresolution-products": products,
}
