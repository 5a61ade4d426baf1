"""Checks that bars and stars share: how well the pattern is known, and how well it fits."""

from __future__ import annotations

from acutance.curves.grid import Floats
from acutance.numerics.clipping import clipped_share
from acutance.numerics.noise import Correlation, outlier_share
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.periodic.otf_model import FittedOtf
from acutance.targets.periodic.tuned import QUIET_SNR

__all__ = ["contrast_snr", "correlated_noise", "level", "outliers", "saturation"]


def contrast_snr(snr: float, whose: str, limits: Limits) -> Check:
    """Whether the contrast of the pattern, as "the bars'", stands out of the noise."""
    bounded = min(snr, MAX_RATIO)
    found = f"{whose} contrast is {bounded:.0f} times the noise"
    return answer("contrast_snr", bounded, found, limits)


def level(otf: FittedOtf, contrast: str, limits: Limits) -> Check:
    """Whether the contrast before the sensor is known."""
    relative = otf.level_std / abs(otf.level)
    found = f"{contrast} before the sensor is known to {relative:.1%}"
    return answer("level", relative, found, limits)


def saturation(
    value: Floats, saturation_level: float | None, snr: float, pixels: str, limits: Limits
) -> Check:
    """Whether pixels (n,) are clipped."""
    clipped = clipped_share(value, saturation_level, noisy=snr <= QUIET_SNR)
    found = f"{clipped:.1%} of {pixels} are clipped at an end of the scale"
    return answer("saturation", clipped, found, limits)


def correlated_noise(correlation: Correlation, snr: float, limits: Limits, *, advice: str) -> Check:
    """Whether residuals of neighbouring pixels correlate."""
    # Of an image without noise, the residuals are the arithmetic's.
    strongest = 0.0 if snr > QUIET_SNR else correlation.significant
    found = f"residuals of neighbouring pixels correlate by {strongest:.2f}"
    return answer("correlated_noise", strongest, found, limits, advice=advice)


def outliers(residual: Floats, noise: float, otf: FittedOtf, target: str, limits: Limits) -> Check:
    """Whether residuals (n,) are those of noise."""
    share = outlier_share(residual, max(noise, abs(otf.level) / QUIET_SNR))
    return answer("outliers", share, f"{share:.1%} of the pixels do not fit {target}", limits)
