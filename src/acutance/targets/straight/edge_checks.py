"""Checks of an edge: what is found; `check_table` holds questions, limits and sources."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.geometry.line import Line
from acutance.targets.check import MAX_RATIO, Check, Limits, answer, bounded_ratio
from acutance.targets.full_pixel import full_pixel
from acutance.targets.processing_checks import PROCESSING_CHECKS, processing_checks
from acutance.targets.question import PLACES
from acutance.targets.region import RegionPixels, stated_gsd, undeclared_fill
from acutance.targets.straight.check_data import CheckData, ratio_in_words
from acutance.targets.straight.check_loops import change_along
from acutance.targets.straight.ground_checks import ground_checks, rim
from acutance.targets.straight.odd_even import odd_even
from acutance.targets.straight.pixel_checks import (
    correlated_noise,
    gradient,
    nonlinearity,
    outliers,
    quantisation,
    saturation,
)
from acutance.targets.straight.removed_noise import removed_noise
from acutance.targets.straight.step_profile import EDGE
from acutance.targets.straight.structure_checks import (
    asymmetric_lsf,
    asymmetric_wings,
    double_edge,
    edge_roughness,
    one_sided_overshoot,
    profile,
    structure,
    tolerable_px,
    uniformity,
)
from acutance.targets.straight.trim import Extent
from acutance.targets.straight.tuned import (
    CHANGE_SIGMAS,
    MAX_ANGLE_BY_ROWS_DEG,
    MIN_CONTRAST_SNR,
    MIN_TRUSTED_SNR,
)

__all__ = [
    "EDGE_CHECKS",
    "angle",
    "blur_uniformity",
    "check_edge",
    "contrast_snr",
    "edge_snr",
    "enough_rows",
    "lsf_narrow",
    "lsf_width",
    "phases",
    "plateau",
    "possible_sharpness",
    "sample_phases",
    "straightness",
]

EDGE_CHECKS = (
    "contrast_snr", "uniformity_dark", "uniformity_bright", "angle_deg", "sample_phases",
    "rows", "straightness_px", "blur_uniformity", "edge_roughness_px", "lsf_width_px",
    "lsf_narrow_px", "plateau_dark_px", "plateau_bright_px", "saturation", "undeclared_fill",
    "quantisation", "full_pixel", "stated_gsd", *PROCESSING_CHECKS, "nonlinearity", "gradient",
    "correlated_noise", "odd_even", "removed_noise", "structure", "one_sided_overshoot",
    "double_edge", "asymmetric_lsf", "asymmetric_wings", "profile", "outliers", "ground",
    "close_ground", "mirrored_ground", "rim",
)  # fmt: skip
"""Names of all checks of an edge."""

_FAINT_ADVICE = (
    "what is so faint may be no target but a pattern of the ground or of its noise; choose a "
    "target of more contrast"
)
_ROUNDING = 1e-12
"""Standard deviations of plateaus, relative to the contrast, that are arithmetic's alone."""


def check_edge(
    region: RegionPixels,
    data: CheckData,
    extent: Extent,
    limits: Limits,
    *,
    by_rows: bool,
    own_misfit: bool,
    of_scene: bool = False,
) -> tuple[Check, ...]:
    """All checks of an edge.

    Parameters
    ----------
    region : RegionPixels
    data : CheckData
    extent : Extent
        How much of the region is used.
    limits : mapping of str to float
        Limits the caller changed.
    by_rows : bool
        Whether the method works row by row, which limits the angle.
    own_misfit : bool
        Whether the method's curves do not follow the pixels.
    of_scene : bool, optional
        Whether it is one of the many edges of a scene: what has one answer for all of them is asked
        of the scene.
    """
    values = region.pixels[data.trimmed.pixels.at]
    return (
        _contrast(data, limits),
        uniformity(data, limits, "dark", data.before),
        uniformity(data, limits, "bright", data.behind),
        angle(data.fit.line, limits, by_rows=by_rows),
        phases(data, limits),
        enough_rows(extent, limits),
        straightness(data, limits),
        blur_uniformity(data, limits),
        edge_roughness(data, limits),
        lsf_width(data, limits),
        lsf_narrow(data, limits),
        plateau(limits, "dark", extent.dark_px),
        plateau(limits, "bright", extent.bright_px),
        saturation(region, values, data, limits, ("dark", "bright")),
        undeclared_fill([region.fill], limits),
        quantisation(region, values, data, limits),
        *(() if of_scene else _of_the_image(region, data, limits)),
        nonlinearity(region, data, limits, EDGE),
        gradient(data, limits),
        correlated_noise(data, limits),
        odd_even(data, limits),
        structure(data, limits),
        one_sided_overshoot(data, limits),
        double_edge(data, limits),
        asymmetric_lsf(data, limits, of_scene=of_scene),
        asymmetric_wings(data, limits),
        profile(data, limits, 0.0, own_misfit=own_misfit),
        outliers(data, limits),
        *ground_checks(data, limits, ("dark", "bright"), steps=1),
        *rim(data, limits),
    )


def _of_the_image(region: RegionPixels, data: CheckData, limits: Limits) -> tuple[Check, ...]:
    """Whether a sensor made the pixels, and of which size they are."""
    return (
        possible_sharpness(data, limits),
        stated_gsd(region.info, limits),
        *processing_checks(region, limits),
        removed_noise(data, limits),
    )


def edge_snr(data: CheckData) -> float:
    """Contrast over the mean standard deviation of the plateaus (KOMPSAT-3 draft 3c)."""
    std = data.plateau_std
    return 1 / std if std > _ROUNDING else math.inf


def _contrast(data: CheckData, limits: Limits) -> Check:
    value = bounded_ratio(1.0, data.plateau_std)
    found = (
        f"bright minus dark is {ratio_in_words(value)} times the plateaus' mean standard deviation"
    )
    return contrast_snr(value, found, limits)


def contrast_snr(value: float, found: str, limits: Limits) -> Check:
    """Whether the contrast is large enough; in much noise other things are taken for targets."""
    return answer(
        "contrast_snr", value, found, limits, default=MIN_CONTRAST_SNR, caution=MIN_TRUSTED_SNR,
        advice=_FAINT_ADVICE if value < MIN_TRUSTED_SNR else None,
    )  # fmt: skip


def angle(line: Line, limits: Limits, *, by_rows: bool) -> Check:
    """Angle between the edge and the grid."""
    angle_deg = line.angle_deg
    return answer(
        "angle_deg", angle_deg, f"the edge is inclined by {angle_deg:.2f} degrees",
        limits, default=MAX_ANGLE_BY_ROWS_DEG if by_rows else None,
    )  # fmt: skip


def sample_phases(line_distance: Floats, reach_px: float = 2.0) -> float:
    """Number of sub-pixel phases: one over the largest gap between the samples of the profile."""
    ordered = np.sort(line_distance[np.abs(line_distance) < reach_px])
    if ordered.size < 2:
        return 0.0
    return bounded_ratio(1.0, float((ordered[1:] - ordered[:-1]).max()))


def phases(data: CheckData, limits: Limits) -> Check:
    """Sub-pixel phases of the samples."""
    value = sample_phases(data.before)
    found = f"the widest gap between samples of the profile is {1 / max(value, 1e-9):.2f} px"
    return answer("sample_phases", value, found, limits)


def enough_rows(extent: Extent, limits: Limits) -> Check:
    """Length of the edge that is used."""
    found = f"{extent.length_px:.0f} px of the edge's length are used"
    return answer("rows", extent.length_px, found, limits)


def straightness(data: CheckData, limits: Limits) -> Check:
    """How far the parts of the edge lie off the line, beyond what noise explains."""
    value = _change_along(data, data.slope)
    found = (
        f"the edge leaves its line by {value:.3f} px rms, which takes "
        f"{100 * _lost_at_nyquist(value**2):.1f} % of the MTF at Nyquist"
    )
    tolerable = tolerable_px(data, "straightness_px")
    return answer("straightness_px", value, found, limits, default=tolerable)


def blur_uniformity(data: CheckData, limits: Limits) -> Check:
    """How much the blur changes along the edge, as the share of the MTF at Nyquist that it moves.

    A blur wider by a variance v has an edge spread function (ESF) that differs by v / 2 times the
    slope of the line spread function (LSF).
    """
    value = _lost_at_nyquist(2 * _change_along(data, data.bend))
    found = (
        f"from part to part of the edge its blur changes by {100 * value:.1f} % of the MTF at "
        "Nyquist"
    )
    return answer("blur_uniformity", value, found, limits)


def _lost_at_nyquist(variance_px2: float) -> float:
    """Share of the MTF at Nyquist that an additional blur takes."""
    return 1 - math.exp(-2 * math.pi**2 * NYQUIST_CPP**2 * variance_px2)


def _change_along(data: CheckData, column: Floats) -> float:
    """Amount of a column in the residuals of the parts of an edge, rms beyond their noise.

    The column has a value for every near pixel.
    """
    variance = data.noise**2 * data.smoothness
    return change_along(*data.along, column, data.bounded, data.near, variance, CHANGE_SIGMAS)


def lsf_width(data: CheckData, limits: Limits) -> Check:
    """Whether the LSF is as wide as that of any detector: an image may hold other data than light.

    A square detector alone has a full width at half maximum (FWHM) of 0.7 to 1 px; the strongest
    sharpening takes a third. That of the sensor is asked for, a stated border divided out.
    """
    value = data.fwhm_px
    found = f"the LSF is {value:.2f} px wide at half maximum"
    sensor_px = data.sensor.fwhm_px.value
    if data.behind_border is None or not sensor_px < value:
        return answer("lsf_width_px", value, found, limits)
    return answer(
        "lsf_width_px", sensor_px,
        f"{found}, and {sensor_px:.2f} px without the stated softness of the border", limits,
        advice="no detector is that narrow: the border is sharper than stated; check the softness, "
        "and the GSD",
    )  # fmt: skip


def possible_sharpness(data: CheckData, limits: Limits) -> Check:
    """Whether a sensor whose pixels touch can be that sharp, a stated border divided out."""
    with_border = None if data.behind_border is None else data.fit.response.mtf_nyquist
    return full_pixel([data.sensor.mtf_nyquist], limits, with_border=with_border)


def lsf_narrow(data: CheckData, limits: Limits) -> Check:
    """Whether the LSF is as narrow as a camera's: borders of forests and clouds are softer."""
    value = data.fwhm_px
    found = f"the LSF is {value:.2f} px wide at half maximum"
    return answer("lsf_narrow_px", value, found, limits)


def plateau(limits: Limits, side: str, value: float) -> Check:
    """How far one side is uniform."""
    found = f"the plateau {PLACES[side]} is uniform out to {min(value, MAX_RATIO):.1f} px"
    return answer(f"plateau_{side}_px", value, found, limits)
