"""Checks of a pulse: those of an edge, and of its sides, background and width."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.targets.check import MAX_RATIO, Check, Limits, answer, limit_of
from acutance.targets.processing_checks import PROCESSING_CHECKS, processing_checks
from acutance.targets.region import RegionPixels, stated_gsd, undeclared_fill
from acutance.targets.straight.check_data import CheckData, ratio_in_words
from acutance.targets.straight.edge_checks import (
    angle,
    contrast_snr,
    enough_rows,
    lsf_width,
    phases,
    plateau,
    possible_sharpness,
    straightness,
)
from acutance.targets.straight.fit_pulse import PulsePixels
from acutance.targets.straight.ground_checks import ground_checks
from acutance.targets.straight.odd_even import odd_even
from acutance.targets.straight.pixel_checks import (
    correlated_noise,
    gradient,
    nonlinearity,
    outliers,
    quantisation,
    saturation,
)
from acutance.targets.straight.published import PublishedPulse
from acutance.targets.straight.pulse_spectrum import zeros_cpp
from acutance.targets.straight.removed_noise import removed_noise
from acutance.targets.straight.step_profile import pulse_profile
from acutance.targets.straight.structure_checks import (
    asymmetric_lsf,
    edge_roughness,
    profile,
    target_uniformity,
    uniformity,
)
from acutance.targets.straight.trim import Extent
from acutance.targets.straight.tuned import STRUCTURE_SIGMAS

__all__ = ["PULSE_CHECKS", "check_pulse", "pulse_snr", "width_check"]

PULSE_CHECKS = (
    "contrast_snr", "uniformity_before", "uniformity_behind", "uniformity_target", "angle_deg",
    "sample_phases", "rows", "straightness_px", "edge_roughness_px", "lsf_width_px",
    "plateau_before_px", "plateau_behind_px", "saturation", "undeclared_fill", "quantisation",
    "full_pixel", "stated_gsd", *PROCESSING_CHECKS, "nonlinearity", "gradient",
    "correlated_noise", "odd_even", "removed_noise", "asymmetric_lsf", "profile", "outliers",
    "parallel_deg", "background_step", "width_px", "width_sigmas", "zero_distance_cpp", "ground",
    "close_ground", "mirrored_ground",
)  # fmt: skip
"""Names of all checks of a pulse."""

LEAST_FREE_PX: Final = 1.75
"""Narrower pulses have several widths that fit, each with its own blur: of 717 of .5 to 1.5 px, six
shapes of sensors at SNR 40 to 200, 54 % of the intervals of MTF at Nyquist held, and of 720 of a
held width 99 %; of those of 2 px 98 %."""
_FREE_ADVICE = (
    "so narrow a pulse has several widths that fit, each with another blur; hold the width that "
    "was measured on the ground (fit_width=False, --hold-width), or use a target of three times "
    "the GSD"
)
_HELD_ADVICE = (
    "the held width, or the GSD, is wrong, and every number with it; leave the width free "
    "(method spline without --hold-width), or measure the target again"
)
_NARROW_STD_PX: Final = 0.25
"""Of the free width of narrower ones, whatever it states (417 of six shapes: RMS .16 to .27)."""


def check_pulse(
    region: RegionPixels,
    data: CheckData,
    extent: Extent,
    limits: Limits,
    *,
    width: Estimate,
    height_ratio: Estimate,
    stated_width: Check,
    by_ratio: bool,
) -> tuple[Check, ...]:
    """All checks of a pulse.

    Parameters
    ----------
    region : RegionPixels
    data : CheckData
    extent : Extent
        How much of the region is used.
    limits : mapping of str to float
        Limits the caller changed.
    width, height_ratio : Estimate
        Width of the pulse in pixels, and height of its falling side over the rising one's.
    stated_width : Check
        Whether the stated width agrees with the image.
    by_ratio : bool
        Whether the method divides by the pulse's spectrum.
    """
    values = region.pixels[data.trimmed.pixels.at]
    wrongly_held = not (stated_width.passed or width.std > 0)
    return (
        _contrast(data, limits),
        uniformity(data, limits, "before", data.before),
        uniformity(data, limits, "behind", data.behind),
        target_uniformity(data, limits),
        angle(data.fit.line, limits, by_rows=by_ratio),
        phases(data, limits),
        enough_rows(extent, limits),
        straightness(data, limits),
        edge_roughness(data, limits),
        lsf_width(data, limits),
        plateau(limits, "before", extent.dark_px),
        plateau(limits, "behind", extent.bright_px),
        saturation(region, values, data, limits, ("before", "behind")),
        undeclared_fill([region.fill], limits),
        quantisation(region, values, data, limits),
        possible_sharpness(data, limits),
        stated_gsd(region.info, limits),
        *processing_checks(region, limits),
        _nonlinearity(region, data, limits, width.value, height_ratio.value),
        gradient(data, limits),
        correlated_noise(data, limits),
        odd_even(data, limits),
        removed_noise(data, limits),
        asymmetric_lsf(data, limits),
        profile(
            data,
            limits,
            width.value,
            own_misfit=by_ratio,
            advice=stated_width.message if wrongly_held else None,
        ),
        outliers(data, limits),
        _parallel(data, limits, height_ratio.value),
        _background_step(limits, height_ratio.value),
        _wide_enough(limits, width),
        stated_width,
        _zero_distance(data, limits, width.value, by_ratio=by_ratio),
        *ground_checks(data, limits, ("before", "behind"), steps=2),
    )


def pulse_snr(data: CheckData) -> float:
    """Peak minus mean background, over the background's standard deviation (2005, 3.4.1)."""
    std = data.plateau_std
    far = data.outside > data.far_px
    if not (std > 0 and far.any()):
        return math.inf
    fitted = data.value - data.residual
    return float((fitted.max() - fitted[far].mean()) / std)


def _contrast(data: CheckData, limits: Limits) -> Check:
    value = min(pulse_snr(data), MAX_RATIO)
    found = (
        f"the pulse's peak stands {ratio_in_words(value)} standard deviations of the background "
        "above it"
    )
    return contrast_snr(value, found, limits)


def _nonlinearity(
    region: RegionPixels, data: CheckData, limits: Limits, width_px: float, height_ratio: float
) -> Check:
    sign = data.trimmed.sign if isinstance(data.trimmed, PulsePixels) else 1.0
    return nonlinearity(region, data, limits, pulse_profile(width_px, height_ratio), sign)


def _parallel(data: CheckData, limits: Limits, height_ratio: float) -> Check:
    """Whether the falling side turns against the rising one, from the residuals next to it."""
    lsf = data.fit.response.lsf
    slope = -height_ratio * np.interp(data.behind, lsf.distance_px, lsf.value, left=0.0, right=0.0)
    # The line's direction is fitted to both sides: half of a turn shows on either.
    power = float(slope**2 @ data.t**2)
    turn = -float((slope * data.t) @ data.residual) / power if power > 0 else 0.0
    std = data.noise / math.sqrt(power) if power > 0 else 0.0
    value = 2 * abs(math.degrees(turn)) if abs(turn) > STRUCTURE_SIGMAS * std else 0.0
    found = f"the two sides are inclined by {value:.2f} degrees to each other"
    return answer("parallel_deg", value, found, limits)


def _background_step(limits: Limits, height_ratio: float) -> Check:
    value = abs(1 - height_ratio)
    found = f"the two backgrounds differ by {100 * value:.0f} % of the pulse's height"
    return answer("background_step", value, found, limits)


def _wide_enough(limits: Limits, width: Estimate) -> Check:
    """Whether there is enough of the pulse, and of its width where that was fitted."""
    found = f"the pulse is {width.value:.2f} px wide"
    if not width.std > 0:
        return answer("width_px", width.value, found, limits)
    advice = _FREE_ADVICE if width.value < LEAST_FREE_PX else None
    return answer("width_px", width.value, found, limits, caution=LEAST_FREE_PX, advice=advice)


def width_check(
    limits: Limits, stated_px: float | None, fitted: Estimate | None, *, is_held: bool
) -> Check:
    """Whether the image agrees with the stated width.

    Parameters
    ----------
    limits : mapping of str to float
        Limits the caller changed.
    stated_px : float or None
        The width as stated.
    fitted : Estimate or None
        The width of the joint fit where nothing holds it; None if that found no pulse.
    is_held : bool
        Whether the measurement holds the stated width.
    """
    if stated_px is None:
        found = f"the width is {fitted} px; no other was stated"
        return answer("width_sigmas", 0.0, found, limits)
    if fitted is None or not fitted.std > 0:
        found = f"the width was held at {stated_px:.4f} px, and no pulse of a free width was found"
        return answer("width_sigmas", MAX_RATIO, found, limits, advice=_HELD_ADVICE)
    is_narrow = is_held and fitted.value < LEAST_FREE_PX
    std = math.hypot(fitted.std, _NARROW_STD_PX) if is_narrow else fitted.std
    difference_px = fitted.value - stated_px
    sigmas = abs(difference_px) / std
    value = min(sigmas, MAX_RATIO) if is_held else sigmas
    away = f"{difference_px:+.4f} px, {value:.1f} standard deviations"
    if not is_held:
        found = f"the fitted width is {fitted} px, the stated one {stated_px:.4f} px: {away}"
        return answer("width_sigmas", value, found, limits)
    freely = Estimate(fitted.value, std)
    found = f"the width was held at {stated_px:.4f} px, fitted freely it is {freely} px: {away}"
    return answer("width_sigmas", value, found, limits, advice=_HELD_ADVICE)


def _zero_distance(data: CheckData, limits: Limits, width_px: float, *, by_ratio: bool) -> Check:
    """Whether the reported frequencies are far enough from the zeros of the pulse's spectrum.

    A ratio divides by it. The joint fit does not: it bridges a zero with wider intervals, and has
    no limit unless the caller sets one.
    """
    response = data.fit.response
    reported = {"Nyquist": NYQUIST_CPP}
    if by_ratio:
        reported |= {"MTF50": response.mtf50_cpp.value, "MTF30": response.mtf30_cpp.value}
    divided_px = data.fit.ratio_width_px if isinstance(data.fit, PublishedPulse) else width_px
    zeros = zeros_cpp(divided_px)
    if zeros.size == 0:
        found = "the pulse's spectrum has no zero up to 1 c/px"
        return answer("zero_distance_cpp", 1.0, found, limits)
    near = [_nearest(zeros, name, freq) for name, freq in reported.items() if freq > 0]
    value = min(distance for distance, _ in near)
    limit = limit_of("zero_distance_cpp", limits)
    named = [words for distance, words in near if distance < limit] or [min(near)[1]]
    return answer(
        "zero_distance_cpp", value, f"of the pulse's spectrum, {'; '.join(named)}", limits,
        default=None if by_ratio else 0.0,
    )  # fmt: skip


def _nearest(zeros: Floats, name: str, freq_cpp: float) -> tuple[float, str]:
    """How far a frequency is from the zero next to it, and the same in words."""
    zero = float(zeros[np.argmin(np.abs(zeros - freq_cpp))])
    away = abs(freq_cpp - zero)
    return away, f"{name} ({freq_cpp:.3f} c/px) lies {away:.3f} from the zero at {zero:.3f}"
