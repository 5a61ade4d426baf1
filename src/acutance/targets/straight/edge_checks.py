"""Is this target good enough to tell? One question a check, with its limit and its source.

Sources: the KOMPSAT-3 draft (Lee et al. 2014) step 3; Li et al., "On-orbit MTF estimation
methods", 3.2 and 4.2; and what simulation shows of this estimator (documentation, "Edges").
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.targets.measurement import Check
from acutance.targets.region import RegionPixels
from acutance.targets.straight import pixel_checks, structure_checks
from acutance.targets.straight.check_data import (
    MUCH,
    PLACES,
    Evidence,
    TargetChecks,
    at_least,
    at_most,
    at_most_much,
)
from acutance.targets.straight.options import EdgeLimits
from acutance.targets.straight.pixels import EdgeBand, EdgeFit
from acutance.targets.straight.trim import Extent

__all__ = ["EdgeChecks", "sample_phases"]

_OUTLIER_SIGMAS = 4.5
_CHANGED = 4.0
"""Standard deviations of a chi-square: less is noise."""
_MOST_BY_ROWS_DEG = 30.0
_MOST_DEG = 45.0


@dataclass(frozen=True, eq=False, repr=False)
class EdgeChecks(TargetChecks):
    """All target checks of an edge.

    Parameters
    ----------
    cut, band, extent, fit
        What the measurement went through.
    limits : EdgeLimits
    by_rows : bool
        Whether the method works row by row, which limits the angle.
    """

    cut: RegionPixels
    band: EdgeBand
    extent: Extent
    fit: EdgeFit
    limits: EdgeLimits
    by_rows: bool

    @cached_property
    def _seen(self) -> Evidence:
        return Evidence.of(self.band, self.fit)

    @property
    def snr(self) -> float:
        """Contrast over the mean standard deviation of the plateaus (KOMPSAT-3 draft 3c)."""
        std = self._seen.plateau_std
        return 1 / std if std > 0 else math.inf

    @cached_property
    def answers(self) -> tuple[Check, ...]:
        """All checks of an edge."""
        seen, limits = self._seen, self.limits
        return (
            contrast(seen, limits),
            structure_checks.uniformity(seen, limits, "dark", seen.before),
            structure_checks.uniformity(seen, limits, "bright", seen.behind),
            angle(self.fit, limits, self.by_rows),
            phases(seen, limits),
            enough_rows(self.extent, limits),
            straightness(seen, limits),
            steadiness(seen, limits),
            structure_checks.ragged(seen, limits),
            lsf_width(seen, limits),
            plateau(limits, "dark", self.extent.dark_px),
            plateau(limits, "bright", self.extent.bright_px),
            pixel_checks.saturation(self.cut, self.band, seen, limits),
            pixel_checks.quantisation(self.cut, self.band, seen, limits),
            pixel_checks.gradient(seen, limits),
            pixel_checks.correlation(seen, limits),
            structure_checks.structure(seen, limits),
            structure_checks.lopsided(seen, limits),
            structure_checks.profile(seen, limits, 0.0, self.by_rows),
            pixel_checks.outliers(seen, limits),
        )


def contrast(seen: Evidence, limits: EdgeLimits) -> Check:
    """Contrast over the noise of the plateaus."""
    std = seen.plateau_std
    value = min(1 / std, MUCH) if std > 0 else MUCH
    return at_least(
        "contrast_snr", value, limits.contrast_snr,
        f"bright less dark is {at_most_much(value)} times the plateaus' mean standard deviation "
        "(KOMPSAT-3 draft 3c asks 50)",
        "the intervals widen; choose an edge of more contrast, or a longer one",
    )  # fmt: skip


def angle(fit: EdgeFit, limits: EdgeLimits, by_rows: bool) -> Check:
    """Angle between the edge and the grid."""
    angle = fit.line.angle_deg
    limit = limits.angle_deg
    if limit is None:
        limit = _MOST_BY_ROWS_DEG if by_rows else _MOST_DEG
    return at_most(
        "angle_deg", angle, limit,
        f"the edge is inclined by {angle:.2f} degrees (KOMPSAT-3 draft 3d allows 30 to methods "
        "that work row by row; a fit along the normal allows every angle with enough phases)",
        "use the method spline, or another edge",
    )  # fmt: skip


def sample_phases(line_distance: Floats, reach_px: float = 2.0) -> float:
    """Number of sub-pixel phases: one over the largest gap between the samples of the profile."""
    ordered = np.sort(line_distance[np.abs(line_distance) < reach_px])
    if ordered.size < 2:
        return 0.0
    gap = float((ordered[1:] - ordered[:-1]).max())
    return min(1 / gap, MUCH) if gap > 0 else MUCH


def phases(seen: Evidence, limits: EdgeLimits) -> Check:
    """Sub-pixel phases of the samples."""
    value = sample_phases(seen.before)
    return at_least(
        "sample_phases", value, limits.sample_phases,
        f"the widest gap between samples of the profile is {1 / max(value, 1e-9):.2f} px",
        "with so few phases fine structure is not determined and the intervals are wider",
    )  # fmt: skip


def enough_rows(extent: Extent, limits: EdgeLimits) -> Check:
    """Length of the edge in rows."""
    return at_least(
        "rows", extent.length_px, limits.rows,
        f"{extent.length_px:.0f} rows of the edge serve (KOMPSAT-3 draft 3e: more than 10 to 20)",
        "the intervals are wide; choose a region with more of it",
    )  # fmt: skip


def straightness(seen: Evidence, limits: EdgeLimits) -> Check:
    """Where every part of the edge lies beside the line, beyond what noise explains."""
    value = _change_along(seen, seen.slope)
    lost = 100 * (1 - math.exp(-2 * math.pi**2 * NYQUIST_CPP**2 * value**2))
    return at_most(
        "straightness_px", value, limits.straightness_px,
        f"the edge leaves its line by {value:.3f} px rms, which takes {lost:.1f} % of the MTF at "
        "Nyquist (0.05 px take 1.2 %)",
        "choose a straighter part",
    )  # fmt: skip


def steadiness(seen: Evidence, limits: EdgeLimits) -> Check:
    """How much the blur changes along the edge, as the share of the MTF at Nyquist that it moves.

    A blur wider by a variance v has an ESF that differs by v / 2 times the slope of the LSF.
    """
    lsf = seen.fit.response.lsf
    bend = np.gradient(lsf.value, lsf.distance_px)
    column = np.interp(-seen.before, lsf.distance_px, bend, left=0.0, right=0.0)
    variance = 2 * _change_along(seen, column)
    value = 1 - math.exp(-2 * math.pi**2 * NYQUIST_CPP**2 * variance)
    return at_most(
        "steadiness", value, limits.steadiness,
        f"from part to part of the edge its blur changes by {100 * value:.1f} % of the MTF at "
        "Nyquist",
        "another edge crosses it, or it is not equally sharp everywhere; choose a shorter part",
    )  # fmt: skip


def _change_along(seen: Evidence, column: Floats) -> float:
    """How much of `column` (n,) the residuals of an edge's parts hold, rms beyond their noise."""
    steep = np.abs(seen.before) < 1
    span = float(np.ptp(seen.t[steep])) if steep.any() else 0.0
    parts = max(3, min(12, int(span // 5)))
    first = float(seen.t.min())
    part = np.minimum(((seen.t - first) * parts / max(np.ptp(seen.t), 1e-9)).astype(int), parts - 1)
    power = np.bincount(part, column * column, parts)
    clipped = np.clip(seen.residual, -_OUTLIER_SIGMAS * seen.noise, _OUTLIER_SIGMAS * seen.noise)
    share = np.bincount(part, column * clipped, parts)
    told = power > 0.3 * np.median(power)
    amount = share[told] / power[told]
    variance = seen.noise**2 * seen.smoothness / power[told]
    # What all parts have alike is the fit's, and no change.
    amount -= np.average(amount, weights=power[told])
    freedom = int(told.sum()) - 1
    chi_square = float(np.sum(amount**2 / np.maximum(variance, 1e-18)))
    if chi_square <= freedom + _CHANGED * math.sqrt(2 * freedom):
        return 0.0
    return math.sqrt(max(float(np.mean(amount**2 - variance)), 0.0))


def lsf_width(seen: Evidence, limits: EdgeLimits) -> Check:
    """Whether the LSF is as wide as that of any detector: numbers may be no picture of light.

    A square detector alone has an FWHM of 0.7 to 1 px; the strongest sharpening takes a third.
    """
    value = seen.fwhm_px
    return at_least(
        "lsf_width_px", value, limits.lsf_width_px,
        f"the LSF is {value:.2f} px wide at half its maximum",
        "no detector is that narrow: the numbers are no sampled light (wrapped around the end of "
        "their type, thresholded, or drawn)",
    )  # fmt: skip


def plateau(limits: EdgeLimits, side: str, value: float) -> Check:
    """How far one side is uniform."""
    return at_least(
        f"plateau_{side}_px", value, limits.plateau_px,
        f"the ground {PLACES[side]} is uniform out to {value:.1f} px (Li et al. 4.2: 7 to 10)",
        "what lies further of a halo is not seen and raises the MTF",
    )  # fmt: skip
