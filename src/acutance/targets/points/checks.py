"""Are these point sources good enough for a measurement?"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.numerics.noise import Correlation
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.points import tuned
from acutance.targets.points.rounding import noise_in_steps
from acutance.targets.points.sources import PointSource
from acutance.targets.points.survey import SurveyErrors
from acutance.targets.processing_checks import PROCESSING_CHECKS, processing_checks
from acutance.targets.region import RegionPixels, stated_gsd, undeclared_fill

__all__ = [
    "POINTS_CHECKS",
    "check_points",
    "check_positions",
    "check_survey",
    "check_unmatched_survey",
    "phase_gap_px",
]

POINTS_CHECKS = (
    "sources",
    "peak_snr",
    "spacing_px",
    "phase_gap_px",
    "background_uniformity",
    "background_curvature",
    "psf_width_px",
    "source_misfit",
    "equal_widths",
    "undeclared_fill",
    "stated_gsd",
    *PROCESSING_CHECKS,
    "full_scale",
    "quantisation",
    "correlated_noise",
    "outliers",
    "positions",
    "survey_px",
)
"""Names of all checks of point sources; their questions are in `acutance.targets.QUESTIONS`."""

_PHASES = 21
_MIN_ABOUT_PLANE = 5
_MIN_ABOUT_SURFACE: Final = 12
_MIN_BENT: Final = 8
"""Sources from which on the slopes of their backgrounds show whether the ground bends."""
_REACH_PX: Final = 13.0
"""How far from a source its pixels are used."""
_SURE: Final = 5.0
"""Deviations from which a bend of the ground is one."""


def check_points(
    sources: Sequence[PointSource],
    region: RegionPixels,
    limits: Limits,
    *,
    fwhm_px: Mapping[str, float],
    full_scale: float | None = None,
    correlation: Correlation | None = None,
    outliers: float | None = None,
    widths: tuple[Floats, Floats] | None = None,
) -> tuple[Check, ...]:
    """All checks of an array of point sources.

    Parameters
    ----------
    sources : sequence of PointSource
    region : RegionPixels
    limits : mapping of str to float
        Limits the caller changed.
    fwhm_px : mapping of str to float
        Full width of the point spread function at half maximum by direction, NaN where it has none.
    full_scale : float, optional
        The brightest pixel of a source over the detector's limit, where that is known.
    correlation : Correlation, optional
        Of the noise, where the method knows it.
    outliers : float, optional
        Share of outlying pixels, where the method knows it.
    widths : (k,) and (k,) arrays, optional
        Variance of every source beyond that of the PSF, as a share of it, with its deviation,
        where the method knows them.
    """
    checks = [
        answer("sources", len(sources), _counted(sources), limits),
        _peak_snr(sources, limits),
        _spacing(sources, limits),
        _phase_gap(sources, limits),
        _background_uniformity(sources, limits),
        _background_curvature(sources, limits),
        _psf_width(fwhm_px, limits),
        _source_misfit(sources, correlation, limits),
        undeclared_fill([region.fill], limits),
        stated_gsd(region.info, limits),
        *processing_checks(region, limits),
        _quantisation(sources, region, limits),
    ]
    if widths is not None:
        checks.append(_equal_widths(sources, *widths, limits))
    if full_scale is not None:
        found = f"the brightest pixel is at {100 * full_scale:.0f} % of the detector's range"
        checks.append(answer("full_scale", full_scale, found, limits))
    if correlation is not None:
        found = f"the noise of neighbouring pixels is correlated by {correlation.strongest:+.2f}"
        checks.append(answer("correlated_noise", correlation.significant, found, limits))
    if outliers is not None:
        found = f"{100 * outliers:.1f} % of the pixels lie far from the fit"
        checks.append(answer("outliers", outliers, found, limits))
    return tuple(checks)


def check_positions(missing: int, given: int, limits: Limits) -> Check:
    """Whether the given positions are those of sources."""
    found = f"at {missing} of the {given} positions that were given there is no source"
    return answer("positions", 1 - missing / given, found, limits)


def check_survey(survey: SurveyErrors, limits: Limits) -> Check:
    """Whether the measured places agree with the surveyed ones."""
    across, along = survey.rmse_px
    found = (
        f"surveyed and measured places differ by {across:.3f} px across and {along:.3f} px along "
        "rms"
    )
    if survey.rmse_cm is not None:
        found += f", {survey.rmse_cm[0]:.2f} and {survey.rmse_cm[1]:.2f} cm"
    found += ", after a common shift of {:.2f} and {:.2f} px".format(*survey.shift_px)
    if survey.rival_px is not None:
        found += "; one of {:.2f} and {:.2f} px matches as well".format(*survey.rival_px)
    return answer("survey_px", max(across, along), found, limits)


def check_unmatched_survey(why: str, limits: Limits) -> Check:
    """The same where the surveyed places are not those of the sources."""
    return answer("survey_px", MAX_RATIO, why, limits, advice="")


def phase_gap_px(phases: Floats) -> float:
    """Largest distance of any sub-pixel phase from the nearest of some phases, (n, 2)."""
    steps = (np.arange(_PHASES) + 0.5) / _PHASES
    rows, cols = np.meshgrid(steps, steps)
    tree = cKDTree(np.mod(phases, 1.0), boxsize=1.0)
    return float(tree.query(np.stack([rows.ravel(), cols.ravel()], axis=1))[0].max())


def _counted(sources: Sequence[PointSource]) -> str:
    return "1 source was measured" if len(sources) == 1 else f"{len(sources)} sources were measured"


def _psf_width(fwhm_px: Mapping[str, float], limits: Limits) -> Check:
    widths = {
        name: MAX_RATIO if math.isnan(own) else min(own, MAX_RATIO) for name, own in fwhm_px.items()
    }
    widest = max(widths, key=widths.__getitem__)
    value = widths[widest]
    if value == MAX_RATIO:
        found = f"{widest} track the PSF does not fall to half its height: it has no width"
    else:
        found = f"{widest} track the PSF is {value:.2f} px wide at half maximum"
    return answer("psf_width_px", value, found, limits)


def _peak_snr(sources: Sequence[PointSource], limits: Limits) -> Check:
    snr = min(float(np.median([one.snr for one in sources])), MAX_RATIO)
    found = f"the median source's peak is {snr:.0f} times the background's noise"
    return answer("peak_snr", snr, found, limits)


def _spacing(sources: Sequence[PointSource], limits: Limits) -> Check:
    if len(sources) == 1:
        return answer("spacing_px", MAX_RATIO, "there is one source alone", limits)
    nearest = min(float(cKDTree(_places(sources)).query(_places(sources), 2)[0].max(1).min()),
                  MAX_RATIO)  # fmt: skip
    found = f"the two nearest sources are {nearest:.1f} px apart"
    return answer("spacing_px", nearest, found, limits)


def _phase_gap(sources: Sequence[PointSource], limits: Limits) -> Check:
    gap = phase_gap_px(np.array([one.phase for one in sources]))
    found = f"the sub-pixel phases leave a gap of {gap:.2f} px"
    return answer("phase_gap_px", gap, found, limits)


def _background_uniformity(sources: Sequence[PointSource], limits: Limits) -> Check:
    """Scatter of the backgrounds about a plane, or about their mean if they are few."""
    levels = np.array([one.background.value for one in sources])
    columns = np.ones((len(sources), 1))
    if len(sources) >= _MIN_ABOUT_PLANE:
        columns = np.hstack([columns, _places(sources)])
    levels = levels - columns @ np.linalg.lstsq(columns, levels, rcond=None)[0]
    peak = float(np.median([one.peak for one in sources]))
    scatter = float(np.sqrt(np.mean(levels**2))) / peak
    found = f"the backgrounds of the sources differ by {100 * scatter:.1f} % of the median peak"
    return answer("background_uniformity", scatter, found, limits)


def _background_curvature(sources: Sequence[PointSource], limits: Limits) -> Check:
    """How far the ground bends off its slope where stamps end; zero where it surely does not.

    The slopes of the backgrounds show it: under a single source a bent ground and a wing are one.
    """
    peak = float(np.median([one.peak for one in sources]))
    slopes = np.array([one.slope for one in sources])
    found = [
        abs(bend.value) * 0.5 * _REACH_PX**2 / peak
        for bend in (_rise(_places(sources), slopes[:, axis], axis) for axis in (0, 1))
        if abs(bend.value) > _SURE * bend.std
    ]
    sag = max(found, default=0.0)
    text = (
        f"{_REACH_PX:g} px from a source the ground bends by {100 * sag:.2f} % of the median peak"
    )
    return answer("background_curvature", sag, text, limits)


def _rise(places: Floats, slope: Floats, axis: int) -> Estimate:
    """How much the slope along an axis rises per pixel along it."""
    count = slope.size
    columns = np.hstack([np.ones((count, 1)), places - places.mean(axis=0)])
    if count < _MIN_BENT or np.linalg.matrix_rank(columns) < columns.shape[1]:
        return Estimate(0.0, math.inf)
    inverse = np.linalg.inv(columns.T @ columns)
    fit = inverse @ (columns.T @ slope)
    scatter = float(np.sum((slope - columns @ fit) ** 2)) / (count - columns.shape[1])
    return Estimate(float(fit[1 + axis]), math.sqrt(scatter * inverse[1 + axis, 1 + axis]))


def _source_misfit(
    sources: Sequence[PointSource], correlation: Correlation | None, limits: Limits
) -> Check:
    """How large the residuals of the worst source are; of correlated pixels they scatter more."""
    worst = max(sources, key=lambda one: one.misfit)
    misfit = min(worst.misfit, MAX_RATIO)
    found = (
        f"the residuals of the source at row {worst.row.value:.1f}, column {worst.col.value:.1f} "
        f"are {misfit:.1f} times the noise"
    )
    if correlation is not None and correlation.by_lag and misfit > 1:
        misfit = 1 + (misfit - 1) / math.sqrt(correlation.pixels_as_one)
        found += f", which counts as {misfit:.1f} in noise that neighbours share"
    return answer("source_misfit", misfit, found, limits)


def _equal_widths(
    sources: Sequence[PointSource], excess: Floats, std: Floats, limits: Limits
) -> Check:
    """Whether the sources differ in width by more than their noise: chi-square, in deviations.

    A mirror of a whole pixel widens its image by less than its residuals show, pixel by pixel. A
    PSF that changes slowly over the field is no difference of the sources.
    """
    weight = 1 / np.sqrt(std**2 + tuned.EXTENT_TOLERANCE**2)
    columns = _slow_changes(sources) * weight[:, None]
    away = excess * weight
    away = away - columns @ np.linalg.lstsq(columns, away, rcond=None)[0]
    freedom = max(away.size - columns.shape[1], 1)
    beyond = (float(away @ away) - freedom) / math.sqrt(2 * freedom)
    value = min(max(beyond, 0.0), MAX_RATIO)
    found = f"the widths of the sources differ by {value:.1f} deviations more than by noise"
    return answer("equal_widths", value, found, limits)


def _slow_changes(sources: Sequence[PointSource]) -> Floats:
    """Columns of a surface of second order through the field; of few sources their mean."""
    ones = np.ones((len(sources), 1))
    if len(sources) < _MIN_ABOUT_SURFACE:
        return ones
    y, x = (_places(sources) - _places(sources).mean(axis=0)).T
    return np.hstack([ones, np.stack([x, y, x * x, x * y, y * y], axis=1)])


def _quantisation(sources: Sequence[PointSource], region: RegionPixels, limits: Limits) -> Check:
    origin = region.box.row, region.box.col
    steps = min(noise_in_steps(region.pixels, _places(sources) - origin), MAX_RATIO)
    found = (
        "the noise is more than a step of the image's numbers"
        if steps == MAX_RATIO
        else f"the background's noise is {steps:.2f} steps of the image's numbers"
    )
    return answer("quantisation", steps, found, limits)


def _places(sources: Sequence[PointSource]) -> Floats:
    return np.array([(one.row.value, one.col.value) for one in sources])
