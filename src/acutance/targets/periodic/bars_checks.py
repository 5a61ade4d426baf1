"""Checks of groups of bars."""

from __future__ import annotations

import numpy as np

from acutance.numerics.clipping import clipped_share
from acutance.numerics.noise import outlier_share
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.periodic.fit_bars import BarsSolution
from acutance.targets.periodic.tuned import QUIET_SNR

__all__ = ["BARS_CHECKS", "bars_checks"]

BARS_CHECKS = (
    "contrast_snr", "level", "bars", "bar_directions", "coarsest_cpp", "finest_cpp", "misfit",
    "saturation", "correlated_noise", "outliers",
)  # fmt: skip
"""The names of the checks of bars."""


def bars_checks(
    solved: BarsSolution,
    directions_deg: tuple[float, ...],
    saturation_level: float | None,
    limits: Limits,
) -> tuple[Check, ...]:
    """All checks of bars.

    Parameters
    ----------
    solved : BarsSolution
    directions_deg : tuple of float
        Directions across the bars.
    saturation_level : float or None
        The largest value the detector can give.
    limits : mapping of str to float
        Limits the caller changed.
    """
    snr = min(solved.snr, MAX_RATIO)
    contrast = abs(solved.otf.level)
    return (
        answer("contrast_snr", snr, f"the bars' contrast is {snr:.0f} times the noise", limits),
        _level(solved, limits),
        _bars(solved, limits),
        _directions(directions_deg, limits),
        *_frequencies(solved, limits),
        _misfit(solved, limits),
        _saturation(solved, saturation_level, limits),
        _correlated_noise(solved, limits),
        _outliers(solved, contrast, limits),
    )


def _level(solved: BarsSolution, limits: Limits) -> Check:
    relative = solved.otf.level_std / abs(solved.otf.level)
    found = f"the bars' contrast before the sensor is known to {relative:.1%}"
    return answer("level", relative, found, limits)


def _bars(solved: BarsSolution, limits: Limits) -> Check:
    fewest = min(one.bars.count for one in solved.groups)
    return answer("bars", fewest, f"the smallest group has {fewest} bars", limits)


def _directions(directions_deg: tuple[float, ...], limits: Limits) -> Check:
    named = " and ".join(f"{angle:.1f}" for angle in directions_deg)
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


def _saturation(solved: BarsSolution, saturation_level: float | None, limits: Limits) -> Check:
    values = np.concatenate([one.value for one in solved.groups])
    clipped = clipped_share(values, saturation_level, noisy=solved.snr <= QUIET_SNR)
    found = f"{clipped:.1%} of the pixels are clipped at an end of the scale"
    return answer("saturation", clipped, found, limits)


def _correlated_noise(solved: BarsSolution, limits: Limits) -> Check:
    # Of an image without noise, the residuals are the arithmetic's.
    strongest = 0.0 if solved.snr > QUIET_SNR else solved.correlation.significant
    return answer(
        "correlated_noise", strongest,
        f"residuals of neighbouring pixels correlate by {strongest:.2f}", limits,
        advice="the image was resampled, or the bars are not as they were taken to be (place, "
        "direction, number, period, levels)",
    )  # fmt: skip


def _outliers(solved: BarsSolution, contrast: float, limits: Limits) -> Check:
    noise = max(solved.noise, contrast / QUIET_SNR)
    share = outlier_share(np.concatenate(solved.residuals), noise)
    return answer("outliers", share, f"{share:.1%} of the pixels do not fit the bars", limits)
