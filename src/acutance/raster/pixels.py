"""Where the pixels of an image come from: an array in memory, or a NumPy file on disk."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache, lru_cache
from io import FileIO
from numbers import Real
from typing import Any, NamedTuple, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ImageError, OptionError
from acutance.raster.region import Box

__all__ = [
    "ArrayPixels",
    "NpyPixels",
    "PartPixels",
    "PixelSource",
    "equals_nodata",
    "is_nan",
    "is_npy",
    "largest_count",
    "require_image_array",
    "require_nodata",
    "storable_nodata",
    "type_name",
    "usable_values",
]

_NPY_MAGIC = b"\x93NUMPY"


class PixelSource(Protocol):
    """Something that hands out boxes of one band."""

    def read(self, box: Box) -> Floats:
        """(height, width) values of a box that lies inside the image; NaN where unusable."""
        ...


@dataclass(frozen=True, eq=False)
class ArrayPixels:
    """A 2-D array in memory, masked or not.

    Parameters
    ----------
    array : (rows, cols) array
        Integers or floats; the mask of a masked array marks unusable pixels.
    nodata : float, optional
        A value that marks unusable pixels.
    """

    array: NDArray[Any]
    nodata: float | None = None

    def read(self, box: Box) -> Floats:
        cut = self.array[box.slices]
        raw = np.ma.getdata(cut)
        values = usable_values(raw, np.asarray(np.ma.getmask(cut)))
        if self.nodata is not None:
            values[equals_nodata(raw, self.nodata)] = np.nan
        return values


@dataclass(frozen=True, eq=False)
class PartPixels:
    """The pixels of one box of an image, in memory: no others can be read.

    Parameters
    ----------
    box : Box
    values : (height, width) array
        As the image gave them, NaN where unusable.
    """

    box: Box
    values: Floats

    def read(self, box: Box) -> Floats:
        inner = Box(box.row - self.box.row, box.col - self.box.col, *box.shape)
        inner.require_inside(self.box.shape)
        return np.array(self.values[inner.slices])


@dataclass(frozen=True)
class NpyPixels:
    """A 2-D array in a ``.npy`` file, of which the lines of a box are read.

    Parameters
    ----------
    path : str
    nodata : float, optional
        A value that marks unusable pixels.
    """

    path: str
    nodata: float | None = None

    def read(self, box: Box) -> Floats:
        # Lines are read: to map the file would cost a small region a page or more a line, and
        # its neighbourhood, which the system maps as well.
        try:
            state = os.stat(self.path)
            layout = _layout(self, state.st_mtime_ns, state.st_size)
            with open(self.path, "rb", buffering=0) as file:
                raw = layout.read(file, box)
        except (EOFError, OSError) as error:
            raise self._unreadable(error) from error
        return ArrayPixels(raw, self.nodata).read(Box(0, 0, *box.shape))

    def map(self) -> NDArray[Any]:
        """The array, read-only, of which only the pages touched are loaded.

        Raises
        ------
        ImageError
            If the file is not a NumPy array, or is cut short.
        """
        try:
            with open(self.path, "rb") as file:
                if file.read(len(_NPY_MAGIC)) != _NPY_MAGIC:
                    raise ValueError("its first bytes are not those of one")
            array: NDArray[Any] = np.load(self.path, mmap_mode="r", allow_pickle=False)
        except (ValueError, EOFError, OSError) as error:
            raise self._unreadable(error) from error
        return array

    def _unreadable(self, error: Exception) -> ImageError:
        return ImageError(
            f"{self.path} cannot be read as a NumPy file ({error}): "
            "save a 2-D array of numbers with numpy.save"
        )


class _Layout(NamedTuple):
    """Where the values of a 2-D array lie in its file.

    Attributes
    ----------
    dtype : dtype
    start : int
        Bytes before the first value.
    strides : (int, int)
        Bytes from row to row, and from column to column.
    """

    dtype: np.dtype[Any]
    start: int
    strides: tuple[int, int]

    def read(self, file: FileIO, box: Box) -> NDArray[Any]:
        """The values of a box, line by line as they lie in the file.

        Raises
        ------
        EOFError
            If the file ends before.
        """
        down, right = self.strides
        by_rows = down >= right
        raw = np.empty(box.shape if by_rows else box.shape[::-1], self.dtype)
        place = self.start + box.row * down + box.col * right
        for line in raw:
            file.seek(place)
            if file.readinto(line) < line.nbytes:
                raise EOFError("it is cut short")
            place += down if by_rows else right
        return raw if by_rows else raw.T


@lru_cache(maxsize=8)
def _layout(source: NpyPixels, changed_ns: int, size: int) -> _Layout:
    """The layout of a file, of which the time of the last change and the size are known."""
    array = source.map()
    down, right = array.strides
    return _Layout(array.dtype, cast(np.memmap[Any, Any], array).offset, (down, right))


def is_npy(path: str) -> bool:
    """Whether a name is that of a NumPy file, which GDAL does not read."""
    return path.lower().endswith(".npy")


def require_image_array(array: NDArray[Any], name: str) -> None:
    """Check that an array is an image: 2-D, real numbers, not empty.

    Parameters
    ----------
    array : array
    name : str
        What to call it in a message.

    Raises
    ------
    ImageError
        With what was found and what to hand in instead.
    """
    if array.dtype.kind not in "iuf":
        advice = {
            "c": "take its modulus first: numpy.abs(array)",
            "b": "a mask holds no grey levels: hand in the image it belongs to",
        }.get(array.dtype.kind, "convert it to integers or floats first")
        raise ImageError(f"{name} holds values of type {array.dtype}, not real numbers: {advice}")
    if array.ndim != 2:
        advice = {
            0: "a single number is no image",
            1: "reshape it to (rows, columns)",
            3: "choose one band: array[band] if the bands come first, array[..., band] if last; "
            "for a command save it in a file of its own",
        }.get(array.ndim, "choose one image of one band, for example array[0, 0]")
        raise ImageError(
            f"{name} has shape {array.shape}; an image has two axes, (rows, columns): {advice}"
        )
    if array.size == 0:
        raise ImageError(
            f"{name} has shape {array.shape}: it is empty; give an array with rows and columns"
        )


def require_nodata(nodata: float | None) -> None:
    """Refuse a nodata value that no pixel can have.

    Raises
    ------
    OptionError
        If it is of another kind than a number.
    """
    if nodata is not None and not isinstance(nodata, Real):
        raise OptionError(
            f"nodata is {nodata!r:.80}: give the number that unusable pixels have, or NaN if every "
            "value is data"
        )


def equals_nodata(raw: NDArray[Any], nodata: float | None) -> NDArray[np.bool_]:
    """Where raw values are the nodata value, compared in the precision of the raw values."""
    if nodata is None:
        return np.zeros(raw.shape, dtype=np.bool_)
    if raw.dtype.kind != "f":
        return np.asarray(raw == nodata)
    with np.errstate(over="ignore"):
        return np.asarray(raw == raw.dtype.type(nodata))


def storable_nodata(dtype: np.dtype[Any], nodata: float | None) -> float | None:
    """The nodata value as pixels of a type have it; ``None`` if none of them can."""
    if nodata is None:
        return None
    if dtype.kind == "f":
        with np.errstate(over="ignore"):
            stored = float(dtype.type(nodata))
        return None if np.isinf(stored) and np.isfinite(nodata) else stored
    bounds = np.iinfo(dtype)
    is_whole = np.isfinite(nodata) and float(nodata).is_integer()
    return float(nodata) if is_whole and bounds.min <= nodata <= bounds.max else None


def is_nan(nodata: float | None) -> bool:
    """Whether the nodata value is NaN, given to say that every value is data."""
    return nodata is not None and bool(np.isnan(nodata))


def usable_values(raw: NDArray[Any], masked: NDArray[np.bool_]) -> Floats:
    """Raw values as a new float64 array, NaN where masked or not finite."""
    values = np.array(raw, dtype=np.float64, order="C")
    # Of a large image most boxes are whole.
    unusable = masked if raw.dtype.kind in "iu" else masked | ~np.isfinite(values)
    if unusable.any():
        values[unusable] = np.nan
    return values


@cache
def type_name(dtype: np.dtype[Any]) -> str:
    """Name of a type; to compose it takes as long as to read a small region."""
    return dtype.name


def largest_count(dtype: np.dtype[Any]) -> float | None:
    """The largest value of an integer type; ``None`` for floats."""
    return float(np.iinfo(dtype).max) if dtype.kind in "iu" else None
