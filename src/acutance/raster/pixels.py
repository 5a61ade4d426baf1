"""Where the pixels of an image come from: an array in memory, or a NumPy file on disk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import ImageError
from acutance.raster.region import Box

__all__ = [
    "ArrayPixels",
    "NpyPixels",
    "PixelSource",
    "equals_nodata",
    "require_image_array",
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
        return usable_values(raw, np.ma.getmaskarray(cut) | equals_nodata(raw, self.nodata))


@dataclass(frozen=True)
class NpyPixels:
    """A 2-D array in a ``.npy`` file, mapped into memory for the length of a reading.

    Parameters
    ----------
    path : str
    nodata : float, optional
        A value that marks unusable pixels.
    """

    path: str
    nodata: float | None = None

    def read(self, box: Box) -> Floats:
        return ArrayPixels(self.map(), self.nodata).read(box)

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
            raise ImageError(
                f"{self.path} cannot be read as a NumPy file ({error}): "
                "save a 2-D array of numbers with numpy.save"
            ) from error
        return array


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
            3: "choose one band: array[band] if the bands come first, array[..., band] if last",
        }.get(array.ndim, "choose one image of one band, for example array[0, 0]")
        raise ImageError(
            f"{name} has shape {array.shape}; an image has two axes, (rows, columns): {advice}"
        )
    if array.size == 0:
        raise ImageError(f"{name} has shape {array.shape}: it is empty, so there is no image")


def equals_nodata(raw: NDArray[Any], nodata: float | None) -> NDArray[np.bool_]:
    """Where raw values are the nodata value, compared in the precision of the raw values."""
    if nodata is None:
        return np.zeros(raw.shape, dtype=np.bool_)
    if raw.dtype.kind != "f":
        return np.asarray(raw == nodata)
    with np.errstate(over="ignore"):
        return np.asarray(raw == raw.dtype.type(nodata))


def usable_values(raw: NDArray[Any], masked: NDArray[np.bool_]) -> Floats:
    """Raw values as a new float64 array, NaN where masked or not finite."""
    values = np.array(raw, dtype=np.float64, order="C")
    values[masked | ~np.isfinite(values)] = np.nan
    return values
