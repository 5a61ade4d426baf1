"""Fill that a file does not declare: the constant beyond the border of a swath or a warped image.

Fill is one exact value that reaches the border of the image. So do the sides of an edge simulated
without noise, dark water of an 8-bit image and clipped roofs; but their borders are blurred, as a
sensor blurs everything. At fill the image drops from its full level to the constant between two
pixels, or within one more where a resampling mixed the two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_floats, require_kind
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.raster.image import require_image
from acutance.raster.region import Box

if TYPE_CHECKING:
    from acutance.raster.image import Image

__all__ = ["Fill", "blended_px", "find_fill", "grown", "value_far_off"]

_CONTEXT_PX: Final = 16
"""How far around a region its constant parts are looked at."""
_MIN_BLOCKS: Final = 24
"""Blocks of 2 x 2 equal pixels below which a value is no fill: noise of half a step makes some."""
_MAX_VALUES: Final = 3
_MIN_PIXELS: Final = 32
_MIN_BORDER: Final = 12
"""Pixels along the border from which its sharpness is judged."""
_MAX_EQUAL: Final = 0.8
"""Share of equal neighbours in the rest of the image above which that has no noise either."""
_FIRST, _SECOND, _NEAR, _FAR = 0, 1, 2, 5
"""Pixels outside fill, counted from its border, that are compared."""
_LOW_SHARE: Final = 20
_MAX_BLUR: Final = 0.15
_MIN_LOW: Final = 0.6
_MAX_BLUR_BLENDED: Final = 0.35
"""A border is sharp if its first pixels reach the level of those further out, but for this share:
in the median, and in the lowest fifth beyond what the background itself varies by, but never below
.6. At a clipped side blurred by .4 px they lack a third and more. The same of the second pixels of
a border that a resampling blended."""
_MIN_STEPS: Final = 8.0
_MIN_STEPS_BLENDED: Final = 1000.0
"""Contrast in steps of the image's numbers: at least, and from which one blended pixel is allowed,
as the sharpest sensor takes two from a thousandth of the contrast to the full level."""
_DIGITS: Final = 9
_GROWTH_BLENDED_PX: Final = 2
_MAX_ROUGHNESS_PX: Final = 0.7
"""Of a blended border, rms: a staircase has .3. A clipped side has a border like that, so only zero
is taken for blended fill: what resampling leaves where it has no data."""
_FAR_OFF: Final = 2.0
"""Distance of a value from all others, in units of their range: no light is so much apart."""
_READ_PX: Final = (256, 4096)
"""Length of the first and of the longest piece that is read on the way to the image's border."""
_SIDES: Final = ((0, 1), (0, -1), (1, 0), (-1, 0))


@dataclass(frozen=True, eq=False)
class Fill:
    """Pixels of a box that hold no data, though the image does not declare their value.

    Attributes
    ----------
    value : float
        In the units `Image.read` gives.
    mask : (height, width) bool array
        Which pixels of the box are left out: those of this value, and those that a resampling
        mixed with it.
    """

    value: float
    mask: NDArray[np.bool_] = field(repr=False)

    @property
    def count(self) -> int:
        """How many pixels are left out."""
        return int(np.count_nonzero(self.mask))

    def within(self, inside: NDArray[np.bool_]) -> Fill | None:
        """The fill inside a mask of the box; `None` if there is none."""
        mask = self.mask & inside
        return Fill(self.value, mask) if mask.any() else None


def find_fill(image: Image, box: Box, pixels: Floats) -> Fill | None:
    """The undeclared fill of a box.

    Beyond the box and a narrow frame around it only single rows and columns are read, and only
    where the box holds a constant part.

    Parameters
    ----------
    image : Image
    box : Box
        Inside the image.
    pixels : (height, width) array
        What `Image.read` gives for it.

    Returns
    -------
    Fill or None
        `None` where there is none, or the image's values were stated to be data, all of them.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind.
    """
    require_image(image)
    require_kind(Box, box=box)
    pixels = require_floats("pixels", pixels)
    if pixels.shape != box.shape:
        raise OptionError(f"pixels have the shape {pixels.shape}: give those of {box}")
    if image.every_value_is_data or not _frequent_values(pixels):
        return None
    frame = box.grown(_CONTEXT_PX).intersection(Box.whole(image.shape)) or box
    around = pixels if frame == box else image.read(frame)
    for value in _frequent_values(around):
        parts = _parts_at_the_frame(around == value)
        growth_px = blended_px(around, parts > 0, value)
        if growth_px is None:
            continue
        constant = _to_the_border(image, frame, parts, value)
        row, col = box.row - frame.row, box.col - frame.col
        mask = grown(constant, growth_px)[row : row + box.height, col : col + box.width]
        if mask.any():
            return Fill(value, mask)
    return None


def _frequent_values(pixels: Floats) -> list[float]:
    """Values that fill many blocks of 2 x 2 pixels, the most frequent first."""
    corner = pixels[1:, 1:]
    blocks = corner == pixels[:-1, :-1]
    if np.count_nonzero(blocks) < _MIN_BLOCKS:
        return []
    blocks &= (corner == pixels[:-1, 1:]) & (corner == pixels[1:, :-1])
    value, count = np.unique(corner[blocks], return_counts=True)
    often = np.argsort(-count, kind="stable")[:_MAX_VALUES]
    return [float(value[one]) for one in often if count[one] >= _MIN_BLOCKS]


def _parts_at_the_frame(constant: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Numbers of the connected parts that reach the outline of an array and are large, else 0."""
    from scipy import ndimage

    parts, count = ndimage.label(constant)
    sizes = np.bincount(parts.reshape(-1), minlength=count + 1)
    kept = np.zeros(count + 1, np.int32)
    for line in (parts[0], parts[-1], parts[:, 0], parts[:, -1]):
        kept[line] = line
    kept[sizes < _MIN_PIXELS] = 0
    return np.asarray(kept[parts])


def _to_the_border(
    image: Image, frame: Box, parts: NDArray[np.int32], value: float
) -> NDArray[np.bool_]:
    """The parts from which a straight row or column of the value leads to the image's border.

    Where the data are convex, as in a swath, one leads from every pixel beyond them.
    """
    bottom, right = frame.row + frame.height, frame.col + frame.width
    exits = (
        (parts[0], frame.col, frame.row, 0, True),
        (parts[-1], frame.col, bottom, image.shape[0], True),
        (parts[:, 0], frame.row, frame.col, 0, False),
        (parts[:, -1], frame.row, right, image.shape[1], False),
    )
    reaching: set[int] = set()
    for line, corner, start, stop, by_rows in exits:
        for part in set(line.tolist()) - {0} - reaching:
            at = np.flatnonzero(line == part)
            for place in {int(at[k]) for k in (0, at.size // 2, -1)}:
                pieces = _pieces(corner + place, start, stop, by_rows=by_rows)
                if all((image.read(piece) == value).all() for piece in pieces):
                    reaching.add(part)
                    break
    return np.isin(parts, list(reaching))


def _pieces(line: int, start: int, stop: int, *, by_rows: bool) -> Iterator[Box]:
    """The pixels of a column (by rows) or of a row from one place to another, piece by piece."""
    length = _READ_PX[0]
    while start != stop:
        end = max(start - length, stop) if stop < start else min(start + length, stop)
        low, extent = min(start, end), abs(end - start)
        yield Box(low, line, extent, 1) if by_rows else Box(line, low, 1, extent)
        start, length = end, min(2 * length, _READ_PX[1])


def blended_px(around: Floats, constant: NDArray[np.bool_], value: float) -> int | None:
    """How many pixels next to constant parts are mixed with them; `None` if a sensor blurred them.

    It is `None` too where the border is too short to be judged. The pixels outside, at one, two,
    three and six pixels from the border, are compared by their difference from the constant.
    """
    if _equal_share(around, constant) > _MAX_EQUAL:
        return None
    lines = _lines_outwards(around - value, constant)
    outside = np.abs(np.concatenate([line.difference for line in lines], axis=1))
    if outside.shape[1] < _MIN_BORDER:
        return None
    near, far = outside[_NEAR], outside[_FAR]
    steps = float(np.median(near)) / _smallest_step(outside)
    if steps >= _MIN_STEPS and _reach_the_level(outside[_FIRST], near, far, _MAX_BLUR):
        return 0
    if (
        value == 0
        and steps >= _MIN_STEPS_BLENDED
        and _reach_the_level(outside[_SECOND], near, far, _MAX_BLUR_BLENDED)
        and all(line.roughness_px() <= _MAX_ROUGHNESS_PX for line in lines)
    ):
        return _GROWTH_BLENDED_PX
    return None


def _equal_share(around: Floats, constant: NDArray[np.bool_]) -> float:
    """Share of equal neighbours outside the constant parts."""
    rest = np.where(constant, np.nan, around)
    pairs = [(rest[:, 1:], rest[:, :-1]), (rest[1:], rest[:-1])]
    known = sum(int(np.count_nonzero(np.isfinite(a + b))) for a, b in pairs)
    equal = sum(int(np.count_nonzero(a == b)) for a, b in pairs)
    return equal / known if known else 1.0


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines of pixels that lead from constant parts in one of the four directions.

    Attributes
    ----------
    difference : (6, n) array
        From the constant, at 1 .. 6 px from the border.
    along, across : (n,) arrays
        Place of the border: along it, and in the direction of the lines.
    """

    difference: Floats
    along: NDArray[np.intp]
    across: NDArray[np.intp]

    def roughness_px(self) -> float:
        """Deviation of the border from a straight line, rms; 0 of a few pixels."""
        if self.along.size < _MIN_BORDER:
            return 0.0
        offset = self.along - self.along.mean()
        place = self.across - self.across.mean()
        slope = float(offset @ place) / max(float(offset @ offset), 1.0)
        return float(np.std(place - slope * offset))


def _lines_outwards(difference: Floats, constant: NDArray[np.bool_]) -> list[_Lines]:
    """Lines of six pixels outside every border pixel, each of which holds data."""
    rows, cols = constant.shape
    data = np.isfinite(difference) & (difference != 0)
    padded = np.pad(data, 1)
    steps = np.arange(1, _FAR + 2)[:, None]
    found = []
    for down, right in _SIDES:
        next_to = padded[1 + down : 1 + down + rows, 1 + right : 1 + right + cols]
        row, col = np.nonzero(constant & next_to)
        row, col = row + down * steps, col + right * steps
        inside = (row[-1] >= 0) & (row[-1] < rows) & (col[-1] >= 0) & (col[-1] < cols)
        row, col = row[:, inside], col[:, inside]
        whole = data[row, col].all(axis=0)
        row, col = row[:, whole], col[:, whole]
        along, across = (col[0], row[0]) if down else (row[0], col[0])
        found.append(_Lines(difference[row, col], along, across))
    return found


def _reach_the_level(border: Floats, near: Floats, far: Floats, tolerance: float) -> bool:
    """Whether pixels of the border have the level of those further out, in all places."""
    reached, usual = border / near, near / far
    low, usual_low = np.percentile([reached, usual], _LOW_SHARE, axis=1)
    least = max(min(usual_low, 1.0) - tolerance, _MIN_LOW)
    return bool(np.median(reached) >= 1 - _MAX_BLUR and low >= least)


def _smallest_step(difference: Floats) -> float:
    """Smallest step between values, beyond the rounding of the arithmetic."""
    values = np.unique(np.round(difference / difference.max(), _DIGITS))
    return float(np.diff(values).min() * difference.max()) if values.size > 1 else 1.0


def grown(mask: NDArray[np.bool_], by_px: int) -> NDArray[np.bool_]:
    """A mask with the pixels around it, so many on every side."""
    if by_px == 0:
        return mask
    from scipy import ndimage

    return np.asarray(ndimage.binary_dilation(mask, np.ones((3, 3)), iterations=by_px))


def value_far_off(pixels: Floats) -> tuple[float, int] | None:
    """The lowest or the highest value, if it is far from all others, and how many pixels have it.

    It may be fill inside an image, which no sharp border tells from dark or clipped ground: nothing
    is left out for it.

    Raises
    ------
    OptionError
        If they are no numbers.
    """
    pixels = require_floats("pixels", pixels)
    finite = pixels[np.isfinite(pixels)]
    for value in (finite.min(initial=np.inf), finite.max(initial=-np.inf)):
        others = finite[finite != value]
        if not others.size or others.size < 0.5 * finite.size:
            continue
        if np.abs(others - value).min() > _FAR_OFF * float(np.ptp(others)) > 0:
            return float(value), finite.size - others.size
    return None
