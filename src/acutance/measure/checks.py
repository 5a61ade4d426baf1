"""Is this target good enough to tell? One question a check, with its limit and its source.

Sources: the KOMPSAT-3 draft (Lee et al. 2014) step 3; Li et al., "On-orbit MTF estimation
methods", 3.2 and 4.2; and what simulation shows of this estimator (documentation, "Edges").
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import overload

import numpy as np

from acutance.curves.grid import Floats
from acutance.fit.band import EdgeBand, EdgeFit
from acutance.fit.noise import correlation as noise_correlation
from acutance.fit.trim import Extent
from acutance.measure.cut import Cut
from acutance.measure.measurement import Check
from acutance.measure.options import EdgeLimits

__all__ = ["EdgeChecks", "Evidence", "TargetChecks", "sample_phases"]

_FAR_WIDTHS = 2.0
_OUTLIER_SIGMAS = 4.5
_MUCH = 999.0


@dataclass(frozen=True, eq=False)
class Evidence:
    """The pixels of a fit with their places, as the checks read them.

    Distances in pixels, values and residuals as shares of the contrast. `before` and `behind` are
    the distances outwards from the target's first and last step: of an edge, its dark and its
    bright side.
    """

    rows: Floats
    cols: Floats
    before: Floats
    behind: Floats
    t: Floats
    value: Floats
    residual: Floats
    fwhm_px: float
    fit: EdgeFit

    @classmethod
    def of(cls, band: EdgeBand, fit: EdgeFit, last_px: float = 0.0) -> Evidence:
        """Evidence of a fit whose last step lies `last_px` behind its first."""
        rows, cols = np.nonzero(np.isfinite(band.image))
        fwhm = fit.response.fwhm_px.value
        return cls(
            rows.astype(float),
            cols.astype(float),
            -fit.distance_px,
            fit.distance_px - last_px,
            fit.line.tangent_distance(rows, cols),
            fit.value,
            fit.residual,
            fwhm if math.isfinite(fwhm) else 1.0,
            fit,
        )

    @cached_property
    def outside(self) -> Floats:
        """Distance from the target's nearest step outwards (negative within a pulse)."""
        return np.maximum(self.before, self.behind)

    @cached_property
    def far_px(self) -> float:
        """From here on a plateau is flat for every usual blur."""
        return max(_FAR_WIDTHS * self.fwhm_px, 2.0)

    @cached_property
    def noise(self) -> float:
        """Robust standard deviation of the residuals."""
        return 1.4826 * float(np.median(np.abs(self.residual)))

    @cached_property
    def plateau_std(self) -> float:
        """Mean standard deviation of the two plateaus."""
        sides = (self.value[side > self.far_px] for side in (self.before, self.behind))
        stds = [float(np.std(side)) for side in sides if side.size > 1]
        return sum(stds) / len(stds) if stds else 0.0

    @cached_property
    def slope(self) -> Floats:
        """How much every pixel changes when the first step moves by one pixel against s."""
        lsf = self.fit.response.lsf
        return np.interp(-self.before, lsf.distance_px, lsf.value, left=0.0, right=0.0)


class TargetChecks(Sequence[Check]):
    """Checks of a target, answered when somebody first asks."""

    @cached_property
    def answers(self) -> tuple[Check, ...]:
        """All checks."""
        raise NotImplementedError

    def __len__(self) -> int:
        return len(self.answers)

    @overload
    def __getitem__(self, index: int) -> Check: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Check, ...]: ...

    def __getitem__(self, index: int | slice) -> Check | tuple[Check, ...]:
        return self.answers[index]


@dataclass(frozen=True, eq=False)
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

    cut: Cut
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
        seen, limits = self._seen, self.limits
        return (
            contrast(seen, limits),
            uniformity(seen, limits, "dark", seen.before),
            uniformity(seen, limits, "bright", seen.behind),
            angle(self.fit, limits, self.by_rows),
            phases(seen, limits),
            enough_rows(self.extent, limits),
            straightness(seen, limits),
            plateau(limits, "dark", self.extent.dark_px),
            plateau(limits, "bright", self.extent.bright_px),
            saturation(self.cut, self.band, seen, limits),
            correlation(seen, limits),
            structure(seen, limits),
            outliers(seen, limits),
        )


def _at_least(name: str, value: float, limit: float, message: str) -> Check:
    return Check(name, value, f">= {limit:g}", bool(value >= limit), message)


def _at_most(name: str, value: float, limit: float, message: str) -> Check:
    return Check(name, value, f"<= {limit:g}", bool(value <= limit), message)


def contrast(seen: Evidence, limits: EdgeLimits) -> Check:
    std = seen.plateau_std
    value = min(1 / std, _MUCH) if std > 0 else _MUCH
    return _at_least(
        "contrast_snr", value, limits.contrast_snr,
        f"bright less dark is {value:.0f} times the plateaus' mean standard deviation "
        "(KOMPSAT-3 draft 3c asks 50; below it the intervals widen)",
    )  # fmt: skip


def uniformity(seen: Evidence, limits: EdgeLimits, side: str, outwards: Floats) -> Check:
    """Structure of one plateau: what means over 4 x 4 pixels vary beyond what noise explains."""
    there = outwards > seen.far_px
    blocks = (seen.rows[there] // 4) * 4096 + seen.cols[there] // 4
    _, block = np.unique(blocks, return_inverse=True)
    count = np.bincount(block)
    mean = np.bincount(block, seen.value[there]) / np.maximum(count, 1)
    full = count >= 8
    value = _MUCH
    if np.count_nonzero(full) >= 3:
        within = np.bincount(block, (seen.value[there] - mean[block]) ** 2)[full].sum()
        noise = within / np.maximum((count[full] - 1).sum(), 1)
        structure = float(np.var(mean[full], ddof=1)) - float(noise * np.mean(1 / count[full]))
        if structure > 0:
            value = min(1 / math.sqrt(structure), _MUCH)
    return _at_least(
        f"uniformity_{side}", value, limits.uniformity,
        f"the {side} side varies by {100 / value:.1f} % of the contrast from place to place "
        "(KOMPSAT-3 draft 3b: contrast at least 50 times the variation)",
    )  # fmt: skip


def angle(fit: EdgeFit, limits: EdgeLimits, by_rows: bool) -> Check:
    angle = fit.line.angle_deg
    limit = limits.angle_deg if by_rows else 45.0
    return _at_most(
        "angle_deg", angle, limit,
        f"the edge is inclined by {angle:.2f} degrees (KOMPSAT-3 draft 3d allows 30 to methods "
        "that work row by row; a fit along the normal allows every angle with enough phases)",
    )  # fmt: skip


def sample_phases(line_distance: Floats, reach_px: float = 2.0) -> float:
    """Number of sub-pixel phases: one over the largest gap between the samples of the profile."""
    ordered = np.sort(line_distance[np.abs(line_distance) < reach_px])
    if ordered.size < 2:
        return 0.0
    gap = float(np.max(np.diff(ordered)))
    return min(1 / gap, _MUCH) if gap > 0 else _MUCH


def phases(seen: Evidence, limits: EdgeLimits) -> Check:
    value = sample_phases(seen.before)
    return _at_least(
        "sample_phases", value, limits.sample_phases,
        f"the widest gap between samples of the profile is {1 / max(value, 1e-9):.2f} px: "
        "with fewer phases fine structure is not determined and the intervals are wider",
    )  # fmt: skip


def enough_rows(extent: Extent, limits: EdgeLimits) -> Check:
    return _at_least(
        "rows", extent.length_px, limits.rows,
        f"{extent.length_px:.0f} rows of the edge serve (KOMPSAT-3 draft 3e: more than 10 to 20)",
    )  # fmt: skip


def straightness(seen: Evidence, limits: EdgeLimits) -> Check:
    """Where every eighth of the edge lies beside the line, beyond what noise explains."""
    slope = seen.slope
    steep = np.abs(seen.before) < 1
    span = float(np.ptp(seen.t[steep])) if steep.any() else 0.0
    parts = max(3, min(12, int(span // 5)))
    first = float(seen.t.min())
    part = np.minimum(((seen.t - first) * parts / max(np.ptp(seen.t), 1e-9)).astype(int), parts - 1)
    power = np.bincount(part, slope * slope, parts)
    clipped = np.clip(seen.residual, -_OUTLIER_SIGMAS * seen.noise, _OUTLIER_SIGMAS * seen.noise)
    moved = -np.bincount(part, slope * clipped, parts)
    told = power > 0.3 * np.median(power)
    place = moved[told] / power[told]
    variance = seen.noise**2 / power[told]
    chi_square = float(np.sum(place**2 / np.maximum(variance, 1e-18)))
    excess = float(np.mean(place**2 - variance))
    # Three standard deviations of a chi-square: less is noise.
    bent = chi_square > told.sum() + 3 * math.sqrt(2 * told.sum())
    value = math.sqrt(max(excess, 0.0)) if bent else 0.0
    lost = 100 * (1 - math.exp(-2 * math.pi**2 * 0.25 * value**2))
    return _at_most(
        "straightness_px", value, limits.straightness_px,
        f"the edge leaves its line by {value:.3f} px rms, which takes {lost:.1f} % of the MTF at "
        "Nyquist (0.05 px take 1.2 %): choose a straighter part",
    )  # fmt: skip


def plateau(limits: EdgeLimits, side: str, value: float) -> Check:
    """How far one side is uniform."""
    return _at_least(
        f"plateau_{side}_px", value, limits.plateau_px,
        f"the {side} side is uniform out to {value:.1f} px from the edge (Li et al. 4.2: 7 to 10); "
        "what lies further of a halo is not seen and raises the MTF",
    )  # fmt: skip


def saturation(cut: Cut, band: EdgeBand, seen: Evidence, limits: EdgeLimits) -> Check:
    """Pixels at the detector's limit, or a side whose values are all one."""
    used = np.isfinite(band.image)
    values = cut.pixels[used]
    share = 0.0
    if cut.saturation_level is not None:
        share = float(np.mean(values >= cut.saturation_level))
    middle = float(np.median(values))
    spreads = []
    for outwards in (seen.before, seen.behind):
        side = values[outwards > seen.far_px]
        if side.size >= 20:
            end = side.max() if np.median(side) > middle else side.min()
            spreads.append(float(np.mean(side == end)))
    # One side piled up at one value while the other is noisy: clipped before it was written.
    if len(spreads) == 2 and max(spreads) > 0.3 and min(spreads) < 0.2:
        share = max(share, max(spreads))
    return _at_most(
        "saturation", share, limits.saturation,
        f"{100 * share:.1f} % of the pixels are clipped at the end of the scale: the edge's height "
        "and shape are then not what the sensor saw",
    )  # fmt: skip


def correlation(seen: Evidence, limits: EdgeLimits) -> Check:
    # On the plateaus alone: across the edge a method's own misfit would pass for correlation.
    flat = seen.outside > seen.far_px
    residual = seen.residual[flat]
    noise = 1.4826 * float(np.median(np.abs(residual))) if residual.size else 0.0
    if noise <= 1e-6:
        found, significance = 0.0, 0.0
    else:
        rows, cols = seen.rows[flat].astype(np.intp), seen.cols[flat].astype(np.intp)
        bounded = np.clip(residual / noise, -4, 4)
        measured = noise_correlation(bounded, rows, cols, seen.fit.line.normal)
        found, significance = abs(measured.strongest), measured.significance
    value = found if significance >= 4 else 0.0
    return _at_most(
        "correlated_noise", value, limits.correlated_noise,
        f"neighbouring pixels' noise correlates by {found:.2f} ({significance:.0f} standard "
        "deviations): a resampled product or textured ground; the intervals allow for it, and "
        "the MTF is the product's",
    )  # fmt: skip


def structure(seen: Evidence, limits: EdgeLimits) -> Check:
    """Bumps of the ESF where it should be flat: a line, a road, a second edge."""
    esf = seen.fit.response.esf
    reach = float(np.sort(seen.outside)[int(0.95 * seen.outside.size)])
    worst = 0.0
    for sign in (-1.0, 1.0):
        outwards = sign * esf.distance_px
        there = (outwards > 2.5 * seen.fwhm_px) & (outwards < reach)
        if np.count_nonzero(there) < 3:
            continue
        coarse = esf.value[there][::10]
        detour = float(np.abs(np.diff(coarse)).sum() - abs(coarse[-1] - coarse[0])) / 2
        noise = 2.0 * float(np.median(esf.std[there]))
        worst = max(worst, detour - noise)
    value = max(worst, 0.0)
    return _at_most(
        "structure", value, limits.structure,
        f"beside the edge the profile goes up and down by {100 * value:.1f} % of the contrast: "
        "something else lies there, and its spectrum is taken for the sensor's",
    )  # fmt: skip


def outliers(seen: Evidence, limits: EdgeLimits) -> Check:
    noise = seen.noise
    many = np.abs(seen.residual) > _OUTLIER_SIGMAS * noise if noise > 1e-6 else np.zeros(1, bool)
    value = float(np.mean(many))
    return _at_most(
        "outliers", value, limits.outliers,
        f"{100 * value:.2f} % of the pixels lie further than {_OUTLIER_SIGMAS:g} standard "
        "deviations from the fit: objects on the target, or a bad fit",
    )  # fmt: skip
