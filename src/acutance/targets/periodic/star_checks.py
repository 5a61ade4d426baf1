"""Is this star good enough to tell?"""

from __future__ import annotations

import math

import numpy as np

from acutance.targets.measurement import Check
from acutance.targets.periodic.clipped_and_outlying import QUIET_SNR, clipped_share, outlier_share
from acutance.targets.periodic.fit_star import StarSolution
from acutance.targets.periodic.star_options import StarLimits
from acutance.targets.region import RegionPixels
from acutance.targets.straight.check_data import MUCH, at_least, at_most

__all__ = ["star_checks", "third_harmonic"]


def star_checks(
    pixels: RegionPixels, solved: StarSolution, snr: float, limits: StarLimits
) -> tuple[Check, ...]:
    """All target checks of a star."""
    star, level = solved.star, solved.model
    relative = level.level_std / level.level
    coarsest = star.cycles / (2 * math.pi * solved.outer_px)
    finest = star.cycles / (2 * math.pi * solved.inner_px)
    wave = third_harmonic(solved)
    clipped = clipped_share(solved.value, pixels.saturation_level, snr)
    # Of an image without noise, what is left is the arithmetic's.
    strongest = 0.0 if snr > QUIET_SNR else abs(solved.correlation.strongest)
    outliers = outlier_share(solved.residual, solved.outlier, level.level)
    return (
        at_least(
            "contrast_snr", min(snr, MUCH), limits.contrast_snr,
            f"the spokes' contrast is {snr:.0f} times the noise: with less than 50 the MTF near "
            "Nyquist is read from few pixels that show little but noise",
        ),
        at_most(
            "level", relative, limits.level,
            f"the contrast of the spokes before the sensor is known to {relative:.1%}, which "
            "scales the whole MTF: state the levels of wide patches of the same materials (dark "
            "and bright), or use a star with fewer cycles or a larger radius",
        ),
        at_most(
            "coarsest_cpp", coarsest, limits.coarsest_cpp,
            f"the widest spokes used have {coarsest:.3f} c/px: below that the MTF is continued "
            "to 1 at zero frequency, not measured",
        ),
        at_least(
            "finest_cpp", finest, limits.finest_cpp,
            f"the finest spokes used have {finest:.2f} c/px: beyond that the MTF is continued, "
            "not measured",
        ),
        at_least(
            "sweep_deg", star.sweep_deg, limits.sweep_deg,
            f"the star holds {star.sweep_deg:.0f} degrees of directions: the other ones are told "
            "by what all sensors have in common, with wide intervals",
        ),
        at_most(
            "wave", wave, limits.wave,
            f"{wave:.1%} of the contrast is a third harmonic that the stated wave does not have: "
            "the star may be a square wave instead of a sine, or the other way round, or bright "
            "and dark spokes may not be equally wide",
        ),
        at_most(
            "saturation", clipped, limits.saturation,
            f"{clipped:.1%} of the star's pixels are clipped at an end of the scale: the spokes' "
            "contrast is then not what the sensor saw",
        ),
        at_most(
            "correlated_noise", strongest, limits.correlated_noise,
            f"residuals of neighbouring pixels are correlated by {strongest:.2f}: the image was "
            "resampled, or the target departs from a perfect star",
        ),
        at_most(
            "outliers", outliers, limits.outliers,
            f"{outliers:.1%} of the pixels do not fit the star: something lies on it, or it is "
            "damaged",
        ),
    )  # fmt: skip


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
    return math.sqrt(max(amplitude**2 - chance**2, 0.0)) / solved.model.level
