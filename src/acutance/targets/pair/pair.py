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
from acutance.errors import TargetError
from acutance.numerics.clipping import clipped_share
from acutance.numerics.one_thread import one_thread
from acutance.raster import Box, Gsd, Image, Region
from acutance.targets.options import chosen_options, require_known_method
from acutance.targets.pair import tuned
from acutance.targets.pair.axis_gaussian import AxisGaussian
from acutance.targets.pair.checks import check_pair
from acutance.targets.pair.equal_blur import blur_difference
from acutance.targets.pair.gaussian_fit import GaussianFit, fit_gaussian
from acutance.targets.pair.grid import PairGrid, pair_grid
from acutance.targets.pair.kernel_fit import KernelFit, fit_kernel
from acutance.targets.pair.kernel_otf import KernelOtf
from acutance.targets.pair.local import fit_regions
from acutance.targets.pair.options import BiresolutionOptions
from acutance.targets.pair.pair_measurement import (
    BiresolutionMeasurement,
    Coherence,
    PairDetails,
)
from acutance.targets.pair.reference import ReferenceLike, reference_otf
from acutance.targets.pair.reference_otf import ReferenceOtf
from acutance.targets.pair.register import Registration, look_further, registered_tiles
from acutance.targets.pair.residual_slopes import noise_products, residual_slopes
from acutance.targets.pair.screen import ScreenedTiles, screened
from acutance.targets.pair.spectral_ratio import PairSpectra, fit_spectra, pair_spectra
from acutance.targets.pair.tile import TapGrid, core
from acutance.targets.pair.tiles import PairTiles
from acutance.targets.region import RoiLike, chosen_region, image_info

__all__ = ["BIRESOLUTION_METHODS", "measure_biresolution"]

BIRESOLUTION_METHODS = ("kernel-fit", "spectral-ratio")
_MAX_WINDOW_PX, _MIN_WINDOW_PX = 64, 16
_SOME_TILES = 16
_MIN_CORRELATION = 0.05


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
        The image whose sensor is measured, and the reference. Geotransforms give how the images lie
        on each other; without them the first corners of both coincide.
    ratio : float, optional
        GSD of the low image over that of the high one; without it, that of the geotransforms or
        of the shapes.
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        Where to look, in pixels of the low image.
    reference_mtf : Sensor, Measurement, TargetResult, Record, MeasuredCurves, Mtf or float
        The high image's own MTF, in its own pixels; a number is its value at Nyquist. Without it
        the result is MTF_low / MTF_high, and a check fails for it.
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
    NoDataError
        If one of them holds next to no data.
    """
    require_known_method("bi-resolution", method, BIRESOLUTION_METHODS)
    chosen = chosen_options(options, BiresolutionOptions)
    coarse, fine = Image.of(low), Image.of(high)
    grid = pair_grid(coarse, fine, ratio)
    reference = _reference(reference_mtf, coarse, fine, grid)
    tiles, match = registered_tiles(coarse, fine, grid, _as_region(roi, coarse), chosen)
    ground, gaussian = _gaussian(tiles, match, chosen)
    pixel_fit = _pixel_fit(tiles, ground, gaussian, reference, chosen)
    spectra = _spectra(tiles, ground, pixel_fit, gaussian)
    fit = pixel_fit if method == "kernel-fit" else fit_spectra(spectra, pixel_fit)
    model = KernelOtf.of_fit(
        fit, (tiles.grid.across.band_cpp, tiles.grid.down.band_cpp), reference
    )  # fmt: skip
    slopes = list(residual_slopes(ground, tiles.taps, gaussian, pixel_fit))
    noise = pixel_fit.high_noise.power * noise_products(tiles.taps, gaussian, pixel_fit)
    local, residuals = fit_regions(slopes, tiles.map_shape, tiles.box, noise)
    info = image_info(coarse, tiles.box, coarse.gsd(*_middle(tiles.box)))
    return BiresolutionMeasurement(
        kind="biresolution",
        method=method,
        transfer=Otf2d(model, info.pixel_gsd_m),
        snr=_snr(gaussian, pixel_fit),
        checks=check_pair(
            tiles.grid, gaussian, pixel_fit, model, spectra, local,
            blur_difference(slopes, tiles.taps, gaussian, pixel_fit), chosen.limits,
            stop_change=chosen.stop_change, clipped=_clipped(tiles), fills=tiles.fills(),
            defects=tiles.defects, images=tiles.parts, info=info, inverted=match.inverted,
        ),
        image=info,
        options={**chosen.to_dict(), "ratio": ratio, "reference_given": reference is not None},
        high=image_info(fine, Box.whole(fine.shape), fine.gsd(*_middle(Box.whole(fine.shape)))),
        grid=tiles.grid,
        shift_px=_shifts(gaussian, fit),
        gain=gaussian.gain,
        offset=gaussian.offset,
        steps=tuple(gaussian.steps),
        used=pixel_fit.used,
        left_out=pixel_fit.left_out,
        share_read=tiles.share_read,
        residual_std=pixel_fit.noise,
        high_noise=pixel_fit.high_noise.times(1 / tiles.noise_stretch).std,
        coherence=None if spectra is None else Coherence.of(spectra),
        local=local,
        reference_known=reference is not None,
        details=PairDetails(gaussian, fit, pixel_fit, spectra, residuals),
    )  # fmt: skip


def _as_region(roi: RoiLike, image: Image) -> Region | None:
    where = None if roi is None else chosen_region(roi)
    if where is None or isinstance(where, Region):
        return where
    where.require_inside(image.shape)
    return Region.from_box(where)


def _reference(
    reference: ReferenceLike, low: Image, high: Image, grid: PairGrid
) -> ReferenceOtf | None:
    """The high image's own OTF, where it was given; its pixels' GSD may follow from the ratio."""
    gsd, coarse = high.gsd(), low.gsd()
    if gsd is None and coarse is not None:
        gsd = Gsd(coarse.row_m / grid.down.ratio, coarse.col_m / grid.across.ratio)
    return reference_otf(reference, grid.across.ratio, grid.down.ratio, gsd)


def _gaussian(
    tiles: PairTiles, match: Registration, options: BiresolutionOptions
) -> tuple[ScreenedTiles, GaussianFit]:
    """The parametric fit, and the tiles without what shows other ground.

    Raises
    ------
    TargetError
        If the low image does not follow the high one.
    """
    axes = AxisGaussian(match.shift_px[0]), AxisGaussian(match.shift_px[1])
    ground = ScreenedTiles(tiles, {}, 0)
    if options.robust:
        ground = screened(tiles, tiles.taps, *axes)
    found = fit_gaussian(
        ground, tiles.taps, *axes,
        stop_change=options.stop_change, max_steps=options.max_steps, robust=options.robust,
    )  # fmt: skip
    if found.gain <= 0 or found.correlation <= _MIN_CORRELATION:
        raise TargetError(
            f"the low image follows the high one with gain {found.gain:.3g} and correlation "
            f"{found.correlation:.3f}"
            + (", brighter where that is darker" if found.gain < 0 else "")
            + ": bands, dates or places differ too much for a measurement; choose a similar band; "
            + look_further(match, options)
        )
    _require_within_taps(found, tiles.taps, look_further(match, options))
    return ground, found


def _require_within_taps(found: GaussianFit, taps: TapGrid, advice: str) -> None:
    """Refuse a fit that moved the kernel off the samples it acts on."""
    for axis, name in ((found.down, "rows"), (found.across, "columns")):
        places = (taps.down if name == "rows" else taps.across).places_px
        if not places[0] <= -axis.shift_px <= places[-1]:
            raise TargetError(
                f"the parametric fit moved the low image by {axis.shift_px:.1f} pixels along its "
                f"{name}, off the high image's samples, which were taken {places[0]:.1f} to "
                f"{places[-1]:.1f} pixels from its own: the two have too little in common to be "
                f"registered; choose a region with more structure; {advice}"
            )


def _pixel_fit(
    tiles: PairTiles,
    ground: ScreenedTiles,
    gaussian: GaussianFit,
    reference: ReferenceOtf | None,
    options: BiresolutionOptions,
) -> KernelFit:
    """The free kernel that fits the pixels.

    Raises
    ------
    TargetError
        If they determine none, as less the noise that is stated.
    """
    try:
        found = fit_kernel(
            ground, tiles.taps, gaussian,
            reference=reference,
            processes=3 if tiles.reach_px > tuned.HALO_REACH_PX else 2,
            high_noise=tiles.high_noise(options.noise_high),
            robust=options.robust,
        )  # fmt: skip
    except TargetError as error:
        if options.noise_high is None:
            raise
        estimated = tiles.high_noise(None).times(1 / tiles.noise_stretch).std
        raise TargetError(
            f"{error}; a noise of {options.noise_high:g} was stated of the high image, whose own "
            f"is estimated as {estimated:.3g}: state less (noise_high, --high-noise), or none"
        ) from error
    return replace(found, left_out=found.left_out + ground.left_out + tiles.defects[0])


def _spectra(
    tiles: PairTiles, ground: ScreenedTiles, fit: KernelFit, gaussian: GaussianFit
) -> PairSpectra | None:
    """Spectra in the largest windows of which two fit into a tile either way."""
    side = min(min(box.shape) for box in tiles.boxes)
    size = min(_MAX_WINDOW_PX, 2 * (side // 3))
    if size < _MIN_WINDOW_PX:
        return None
    return pair_spectra(ground(), fit.residuals(ground), tiles.taps, gaussian, size)


def _shifts(gaussian: GaussianFit, fit: KernelFit) -> tuple[Estimate, Estimate]:
    """Displacement of the kernel: that of its centre, with its standard deviation."""
    step = 1e-4
    nothing, some = np.zeros(2), np.array([0.0, step])
    stds = []
    for u, v in ((nothing, some), (some, nothing)):
        transfer = fit.basis.transfer(u, v)
        value = transfer @ fit.beta
        slopes = (transfer[1] / value[1] - transfer[0] / value[0]).imag / (2 * np.pi * step)
        stds.append(float(np.linalg.norm(slopes @ fit.posterior.factor)))
    down, across = gaussian.down.shift_px, gaussian.across.shift_px
    return Estimate(down, stds[0]), Estimate(across, stds[1])


def _snr(gaussian: GaussianFit, fit: KernelFit) -> float:
    """Standard deviation of the low image's detail over that of the residuals."""
    return gaussian.signal / fit.noise if fit.noise > 0 else float("inf")


def _clipped(tiles: PairTiles) -> float:
    """Share of clipped pixels of the image that has more of them."""
    low = np.concatenate([_known(core(tile.low)) for tile in tiles.some(_SOME_TILES)])
    high = np.concatenate([_known(tile.fine) for tile in tiles.some(_SOME_TILES)])
    return max(
        clipped_share(low, tiles.low.saturation_level),
        clipped_share(high, tiles.high.saturation_level),
    )


def _known(values: Floats) -> Floats:
    return values[np.isfinite(values)]


def _middle(box: Box) -> tuple[float, float]:
    return box.row + box.height / 2, box.col + box.width / 2
