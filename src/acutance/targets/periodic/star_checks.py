"""Checks of a star."""

from __future__ import annotations

import math

import numpy as np

from acutance.targets.check import Check, Limits, answer
from acutance.targets.periodic.fit_star import StarSolution
from acutance.targets.periodic.pattern_checks import (
    contrast_snr,
    contrast_uniformity,
    correlated_noise,
    level,
    nonlinearity,
    outliers,
    saturation,
    stated_levels,
)
from acutance.targets.processing_checks import PROCESSING_CHECKS, processing_checks
from acutance.targets.region import RegionPixels, stated_gsd, undeclared_fill

__all__ = ["STAR_CHECKS", "star_checks", "third_harmonic"]

STAR_CHECKS = (
    "contrast_snr", "level", "stated_levels", "rim_cpp", "centre_cpp", "sweep_deg", "wave",
    "saturation", "undeclared_fill", "stated_gsd", *PROCESSING_CHECKS,
    "nonlinearity", "contrast_uniformity", "correlated_noise", "outliers",
)  # fmt: skip
"""The names of the checks of a star."""


def star_checks(
    solved: StarSolution, snr: float, region: RegionPixels, limits: Limits
) -> tuple[Check, ...]:
    """All checks of a star.

    Parameters
    ----------
    solved : StarSolution
    snr : float
        Contrast of the spokes over noise.
    region : RegionPixels
    limits : mapping of str to float
        Limits the caller changed.
    """
    return (
        contrast_snr(snr, "the spokes'", limits),
        level(solved.otf, "the contrast of the spokes", limits),
        *_stated_levels(solved, limits),
        *_frequencies(solved, limits),
        _sweep(solved, limits),
        _wave(solved, limits),
        saturation(solved.value, region.saturation_level, snr, "the star's pixels", limits),
        undeclared_fill([region.fill], limits),
        stated_gsd(region.info, limits),
        *processing_checks(region, limits),
        nonlinearity(region, solved.curvature, "spokes", limits),
        contrast_uniformity([solved.uneven], ["one side"], limits),
        correlated_noise(
            solved.correlation, snr, limits,
            advice="the image was resampled, or the spokes are not those of a perfect star",
        ),
        outliers(solved.residual, solved.noise, solved.otf, "the star", limits),
    )  # fmt: skip


def _stated_levels(solved: StarSolution, limits: Limits) -> tuple[Check, ...]:
    """Of a star whose levels are stated; dark and bright spokes are equally wide."""
    stated = solved.stated
    if stated is None:
        return ()
    half = 0.5 * (stated.levels.dark + stated.levels.bright)
    place = "half way between the spokes"
    return (stated_levels(stated, place, solved.middle, half, limits),)


def _frequencies(solved: StarSolution, limits: Limits) -> tuple[Check, Check]:
    rim, centre = solved.reach_cpp
    return (
        answer("rim_cpp", rim, f"the widest spokes used have {rim:.3f} c/px", limits),
        answer("centre_cpp", centre, f"the finest spokes used have {centre:.2f} c/px", limits),
    )


def _sweep(solved: StarSolution, limits: Limits) -> Check:
    sweep = solved.star.sweep_deg
    return answer("sweep_deg", sweep, f"the star holds {sweep:.0f} degrees of directions", limits)


def _wave(solved: StarSolution, limits: Limits) -> Check:
    share = third_harmonic(solved)
    found = (
        f"{100 * share:.1f} % of the contrast is a third harmonic that the stated wave does not "
        "have"
    )
    return answer("wave", share, found, limits)


def third_harmonic(solved: StarSolution) -> float:
    """Third harmonic left in the outer half of the star, as a share of the level.

    Below what noise makes of it three times out of four, it is zero.
    """
    star = solved.star
    radius, angle = star.polar(solved.rows.astype(float), solved.cols.astype(float))
    outer = radius > 0.5 * (solved.inner_px + solved.outer_px)
    phase = 3 * (star.cycles * angle[outer] + star.alpha_rad)
    design = np.stack([np.cos(phase), np.sin(phase)], axis=1)
    fit, *_ = np.linalg.lstsq(design, solved.residual[outer], rcond=None)
    amplitude = float(np.hypot(*fit))
    chance = 1.7 * solved.noise * math.sqrt(2 / phase.size)
    return math.sqrt(max(amplitude**2 - chance**2, 0.0)) / solved.otf.level
