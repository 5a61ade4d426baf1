"""Fill that a file does not declare, of a whole image: one pass over it, a few numbers a line.

Fill lies beyond a border that is convex, as that of a swath: a straight row or column of one value
leads from each of its pixels to the border of the image. So the lengths of the runs that begin at
the border describe all of it, and the mask of any window follows from them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.short_repr import ShortRepr
from acutance.raster.fill import blended_px, grown
from acutance.raster.image import require_image
from acutance.raster.region import Box

if TYPE_CHECKING:
    from acutance.raster.image import Image

__all__ = ["SwathFill", "find_swath_fill"]

_MIN_RUN_PX: Final = 24
"""Equal pixels along the border of the image from which their value may be fill."""
_MAX_VALUES: Final = 3
_READ_PX: Final = (512, 4096)
_JUDGED_PX: Final = 256
_MAX_JUDGED: Final = 16
"""Places along the border of fill at which its sharpness is judged: most have to be sharp."""


@dataclass(frozen=True, eq=False)
class SwathFill(ShortRepr):
    """Pixels of an image that hold no data, though it does not declare their value.

    Attributes
    ----------
    value : float
        In the units `Image.read` gives.
    left, right : (rows,) int arrays
        Where in each row the run from its beginning ends, and the one to its end begins.
    top, bottom : (cols,) int arrays
        The same of the columns.
    growth_px : int
        So many pixels beside them were mixed with them by a resampling.
    """

    value: float
    left: NDArray[np.intp]
    right: NDArray[np.intp]
    top: NDArray[np.intp]
    bottom: NDArray[np.intp]
    growth_px: int = 0

    def mask(self, box: Box) -> NDArray[np.bool_]:
        """Which pixels of a box hold no data; the box may reach beyond the image.

        Returns
        -------
        (height, width) bool array
        """
        around, by = box.grown(self.growth_px), self.growth_px
        found = grown(self._constant(around), by)
        return found[by : by + box.height, by : by + box.width]

    def _constant(self, box: Box) -> NDArray[np.bool_]:
        """Pixels of the value itself."""
        found = np.zeros(box.shape, bool)
        inside = box.intersection(Box.whole((self.left.size, self.top.size)))
        if inside is not None:
            rows, cols = inside.slices
            row, col = (np.arange(one.start, one.stop) for one in (rows, cols))
            first, last = inside.row - box.row, inside.col - box.col
            found[first : first + inside.height, last : last + inside.width] = (
                (col < self.left[rows, None])
                | (col >= self.right[rows, None])
                | (row[:, None] < self.top[cols])
                | (row[:, None] >= self.bottom[cols])
            )
        return found


def find_swath_fill(image: Image) -> SwathFill | None:
    """The undeclared fill of a whole image, by windows.

    Where no constant lies along the border of the image, nothing but the border is read.

    Parameters
    ----------
    image : Image

    Returns
    -------
    SwathFill or None
        `None` where there is none, or the image's values were stated to be data, all of them.

    Raises
    ------
    OptionError
        If it is no image.
    """
    require_image(image)
    if image.every_value_is_data:
        return None
    for value in _values_at_the_border(image):
        runs = _runs(image, value)
        growth_px = _judged(image, runs)
        if growth_px is not None:
            return SwathFill(value, runs.left, runs.right, runs.top, runs.bottom, growth_px)
    return None


def _values_at_the_border(image: Image) -> list[float]:
    """Values of long runs along the border of the image, the most frequent first."""
    rows, cols = image.shape
    sides = {Box(0, 0, 1, cols), Box(rows - 1, 0, 1, cols), Box(0, 0, rows, 1),
             Box(0, cols - 1, rows, 1)}  # fmt: skip
    total: dict[float, int] = {}
    for side in sides:
        line = image.read(side).ravel()
        starts = np.flatnonzero(np.r_[True, line[1:] != line[:-1]])
        lengths = np.diff(np.r_[starts, line.size])
        for start, length in zip(starts, lengths, strict=True):
            if length >= _MIN_RUN_PX:
                value = float(line[start])
                total[value] = total.get(value, 0) + int(length)
    return sorted(total, key=lambda value: (-total[value], value))[:_MAX_VALUES]


def _runs(image: Image, value: float) -> SwathFill:
    """The runs of a value from all sides."""
    rows, cols = image.shape
    left, right = np.zeros(rows, np.intp), np.zeros(rows, np.intp)
    top, bottom = np.zeros(cols, np.intp), np.zeros(cols, np.intp)
    for box in _boxes(image.shape, _READ_PX):
        equal = image.read(box) == value
        by_row, by_col = box.slices
        _lengthen(left[by_row], right[by_row], equal, box.col)
        _lengthen(top[by_col], bottom[by_col], equal.T, box.row)
    return SwathFill(value, left, right, top, bottom)


def _lengthen(
    ends: NDArray[np.intp], starts: NDArray[np.intp], equal: NDArray[np.bool_], place: int
) -> None:
    """Follow the first and the last run of lines through their next piece, in place."""
    width = equal.shape[1]
    whole = equal.all(axis=1)
    leading = np.where(whole, width, np.argmin(equal, axis=1))
    ends += np.where(ends == place, leading, 0)
    trailing = np.argmin(equal[:, ::-1], axis=1)
    starts[~whole] = (place + width - trailing)[~whole]


def _judged(image: Image, fill: SwathFill) -> int | None:
    """How many pixels beside fill are mixed with it; `None` if most of its border is blurred."""
    places = [
        box
        for box in _boxes(image.shape, (_JUDGED_PX, _JUDGED_PX))
        if 0 < np.count_nonzero(fill.mask(box)) < box.height * box.width
    ]
    chosen = np.unique(np.linspace(0, len(places) - 1, min(len(places), _MAX_JUDGED)).astype(int))
    found = [blended_px(image.read(places[i]), fill.mask(places[i]), fill.value) for i in chosen]
    sharp = [one for one in found if one is not None]
    return max(sharp) if 2 * len(sharp) > len(found) else None


def _boxes(shape: tuple[int, int], size: tuple[int, int]) -> Iterator[Box]:
    """Windows of a whole image, row after row."""
    for row in range(0, shape[0], size[0]):
        for col in range(0, shape[1], size[1]):
            yield Box(row, col, min(size[0], shape[0] - row), min(size[1], shape[1] - col))
