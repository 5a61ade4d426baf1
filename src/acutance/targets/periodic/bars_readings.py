"""The plain readings of a group of bars: modulation, contrast transfer, and Coltman's series."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.bar_group import Bars

__all__ = ["GroupReading", "central", "coltman_mtf", "read_group"]

_HIGHEST_CPP = 1.0
_MAX_CONDITION = 30.0


@dataclass(frozen=True)
class GroupReading:
    """The plain reading of a group: sinusoids at its frequency, by least squares.

    Attributes
    ----------
    modulation, modulation_std : float
        Amplitude of the sinusoid over that of square bars (2 / pi of the contrast): the MTF as
        far as a finite group shows one frequency, and its standard deviation by noise alone.
    ctf, ctf_std : float
        Contrast of the bars midway on bars and gaps over that of wide bars; NaN where sampling
        hides a harmonic of it.
    """

    modulation: float
    modulation_std: float
    ctf: float
    ctf_std: float


def read_group(
    bars: Bars, across_px: Floats, value: Floats, contrast: float, noise: float
) -> GroupReading:
    """Fit the fundamental of a group, and the harmonics that sampling separates from it.

    Parameters
    ----------
    bars : Bars
    across_px, value : (n,) arrays
        Pixels between the middle of the first bar and that of the last one.
    contrast : float
        Bright minus dark, before the sensor.
    noise : float
        Standard deviation of the noise.
    """
    middle = 0.0 if bars.count % 2 else 0.5 * bars.period_px
    phase = 2 * math.pi * bars.freq_cpp * (across_px - middle)
    design, is_whole = _harmonics(bars, phase)
    inverse = np.linalg.pinv(design.T @ design, rcond=1e-8)
    fit = inverse @ (design.T @ value)
    covariance = noise**2 * inverse
    first = 2 / math.pi * contrast
    modulation, modulation_std = fit[1] / first, math.sqrt(covariance[1, 1]) / abs(first)
    # Midway on a bar and midway on a gap all odd harmonics count in full, with opposite signs.
    both = np.zeros(fit.size)
    both[1::2] = 2.0
    ctf, ctf_std = float(both @ fit), math.sqrt(float(both @ covariance @ both))
    if not is_whole:
        ctf = ctf_std = math.nan
    return GroupReading(
        float(modulation), float(modulation_std), ctf / contrast, ctf_std / abs(contrast)
    )


def _harmonics(bars: Bars, phase: Floats) -> tuple[Floats, bool]:
    """Constant, fundamental, and the odd harmonics that sampling separates from those before.

    Then whether these are all that a sensor may pass.
    """
    is_whole = True
    design = np.stack([np.ones(phase.size), np.cos(phase), np.sin(phase)], axis=1)
    for number in (3, 5):
        if number * bars.freq_cpp > _HIGHEST_CPP:
            break
        turn = number * phase
        wider = np.column_stack([design, np.cos(turn), np.sin(turn)])
        if np.linalg.cond(wider.T @ wider) < _MAX_CONDITION:
            design = wider
        else:
            is_whole = False
    return design, is_whole


def coltman_mtf(freq_cpp: Floats, ctf: Floats) -> Floats:
    """MTF from the contrast of square bars at some frequencies, ascending.

    ``M(f) = pi/4 [C(f) + C(3f)/3 - C(5f)/5 + C(7f)/7 + C(11f)/11 - C(13f)/13 ...]`` (Coltman,
    JOSA 44, 468, 1954). Between the frequencies C is interpolated; beyond the last it goes on
    along the line of the last two, down to 0. Where C is not known (NaN) there is no MTF.
    """
    known = np.isfinite(ctf)
    if not known.all():
        found = np.full(ctf.shape, np.nan)
        if known.any():
            found[known] = coltman_mtf(freq_cpp[known], ctf[known])
        return found
    if freq_cpp.size > 1:
        slope = (ctf[-2] - ctf[-1]) / (freq_cpp[-1] - freq_cpp[-2])
        if slope > 0 and ctf[-1] > 0:
            freq_cpp, ctf = np.append(freq_cpp, freq_cpp[-1] + ctf[-1] / slope), np.append(ctf, 0.0)
            return _series(freq_cpp, ctf)[:-1]
    return _series(freq_cpp, ctf)


def _series(freq_cpp: Floats, ctf: Floats) -> Floats:
    signs: dict[int, float] = {1: 1, 3: 1, 5: -1, 7: 1, 11: 1, 13: -1, 15: -1, 17: -1, 19: 1}
    total = np.zeros(freq_cpp.size)
    for harmonic, sign in signs.items():
        wanted = harmonic * freq_cpp
        found = np.interp(wanted, freq_cpp, ctf, right=0.0)
        total += sign / harmonic * found
    return np.asarray(math.pi / 4 * total)


def central(bars: Bars, across_px: Floats) -> NDArray[np.bool_]:
    """Places between the middle of the first bar and that of the last one."""
    return np.asarray(np.abs(across_px) <= 0.5 * (bars.count - 1) * bars.period_px)
