"""The evidence of a measurement of points: every source, and what the fit leaves of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.points.fit import PointsFit
from acutance.targets.points.published import MirrorFit, PublishedMirrors

__all__ = ["PointSource", "sources_of_fit", "sources_of_mirrors"]

_SHOWN_PX = 7


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
        Level of the ground at its place.
    slope : (float, float)
        How the ground rises from row to row and from column to column.
    snr : float
        Peak over the background's noise.
    misfit : float
        Root mean square residual within three pixels, over the noise.
    origin : (int, int)
        Row and column, in the whole image, of the first pixel of the arrays.
    pixels, residual : (rows, cols) arrays
        The pixels around it, and what the fit leaves of those it used; NaN elsewhere.
    """

    row: Estimate
    col: Estimate
    flux: Estimate
    peak: float
    background: Estimate
    slope: tuple[float, float]
    snr: float
    misfit: float
    origin: tuple[int, int]
    pixels: Floats
    residual: Floats

    @property
    def phase(self) -> tuple[float, float]:
        """Place within the pixel, (row, col), -0.5 to 0.5."""
        row, col = self.row.value, self.col.value
        return row - round(row), col - round(col)

    def to_dict(self) -> dict[str, Any]:
        """Numbers of the source, for JSON."""
        return {
            "row": self.row.to_dict(),
            "col": self.col.to_dict(),
            "flux": self.flux.to_dict(),
            "peak": self.peak,
            "background": self.background.to_dict(),
            "background_slope": list(self.slope),
            "snr": self.snr if math.isfinite(self.snr) else None,
            "misfit": self.misfit if math.isfinite(self.misfit) else None,
        }


def sources_of_fit(
    fit: PointsFit, image: Floats, origin: tuple[int, int]
) -> tuple[PointSource, ...]:
    """The sources of the joint fit; `origin` is the place of the cut in the whole image."""
    stamps = fit.stamps
    left = np.full(image.shape, np.nan)
    left[stamps.row.astype(np.intp), stamps.col.astype(np.intp)] = fit.residual
    x, y = stamps.offsets(fit.places)
    core = np.hypot(x, y) <= 3.0
    standard = fit.residual[core] / np.maximum(fit.pixel_noise[core], 1e-300)
    power = np.bincount(stamps.owner[core], standard**2, fit.fluxes.size)
    count = np.bincount(stamps.owner[core], minlength=fit.fluxes.size)
    misfit = np.sqrt(power / np.maximum(count, 1))
    peaks = fit.peaks
    found = []
    for k, place in enumerate(fit.places):
        at, pixels, residual = _stamp(place, image, left)
        found.append(
            PointSource(
                Estimate(float(place[0]) + origin[0], float(fit.places_std[k, 0])),
                Estimate(float(place[1]) + origin[1], float(fit.places_std[k, 1])),
                Estimate(float(fit.fluxes[k]), float(fit.fluxes_std[k])),
                float(peaks[k]),
                Estimate(float(fit.grounds[k, 0]), float(fit.grounds_std[k])),
                (float(fit.grounds[k, 1]), float(fit.grounds[k, 2])),
                float(peaks[k]) / fit.noise if fit.noise > 0 else math.inf,
                float(misfit[k]),
                (at[0] + origin[0], at[1] + origin[1]),
                pixels,
                residual,
            )
        )
    return tuple(found)


def sources_of_mirrors(
    found: PublishedMirrors, image: Floats, origin: tuple[int, int], window_px: int
) -> tuple[PointSource, ...]:
    """The sources of the published method, with the residuals of their own Gaussians."""
    noise = max(found.noise_std, 1e-300)
    return tuple(_source_of(one, image, origin, window_px, noise) for one in found.mirrors)


def _source_of(
    one: MirrorFit, image: Floats, origin: tuple[int, int], window_px: int, noise: float
) -> PointSource:
    rows, cols = np.indices(image.shape)
    power = ((cols - one.col) / one.sigma_x_px) ** 2 + ((rows - one.row) / one.sigma_y_px) ** 2
    fitted = one.bias + one.peak * np.exp(-0.5 * power)
    inside = np.maximum(np.abs(rows - round(one.row)), np.abs(cols - round(one.col)))
    left = np.where(inside <= window_px // 2, image - fitted, np.nan)
    at, pixels, residual = _stamp(np.array([one.row, one.col]), image, left)
    volume = 2 * math.pi * one.sigma_x_px * one.sigma_y_px
    misfit = float(np.sqrt(np.nanmean(residual**2))) / noise
    return PointSource(
        Estimate(one.row + origin[0], one.row_std),
        Estimate(one.col + origin[1], one.col_std),
        Estimate(volume * one.peak, math.nan),
        one.peak,
        Estimate(one.bias, noise),
        (0.0, 0.0),
        one.peak / noise,
        misfit,
        (at[0] + origin[0], at[1] + origin[1]),
        pixels,
        residual,
    )


def _stamp(place: Floats, image: Floats, left: Floats) -> tuple[tuple[int, int], Floats, Floats]:
    row, col = (round(number) for number in place.tolist())
    top, side = max(row - _SHOWN_PX, 0), max(col - _SHOWN_PX, 0)
    rows, cols = slice(top, row + _SHOWN_PX + 1), slice(side, col + _SHOWN_PX + 1)
    return (top, side), image[rows, cols].copy(), left[rows, cols].copy()
