"""Measure a pulse target: two parallel edges, as of a tarp on grass or a bridge."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from numbers import Real

from numpy.typing import ArrayLike

from acutance.arguments import require_flags
from acutance.curves import Estimate
from acutance.errors import OptionError, TargetError
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.check import Check, Checks, limit_of
from acutance.targets.options import chosen_options, published_options, require_known_method
from acutance.targets.region import RegionPixels, RoiLike, read_region
from acutance.targets.steps import Steps, finished
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.edge import described, details_of, in_whole_image, require_phases
from acutance.targets.straight.find_edges import find_segments
from acutance.targets.straight.find_pulse import find_pulse
from acutance.targets.straight.fit_pulse import PulsePixels, fit_pulse, fit_pulse_steps
from acutance.targets.straight.lsf import SplineResponse, of_stated_target, with_uncertain_halo
from acutance.targets.straight.options import PulseOptions
from acutance.targets.straight.pixels import EdgeFit
from acutance.targets.straight.published import PUBLISHED_PULSE, PUBLISHED_PULSE_OPTIONS
from acutance.targets.straight.pulse_checks import (
    LEAST_FREE_PX,
    check_pulse,
    pulse_snr,
    width_check,
)
from acutance.targets.straight.pulse_halo import light_of_halo
from acutance.targets.straight.pulse_response import prf_fwhm
from acutance.targets.straight.stated_target import stated_target
from acutance.targets.straight.straight_measurement import StraightMeasurement
from acutance.targets.straight.trim import Extent
from acutance.targets.straight.tuned import HALO_WIDTH_PX2, MAX_CORRECTED_WIDTH

__all__ = ["PULSE_METHODS", "measure_pulse", "pulse_steps", "require_pulse_method"]


_Fitted = tuple[EdgeFit, Estimate, Estimate, Estimate]
"""Of a method: the fit of a pulse, its width, the height of its falling side over that of the
rising one, and the full width at half maximum (FWHM) of its response."""


def _spline(trimmed: PulsePixels, fit_width: bool, options: PulseOptions) -> Steps[_Fitted]:
    if options.method_options is not None:
        raise OptionError("method_options belong to the published methods: leave them out")
    fit = yield from fit_pulse_steps(trimmed, fit_width=fit_width, robust=options.robust)
    response = with_uncertain_halo(fit.response)
    prf = prf_fwhm(response, fit.pulse_width.value, fit.width_factor)
    width = _with_halo(fit.pulse_width, response)
    return replace(fit, response=response), width, fit.height_ratio, prf


def _with_halo(width: Estimate, response: SplineResponse) -> Estimate:
    """A fitted width, which follows the light that the halo takes from the pulse or gives it."""
    if width.std == 0 or not width.value > 0:
        return width
    std = HALO_WIDTH_PX2 * response.halo_share * light_of_halo(response) / width.value
    return replace(width, std=math.hypot(width.std, std))


def _published(name: str) -> Callable[[PulsePixels, bool, PulseOptions], Steps[_Fitted]]:
    def measure(trimmed: PulsePixels, fit_width: bool, options: PulseOptions) -> Steps[_Fitted]:
        yield
        wanted = PUBLISHED_PULSE_OPTIONS[name]
        fit = PUBLISHED_PULSE[name](trimmed, published_options(options, name, wanted))
        along_normal = fit.prf_fwhm_px / fit.px_per_normal
        return fit, fit.pulse_width, fit.height_ratio, along_normal

    return measure


PULSE_METHODS: dict[str, Callable[[PulsePixels, bool, PulseOptions], Steps[_Fitted]]] = {
    "spline": _spline,
    **{name: _published(name) for name in PUBLISHED_PULSE},
}


@one_thread
def measure_pulse(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    width_px: float | None = None,
    width_m: float | None = None,
    gsd_m: float | Gsd | None = None,
    fit_width: bool = True,
    method: str = "spline",
    options: PulseOptions | None = None,
) -> StraightMeasurement:
    """Measure the strongest pulse of a region.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        A loose region is normal: the pulse is found in it, and its usable pixels are kept.
    width_px, width_m : float, optional
        Width of the target along its normal, in pixels or in metres (which needs a GSD); without
        either a first guess from the profile is fitted.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    fit_width : bool, optional
        Whether the width is fitted with the line spread function (LSF), with its own standard
        deviation (method "spline"); the stated one is then the first guess, and a check compares
        the two.
    method : {"spline", "sdsu-2005"}, optional
        The joint fit, or the published ratio of spectra with its biases: its width is the stated
        one, or else the one at which the pulse was found.
    options : PulseOptions, optional

    Returns
    -------
    StraightMeasurement
        With `width_px` and `prf_fwhm_px`. The MTF is the sensor's, not that of the pulse response.

    Raises
    ------
    ImageError, RegionError, OptionError
        If there are no pixels to measure, or the width is no number or out of range.
    NoEdgeError, PhaseError, SupportError
        If there is no pulse, it is aligned with the grid, or too little of it is there.
    """
    chosen = chosen_options(options, PulseOptions)
    return finished(
        pulse_steps(
            read_region(image, roi, gsd_m), width_px=width_px, width_m=width_m,
            fit_width=fit_width, method=method, options=chosen,
        )
    )  # fmt: skip


def pulse_steps(
    region: RegionPixels,
    *,
    width_px: float | None,
    width_m: float | None,
    fit_width: bool,
    method: str,
    options: PulseOptions,
) -> Steps[StraightMeasurement]:
    """`measure_pulse` of pixels that were read, in steps."""
    require_flags(fit_width=fit_width)
    estimate = require_pulse_method(method)
    stated_px = _stated_width(region, width_px, width_m)
    free = fit_width or stated_px is None
    with _naming_the_width(region, stated_px):
        trimmed, extent = find_pulse(region.pixels, stated_px, fit_width=free)
    require_phases(trimmed, trimmed.line, limit_of("sample_phases", options.limits))
    if stated_px is not None and method in PUBLISHED_PULSE:
        trimmed = replace(trimmed, pulse_width_px=stated_px)
    yield
    with _naming_the_width(region, stated_px):
        found = yield from estimate(trimmed, free, options)
    if free and stated_px is not None and _is_far(found[1].value, stated_px):
        # Far from the first guess the fit may have stopped in a local minimum: begin near the end.
        trimmed, extent = find_pulse(region.pixels, found[1].value)
        found = yield from estimate(trimmed, free, options)
    yield
    return _measurement(region, trimmed, extent, found, method, options, stated_px)


@contextmanager
def _naming_the_width(region: RegionPixels, stated_px: float | None) -> Iterator[None]:
    """Where a stated width leads to no pulse, the error names the width found without it."""
    try:
        yield
    except TargetError as error:
        if stated_px is None:
            raise
        found_px = _width_found(region)
        if found_px is None or not _is_far(found_px, stated_px):
            raise
        raise type(error)(
            f"{error}; the image shows a pulse of about {found_px:.2f} px where {stated_px:.2f} px "
            "were stated: check the width and the GSD, or state no width"
        ) from error


def _width_found(region: RegionPixels) -> float | None:
    """Width in pixels of the pulse that is found when no width is stated."""
    try:
        return find_pulse(region.pixels)[0].pulse_width_px
    except TargetError:
        return None


def _is_far(found_px: float, stated_px: float) -> bool:
    """Whether a fitted width is more than a correction of the stated one."""
    return abs(found_px / stated_px - 1) > MAX_CORRECTED_WIDTH


def _width_check(
    region: RegionPixels,
    width: Estimate,
    stated_px: float | None,
    options: PulseOptions,
) -> Check:
    """Whether the image agrees with the stated width; one that was held is fitted for it."""
    if stated_px is None or width.std > 0:
        return width_check(options.limits, stated_px, width, is_held=False)
    free = _free_width(region, stated_px, robust=options.robust)
    return width_check(options.limits, stated_px, free, is_held=True)


def _free_width(region: RegionPixels, held_px: float, *, robust: bool) -> Estimate | None:
    """The width that the joint fit finds where another was held; None where it finds none.

    Fitted from the width that is found when none is stated, and from the held one: about one with
    half the width the blur is wide, and stays so. The former is told unless it is too narrow to be
    known, as next to a wrong width there may be a minimum of its own; of narrow ones the nearest.
    """
    starts = (None, held_px)
    found = [one for one in (_fitted_width(region, px, robust) for px in starts) if one is not None]
    wide = [one for one in found if one.value >= LEAST_FREE_PX]
    return min(wide[:1] or found, key=lambda one: abs(one.value - held_px), default=None)


def _fitted_width(region: RegionPixels, first_px: float | None, robust: bool) -> Estimate | None:
    """The width that the joint fit finds from a first guess, near the end begun once more."""
    try:
        trimmed, _ = find_pulse(region.pixels, first_px)
        fit = fit_pulse(trimmed, robust=robust)
        if first_px is not None and _is_far(fit.pulse_width.value, first_px):
            again, _ = find_pulse(region.pixels, fit.pulse_width.value)
            fit = fit_pulse(again, robust=robust)
    except TargetError:
        return None
    return _with_halo(fit.pulse_width, with_uncertain_halo(fit.response))


def require_pulse_method(
    name: str,
) -> Callable[[PulsePixels, bool, PulseOptions], Steps[_Fitted]]:
    """The pulse method of a name.

    Raises
    ------
    OptionError
        If there is none.
    """
    require_known_method("pulse", name, PULSE_METHODS)
    return PULSE_METHODS[name]


def _stated_width(
    region: RegionPixels, width_px: float | None, width_m: float | None
) -> float | None:
    """The stated width in pixels along the normal of the strongest side in the region."""
    for name, width in (("width_px", width_px), ("width_m", width_m)):
        if width is not None and not isinstance(width, Real):
            unit = "pixels" if name == "width_px" else "metres"
            raise OptionError(f"{name} is {width!r:.80}: give a number of {unit}")
    if width_px is not None and width_m is not None:
        raise OptionError("the width was given in pixels and in metres: give one of them")
    if width_m is not None:
        if region.gsd is None:
            raise OptionError(
                f"a width of {width_m:g} m needs a GSD, and the image has none: give gsd_m "
                "(--gsd), or the width in pixels"
            )
        side = next(find_segments(region.pixels, 1), None)
        width_px = width_m / region.gsd.along_normal(side.line.normal_deg if side else 0.0)
    if width_px is not None and not 0.3 <= width_px <= 100:
        raise OptionError(
            f"a pulse {width_px:.3g} px wide cannot be measured: widths of 2 to 6 px are best; "
            "check the width and the GSD"
        )
    return width_px


def _measurement(
    region: RegionPixels,
    trimmed: PulsePixels,
    extent: Extent,
    found: _Fitted,
    method: str,
    options: PulseOptions,
    stated_px: float | None,
) -> StraightMeasurement:
    """The measurement, its line in pixels of the whole image."""
    fit, width, height_ratio, prf_fwhm_px = found
    fit = replace(fit, response=described(fit.response, fit.line, region, options.rer_centre))
    stated = stated_target(options, fit.response.gsd_m)
    transfer = of_stated_target(fit.response, stated)
    data = CheckData.of(trimmed, fit, width.value, transfer if stated.has_border else None)

    def answers() -> tuple[Check, ...]:
        return check_pulse(
            region, data, extent, options.limits,
            width=width, height_ratio=height_ratio,
            stated_width=_width_check(region, width, stated_px, options),
            by_ratio=method in PUBLISHED_PULSE,
        )  # fmt: skip

    return StraightMeasurement(
        kind="pulse",
        method=method,
        transfer=transfer,
        line=in_whole_image(fit.line, region),
        dark=trimmed.sign * fit.dark,
        bright=trimmed.sign * fit.bright,
        width_px=width,
        prf_fwhm_px=prf_fwhm_px,
        stated_width_px=stated_px,
        stated=stated,
        snr=pulse_snr(data),
        checks=Checks(answers),
        image=region.info,
        options=options.to_dict(),
        details=details_of(region, trimmed, fit),
    )
