"""Measure point sources: arrays of convex mirrors, lamps, stars."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Otf2d, OtfModel
from acutance.curves.grid import Floats
from acutance.errors import OptionError, TargetError
from acutance.numerics.noise import outlier_share
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.check import Check, Checks
from acutance.targets.options import chosen_options, published_options, require_known_method
from acutance.targets.points.checks import (
    check_points,
    check_positions,
    check_survey,
    check_unmatched_survey,
)
from acutance.targets.points.detect import RejectedSpot
from acutance.targets.points.extent import excess_variances
from acutance.targets.points.first_fit import FirstFit, fit_first_gaussian, unlike_sources
from acutance.targets.points.fit import fit_points
from acutance.targets.points.options import PointsOptions
from acutance.targets.points.points_fit import PointsFit
from acutance.targets.points.points_measurement import PointsDetails, PointsMeasurement
from acutance.targets.points.published import SdsuMirrorsOptions, sdsu_2003_mirrors
from acutance.targets.points.selection import (
    Selection,
    cover_rejected,
    reject_extended,
    reject_unlike,
    select_spots,
)
from acutance.targets.points.sources import (
    PointSource,
    SourceStamp,
    sources_of_fit,
    sources_of_mirrors,
)
from acutance.targets.points.stamps import Stamps, cut_stamps
from acutance.targets.points.survey import SurveyReference, survey_errors
from acutance.targets.region import RegionPixels, RoiLike, read_region

__all__ = ["POINTS_METHODS", "measure_points"]

_MAX_ROUNDS = 4
_Rejected = tuple[RejectedSpot, ...]


def _fit_jointly(
    region: RegionPixels, selected: Selection, options: PointsOptions
) -> PointsMeasurement:
    if options.method_options is not None:
        raise OptionError("method_options belong to the published method: leave them out")
    fit, rejected = _fit_alike(region, selected, options)
    sources, shown = sources_of_fit(fit, region.pixels, _origin(region))
    checks = partial(
        check_points, sources, region, options.limits,
        full_scale=_full_scale(shown, region), correlation=fit.correlation,
        outliers=outlier_share(fit.standard_residual, 1.0), widths=excess_variances(fit),
    )  # fmt: skip
    return _measurement(
        "psf-fit", fit.model, region, options, sources, rejected, checks=checks,
        noise_std=fit.noise, noise_gain=fit.gain, pads=fit.pads,
        details=PointsDetails(region.pixels, shown, fit=fit),
    )  # fmt: skip


def _fit_alike(
    region: RegionPixels, selected: Selection, options: PointsOptions
) -> tuple[PointsFit, _Rejected]:
    """The joint fit; in a mixed field made again without sources wider than the points."""
    places, rejected, mixed = selected
    for _ in range(_MAX_ROUNDS):
        stamps, first, rejected = _fit_first(region, places, rejected, options)
        fit = fit_points(stamps, first, robust=options.robust)
        if not mixed:
            break
        same, rejected = reject_extended(fit.places, *excess_variances(fit), rejected)
        if same.all():
            break
        places = fit.places[same]
    return fit, rejected


def _fit_first(
    region: RegionPixels, places: Floats, rejected: _Rejected, options: PointsOptions
) -> tuple[Stamps, FirstFit, _Rejected]:
    """The first fit, made again without sources that are unlike the others."""
    stamps = cut_stamps(cover_rejected(region.pixels, rejected), places, options.radius_px)
    first = fit_first_gaussian(stamps, places)
    share, unlike = unlike_sources(stamps, first)
    if unlike.any():
        rejected = (*rejected, *reject_unlike(places, share, unlike))
        places = places[~unlike]
        stamps = cut_stamps(cover_rejected(region.pixels, rejected), places, options.radius_px)
        first = fit_first_gaussian(stamps, places)
    return stamps, first, rejected


def _fit_gaussians(
    region: RegionPixels, selected: Selection, options: PointsOptions
) -> PointsMeasurement:
    places, rejected, _ = selected
    chosen = published_options(options, "gaussian-2003", SdsuMirrorsOptions)
    found = sdsu_2003_mirrors(cover_rejected(region.pixels, rejected), places, chosen)
    sources, shown = sources_of_mirrors(found, region.pixels, _origin(region), chosen.window_px)
    checks = partial(
        check_points, sources, region, options.limits,
        full_scale=_full_scale(shown, region),
    )  # fmt: skip
    return _measurement(
        "gaussian-2003", found.psf, region, options, sources, (*rejected, *found.left_out),
        checks=checks,
        noise_std=found.aligned.background_std, aligned=found.aligned,
        details=PointsDetails(region.pixels, shown, published=found),
    )  # fmt: skip


def _measurement(
    method: str,
    model: OtfModel,
    region: RegionPixels,
    options: PointsOptions,
    sources: tuple[PointSource, ...],
    rejected: _Rejected,
    checks: Callable[..., tuple[Check, ...]],
    **found: Any,
) -> PointsMeasurement:
    """A measurement by one of the methods; `found` is what differs between them."""
    row, col = _origin(region)
    measurement = PointsMeasurement(
        kind="points",
        method=method,
        transfer=_otf(model, region),
        snr=float(np.median([one.snr for one in sources])),
        image=region.info,
        options=options.to_dict(),
        sources=sources,
        rejected=tuple(replace(one, row=one.row + row, col=one.col + col) for one in rejected),
        checks=Checks(lambda: checks(fwhm_px=_fwhm_px(measurement))),
        **found,
    )
    return measurement


POINTS_METHODS: dict[str, Callable[[RegionPixels, Selection, PointsOptions], PointsMeasurement]] = {
    "psf-fit": _fit_jointly,
    "gaussian-2003": _fit_gaussians,
}


@one_thread
def measure_points(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    positions: ArrayLike | None = None,
    surveyed: ArrayLike | None = None,
    survey_reference: SurveyReference = "mean",
    gsd_m: float | Gsd | None = None,
    method: str = "psf-fit",
    options: PointsOptions | None = None,
) -> PointsMeasurement:
    """Measure the PSF and its MTF on the point sources of a region.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
    positions : (n, 2) array_like, optional
        Approximate places (row, col) in the whole image, to 1.5 px; found in the image without.
    surveyed : (n, 2) array_like, optional
        Surveyed places (row, col), to be compared with the measured ones; off by up to 20 px as a
        whole.
    survey_reference : {"mean", "first"}, optional
        Which shift is taken out of the comparison: the mean, or the first source's as in the
        report of 2003.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    method : {"psf-fit", "gaussian-2003"}, optional
        The joint fit, or the published Gaussian of aligned samples.
    options : PointsOptions, optional

    Returns
    -------
    PointsMeasurement

    Raises
    ------
    ImageError, RegionError, OptionError
        If there are no pixels to measure, or an option makes no sense.
    TargetError
        If no source is usable; the message counts why.
    """
    chosen = chosen_options(options, PointsOptions)
    require_known_method("points", method, POINTS_METHODS)
    region = read_region(image, roi, gsd_m)
    wanted = None if positions is None else _places_of("positions", positions) - _origin(region)
    selected = select_spots(region, wanted, chosen)
    measurement = _measured(method, region, selected, chosen)
    if wanted is not None:
        missing = sum(one.reason == "no source" for one in selected.rejected)
        matched = check_positions(missing, len(wanted), chosen.limits)
        measurement = replace(measurement, checks=(*measurement.checks, matched))
    if surveyed is None:
        return measurement
    return _with_survey(measurement, _places_of("surveyed", surveyed), survey_reference, chosen)


def _measured(
    method: str, region: RegionPixels, selected: Selection, options: PointsOptions
) -> PointsMeasurement:
    try:
        return POINTS_METHODS[method](region, selected, options)
    except np.linalg.LinAlgError as error:
        raise TargetError(
            f"the {len(selected.places)} sources found are not explained by one point spread "
            "function, however wide: they are no points, or not of one kind; give their positions, "
            "or a region that holds nothing but mirrors or stars"
        ) from error


def _with_survey(
    measurement: PointsMeasurement,
    surveyed: Floats,
    reference: SurveyReference,
    options: PointsOptions,
) -> PointsMeasurement:
    try:
        survey = survey_errors(
            measurement.positions, surveyed, pixel_m=measurement.image.pixel_gsd_m,
            reference=reference, along_track=measurement.image.along_track,
        )  # fmt: skip
    except OptionError as error:
        # The survey alone is wrong: what was measured holds.
        unmatched = check_unmatched_survey(str(error), options.limits)
        return replace(measurement, checks=(*measurement.checks, unmatched))
    checks = (*measurement.checks, check_survey(survey, options.limits))
    return replace(measurement, survey=survey, checks=checks)


def _places_of(name: str, stated: ArrayLike) -> Floats:
    try:
        places = np.asarray(stated, float)
    except (TypeError, ValueError):
        raise OptionError(
            f"{name} are {stated!r}: give an array of numbers, (n, 2): row, column"
        ) from None
    if places.ndim != 2 or places.shape[0] == 0 or places.shape[1] != 2:
        raise OptionError(f"{name} have shape {places.shape}, they have to be (n, 2): row, column")
    if not np.isfinite(places).all():
        raise OptionError(f"{name} hold numbers that are not finite: leave those sources out")
    return places


def _origin(region: RegionPixels) -> tuple[int, int]:
    """Row and column of the region's first pixel in the whole image."""
    return region.box.row, region.box.col


def _otf(model: OtfModel, region: RegionPixels) -> Otf2d:
    return Otf2d(model, region.info.pixel_gsd_m)


def _fwhm_px(measurement: PointsMeasurement) -> dict[str, float]:
    """Full width at half maximum by direction."""
    return {name: own.fwhm_px.value for name, own in measurement.directions.items()}


def _full_scale(shown: Sequence[SourceStamp], region: RegionPixels) -> float | None:
    """The brightest pixel around a source over the detector's limit, where that is known."""
    if region.saturation_level is None:
        return None
    return max(float(np.nanmax(one.pixels)) for one in shown) / region.saturation_level
