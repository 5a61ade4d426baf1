"""Measure a straight edge: from pixels to MTF, RER and FWHM with their standard deviations.

RER is the relative edge response, FWHM the full width at half maximum of the line spread function.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.curves.metrics import RerCentre
from acutance.errors import NoEdgeError, OptionError, PhaseError, TargetError
from acutance.geometry.line import Line
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image, value_far_off
from acutance.targets.check import Check, Checks, limit_of
from acutance.targets.options import chosen_options, published_options, require_known_method
from acutance.targets.region import RegionPixels, RoiLike, read_region
from acutance.targets.steps import Steps, finished
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.edge_checks import check_edge, edge_snr, sample_phases
from acutance.targets.straight.find_edges import Segment, find_segments
from acutance.targets.straight.fit_edge import SplineEdge, fit_edge_steps
from acutance.targets.straight.lsf import of_stated_target
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.published import BY_ROWS, PUBLISHED, PUBLISHED_OPTIONS
from acutance.targets.straight.stated_target import stated_target
from acutance.targets.straight.straight_measurement import StraightDetails, StraightMeasurement
from acutance.targets.straight.trim import trim
from acutance.targets.straight.tuned import MIN_PHASES

__all__ = [
    "METHODS",
    "described",
    "details_of",
    "edge_steps",
    "in_whole_image",
    "measure_edge",
    "measure_segment",
    "require_method",
    "require_phases",
    "segment_steps",
]

_MANY_MISSING = 0.05
_MISSING_WORDS = "nodata, masked, NaN, infinite, fill, or outside its outline"
_CANDIDATES = 4
_ALIGNED_DEG = 0.1
_NEAR_45_DEG = 40.0
_SIGNIFICANT = 3.0
_OFF_LINE_PX = 1.0


def _spline(trimmed: EdgePixels, options: EdgeOptions) -> Steps[EdgeFit]:
    if options.method_options is not None:
        raise OptionError("method_options belong to the published methods: leave them out")
    return fit_edge_steps(trimmed, robust=options.robust)


def _published(name: str) -> Callable[[EdgePixels, EdgeOptions], Steps[EdgeFit]]:
    def measure(trimmed: EdgePixels, options: EdgeOptions) -> Steps[EdgeFit]:
        yield
        return PUBLISHED[name](trimmed, published_options(options, name, PUBLISHED_OPTIONS[name]))

    return measure


METHODS: dict[str, Callable[[EdgePixels, EdgeOptions], Steps[EdgeFit]]] = {
    "spline": _spline,
    **{name: _published(name) for name in PUBLISHED},
}


@one_thread
def measure_edge(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
) -> StraightMeasurement:
    """Measure the dominant straight edge of a region.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
        From `acutance.open_image`, or pixels in memory; NaN, infinite and masked
        pixels are not used.
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        A loose region is normal: the edge is found in it, and its usable pixels are kept.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    method : {"spline", "sdsu-2005", "kompsat-2014", "iso12233", "fermi"}, optional
        The reference estimator, or a published one with its biases.
    options : EdgeOptions, optional

    Returns
    -------
    StraightMeasurement
        Numbers with standard deviations, curves, details and checks. The line is in pixels of
        the whole image, row and column, integers at pixel centres.

    Raises
    ------
    ImageError, RegionError
        If there are no pixels to measure.
    NoEdgeError, PhaseError, SupportError
        If there is no edge, it is aligned with the grid, or too little of it is there.

    Examples
    --------
    >>> import acutance as ac
    >>> image, truth = ac.simulate.edge(sensor, angle_deg=6, snr=100, rng=rng)  # doctest: +SKIP
    >>> print(ac.measure_edge(image).mtf_nyquist)  # doctest: +SKIP
    0.2893 ± 0.0061
    """
    chosen = chosen_options(options, EdgeOptions)
    return finished(edge_steps(read_region(image, roi, gsd_m), method=method, options=chosen))


def edge_steps(
    region: RegionPixels, *, method: str, options: EdgeOptions
) -> Steps[StraightMeasurement]:
    """`measure_edge` of pixels that were read, in steps: the strongest edge that can be measured.

    Raises
    ------
    AcutanceError
        If none can, the strongest's.
    """
    first: TargetError | None = None
    for segment in find_segments(region.pixels, _CANDIDATES):
        try:
            return (yield from segment_steps(region, segment, method, options))
        except TargetError as error:
            first = first or error
    raise _named(_nothing_found(region) if first is None else _torn(first, region), region)


def _nothing_found(region: RegionPixels) -> NoEdgeError:
    missing = _share_missing(region)
    reason = "the region is flat, or its longest edge is too short"
    if missing > _MANY_MISSING:
        reason += f", or torn by the {100 * missing:.0f} % of it without data ({_MISSING_WORDS})"
    return NoEdgeError(
        f"no straight edge stands out in the {region.box.height} x {region.box.width} pixels: "
        f"{reason}; choose a region that holds one bright and one dark side"
    )


def _torn(error: TargetError, region: RegionPixels) -> TargetError:
    """The error, with what pixels without data may have to do with it."""
    missing = _share_missing(region)
    if missing <= _MANY_MISSING:
        return error
    return type(error)(
        f"{error}; {100 * missing:.0f} % of the region is without data ({_MISSING_WORDS})"
    )


def _share_missing(region: RegionPixels) -> float:
    return float(np.mean(np.isnan(region.pixels)))


def _named(error: TargetError, region: RegionPixels) -> TargetError:
    """The error, with what fill may have to do with it."""
    found = value_far_off(region.pixels)
    if found is None:
        return error
    value, count = found
    return type(error)(
        f"{error}; {count} of the pixels are {value:g}, far from all others: if they hold no data, "
        "say so (nodata, --nodata; masked pixels or NaN in an array)"
    )


def measure_segment(
    region: RegionPixels, segment: Segment, method: str, options: EdgeOptions
) -> StraightMeasurement:
    """Measure one segment that was found in a region; see `measure_edge`."""
    return finished(segment_steps(region, segment, method, options))


def segment_steps(
    region: RegionPixels,
    segment: Segment,
    method: str,
    options: EdgeOptions,
    *,
    of_scene: bool = False,
) -> Steps[StraightMeasurement]:
    """`measure_segment` in steps.

    Of a segment of a scene what is asked of the whole scene is not checked.
    """
    estimate = require_method(method)
    yield
    trimmed, extent = trim(region.pixels, segment)
    require_phases(trimmed, trimmed.line, limit_of("sample_phases", options.limits))
    yield
    fit = yield from estimate(trimmed, options)
    yield
    check = partial(
        check_edge, region, extent=extent, limits=options.limits, by_rows=method in BY_ROWS,
        own_misfit=method in PUBLISHED, of_scene=of_scene,
    )  # fmt: skip
    return _measurement(region, trimmed, fit, method, options, check)


def require_method(name: str) -> Callable[[EdgePixels, EdgeOptions], Steps[EdgeFit]]:
    """The edge method of a name.

    Raises
    ------
    OptionError
        If there is none.
    """
    require_known_method("edge", name, METHODS)
    return METHODS[name]


def require_phases(trimmed: EdgePixels, line: Line, wanted: float) -> None:
    """Refuse an edge whose samples repeat at the same sub-pixel phases.

    Parameters
    ----------
    trimmed : EdgePixels
    line : Line
    wanted : float
        Limit of the check `sample_phases`: more than the least that can be measured.

    Raises
    ------
    PhaseError
        If there are too few.
    """
    distance = line.normal_distance(trimmed.pixels.row, trimmed.pixels.col)
    phases = sample_phases(distance)
    if phases >= MIN_PHASES:
        return
    fill = _fill_value(distance, trimmed.pixels.value)
    wanted = max(wanted, MIN_PHASES)
    # Rounded down: what is too few does not print as enough.
    below = math.floor(10 * phases) / 10
    raise PhaseError(
        f"edge angle {line.angle_deg:.2f} deg gives {below:.1f} sample phases over "
        f"{line.length_px:.0f} rows, at least {MIN_PHASES:g} are needed and {wanted:g} wanted: "
        + (_advice(line, wanted) if fill is None else _fill_advice(fill))
    )


def _fill_value(distance: Floats, value: Floats) -> float | None:
    """The value of one side if all its pixels are equal and those of the other side are not."""
    sides = (value[distance < -_OFF_LINE_PX], value[distance > _OFF_LINE_PX])
    low, high = (float(np.ptp(side)) if side.size else 0.0 for side in sides)
    if (low == 0) == (high == 0):
        return None
    flat = sides[0] if low == 0 else sides[1]
    return float(flat[0]) if flat.size else None


def _fill_advice(fill: float) -> str:
    return (
        f"all pixels on one side of it are {fill:.9g}, as where there is no data; if so, declare "
        f"it (nodata={fill:.9g}, --nodata {fill:.9g}) or choose a region without such pixels, and "
        "otherwise one with a more inclined edge"
    )


def _advice(line: Line, wanted: float) -> str:
    """What to do about too few phases.

    The length of the edge that is needed is proportional to 1 / angle: no use for an aligned one.
    """
    angle = line.angle_deg
    if angle > _NEAR_45_DEG:
        return "use an edge that is not at 45 degrees to the grid"
    if angle < max(_ALIGNED_DEG, _SIGNIFICANT * line.angle_std_deg):
        return (
            "the edge is aligned with the grid within its uncertainty, and no length of it "
            "helps: use a more inclined edge, by 2 degrees or more"
        )
    needed = (1 - 1 / wanted) / math.tan(math.radians(angle))
    return f"use a region of at least {needed:.0f} rows or a more inclined edge"


def _measurement(
    region: RegionPixels,
    trimmed: EdgePixels,
    fit: EdgeFit,
    method: str,
    options: EdgeOptions,
    check: Callable[[CheckData], tuple[Check, ...]],
) -> StraightMeasurement:
    """The measurement, its line in pixels of the whole image."""
    fit = replace(fit, response=described(fit.response, fit.line, region, options.rer_centre))
    stated = stated_target(options, fit.response.gsd_m)
    transfer = of_stated_target(fit.response, stated)
    # The checks compare curves with pixels: they read those of the image, but for two that ask
    # what a sensor can be.
    data = CheckData.of(trimmed, fit, behind_border=transfer if stated.has_border else None)
    return StraightMeasurement(
        kind="edge",
        method=method,
        transfer=transfer,
        line=in_whole_image(fit.line, region),
        dark=fit.dark,
        bright=fit.bright,
        stated=stated,
        snr=edge_snr(data),
        checks=Checks(lambda: check(data)),
        image=region.info,
        options=options.to_dict(),
        details=details_of(region, trimmed, fit),
    )


def described(
    response: Response, line: Line, region: RegionPixels, rer_centre: RerCentre | None
) -> Response:
    """The curves with the GSD along their normal and the chosen centre of the RER."""
    return replace(
        response,
        gsd_m=region.info.gsd_along(line.normal_deg),
        rer_centre=rer_centre or response.rer_centre,
    )


def in_whole_image(line: Line, region: RegionPixels) -> Line:
    """A line of the region, in pixels of the whole image."""
    return replace(line, row=line.row + region.box.row, col=line.col + region.box.col)


def details_of(region: RegionPixels, trimmed: EdgePixels, fit: EdgeFit) -> StraightDetails:
    """The pixels of a fit by their distance along the normal."""
    used = np.isfinite(trimmed.image)
    pixels = (region.pixels, used, fit.distance_px, fit.value, fit.residual)
    if not isinstance(fit, SplineEdge):
        return StraightDetails(*pixels)
    return StraightDetails(*pixels, fit.causes, fit.pixels_alone, fit.families)
