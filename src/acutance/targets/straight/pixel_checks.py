"""Checks of the pixels themselves: their range, steps, noise and outliers."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.measurement import Check
from acutance.targets.region import RegionPixels
from acutance.targets.straight.check_data import MISFIT, MUCH, Evidence, at_least, at_most
from acutance.targets.straight.options import EdgeLimits
from acutance.targets.straight.pixels import EdgeBand

__all__ = ["correlation", "gradient", "outliers", "quantisation", "saturation"]

_OUTLIER_SIGMAS = 4.5
_SIGNIFICANT = 3.5
_MIN_SIDE = 24
_MIN_PILED = 20
_TAIL_PX = 0.1
"""The LSF of an aperture falls as a / s^2: a is 0.065 px for a cutoff of 1 c/px, 0.1 for 0.65."""


def saturation(cut: RegionPixels, band: EdgeBand, seen: Evidence, limits: EdgeLimits) -> Check:
    """Pixels at the detector's limit, or a side whose values are all one."""
    used = np.isfinite(band.image)
    values = cut.pixels[used]
    share = 0.0
    if cut.saturation_level is not None:
        share = float(np.mean(values >= cut.saturation_level))
    middle = float(np.median(values))
    # The two grounds and, of a pulse, the strip.
    for there in (seen.before > seen.far_px, seen.behind > seen.far_px, seen.outside < 0):
        side = values[there]
        if side.size >= _MIN_PILED:
            share = max(share, _piled_up(side, bright=bool(np.median(side) > middle), seen=seen))
    return at_most(
        "saturation", share, limits.saturation,
        f"{100 * share:.1f} % of the pixels are clipped at the end of a scale",
        "the target's height and shape are then not what the sensor saw",
    )  # fmt: skip


def _piled_up(side: Floats, *, bright: bool, seen: Evidence) -> float:
    """Share of a side's pixels that pile up at its outer end, as clipping before writing does.

    Noise has few pixels at its end. A side without any noise has nothing to clip, unless the
    transition is noisy.
    """
    _, counts = np.unique(side if bright else -side, return_counts=True)
    end, beside = int(counts[-1]), int(counts[-2]) if counts.size > 1 else 0
    contrast = abs(seen.fit.bright - seen.fit.dark)
    quiet = float(np.std(side)) < 1e-4 * contrast
    if quiet and float(np.std(seen.residual[seen.outside < 1.0])) < 2e-3:
        return 0.0
    return end / side.size if end >= 5 and end > 2 * beside else 0.0


def quantisation(cut: RegionPixels, band: EdgeBand, seen: Evidence, limits: EdgeLimits) -> Check:
    """Noise in steps of the image's numbers: with less, rounding is no noise but a distortion."""
    values = np.unique(cut.pixels[np.isfinite(band.image)])
    step = float(np.min(np.diff(values))) if values.size > 1 else 0.0
    contrast = abs(seen.fit.bright - seen.fit.dark)
    # Steps far below what the curves resolve do no harm, whatever the noise.
    harmless = step < 1e-4 * contrast
    noise = seen.plateau_std * contrast
    value = MUCH if harmless else min(noise / step, MUCH)
    return at_least(
        "quantisation", value, limits.quantisation,
        "the image's numbers are finer than the curves resolve"
        if harmless
        else f"the plateaus' noise is {value:.2f} steps of the image's numbers",
        "so much rounding is no noise: it is alike for the pixels of a plateau and shifts its "
        "level by more than the intervals say; use data of more bits",
    )  # fmt: skip


def gradient(seen: Evidence, limits: EdgeLimits) -> Check:
    """Slope of the ground far from the target, beyond what an aperture's tail explains.

    Outwards the tail of an aperture falls, alike on both sides, and no steeper than a small
    aperture's: a slope of 0 to 1 in that unit. One below 0 counts as 1 and what it lacks.
    """
    near = max(seen.far_px, 3 * seen.fwhm_px)
    slope, std, tail = _fall(seen, near)
    value = 1 - slope / tail if slope < -_SIGNIFICANT * std else 0.0
    slope, std, tail = _fall(seen, 0.5 * (near + float(seen.outside.max())))
    if slope - tail > _SIGNIFICANT * std:
        value = max(value, slope / tail)
    return at_most(
        "gradient", value, limits.gradient,
        f"far from the target the ground slopes, {value:.1f} in units of a small aperture's tail, "
        "which falls outwards (0 to 1)",
        "the fit cannot tell a slope from a wide halo for sure; choose a region whose sides are "
        "flat",
    )  # fmt: skip


def _fall(seen: Evidence, from_px: float) -> tuple[float, float, float]:
    """How fast the sides come to their levels outwards, 1/px; its std; a small aperture's."""
    covariance, power, weighed = 0.0, 0.0, 0.0
    for outwards in (seen.before, seen.behind):
        there = outwards > from_px
        if np.count_nonzero(there) < _MIN_SIDE:
            continue
        place, value = outwards[there], seen.value[there]
        # A bright side rises to its level, a dark one falls to it.
        sign = 1.0 if float(np.median(value)) > 0.5 else -1.0
        offset = place - place.mean()
        own = float(offset @ offset)
        most = _OUTLIER_SIGMAS * seen.noise
        covariance += sign * float(offset @ np.clip(value - np.median(value), -most, most))
        power += own
        weighed += own * _TAIL_PX / float(place.mean()) ** 2
    if power <= 0:
        return 0.0, 0.0, 1.0
    return covariance / power, max(seen.noise, MISFIT) / math.sqrt(power), weighed / power


def correlation(seen: Evidence, limits: EdgeLimits) -> Check:
    """Correlation of the noise between neighbouring pixels."""
    noise = seen.correlation(seen.fit.line.normal)
    found, significance = abs(noise.strongest), noise.significance
    value = found if significance >= 4 else 0.0
    return at_most(
        "correlated_noise", value, limits.correlated_noise,
        f"neighbouring pixels' noise correlates by {found:.2f} ({significance:.0f} standard "
        "deviations)",
        "a resampled product or textured ground; the intervals allow for it, and the MTF is the "
        "product's",
    )  # fmt: skip


def outliers(seen: Evidence, limits: EdgeLimits) -> Check:
    """Share of the pixels that lie far from the fit."""
    noise = seen.noise
    many = np.abs(seen.residual) > _OUTLIER_SIGMAS * noise if noise > MISFIT else np.zeros(1, bool)
    value = float(np.mean(many))
    return at_most(
        "outliers", value, limits.outliers,
        f"{100 * value:.2f} % of the pixels lie further than {_OUTLIER_SIGMAS:g} standard "
        "deviations from the fit",
        "objects on the target, or a bad fit",
    )  # fmt: skip
