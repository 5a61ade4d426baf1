"""Checks of the pixels themselves: their range, steps, noise and outliers."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.clipping import NOT_CLIPPED, at_limit_share, piled_up_share
from acutance.numerics.noise import median, outlier_share, rounding_std, smallest_step
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.question import PLACES
from acutance.targets.region import RegionPixels
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.check_loops import far_side, rise_outwards, side_upwards
from acutance.targets.straight.nonlinearity import find_curvature, gamma_of
from acutance.targets.straight.rounding import level_step
from acutance.targets.straight.step_profile import Profile
from acutance.targets.straight.tuned import (
    APERTURE_TAIL_PX,
    GRADIENT_SIGMAS,
    MAX_FINE_STEP,
    MAX_NOISE_CORRELATION,
    MAX_OUTLIER_SHARE,
    MIN_PILED_PIXELS,
    MIN_SIDE_PIXELS,
    MISFIT,
    NONLINEAR_LOG_ODDS,
    OUTLIER_SIGMAS,
    QUIET_SIDE,
    QUIET_TRANSITION,
    ROUNDED_NOISE,
)

__all__ = [
    "correlated_noise",
    "gradient",
    "nonlinearity",
    "outliers",
    "quantisation",
    "saturation",
]


_FEW = 512
_CLOSE_SHARE = 0.5
"""Values next to the end over those at it: .7 and more of wings that end, .2 of clips."""


def saturation(
    region: RegionPixels, values: Floats, data: CheckData, limits: Limits, sides: tuple[str, str]
) -> Check:
    """Pixels at the detector's limit, or a side that piles up at its outer end.

    `values` (n,) are those of the image, `sides` the names of those before and behind the target.
    """
    share, where = _clipped_share(region, values, data), ""
    middle = float(np.add.reduce(values)) / values.size
    # The two plateaus and, of a pulse, the pulse itself.
    places = (*(PLACES[side] for side in sides), "of the pulse")
    distances = ((data.before, data.far_px), (data.behind, data.far_px), (-data.outside, 0.0))
    for (outwards, from_px), place in zip(distances, places, strict=True):
        side = side_upwards(values, middle, outwards, from_px)
        if side.size < MIN_PILED_PIXELS:
            continue
        piled = piled_up_share(side)
        if piled > share and not _quiet(data, values, side):
            share, where = piled, f" {place}"
    found = f"{100 * share:.1f} % of the pixels{where} are clipped at an end of the scale"
    return answer("saturation", share, found, limits)


def _clipped_share(region: RegionPixels, values: Floats, data: CheckData) -> float:
    """Share of the pixels at the detector's limit, or piled up where the image is clipped."""
    share = at_limit_share(values, region.saturation_level)
    if region.clipped == NOT_CLIPPED or _is_noise_free(data):
        return share
    dark, bright = region.clipped
    if bright is not None and np.max(values) >= bright:
        share = max(share, piled_up_share(values))
    if dark is not None and np.min(values) <= dark:
        share = max(share, piled_up_share(-values))
    return share


def _quiet(data: CheckData, values: Floats, side: Floats) -> bool:
    """Whether a side has no noise that clipping could cut, and the transition none either.

    Of noise finer than the steps of the numbers a side is all one value, clipped or not. Where it
    is clipped, the transition is no longer that of a sensor, and more is left of it than rounding.
    """
    contrast = abs(data.fit.bright - data.fit.dark)
    if _transition_noise(data) * contrast < ROUNDED_NOISE * rounding_std(values):
        return True
    if not _is_noise_free(data):
        return False
    return float(np.std(side)) < QUIET_SIDE * contrast or _is_approached(side, contrast)


def _is_approached(side: Floats, contrast: float) -> bool:
    """Whether values run into the largest one, as wings that end do: clipping cuts a slope off."""
    end = np.max(side)
    piled = np.count_nonzero(side == end)
    close = np.count_nonzero(side > end - MAX_FINE_STEP * contrast) - piled
    return bool(close > _CLOSE_SHARE * piled)


def _is_noise_free(data: CheckData) -> bool:
    """Whether the transition has no noise, as of a drawn image."""
    return _transition_noise(data) < QUIET_TRANSITION


def _transition_noise(data: CheckData) -> float:
    """Standard deviation of what the fit leaves within a pixel of the target, of the contrast."""
    return float(np.std(data.residual[data.outside < 1.0]))


def quantisation(region: RegionPixels, values: Floats, data: CheckData, limits: Limits) -> Check:
    """Noise in steps of the image's numbers: below one step rounding distorts the profile.

    `values` (n,) are those of the image.
    """
    contrast = abs(data.fit.bright - data.fit.dark)
    if region.image.characteristic is not None:
        return _uneven_quantisation(data, values, contrast, limits)
    # Of fine numbers a few hundred are enough to find two that differ by so little.
    step = smallest_step(values[:: max(values.size // _FEW, 1)])
    if step >= MAX_FINE_STEP * contrast:
        step = smallest_step(values)
    if step < MAX_FINE_STEP * contrast:
        found = "the image's numbers are finer than the curves resolve"
        return answer("quantisation", MAX_RATIO, found, limits)
    value = min(data.plateau_std * contrast / step, MAX_RATIO)
    found = f"the plateaus' noise is {value:.2f} steps of the image's numbers"
    return answer("quantisation", value, found, limits)


def _uneven_quantisation(data: CheckData, values: Floats, contrast: float, limits: Limits) -> Check:
    """The same of an image that was linearised: its steps differ from level to level."""
    value, found = MAX_RATIO, "the image's numbers are finer than the curves resolve"
    for place, name in zip(data.plateaus, ("before", "behind"), strict=True):
        side = values[place]
        step = level_step(values, float(np.median(side))) if side.size > 1 else 0.0
        if step < MAX_FINE_STEP * contrast:
            continue
        ratio = float(np.std(side)) / step
        if ratio < value:
            value = ratio
            found = f"the noise {PLACES[name]} is {ratio:.2f} steps of the image's numbers there"
    return answer("quantisation", value, found, limits)


def nonlinearity(
    region: RegionPixels, data: CheckData, limits: Limits, profile: Profile, sign: float = 1.0
) -> Check:
    """How far the image's values depart from a straight line of light, half way up the contrast.

    Zero where a linear sensor explains the image about as well. `sign` is -1 of a dark pulse, whose
    values are negated.
    """
    found = find_curvature(data, profile, sign)
    if found.log_odds < NONLINEAR_LOG_ODDS:
        return answer("nonlinearity", 0.0, "the image's values are proportional to light", limits)
    value, std = found.departure * abs(found.value), found.departure * found.std
    if found.shoulder > 0:
        words = (
            f"from {100 * found.shoulder:.0f} % of the contrast on the values bend towards the "
            f"bright level, as where a detector saturates softly, and leave a straight line of "
            f"light by {100 * value:.1f} ± {100 * std:.1f} % of it"
        )
        return answer("nonlinearity", value, words, limits, advice=region.curve_advice)
    curvature = sign * found.value
    levels = sorted((sign * data.fit.dark, sign * data.fit.bright))
    law = gamma_of(curvature, found.std, *levels)
    words = (
        f"half way up the contrast the values lie {100 * value:.1f} ± {100 * std:.1f} % of it "
        f"{'above' if curvature > 0 else 'below'} a straight line of light"
    )
    if law:
        words += f", as {law} gives if 0 is dark"
    return answer("nonlinearity", value, words, limits, advice=region.curve_advice)


def gradient(data: CheckData, limits: Limits) -> Check:
    """Slope of the background far from the target, beyond what an aperture's wings explain.

    Outwards the wings of an aperture fall, equally on both sides, and no steeper than a small
    aperture's: a slope of 0 to 1 in that unit. One below 0 counts as 1 plus its modulus.
    """
    near = max(data.far_px, 3 * data.fwhm_px)
    slope, std, tail = _slope_outwards(data, near)
    against = -slope / tail if slope < -GRADIENT_SIGMAS * std else 0.0
    slope, std, tail = _slope_outwards(data, 0.5 * (near + float(data.outside.max())))
    along = slope / tail if slope - tail > GRADIENT_SIGMAS * std else 0.0
    value = max(1 + against, along) if against else along
    return answer("gradient", value, _gradient_words(against, along), limits)


def _gradient_words(against: float, along: float) -> str:
    """How the background slopes, in units of the steepest fall of scattered light; 0: it does not.

    Light that an aperture scatters past the edge gets less outwards: that is one way for a slope.
    """
    if not (against or along):
        return "far from the target the ground slopes no more than light scattered by optics would"
    if along > 1 + against or not against:
        how = f", {along:.1f} times as steeply as light scattered by optics could"
    else:
        # The check's number is found in its own sentence.
        how = (
            f" the other way than light scattered by optics would, {against:.1f} times as steeply "
            f"as that could (the direction counts for 1 more)"
        )
    return f"far from the target the ground slopes{how}"


def _slope_outwards(data: CheckData, from_px: float) -> tuple[float, float, float]:
    """How fast the sides come to their levels outwards, 1/px; its std; a small aperture's."""
    covariance, power, weighed = 0.0, 0.0, 0.0
    most = OUTLIER_SIGMAS * data.noise
    for outwards in (data.before, data.behind):
        distance, value = far_side(outwards, data.value, from_px)
        if value.size < MIN_SIDE_PIXELS:
            continue
        middle = median(value)
        # A bright side rises to its level, a dark one falls to it.
        sign = 1.0 if middle > 0.5 else -1.0
        mean_px, own, rise = rise_outwards(distance, value, middle, most)
        covariance += sign * rise
        power += own
        weighed += own * APERTURE_TAIL_PX / mean_px**2
    if power <= 0:
        return 0.0, 0.0, 1.0
    noise = max(data.noise, MISFIT) * math.sqrt(data.inflation)
    return covariance / power, noise / math.sqrt(power), weighed / power


def correlated_noise(data: CheckData, limits: Limits) -> Check:
    """Correlation of the noise between neighbouring pixels."""
    noise = data.across
    found = (
        f"neighbouring pixels' noise correlates by {abs(noise.strongest):.2f} "
        f"({noise.significance:.0f} standard deviations)"
    )
    return answer(
        "correlated_noise", noise.significant, found, limits, default=MAX_NOISE_CORRELATION
    )


def outliers(data: CheckData, limits: Limits) -> Check:
    """Share of the pixels that lie far from the fit."""
    value = outlier_share(data.residual, data.noise, MISFIT)
    found = (
        f"{100 * value:.2f} % of the pixels lie further than {OUTLIER_SIGMAS:g} standard "
        "deviations from the fit"
    )
    return answer("outliers", value, found, limits, default=MAX_OUTLIER_SHARE)
