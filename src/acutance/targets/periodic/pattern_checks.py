"""Checks that bars and stars share: how well the pattern is known, and how well it fits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.numerics.clipping import clipped_share
from acutance.numerics.noise import Correlation, outlier_share, smallest_step
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.periodic.curvature import DEPARTURE
from acutance.targets.periodic.otf_model import FittedOtf
from acutance.targets.periodic.stated_contrast import StatedContrast
from acutance.targets.periodic.tuned import QUIET_SNR
from acutance.targets.region import RegionPixels

__all__ = [
    "contrast_snr",
    "contrast_uniformity",
    "correlated_noise",
    "level",
    "nonlinearity",
    "outliers",
    "quantisation",
    "saturation",
    "stated_levels",
]

_SURE: Final = 3.0
"""Deviations by which a contrast fitted without the stated levels surely differs from theirs."""
_SURE_CURVE: Final = 4.0
"""Deviations from which a curvature is one, and a difference of contrast."""


def contrast_snr(snr: float, whose: str, limits: Limits) -> Check:
    """Whether the contrast of the pattern, as "the bars'", stands out of the noise."""
    bounded = min(snr, MAX_RATIO)
    found = f"{whose} contrast is {bounded:.0f} times the noise"
    return answer("contrast_snr", bounded, found, limits)


def level(otf: FittedOtf, contrast: str, limits: Limits) -> Check:
    """Whether the contrast before the sensor is known."""
    relative = otf.level_std / abs(otf.level)
    found = f"{contrast} before the sensor is known to {100 * relative:.1f} %"
    return answer("level", relative, found, limits)


def stated_levels(
    stated: StatedContrast, place: str, seen: float, expected: float, limits: Limits
) -> Check:
    """Whether the stated levels can be those of the image.

    Levels of another band or another unit pass for a sensor: they scale its whole MTF. But what
    lies beside the bars, or half way between the spokes, is one of them; and the contrast that the
    pattern has by itself is theirs, as well as it is known.

    Parameters
    ----------
    stated : StatedContrast
    place : str
        Where the image shows a level: "half way between the spokes".
    seen, expected : float
        The value there, and that by the stated levels.
    limits : mapping of str to float
    """
    levels, free = stated.levels, stated.free
    contrast = levels.bright - levels.dark
    apart = abs(free.value - contrast)
    sure = apart > _SURE * math.hypot(free.std, levels.std)
    value = max(abs(seen - expected), apart if sure else 0.0) / contrast
    found = (
        f"{place} the image has {seen:.5g} and the stated levels {expected:.5g}; the contrast is "
        f"{free} by the pattern and {contrast:.5g} by them"
    )
    return answer("stated_levels", value, found, limits)


def nonlinearity(region: RegionPixels, curvature: Estimate, bright: str, limits: Limits) -> Check:
    """How far values depart from a straight line of light; zero where none surely does.

    Parameters
    ----------
    region : RegionPixels
    curvature : Estimate
    bright : str
        What is bright: "spokes".
    limits : mapping of str to float
    """
    if abs(curvature.value) < _SURE_CURVE * curvature.std:
        return answer("nonlinearity", 0.0, "the image's values are proportional to light", limits)
    value = Estimate(abs(curvature.value), curvature.std) * (100 * DEPARTURE)
    lies = "above" if curvature.value > 0 else "below"
    found = (
        f"half way up the contrast the values lie {value} % of it {lies} a straight line of light, "
        f"or bright {bright} are {'wider' if curvature.value > 0 else 'narrower'} than dark ones"
    )
    return answer("nonlinearity", value.value / 100, found, limits, advice=region.curve_advice)


def contrast_uniformity(uneven: Sequence[Estimate], where: Sequence[str], limits: Limits) -> Check:
    """How far the contrast is from the same everywhere; zero where no difference is sure.

    Parameters
    ----------
    uneven : sequence of Estimate
        Differences of contrast, as shares.
    where : sequence of str
        What each of them is of: "group 2".
    limits : mapping of str to float
    """
    sure = [
        (abs(one.value), one, place)
        for one, place in zip(uneven, where, strict=True)
        if abs(one.value) > _SURE_CURVE * one.std
    ]
    if not sure:
        return answer("contrast_uniformity", 0.0, "the contrast is the same everywhere", limits)
    value, largest, place = max(sure, key=lambda one: one[0])
    found = f"the contrast of {place} differs from that of the others by {largest * 100.0} %"
    return answer("contrast_uniformity", value, found, limits)


def saturation(
    value: Floats, saturation_level: float | None, snr: float, pixels: str, limits: Limits
) -> Check:
    """Whether pixels (n,) are clipped."""
    clipped = clipped_share(value, saturation_level, noisy=snr <= QUIET_SNR)
    found = f"{100 * clipped:.1f} % of {pixels} are clipped at an end of the scale"
    return answer("saturation", clipped, found, limits)


def quantisation(value: Floats, noise: float, correlation: Correlation, limits: Limits) -> Check:
    """Noise in steps of the image's numbers.

    Rounding that noise does not smooth is the same for pixels next to each other along the bars.

    Parameters
    ----------
    value : (n,) array
        Pixels of the pattern.
    noise : float
        Standard deviation of what the fit leaves, which holds that of rounding.
    correlation : Correlation
        Of what it leaves.
    limits : mapping of str to float
    """
    step = smallest_step(value)
    steps = noise / step if step > 0 else MAX_RATIO
    if steps >= MAX_RATIO:
        found = "the image's numbers are far finer than the noise"
        return answer("quantisation", MAX_RATIO, found, limits)
    own = math.sqrt(max(steps**2 * (1 - correlation.significant) - 1 / 12, 0.0))
    found = f"the noise is {own:.2f} steps of the image's numbers"
    return answer("quantisation", own, found, limits)


def correlated_noise(correlation: Correlation, snr: float, limits: Limits, *, advice: str) -> Check:
    """Whether residuals of neighbouring pixels correlate."""
    # Of an image without noise, the residuals are the arithmetic's.
    strongest = 0.0 if snr > QUIET_SNR else correlation.significant
    found = f"residuals of neighbouring pixels correlate by {strongest:.2f}"
    return answer("correlated_noise", strongest, found, limits, advice=advice)


def outliers(residual: Floats, noise: float, otf: FittedOtf, target: str, limits: Limits) -> Check:
    """Whether residuals (n,) are those of noise."""
    share = outlier_share(residual, max(noise, abs(otf.level) / QUIET_SNR))
    return answer(
        "outliers", share, f"{100 * share:.1f} % of the pixels do not fit {target}", limits
    )
