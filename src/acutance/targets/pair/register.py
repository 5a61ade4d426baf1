"""Where the low image's content lies against the high one's, to a fraction of a low pixel.

The match is found on the means of the high image over low pixels; the tiles that are measured then
follow it in whole pixels, and the fits the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft
from scipy.ndimage import uniform_filter

from acutance.curves.grid import Floats
from acutance.errors import NoDataError, TargetError
from acutance.numerics.noise import robust_scale
from acutance.raster import Image, Region
from acutance.targets.pair import tuned
from acutance.targets.pair.grid import PairGrid
from acutance.targets.pair.options import MAX_SHIFT_PX, BiresolutionOptions
from acutance.targets.pair.tile import FAR_PX, first_of_cell
from acutance.targets.pair.tiles import PairTiles

__all__ = ["Registration", "look_further", "register", "registered_tiles"]

_LOCAL_PX = 9
_BOUND_SIGMAS = 3.0
_ROUNDING = 1e-9
_MIN_PIXELS = 64
_TILES = 9


@dataclass(frozen=True)
class Registration:
    """The best match of two images.

    Parameters
    ----------
    shift_px : (float, float)
        Displacement (rows, columns) of the low content.
    correlation : float
        Of the images without their local means, at that shift.
    inverted : bool
        Whether a match with opposite sign is the stronger one.
    reach_px : int
        The largest shift that was looked at, along rows and along columns.
    at_limit : bool
        Whether it lies at the end of that range, so that the best may be beyond.
    """

    shift_px: tuple[float, float]
    correlation: float
    inverted: bool
    reach_px: int = 0
    at_limit: bool = False


def register(low: Floats, high: Floats, max_shift_px: int) -> Registration:
    """Match two images of the same pixels by the peak of their correlation.

    Parameters
    ----------
    low, high : (h, w) arrays
        NaN where unusable. `high` is the reference averaged over low pixels.
    max_shift_px : int
        The largest shift that is looked for; half of a small image is the most.
    """
    a, b = _detail(low), _detail(high)
    power = math.sqrt(float(np.sum(a * a)) * float(np.sum(b * b)))
    if power == 0:
        return Registration((0.0, 0.0), 0.0, False)
    reach = min(max_shift_px, min(low.shape) // 2 - 1)
    shape = [fft.next_fast_len(size + reach) for size in low.shape]
    product = fft.rfft2(a, shape) * np.conj(fft.rfft2(b, shape))
    match = fft.irfft2(product, shape) / power
    order = np.arange(-reach, reach + 1)
    near = match[np.ix_(order, order)]
    i, j = (int(k) for k in np.unravel_index(int(np.argmax(near)), near.shape))
    shift = tuple(float(order[k]) + _vertex(line, k) for k, line in ((i, near[:, j]), (j, near[i])))
    return Registration(
        (shift[0], shift[1]), float(near[i, j]), bool(-near.min() > near.max()), reach,
        reach > 0 and max(abs(int(order[i])), abs(int(order[j]))) == reach,
    )  # fmt: skip


def registered_tiles(
    low: Image,
    high: Image,
    grid: PairGrid,
    region: Region | None,
    options: BiresolutionOptions,
) -> tuple[PairTiles, Registration]:
    """Tiles whose taps follow the displacement of the low content, found in steps of a pixel.

    Parameters
    ----------
    low, high : Image
    grid : PairGrid
        As the geometry has it.
    region : Region or None
        Where to look in the low image.
    options : BiresolutionOptions

    Raises
    ------
    TargetError
        If the images have nothing in common, or match best at the end of what was looked at.
    NoDataError
        If one of them holds next to no data.
    RegionError
        If too few low pixels have the high image around them.
    """
    first = PairTiles(
        low, high, grid, region, tuned.SHORT_REACH_PX, options.max_pixels, not options.robust
    )
    found = _best_match(first, options.max_shift_px)
    if found.correlation <= 0:
        _require_data(first)
        raise TargetError(
            "the two images have no structure in common within "
            f"{options.max_shift_px} low pixels: one is uniform, or they show different ground; "
            "check the pair, the ratio and the geotransforms"
        )
    if found.at_limit:
        raise TargetError(
            f"the images match best with a shift of {found.shift_px[0]:.1f} rows and "
            f"{found.shift_px[1]:.1f} columns, at the end of the {found.reach_px} low pixels "
            f"looked at: {look_further(found, options)}; or they show different ground"
        )
    placed = grid.shifted((round(found.shift_px[0]), round(found.shift_px[1])))
    reach_px = options.reach_px
    if reach_px is None:
        reach_px = _reach_with_room(placed, first, region)
    return replace(first, grid=placed, reach_px=reach_px), found


def look_further(match: Registration, options: BiresolutionOptions) -> str:
    """What to do where images may lie further apart than was looked at."""
    if match.reach_px < options.max_shift_px:
        choice = "choose a larger region (half of a tile is looked at, of up to 96 pixels)"
    elif match.reach_px < MAX_SHIFT_PX:
        choice = f"look further (max_shift_px, --max-shift, up to {MAX_SHIFT_PX})"
    else:
        choice = "correct their geotransforms, or cut both to the same ground"
    return f"if they lie further apart than the {match.reach_px} low pixels looked at, {choice}"


def _reach_with_room(grid: PairGrid, tiles: PairTiles, region: Region | None) -> float:
    """The long reach where enough low pixels have the high image so far around them."""
    wanted = tiles.box if region is None else region.box(tiles.low.shape)
    room = []
    for axis, first, size in zip(
        (grid.down, grid.across), (wanted.row, wanted.col), wanted.shape, strict=True
    ):
        start, stop = axis.inner(tuned.LONG_REACH_PX)
        room.append(min(stop, first + size) - max(start, first))
    return tuned.LONG_REACH_PX if min(room) >= tuned.LONG_REACH_ROOM_PX else tuned.SHORT_REACH_PX


def _best_match(tiles: PairTiles, max_shift_px: int) -> Registration:
    """The best match over some tiles: that of the tile where it is the clearest."""
    best = Registration((0.0, 0.0), 0.0, False)
    for tile in tiles.some(_TILES):
        height, width = tile.low.shape
        means = tile.wide[FAR_PX : FAR_PX + height, FAR_PX : FAR_PX + width]
        if np.isfinite(tile.low).sum() < _MIN_PIXELS:
            continue
        found = register(tile.low, means, max_shift_px)
        if found.correlation > best.correlation:
            best = found
    # The means over the low pixels are not centred on these.
    away = [axis.offset_px + (first_of_cell(axis) + 0.5 * (axis.per_px - 1)) / axis.per_px
            for axis in (tiles.taps.down, tiles.taps.across)]  # fmt: skip
    return replace(best, shift_px=(best.shift_px[0] - away[0], best.shift_px[1] - away[1]))


def _require_data(tiles: PairTiles) -> None:
    """Refuse images that have nothing in common because one of them holds no data."""
    for name, is_empty, option in zip(
        ("low", "high"), tiles.are_empty(), ("--nodata", "--high-nodata"), strict=True
    ):
        if is_empty:
            raise NoDataError(
                f"the {name} image holds no data where the two overlap: choose another region, or "
                f"correct its nodata value if pixels that have it are data (nodata, {option}; nan: "
                "every value is data)"
            )


def _detail(image: Floats) -> Floats:
    """An image minus its local mean, outliers bounded, 0 where unusable."""
    usable = np.isfinite(image)
    filled = np.where(usable, image, 0.0)
    share = uniform_filter(usable.astype(float), _LOCAL_PX, mode="constant")
    mean = uniform_filter(filled, _LOCAL_PX, mode="constant") / np.maximum(share, 1e-9)
    detail = np.where(usable & (share > 0.3), image - mean, 0.0)
    # What rounding leaves of a uniform image is no structure.
    detail[np.abs(detail) < _ROUNDING * float(np.abs(filled).max())] = 0.0
    some = detail[detail != 0]
    if some.size == 0:
        return detail
    bound = _BOUND_SIGMAS * max(robust_scale(some), 0.2 * float(np.abs(some).std()))
    return np.asarray(np.clip(detail, -bound, bound))


def _vertex(line: Floats, peak: int) -> float:
    """Place of a parabola's vertex through the peak and its neighbours."""
    if not 0 < peak < line.size - 1:
        return 0.0
    before, at, after = line[peak - 1 : peak + 2].tolist()
    bend = before - 2 * at + after
    return 0.0 if bend >= 0 else 0.5 * (before - after) / bend
