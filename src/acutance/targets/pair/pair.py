"""Measure the MTF of a sensor from two images of the same ground at two resolutions.

The low image is ``gain * D(h * shift(high)) + offset``: the high image's samples, blurred by a
kernel h and sampled at the low pixels. The transfer of h is exactly MTF_low / MTF_high up to the
high image's Nyquist frequency, as far as that image is not aliased; times the high image's own
OTF it is the low sensor's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Estimate, Otf2d
from acutance.curves.grid import Floats
from acutance.errors import OptionError, TargetError
from acutance.numerics.one_thread import one_thread
from acutance.raster import Box, Gsd, Image, Region
from acutance.targets.measurement import ImageInfo
from acutance.targets.options import chosen_options, chosen_region
from acutance.targets.pair.axis_blur import AxisBlur
from acutance.targets.pair.checks import PairEvidence, check_pair
from acutance.targets.pair.first_fit import BlurFit, fit_blur
from acutance.targets.pair.grid import PairGrid, pair_grid
from acutance.targets.pair.kernel_fit import KernelFit, fit_kernel
from acutance.targets.pair.kernel_otf import KernelOtf
from acutance.targets.pair.local import fit_regions
from acutance.targets.pair.options import BiresolutionOptions
from acutance.targets.pair.pair_measurement import BiresolutionMeasurement
from acutance.targets.pair.reference import (
    ReferenceLike,
    known_curves,
    reference_otf,
    require_pixels,
)
from acutance.targets.pair.register import Registration, register
from acutance.targets.pair.screen import ScreenedTiles, screened
from acutance.targets.pair.spectral_ratio import PairSpectra, fit_spectra, pair_spectra
from acutance.targets.pair.tile import FAR_PX, core, first_of_cell
from acutance.targets.pair.tiles import PairTiles
from acutance.targets.region import RoiLike

__all__ = ["BIRESOLUTION_METHODS", "measure_biresolution"]

BIRESOLUTION_METHODS = ("kernel-fit", "spectral-ratio")
_LONG_REACH_PX = 7.0
_SHORT_REACH_PX = 4.5
_ROOM_PX = 56
_LARGEST_PX, _SMALLEST_PX = 64, 16
_SHOWN_PX = 384
_PILED_UP = 3.0
"""How many times as many pixels have the largest value as the hundredth of the scale below it, if
they were clipped."""


@one_thread
def measure_biresolution(
    low: Image | ArrayLike,
    high: Image | ArrayLike,
    *,
    ratio: float | None = None,
    roi: RoiLike = None,
    reference_mtf: ReferenceLike = None,
    method: str = "kernel-fit",
    options: BiresolutionOptions | None = None,
) -> BiresolutionMeasurement:
    """Measure the MTF of the low image's sensor against a finer image of the same ground.

    Parameters
    ----------
    low, high : Image or (rows, cols) array_like
        The image whose sensor is measured, and the reference. With geotransforms they tell how
        the images lie on each other; without, the first corners of both coincide.
    ratio : float, optional
        GSD of the low image over that of the high one; without it, that of the geotransforms or
        of the shapes.
    roi : Region, Box, (row, col, height, width) or None
        Where to look, in pixels of the low image.
    reference_mtf : Sensor, Measurement, Measurement2d, MeasuredCurves, Response, Mtf or float
        The high image's own MTF, in its own pixels; a number is its value at Nyquist. Without it
        the result is MTF_low / MTF_high, and a check says so.
    method : {"kernel-fit", "spectral-ratio"}, optional
        Least squares on the pixels, or the ratio of spectra weighted by coherence.
    options : BiresolutionOptions, optional

    Returns
    -------
    BiresolutionMeasurement
        Frequencies in cycles per pixel of the LOW image.

    Raises
    ------
    ImageError, OptionError
        If there are no images, or the ratio or another option makes no sense.
    RegionError
        If the images do not overlap, or too few low pixels have the high image around them.
    TargetError
        If the images hold no structure, or nothing in common.
    """
    if method not in BIRESOLUTION_METHODS:
        known = ", ".join(BIRESOLUTION_METHODS)
        raise OptionError(f"there is no bi-resolution method {method!r}: choose one of {known}")
    chosen = chosen_options(options, BiresolutionOptions)
    coarse, fine = _as_image(low), _as_image(high)
    geometry = pair_grid(coarse, fine, ratio)
    reference = reference_otf(reference_mtf, geometry.across.ratio, geometry.down.ratio)
    curves = known_curves(reference_mtf)
    require_pixels(curves, _high_gsd(coarse, fine, geometry))
    tiles, match = _registered(coarse, fine, geometry, _as_region(roi, coarse), chosen)
    noise = tiles.high_noise if chosen.noise_high is None else chosen.noise_high
    start = AxisBlur(match.shift_px[0]), AxisBlur(match.shift_px[1])
    shared = screened(tiles, tiles.taps, *start) if chosen.robust else ScreenedTiles(tiles, {}, 0)
    blur = fit_blur(
        shared, tiles.taps, *start,
        stop_change=chosen.stop_change, max_steps=chosen.max_steps, robust=chosen.robust,
    )  # fmt: skip
    _require_gain(blur, match)
    pixel_fit = fit_kernel(
        shared, tiles.taps, blur,
        processes=3 if tiles.reach_px > 0.5 * (_LONG_REACH_PX + _SHORT_REACH_PX) else 2,
        noise_high=noise, robust=chosen.robust,
    )  # fmt: skip
    pixel_fit = replace(pixel_fit, left_out=pixel_fit.left_out + shared.left_out)
    spectra = _spectra(tiles, shared, pixel_fit, blur)
    fit = pixel_fit
    if method == "spectral-ratio":
        if spectra is None:
            raise TargetError(
                "the region has too few whole windows for spectra: choose a "
                "larger one, or method kernel-fit"
            )
        fit = fit_spectra(spectra, pixel_fit, blur, noise_high=noise)
    shown = _Residuals(tiles.box)
    local = fit_regions(shared, tiles.taps, blur, pixel_fit, tiles.map_shape, shown.keep)
    model = KernelOtf(fit, tiles.grid.across.band_cpp, tiles.grid.down.band_cpp, reference)
    seen = PairEvidence(
        tiles.grid, blur, pixel_fit, model, spectra, local, _saturated(tiles), match.inverted,
        chosen.stop_change, None if curves is None else curves.only_direction,
    )  # fmt: skip
    gsd = coarse.gsd(*_middle(tiles.box))
    return BiresolutionMeasurement(
        kind="biresolution",
        method=method,
        otf=Otf2d(model, None if gsd is None else (gsd.row_m, gsd.col_m)),
        snr=_snr(blur, pixel_fit),
        checks=check_pair(seen, chosen.limits),
        image=_info(coarse, tiles.box),
        options={**chosen.to_dict(), "ratio": ratio, "reference_given": reference is not None},
        high=_info(fine, Box.whole(fine.shape)),
        grid=tiles.grid,
        shift_px=_shifts(blur, fit),
        gain=blur.gain,
        offset=blur.offset,
        blur=blur,
        fit=fit,
        pixel_fit=pixel_fit,
        spectra=spectra,
        local=local,
        residual=shown.field,
        residual_step=shown.step,
        share_read=tiles.share_read,
        high_noise=noise,
        reference_known=reference is not None,
    )


def _high_gsd(low: Image, high: Image, grid: PairGrid) -> Gsd | None:
    """GSD of the high image: its own, or the low one's by the ratio."""
    own, coarse = high.gsd(), low.gsd()
    if own is not None or coarse is None:
        return own
    return Gsd(coarse.row_m / grid.down.ratio, coarse.col_m / grid.across.ratio)


def _as_image(image: Image | ArrayLike) -> Image:
    return image if isinstance(image, Image) else Image.from_array(image)


def _as_region(roi: RoiLike, image: Image) -> Region | None:
    where = None if roi is None else chosen_region(roi)
    if where is None or isinstance(where, Region):
        return where
    where.require_inside(image.shape)
    return Region.from_box(where)


def _registered(
    low: Image, high: Image, grid: PairGrid, region: Region | None, options: BiresolutionOptions
) -> tuple[PairTiles, Registration]:
    """Tiles whose taps follow the displacement of the low content, found in steps of a pixel."""

    def tiles_at(place: PairGrid, reach_px: float) -> PairTiles:
        return PairTiles(low, high, place, region, reach_px, options.max_pixels)

    first = tiles_at(grid, _SHORT_REACH_PX)
    found = _matched(first, options.max_shift_px)
    if found.correlation <= 0:
        raise TargetError(
            "the two images have no structure in common within "
            f"{options.max_shift_px} low pixels: one is uniform, or they show different ground; "
            "check the pair, the ratio and the geotransforms"
        )
    if found.at_limit:
        raise TargetError(
            f"the images match best with a shift of {found.shift_px[0]:.1f} rows and "
            f"{found.shift_px[1]:.1f} columns, at the end of the {options.max_shift_px} low pixels "
            "looked at: they may lie further apart, look further (max_shift_px, --max-shift); or "
            "they show different ground"
        )
    placed = grid.shifted((round(found.shift_px[0]), round(found.shift_px[1])))
    reach = options.reach_px
    if reach is None:
        long = placed.down.inner(_LONG_REACH_PX), placed.across.inner(_LONG_REACH_PX)
        wanted = first.box if region is None else region.box(low.shape)
        room = min(
            min(stop, start_px + size) - max(start, start_px)
            for (start, stop), start_px, size in zip(
                long, (wanted.row, wanted.col), wanted.shape, strict=True
            )
        )
        reach = _LONG_REACH_PX if room >= _ROOM_PX else _SHORT_REACH_PX
    return tiles_at(placed, reach), found


def _matched(tiles: PairTiles, max_shift_px: int) -> Registration:
    """The best match over some tiles: that of the tile where it is the clearest."""
    best = Registration((0.0, 0.0), 0.0, False)
    for tile in tiles.some(9):
        height, width = tile.low.shape
        under = tile.wide[FAR_PX : FAR_PX + height, FAR_PX : FAR_PX + width]
        if np.isfinite(tile.low).sum() < 64:
            continue
        found = register(tile.low, under, max_shift_px)
        if found.correlation > best.correlation:
            best = found
    # The means under the low pixels are not centred on these.
    away = [axis.offset_px + (first_of_cell(axis) + 0.5 * (axis.per_px - 1)) / axis.per_px
            for axis in (tiles.taps.down, tiles.taps.across)]  # fmt: skip
    return replace(best, shift_px=(best.shift_px[0] - away[0], best.shift_px[1] - away[1]))


def _require_gain(blur: BlurFit, match: Registration) -> None:
    if blur.gain > 0 and blur.correlation > 0.05:
        return
    raise TargetError(
        f"the low image follows the high one with gain {blur.gain:.3g} and correlation "
        f"{blur.correlation:.3f}"
        + (", brighter where that is darker" if blur.gain < 0 else "")
        + ": bands, dates or places differ too much for a measurement; choose a similar band"
    )


def _spectra(
    tiles: PairTiles, shared: ScreenedTiles, fit: KernelFit, blur: BlurFit
) -> PairSpectra | None:
    """Spectra in the largest windows of which two fit into a tile either way."""
    side = min(min(box.shape) for box in tiles.boxes)
    size = min(_LARGEST_PX, 2 * (side // 3))
    if size < _SMALLEST_PX:
        return None
    return pair_spectra(shared(), fit.residuals(shared), tiles.taps, blur, size)


def _shifts(blur: BlurFit, fit: KernelFit) -> tuple[Estimate, Estimate]:
    """Displacement of the kernel: that of its centre, with its standard deviation."""
    step = 1e-4
    nothing, some = np.zeros(2), np.array([0.0, step])
    stds = []
    for u, v in ((nothing, some), (some, nothing)):
        transfer = fit.basis.transfer(u, v)
        value = transfer @ fit.beta
        moves = (transfer[1] / value[1] - transfer[0] / value[0]).imag / (2 * np.pi * step)
        stds.append(float(np.linalg.norm(moves @ fit.posterior.factor)))
    return Estimate(blur.down.shift_px, stds[0]), Estimate(blur.across.shift_px, stds[1])


def _snr(blur: BlurFit, fit: KernelFit) -> float:
    """Standard deviation of the low image's detail over that of the residuals."""
    if not fit.noise > 0:
        return float("inf")
    return blur.signal / fit.noise


def _saturated(tiles: PairTiles) -> float:
    """Share of either image's pixels at the end of the scale, or piled up at their own largest."""
    low = np.concatenate([core(tile.low)[np.isfinite(core(tile.low))] for tile in tiles.some(16)])
    high = np.concatenate([tile.fine.ravel() for tile in tiles.some(16)])
    return max(
        _clipped(low, tiles.low.saturation_level), _clipped(high, tiles.high.saturation_level)
    )


def _clipped(values: Floats, level: float | None) -> float:
    top = float(values.max())
    share = float(np.mean(values == top))
    room = 0.01 * float(np.ptp(values))
    piled_up = share > _PILED_UP * float(np.mean((values >= top - room) & (values < top)))
    return share if piled_up or (level is not None and top >= level) else 0.0


def _middle(box: Box) -> tuple[float, float]:
    return box.row + box.height / 2, box.col + box.width / 2


def _info(image: Image, box: Box) -> ImageInfo:
    gsd = image.gsd(*_middle(box))
    gsd_m = None if gsd is None else gsd.col_m
    return ImageInfo(image.path, image.band, gsd_m, box.as_tuple(), image.crs)


class _Residuals:
    """Residuals of all tiles in one thinned field."""

    def __init__(self, box: Box) -> None:
        self.box = box
        self.step = max(1, -(-max(box.shape) // _SHOWN_PX))
        self.field: Floats = np.full([-(-size // self.step) for size in box.shape], np.nan)

    def keep(self, place: tuple[int, int], residual: Floats) -> None:
        """Put a tile's residual in its place."""
        rows = np.arange(residual.shape[0]) + place[0] - self.box.row
        cols = np.arange(residual.shape[1]) + place[1] - self.box.col
        down = (rows >= 0) & (rows < self.box.height) & (rows % self.step == 0)
        across = (cols >= 0) & (cols < self.box.width) & (cols % self.step == 0)
        part = residual[np.ix_(down, across)]
        places = np.ix_(rows[down] // self.step, cols[across] // self.step)
        self.field[places] = np.where(np.isfinite(part), part, self.field[places])
