"""Are these bars good enough to tell?"""

from __future__ import annotations

import numpy as np

from acutance.targets.measurement import Check
from acutance.targets.periodic.bars_options import BarsLimits
from acutance.targets.periodic.clipped_and_outlying import QUIET_SNR, clipped_share, outlier_share
from acutance.targets.periodic.fit_bars import BarsSolution
from acutance.targets.region import RegionPixels
from acutance.targets.straight.check_data import MUCH, at_least, at_most

__all__ = ["bars_checks"]


def bars_checks(
    pixels: RegionPixels,
    solved: BarsSolution,
    directions_deg: tuple[float, ...],
    limits: BarsLimits,
) -> tuple[Check, ...]:
    """All target checks of bars."""
    snr = abs(solved.model.level) / solved.noise if solved.noise > 0 else MUCH
    relative = solved.model.level_std / abs(solved.model.level)
    fewest = min(one.bars.count for one in solved.groups)
    freq = [one.bars.freq_cpp for one in solved.groups]
    misfits = [float(np.sqrt(np.mean(one.residual**2))) / solved.noise for one in solved.groups]
    worst = int(np.argmax(misfits))
    values = np.concatenate([one.value for one in solved.groups])
    clipped = clipped_share(values, pixels.saturation_level, snr)
    # Of an image without noise, what is left is the arithmetic's.
    strongest = 0.0 if snr > QUIET_SNR else abs(solved.correlation.strongest)
    residual = np.concatenate([one.residual for one in solved.groups])
    outliers = outlier_share(residual, solved.outlier, solved.model.level)
    named = " and ".join(f"{angle:.1f}" for angle in directions_deg)
    return (
        at_least(
            "contrast_snr", min(snr, MUCH), limits.contrast_snr,
            f"the bars' contrast is {snr:.0f} times the noise: with less than 50 the finest "
            "groups show little but noise",
        ),
        at_most(
            "level", relative, limits.level,
            f"the bars' contrast before the sensor is known to {relative:.1%}, which scales the "
            "whole MTF: state the levels of wide patches of the same materials (dark and "
            "bright), or add a group of wide bars",
        ),
        at_least(
            "bars", float(fewest), limits.bars,
            f"a group has {fewest} bars: with fewer than 3 its frequency is not one",
        ),
        at_least(
            "directions", float(len(directions_deg)), limits.directions,
            f"the bars' normals point to {named} degrees: other directions are told by what all "
            "sensors have in common, with wide intervals",
        ),
        at_most(
            "coarsest_cpp", min(freq), limits.coarsest_cpp,
            f"the widest bars have {min(freq):.3f} c/px: below that the MTF follows from the "
            "groups' outline",
        ),
        at_least(
            "finest_cpp", max(freq), limits.finest_cpp,
            f"the finest bars have {max(freq):.3f} c/px: beyond that the MTF follows from the "
            "bars' edges, which aliasing mixes up",
        ),
        at_most(
            "misfit", misfits[worst], limits.misfit,
            f"group {worst + 1} departs from its bars by {misfits[worst]:.1f} times the noise of "
            "all: it may be damaged, or have other bars than it was taken for",
        ),
        at_most(
            "saturation", clipped, limits.saturation,
            f"{clipped:.1%} of the pixels are clipped at an end of the scale: the bars' contrast "
            "is then not what the sensor saw",
        ),
        at_most(
            "correlated_noise", strongest, limits.correlated_noise,
            f"residuals of neighbouring pixels are correlated by {strongest:.2f}: the image was "
            "resampled, or the bars are not as they were taken to be (place, direction, number, "
            "period, levels)",
        ),
        at_most(
            "outliers", outliers, limits.outliers,
            f"{outliers:.1%} of the pixels do not fit the bars: something lies on them",
        ),
    )  # fmt: skip
