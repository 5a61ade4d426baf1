"""Are these point sources good enough to tell?

Sources: Helder et al., the QuickBird report of 2003, 5.7.2 and 6; Li et al., "On-orbit MTF
estimation methods", 2.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from acutance.curves.grid import Floats
from acutance.numerics.noise import Correlation
from acutance.targets.measurement import Check
from acutance.targets.points.options import PointsLimits
from acutance.targets.points.sources import PointSource
from acutance.targets.points.survey import SurveyErrors
from acutance.targets.straight.check_data import MUCH, at_least, at_most

__all__ = ["check_points", "check_survey", "phase_gap_px"]

_PHASES = 21


def check_points(
    sources: Sequence[PointSource],
    limits: PointsLimits,
    *,
    saturation: float | None,
    correlation: Correlation | None = None,
    outlier_share: float | None = None,
) -> tuple[Check, ...]:
    """All checks of an array of point sources.

    Parameters
    ----------
    sources : sequence of PointSource
    limits : PointsLimits
    saturation : float or None
        The detector's limit.
    correlation : Correlation, optional
        Of the noise, where the method knows it.
    outlier_share : float, optional
        Share of outlying pixels, where the method knows it.
    """
    checks = [
        _count(sources, limits),
        _snr(sources, limits),
        _spacing(sources, limits),
        _phases(sources, limits),
        _ground(sources, limits),
        _misfit(sources, limits),
    ]
    if saturation is not None:
        checks.append(_full_scale(sources, limits, saturation))
    if correlation is not None:
        checks.append(
            at_most(
                "correlated_noise",
                abs(correlation.strongest),
                limits.correlated_noise,
                f"the noise of neighbouring pixels is correlated by {correlation.strongest:+.2f}: "
                "the image was resampled, or the fit leaves structure; the intervals allow for it",
            )
        )
    if outlier_share is not None:
        checks.append(
            at_most(
                "outliers",
                outlier_share,
                limits.outliers,
                f"{100 * outlier_share:.1f} % of the pixels lie far from the fit and lost weight",
            )
        )
    return tuple(checks)


def check_survey(survey: SurveyErrors, limits: PointsLimits) -> Check:
    """Whether the measured places agree with the surveyed ones."""
    across, along = survey.rmse_px
    worst = max(across, along)
    centimetres = survey.rmse_cm
    words = "" if centimetres is None else f", {centimetres[0]:.2f} and {centimetres[1]:.2f} cm"
    return at_most(
        "survey_px", worst, limits.survey_px,
        f"surveyed and measured places differ by {across:.3f} px across and {along:.3f} px along "
        f"rms{words} (0.017 to 0.047 px in the field: QuickBird report, 5.7.3)",
    )  # fmt: skip


def phase_gap_px(phases: Floats) -> float:
    """Largest distance of any sub-pixel phase from the nearest of some phases (n, 2)."""
    steps = (np.arange(_PHASES) + 0.5) / _PHASES
    rows, cols = np.meshgrid(steps, steps)
    tree = cKDTree(np.mod(phases, 1.0), boxsize=1.0)
    return float(tree.query(np.stack([rows.ravel(), cols.ravel()], axis=1))[0].max())


def _count(sources: Sequence[PointSource], limits: PointsLimits) -> Check:
    return at_least(
        "sources", float(len(sources)), limits.sources,
        f"{len(sources)} sources were measured; 15 to 20 give a reasonable result "
        "(Li et al. 2.2)",
    )  # fmt: skip


def _snr(sources: Sequence[PointSource], limits: PointsLimits) -> Check:
    snr = min(float(np.median([one.snr for one in sources])), MUCH)
    return at_least(
        "peak_snr", snr, limits.peak_snr,
        f"the median source's peak is {snr:.0f} times the background's noise "
        "(QuickBird report, 3.6)",
    )  # fmt: skip


def _spacing(sources: Sequence[PointSource], limits: PointsLimits) -> Check:
    places = np.array([(one.row.value, one.col.value) for one in sources])
    away = cKDTree(places).query(places, 2)[0][:, 1] if len(sources) > 1 else np.array([math.inf])
    nearest = min(float(away.min()), MUCH)
    return at_least(
        "spacing_px", nearest, limits.spacing_px,
        f"the two nearest sources are {nearest:.1f} px apart "
        "(QuickBird report, 5.7.2; Li et al. 2.2: at least 5)",
    )  # fmt: skip


def _phases(sources: Sequence[PointSource], limits: PointsLimits) -> Check:
    gap = phase_gap_px(np.array([one.phase for one in sources]))
    return at_most(
        "phase_gap_px", gap, limits.phase_gap_px,
        f"the sub-pixel phases leave a gap of {gap:.2f} px; steps of 0.2 by 0.25 px leave 0.16 "
        "(QuickBird report, 5.7.2)",
    )  # fmt: skip


def _ground(sources: Sequence[PointSource], limits: PointsLimits) -> Check:
    """Spread of the backgrounds about a plane."""
    levels = np.array([one.background.value for one in sources])
    places = np.array([(1.0, one.row.value, one.col.value) for one in sources])
    if len(sources) > 4:
        levels = levels - places @ np.linalg.lstsq(places, levels, rcond=None)[0]
    else:
        levels = levels - levels.mean()
    peak = float(np.median([one.peak for one in sources]))
    value = float(np.sqrt(np.mean(levels**2))) / peak
    return at_most(
        "ground", value, limits.ground,
        f"the backgrounds of the sources differ by {100 * value:.1f} % of the median peak "
        "(QuickBird report, 4.4: a uniform grassy area)",
    )  # fmt: skip


def _misfit(sources: Sequence[PointSource], limits: PointsLimits) -> Check:
    worst = max(sources, key=lambda one: one.misfit)
    value = min(worst.misfit, MUCH)
    return at_most(
        "source_misfit", value, limits.source_misfit,
        f"the residuals of the source at row {worst.row.value:.1f}, column {worst.col.value:.1f} "
        f"are {value:.1f} times the noise: it is no point, or the PSF differs over the region",
    )  # fmt: skip


def _full_scale(sources: Sequence[PointSource], limits: PointsLimits, saturation: float) -> Check:
    value = max(float(np.nanmax(one.pixels)) for one in sources) / saturation
    return at_most(
        "full_scale", value, limits.full_scale,
        f"the brightest pixel is at {100 * value:.0f} % of the detector's range; about 75 % is "
        "best (Li et al. 2.2)",
    )  # fmt: skip
