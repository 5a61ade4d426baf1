"""The sources of a measurement: numbers of each, and the pixels around it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.points.points_fit import PointsFit
from acutance.targets.points.published import MirrorFit, PublishedMirrors

__all__ = ["PointSource", "SourceStamp", "sources_of_fit", "sources_of_mirrors"]

_SHOWN_PX = 7
_CORE_PX = 3.0


@dataclass(frozen=True, eq=False)
class PointSource(ShortRepr):
    """One source as it was fitted.

    Parameters
    ----------
    row, col : Estimate
        Its place, in pixels of the whole image.
    flux : Estimate
        Its light, summed over all pixels.
    peak : float
        What it would add to a pixel right under it.
    background : Estimate
        Level of the background at its place.
    slope : (float, float)
        How the background rises from row to row and from column to column.
    snr : float
        Peak over the background's noise.
    misfit : float
        Root mean square residual within three pixels, over the noise.
    """

    row: Estimate
    col: Estimate
    flux: Estimate
    peak: float
    background: Estimate
    slope: tuple[float, float]
    snr: float
    misfit: float

    @property
    def phase(self) -> tuple[float, float]:
        """Place within the pixel, (row, col), -0.5 to 0.5."""
        row, col = self.row.value, self.col.value
        return row - round(row), col - round(col)

    def to_dict(self) -> dict[str, Any]:
        """Numbers of the source, for JSON."""
        slope_row, slope_col = self.slope
        return {
            "row": _document(self.row),
            "col": _document(self.col),
            "flux": _document(self.flux),
            "peak": float(f"{self.peak:.6g}"),
            "background": _document(self.background),
            "background_slope": [float(f"{slope_row:.6g}"), float(f"{slope_col:.6g}")],
            "snr": float(f"{self.snr:.6g}") if math.isfinite(self.snr) else None,
            "misfit": float(f"{self.misfit:.6g}") if math.isfinite(self.misfit) else None,
        }


def _document(number: Estimate) -> dict[str, Any]:
    """A number for JSON, with a thousandth of its standard deviation as its last digit."""
    document = number.to_dict()
    if not (math.isfinite(number.std) and number.std > 0):
        return document
    digits = 3 - math.floor(math.log10(number.std))
    low, high = number.interval(0.95)
    interval = [round(low, digits), round(high, digits)]
    value, std = round(number.value, digits), round(number.std, digits)
    return {**document, "value": value, "std": std, "interval95": interval}


@dataclass(frozen=True, eq=False)
class SourceStamp(ShortRepr):
    """The pixels around a source.

    Parameters
    ----------
    origin : (int, int)
        Row and column, in the whole image, of the first pixel.
    pixels : (rows, cols) array
    residual : (rows, cols) array
        What the fit leaves of the pixels it used; NaN elsewhere.
    """

    origin: tuple[int, int]
    pixels: Floats
    residual: Floats


def sources_of_fit(
    fit: PointsFit, image: Floats, origin: tuple[int, int]
) -> tuple[tuple[PointSource, ...], tuple[SourceStamp, ...]]:
    """The sources of the joint fit.

    Parameters
    ----------
    fit : PointsFit
    image : (rows, cols) array
        The region.
    origin : (int, int)
        Row and column of its first pixel in the whole image.
    """
    stamps, count = fit.stamps, fit.fluxes.size
    residual = np.full(image.shape, np.nan)
    residual[stamps.row.astype(np.intp), stamps.col.astype(np.intp)] = fit.residual
    x, y = stamps.offsets(fit.places)
    core = np.hypot(x, y) <= _CORE_PX
    standard = fit.residual[core] / np.maximum(fit.pixel_noise[core], 1e-300)
    power = np.bincount(stamps.owner[core], standard**2, count)
    misfit = np.sqrt(power / np.maximum(np.bincount(stamps.owner[core], minlength=count), 1))
    peaks = fit.peaks
    sources = tuple(
        PointSource(
            Estimate(float(place[0]) + origin[0], float(fit.places_std[k, 0])),
            Estimate(float(place[1]) + origin[1], float(fit.places_std[k, 1])),
            Estimate(float(fit.fluxes[k]), float(fit.fluxes_std[k])),
            float(peaks[k]),
            Estimate(float(fit.backgrounds[k, 0]), float(fit.backgrounds_std[k])),
            (float(fit.backgrounds[k, 1]), float(fit.backgrounds[k, 2])),
            float(peaks[k]) / fit.noise if fit.noise > 0 else math.inf,
            float(misfit[k]),
        )
        for k, place in enumerate(fit.places)
    )
    return sources, tuple(
        _stamp((row, col), image, residual, origin) for row, col in fit.places.tolist()
    )


def sources_of_mirrors(
    found: PublishedMirrors, image: Floats, origin: tuple[int, int], window_px: int
) -> tuple[tuple[PointSource, ...], tuple[SourceStamp, ...]]:
    """The sources of the published method, with the residuals of their own Gaussians."""
    noise = max(found.aligned.background_std, 1e-300)
    stamps = tuple(_stamp_of_mirror(one, image, origin, window_px) for one in found.mirrors)
    sources = tuple(
        PointSource(
            Estimate(one.row + origin[0], one.row_std),
            Estimate(one.col + origin[1], one.col_std),
            Estimate(2 * math.pi * one.sigma_x_px * one.sigma_y_px * one.peak, math.nan),
            one.peak,
            Estimate(one.bias, noise),
            (0.0, 0.0),
            one.peak / noise,
            float(np.sqrt(np.nanmean(stamp.residual**2))) / noise,
        )
        for one, stamp in zip(found.mirrors, stamps, strict=True)
    )
    return sources, stamps


def _stamp_of_mirror(
    one: MirrorFit, image: Floats, origin: tuple[int, int], window_px: int
) -> SourceStamp:
    rows, cols = np.ogrid[: image.shape[0], : image.shape[1]]
    reach = window_px // 2
    window = (np.abs(rows - round(one.row)) <= reach) & (np.abs(cols - round(one.col)) <= reach)
    at_row, at_col = np.nonzero(window)
    residual = np.full(image.shape, np.nan)
    residual[window] = image[window] - one.at(at_col, at_row)
    return _stamp((one.row, one.col), image, residual, origin)


def _stamp(
    place: tuple[float, float], image: Floats, residual: Floats, origin: tuple[int, int]
) -> SourceStamp:
    row, col = (round(number) for number in place)
    top, left = max(row - _SHOWN_PX, 0), max(col - _SHOWN_PX, 0)
    part = (slice(top, row + _SHOWN_PX + 1), slice(left, col + _SHOWN_PX + 1))
    return SourceStamp(
        (top + origin[0], left + origin[1]), image[part].copy(), residual[part].copy()
    )
