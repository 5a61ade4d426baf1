"""Checks of groups of bars."""

from __future__ import annotations

from statistics import median

import numpy as np

from acutance.curves import Estimate
from acutance.targets.check import Check, Limits, answer
from acutance.targets.periodic.fit_bars import BarsSolution
from acutance.targets.periodic.pattern_checks import (
    contrast_snr,
    contrast_uniformity,
    correlated_noise,
    level,
    nonlinearity,
    outliers,
    quantisation,
    saturation,
    stated_levels,
)
from acutance.targets.processing_checks import PROCESSING_CHECKS, processing_checks
from acutance.targets.region import RegionPixels, stated_gsd, undeclared_fill

__all__ = ["BARS_CHECKS", "bars_checks"]

BARS_CHECKS = (
    "contrast_snr", "level", "stated_levels", "bars", "bar_directions", "coarsest_cpp",
    "finest_cpp", "misfit", "saturation", "undeclared_fill", "quantisation", "stated_gsd",
    *PROCESSING_CHECKS, "nonlinearity", "contrast_uniformity", "correlated_noise", "outliers",
)  # fmt: skip
"""The names of the checks of bars."""


def bars_checks(
    solved: BarsSolution,
    directions_deg: tuple[float, ...],
    region: RegionPixels,
    limits: Limits,
) -> tuple[Check, ...]:
    """All checks of bars.

    Parameters
    ----------
    solved : BarsSolution
    directions_deg : tuple of float
        Directions across the bars.
    region : RegionPixels
    limits : mapping of str to float
        Limits the caller changed.
    """
    pixels = np.concatenate([one.value for one in solved.groups])
    residual = np.concatenate(solved.residuals)
    return (
        contrast_snr(solved.snr, "the bars'", limits),
        level(solved.otf, "the bars' contrast", limits),
        *_stated_levels(solved, limits),
        _bars(solved, limits),
        _directions(directions_deg, limits),
        *_frequencies(solved, limits),
        _misfit(solved, limits),
        saturation(pixels, region.saturation_level, solved.snr, "the pixels", limits),
        undeclared_fill([region.fill], limits),
        quantisation(pixels, solved.noise, solved.correlation, limits),
        stated_gsd(region.info, limits),
        *processing_checks(region, limits),
        nonlinearity(region, _curvature(solved), "bars", limits),
        contrast_uniformity(solved.uneven, _names(solved), limits),
        correlated_noise(
            solved.correlation, solved.snr, limits,
            advice="the image was resampled, or the bars are not as they were taken to be (place, "
            "direction, number, period, levels)",
        ),
        outliers(residual, solved.noise, solved.otf, "the bars", limits),
    )  # fmt: skip


def _stated_levels(solved: BarsSolution, limits: Limits) -> tuple[Check, ...]:
    """Of bars whose levels are stated; beside bright ones it is dark, beside dark ones bright."""
    stated = solved.stated
    if stated is None:
        return ()
    own = stated.levels.dark if solved.otf.level > 0 else stated.levels.bright
    seen = median(solved.backgrounds)
    return (stated_levels(stated, "beside the bars", seen, own, limits),)


def _curvature(solved: BarsSolution) -> Estimate:
    """From dark to bright: of dark bars the fit has it the other way round."""
    return solved.curvature if solved.otf.level > 0 else solved.curvature * -1.0


def _names(solved: BarsSolution) -> list[str]:
    return [f"group {number}" for number in range(1, len(solved.groups) + 1)]


def _bars(solved: BarsSolution, limits: Limits) -> Check:
    fewest = min(one.bars.count for one in solved.groups)
    return answer("bars", fewest, f"the smallest group has {fewest} bars", limits)


def _directions(directions_deg: tuple[float, ...], limits: Limits) -> Check:
    named = " and ".join(f"{angle:z.1f}" for angle in directions_deg)
    found = f"the bars' normals point to {named} degrees"
    return answer("bar_directions", len(directions_deg), found, limits)


def _frequencies(solved: BarsSolution, limits: Limits) -> tuple[Check, Check]:
    freq = [one.bars.freq_cpp for one in solved.groups]
    return (
        answer("coarsest_cpp", min(freq), f"the widest bars have {min(freq):.3f} c/px", limits),
        answer("finest_cpp", max(freq), f"the finest bars have {max(freq):.3f} c/px", limits),
    )


def _misfit(solved: BarsSolution, limits: Limits) -> Check:
    misfits = [float(np.sqrt(np.mean(one**2))) / solved.noise for one in solved.residuals]
    worst = int(np.argmax(misfits))
    found = f"the residuals of group {worst + 1} are {misfits[worst]:.1f} times the noise of all"
    return answer("misfit", misfits[worst], found, limits)
