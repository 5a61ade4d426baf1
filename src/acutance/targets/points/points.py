"""Measure point sources: arrays of convex mirrors, lamps, stars."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Otf2d
from acutance.curves.grid import Floats
from acutance.errors import OptionError, TargetError
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.measurement import Check, ImageInfo
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.options import chosen_options, published_options
from acutance.targets.points.checks import check_points, check_survey
from acutance.targets.points.detect import RejectedSpot, Spot, find_spots, sort_spots
from acutance.targets.points.first_fit import fit_blurred_points, unlike_sources
from acutance.targets.points.fit import PointsFit, fit_points
from acutance.targets.points.options import PointsOptions
from acutance.targets.points.published import (
    PublishedMirrors,
    SdsuMirrorsOptions,
    sdsu_2003_mirrors,
)
from acutance.targets.points.sources import PointSource, sources_of_fit, sources_of_mirrors
from acutance.targets.points.stamps import cut_stamps
from acutance.targets.points.survey import SurveyErrors, SurveyReference, survey_errors
from acutance.targets.region import RegionPixels, RoiLike, read_region

__all__ = ["POINTS_METHODS", "PointsMeasurement", "measure_points"]

_COVERED_PX = {"saturated": 9.0, "blended": 4.0, "hot pixel": 1.0, "cosmic ray": 3.0}
_COVERED_ELSE_PX = 2.5


@dataclass(frozen=True, eq=False, kw_only=True)
class PointsMeasurement(Measurement2d):
    """A measurement of point sources, with every source as evidence.

    Parameters
    ----------
    sources : tuple of PointSource
        What was fitted.
    rejected : tuple of RejectedSpot
        Bright spots and given places that do not serve, with the reason.
    survey : SurveyErrors, optional
        Measured against surveyed places.
    fit : PointsFit, optional
        The joint fit (method "psf-fit"), in pixels of the cut.
    published : PublishedMirrors, optional
        The aligned samples and their Gaussian (method "gaussian-2003"), in pixels of the cut.
    pixels : (rows, cols) array
        The cut.
    """

    sources: tuple[PointSource, ...]
    rejected: tuple[RejectedSpot, ...]
    survey: SurveyErrors | None = None
    fit: PointsFit | None = None
    published: PublishedMirrors | None = None
    pixels: Floats

    @property
    def positions(self) -> Floats:
        """Places of the sources as (row, col) in the whole image, (n, 2)."""
        return np.array([(one.row.value, one.col.value) for one in self.sources])

    def evidence(self) -> dict[str, Any]:
        """Sources, what was rejected, and the survey."""
        found: dict[str, Any] = {
            "sources": [one.to_dict() for one in self.sources],
            "rejected": [
                {"row": one.row, "col": one.col, "reason": one.reason, "message": one.message}
                for one in self.rejected
            ],
            "survey": None if self.survey is None else self.survey.to_dict(),
        }
        if self.fit is not None:
            found["noise"] = {"std": self.fit.noise, "gain": self.fit.gain}
        if self.published is not None:
            found["aligned"] = {
                "rmse": self.published.rmse,
                "background_mean": self.published.noise_mean,
                "background_std": self.published.noise_std,
                "peak_over_background": self.published.peak_over_background,
            }
        return found


@dataclass(frozen=True, eq=False)
class _Answer:
    """What a method makes of the sources."""

    otf: Any
    sources: tuple[PointSource, ...]
    rejected: tuple[RejectedSpot, ...]
    checks: tuple[Check, ...]
    fit: PointsFit | None = None
    published: PublishedMirrors | None = None


_Rejected = tuple[RejectedSpot, ...]


def _psf_fit(
    pixels: RegionPixels, places: Floats, rejected: _Rejected, options: PointsOptions
) -> _Answer:
    if options.method_options is not None:
        raise OptionError("method_options belong to the published method: leave them out")
    stamps = cut_stamps(_covered(pixels.pixels, rejected), places, options.radius_px)
    start = fit_blurred_points(stamps, places)
    departure, unlike = unlike_sources(stamps, start)
    if unlike.any():
        rejected = (*rejected, *map(_unlike, places[unlike].tolist(), departure[unlike].tolist()))
        places = places[~unlike]
        stamps = cut_stamps(_covered(pixels.pixels, rejected), places, options.radius_px)
        start = fit_blurred_points(stamps, places)
    fit = fit_points(stamps, start, robust=options.robust)
    sources = sources_of_fit(fit, pixels.pixels, (pixels.box.row, pixels.box.col))
    checks = check_points(
        sources, options.limits, saturation=pixels.saturation_level, correlation=fit.correlation,
        outlier_share=float(np.mean(fit.weight < 0.5)),
    )  # fmt: skip
    return _Answer(fit.model, sources, rejected, checks, fit=fit)


def _unlike(place: tuple[float, float], departure: float) -> RejectedSpot:
    return RejectedSpot(
        *place, "unlike",
        f"the blur of the others leaves {100 * departure:.0f} % of its peak: it is no point",
    )  # fmt: skip


def _gaussian(
    pixels: RegionPixels, places: Floats, rejected: _Rejected, options: PointsOptions
) -> _Answer:
    chosen = published_options(options, "gaussian-2003", SdsuMirrorsOptions)
    found = sdsu_2003_mirrors(_covered(pixels.pixels, rejected), places, chosen)
    origin = (pixels.box.row, pixels.box.col)
    sources = sources_of_mirrors(found, pixels.pixels, origin, chosen.window_px)
    checks = check_points(sources, options.limits, saturation=pixels.saturation_level)
    return _Answer(found.psf, sources, rejected, checks, published=found)


POINTS_METHODS: dict[str, Callable[[RegionPixels, Floats, _Rejected, PointsOptions], _Answer]] = {
    "psf-fit": _psf_fit,
    "gaussian-2003": _gaussian,
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
    roi : Region, Box, (row, col, height, width) or None
    positions : (n, 2) array_like, optional
        Approximate places (row, col) in the whole image, to 1.5 px; found in the image without.
    surveyed : (n, 2) array_like, optional
        Surveyed places (row, col), to be compared with the measured ones.
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
        If no source serves; the message counts why.
    """
    chosen = chosen_options(options, PointsOptions)
    if method not in POINTS_METHODS:
        known = ", ".join(POINTS_METHODS)
        raise OptionError(f"there is no points method {method!r}: choose one of {known}")
    pixels = read_region(image, roi, gsd_m)
    origin = np.array([pixels.box.row, pixels.box.col])
    wanted = None if positions is None else _places("positions", positions) - origin
    spots, rejected = _choose(pixels, wanted, chosen)
    places = np.array([(one.row, one.col) for one in spots])
    try:
        answer = POINTS_METHODS[method](pixels, places, rejected, chosen)
    except np.linalg.LinAlgError as error:
        raise TargetError(
            f"the {len(spots)} sources found are not explained by one point spread function, "
            "however wide: they are no points, or not of one kind; give their positions, or a "
            "region that holds nothing but mirrors or stars"
        ) from error
    gsd = None if pixels.gsd is None else (pixels.gsd.row_m, pixels.gsd.col_m)
    checks, survey = answer.checks, None
    if surveyed is not None:
        found = np.array([(one.row.value, one.col.value) for one in answer.sources])
        survey = survey_errors(
            found,
            _places("surveyed", surveyed),
            pixel_m=None if gsd is None else (gsd[1], gsd[0]),
            reference=survey_reference,
        )
        checks = (*checks, check_survey(survey, chosen.limits))
    return PointsMeasurement(
        kind="points",
        method=method,
        otf=Otf2d(answer.otf, gsd),
        snr=float(np.median([one.snr for one in answer.sources])),
        checks=checks,
        image=_info(pixels),
        options=chosen.to_dict(),
        sources=answer.sources,
        rejected=tuple(_shifted(one, origin) for one in answer.rejected),
        survey=survey,
        fit=answer.fit,
        published=answer.published,
        pixels=pixels.pixels,
    )


def _places(name: str, given: ArrayLike) -> Floats:
    places = np.asarray(given, float)
    if places.ndim != 2 or places.shape[0] == 0 or places.shape[1] != 2:
        raise OptionError(f"{name} have shape {places.shape}, they have to be (n, 2): row, column")
    if not np.isfinite(places).all():
        raise OptionError(f"{name} hold numbers that are not finite: leave those sources out")
    return places


def _choose(
    pixels: RegionPixels, wanted: Floats | None, options: PointsOptions
) -> tuple[tuple[Spot, ...], tuple[RejectedSpot, ...]]:
    """The spots to be fitted, and those that do not serve."""
    image = pixels.pixels
    everything, _, residual, noise = find_spots(image)
    spots = everything
    missing: tuple[RejectedSpot, ...] = ()
    if wanted is not None:
        spots, missing, _, _ = find_spots(image, wanted)
    kept, rejected = sort_spots(
        image, residual, spots,
        saturation=pixels.saturation_level, noise=noise, min_snr=options.min_snr,
        min_distance_px=options.min_distance_px, rivals=everything,
    )  # fmt: skip
    rejected = (*missing, *rejected)
    if not kept:
        raise TargetError(_nothing(rejected, options))
    by_peak = sorted(kept, key=lambda one: -one.peak)
    taken = by_peak[: options.max_sources]
    surplus = f"{options.max_sources} brighter ones were taken (max_sources)"
    left_out = [_left_out(one, surplus) for one in by_peak[options.max_sources :]]
    unasked = (one for one in everything if one not in spots and one.snr >= options.min_snr)
    left_out += [_left_out(one, "it is not among the places that were given") for one in unasked]
    return tuple(one for one in kept if one in taken), (*rejected, *left_out)


def _left_out(one: Spot, message: str) -> RejectedSpot:
    return RejectedSpot(one.row, one.col, "left out", message)


def _nothing(rejected: Sequence[RejectedSpot], options: PointsOptions) -> str:
    if not rejected:
        return (
            "no point source stands out of the noise: choose a region with sources, or a longer "
            "exposure"
        )
    reasons = [one.reason for one in rejected]
    counted = ", ".join(f"{reasons.count(one)} {one}" for one in dict.fromkeys(reasons))
    return (
        f"none of {len(rejected)} bright spots is a usable point source ({counted}): choose "
        f"another region, or ask less (min_snr {options.min_snr:g}, min_distance_px "
        f"{options.min_distance_px:g})"
    )


def _covered(image: Floats, rejected: Sequence[RejectedSpot]) -> Floats:
    """The image with NaN over what was rejected, lest its light disturb the sources."""
    height, width = image.shape
    clean = image.copy()
    for one in rejected:
        if one.reason not in ("no source", "edge"):
            reach = _COVERED_PX.get(one.reason, _COVERED_ELSE_PX)
            top, side = max(int(one.row - reach), 0), max(int(one.col - reach), 0)
            bottom = min(int(one.row + reach) + 2, height)
            right = min(int(one.col + reach) + 2, width)
            rows, cols = np.mgrid[top:bottom, side:right]
            part = (slice(top, bottom), slice(side, right))
            away = np.hypot(rows - one.row, cols - one.col)
            clean[part] = np.where(away <= reach, np.nan, clean[part])
    return clean


def _shifted(one: RejectedSpot, origin: Floats) -> RejectedSpot:
    """A rejected spot in pixels of the whole image."""
    row, col = origin.tolist()
    return RejectedSpot(one.row + row, one.col + col, one.reason, one.message)


def _info(pixels: RegionPixels) -> ImageInfo:
    gsd_m = None if pixels.gsd is None else pixels.gsd.along_normal(0.0)
    image = pixels.image
    return ImageInfo(image.path, image.band, gsd_m, pixels.box.as_tuple(), image.crs)
