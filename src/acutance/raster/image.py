"""An image to measure: one band of a file or an array, read a window at a time."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import require_optional
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ImageError, OptionError
from acutance.raster.band_label import label_band
from acutance.raster.geolocation import Geolocation
from acutance.raster.gsd import Gsd
from acutance.raster.linearization import (
    Characteristic,
    LinearizedPixels,
    LinearizeLike,
    characteristic,
)
from acutance.raster.pixels import (
    ArrayPixels,
    PixelSource,
    is_nan,
    largest_count,
    require_image_array,
    require_nodata,
    type_name,
)
from acutance.raster.region import Box

__all__ = ["AlongTrack", "Image", "require_image"]

AlongTrack = Literal["x", "y"]
"""The image axis the satellite flew along: x is that of the columns' numbers, y of the rows'."""

_COLUMNS_FIRST = (("x", "y"), ("lon", "lat"), ("longitude", "latitude"), ("col", "row"))
"""Names of axes, as xarray has them, of an image that lies on its side."""


@dataclass(frozen=True, eq=False)
class Image(ShortRepr):
    """One band of an image, whether a file or an array: nothing is read before `read`.

    Made by `open_image` and `Image.from_array`. It holds no open file, so it can be pickled and
    read from several threads and processes at once.

    Parameters
    ----------
    path : str or None
        The file; ``None`` for an array.
    band : int
        Which band, from 1.
    band_count : int
        How many the file has.
    shape : (rows, columns)
    dtype : str
        Of the stored pixels, as numpy calls it.
    source : PixelSource
        What the pixels are read from.
    saturation_level : float or None
        The largest value the detector's counts can take, in the units `read` gives: that of the
        integer type, or of the bits or the saturated value the file declares. ``None`` for floats,
        and where a negative scale of the file makes the largest count the smallest value.
    geolocation : Geolocation or None
        ``None`` for an image with no CRS.
    own_gsd : Gsd or None
        The GSD given by the caller or declared by the file (`write_geotiff`); it goes before
        the geolocation's.
    along_track : {"y", "x"}
        The axis along track: y, down the columns, of an image as a pushbroom scanner takes it.
    characteristic : Characteristic or None
        The curve that stored values are turned back through, so that `read` gives values
        proportional to light; ``None`` if they are taken as they are.
    declared_gsd : Gsd or None
        The GSD declared by the file, also where the caller gave another.
    every_value_is_data : bool
        If true, fill that is not declared is not looked for: see `acutance.raster.Fill`.
    band_name : str or None
        As the file or a document beside it states it.
    stated_nodata : float or None
        The nodata value that was stated when the file was opened.
    restored : str or None
        The filter that restored the band, by the tag that `acutance.restore` wrote.
    modelled_gsd : Gsd or None
        Of a file without a geotransform the GSD in its middle by RPC or ground control points, on
        ground of the height for which these are made.

    Raises
    ------
    OptionError
        If there is no such axis along track.
    """

    path: str | None
    band: int
    band_count: int
    shape: tuple[int, int]
    dtype: str
    source: PixelSource
    saturation_level: float | None = None
    geolocation: Geolocation | None = None
    own_gsd: Gsd | None = None
    along_track: AlongTrack = "y"
    characteristic: Characteristic | None = None
    declared_gsd: Gsd | None = None
    every_value_is_data: bool = False
    band_name: str | None = None
    stated_nodata: float | None = None
    restored: str | None = None
    modelled_gsd: Gsd | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.along_track, str) or self.along_track not in ("x", "y"):
            raise OptionError(
                f"along_track is {self.along_track!r}: it has to be 'y' (down the columns) or 'x' "
                "(along the rows)"
            )

    @classmethod
    def of(cls, image: Image | ArrayLike) -> Image:
        """What stands for an image: itself, or an array as one (`from_array`).

        Raises
        ------
        ImageError
            If there is none, or it is no array that can be an image.
        """
        if image is None:
            raise ImageError("the image is None: give an array, or open_image(path)")
        return image if isinstance(image, Image) else cls.from_array(image)

    @classmethod
    def from_array(
        cls,
        array: ArrayLike | np.ma.MaskedArray[Any, Any],
        gsd_m: float | Gsd | None = None,
        nodata: float | None = None,
        along_track: AlongTrack = "y",
    ) -> Image:
        """An array in memory as an image.

        Parameters
        ----------
        array : (rows, columns) array_like
            Integers or floats. Masked and non-finite pixels are unusable. It is not copied.
        gsd_m : float or Gsd, optional
            Ground sampling distance in metres, the same both ways unless a `Gsd` is given.
        nodata : float, optional
            A value that marks unusable pixels; NaN if every value is data.
        along_track : {"y", "x"}, optional
            The axis along track.

        Raises
        ------
        ImageError
            If the array is not 2-D, is empty, or does not hold real numbers.
        OptionError
            If the GSD is not a positive number, or the nodata value no number.
        """
        require_nodata(nodata)
        values = _as_array(array)
        require_image_array(values, "the array")
        return cls(
            path=None,
            band=1,
            band_count=1,
            shape=(int(values.shape[0]), int(values.shape[1])),
            dtype=type_name(values.dtype),
            source=ArrayPixels(values, nodata),
            saturation_level=largest_count(values.dtype),
            own_gsd=Gsd.given(gsd_m),
            along_track=along_track,
            every_value_is_data=is_nan(nodata),
        )

    def linearized(self, linearize: LinearizeLike) -> Image:
        """The same image with values proportional to light, of known characteristic curve.

        Parameters
        ----------
        linearize : str, float, Characteristic or None
            "sRGB" (white at the largest value of the type, 1 of floats) or "sRGB:WHITE"; a number,
            the gamma of a power law; "log:DECADE", by how much values rise for ten times the light
            ("log" alone: natural logarithms); the path of a table of two rising columns, stored
            value and light; or an object with `linear` and `words`. None leaves the image as it is.

        Raises
        ------
        OptionError
            If there is no such curve, or the image has one already.
        """
        curve = characteristic(linearize, self.saturation_level)
        if curve is None:
            return self
        if self.characteristic is not None:
            raise OptionError(
                f"the image is linearised already ({self.characteristic.words}): open it anew to "
                "choose another curve"
            )
        level = self.saturation_level
        return replace(
            self,
            source=LinearizedPixels(self.source, curve),
            saturation_level=None if level is None else _linear_level(curve, level),
            characteristic=curve,
        )

    @property
    def band_label(self) -> str:
        """Number and name of the band: "2 (B3)"."""
        return label_band(self.band, self.band_name)

    @property
    def states_gsd(self) -> bool:
        """Whether the caller, the file or its geotransform states the size of the pixels.

        By a sensor model it can be told, too, and changes with the angle of view while the pixels
        of the detector stay the same.
        """
        return self.own_gsd is not None or self.geolocation is not None

    @property
    def crs(self) -> str | None:
        """The coordinate reference system as text ("EPSG:32631", WKT), or ``None``."""
        return None if self.geolocation is None else self.geolocation.crs

    def read(self, box: Box | None = None) -> Floats:
        """The pixels of a box; it costs what the box costs, not what the file does.

        Parameters
        ----------
        box : Box, optional
            The whole image without one.

        Returns
        -------
        (height, width) float64 array
            A new array, scale and offset of the file applied; NaN where the pixel is nodata,
            masked, fully transparent or not finite.

        Raises
        ------
        RegionError
            If the box reaches beyond the image.
        ImageError
            If the file cannot be read there.
        OptionError
            If it is no box.
        """
        require_optional(Box, box=box)
        window = Box.whole(self.shape) if box is None else box
        window.require_inside(self.shape)
        return self.source.read(window)

    def gsd(self, row: float | None = None, col: float | None = None) -> Gsd | None:
        """Ground sampling distance in metres at a pixel.

        Parameters
        ----------
        row, col : float, optional
            Where; the centre of the image by default. It matters for a geographic CRS.

        Returns
        -------
        Gsd or None
            ``None`` when it was not given and the image declares none.

        Raises
        ------
        OptionError
            If a place is no number.
        """
        require_optional(Real, row=row, col=col)
        if self.own_gsd is not None:
            return self.own_gsd
        return self._located_gsd(row, col)

    def gsd_of_file(self, row: float | None = None, col: float | None = None) -> Gsd | None:
        """The GSD at a pixel that the image has of itself, whatever `open_image` was given.

        Parameters
        ----------
        row, col : float, optional
            As of `gsd`.
        """
        require_optional(Real, row=row, col=col)
        if self.path is None and self.own_gsd is not None:
            return self.own_gsd
        return self.declared_gsd or self._located_gsd(row, col)

    def _located_gsd(self, row: float | None, col: float | None) -> Gsd | None:
        """The GSD by the geolocation, or the sensor model."""
        if self.geolocation is None:
            return self.modelled_gsd
        at_row = (self.shape[0] - 1) / 2 if row is None else row
        at_col = (self.shape[1] - 1) / 2 if col is None else col
        return self.geolocation.gsd(at_row, at_col)


def require_image(image: Any) -> None:
    """Refuse what is no image, such as the name of a file.

    Raises
    ------
    OptionError
        Says how to make one.
    """
    if not isinstance(image, Image):
        raise OptionError(
            f"image is {image!r:.80}: give an Image, open_image(path) or Image.from_array(array)"
        )


def _linear_level(curve: Characteristic, level: float) -> float | None:
    """The light of the largest stored value; ``None`` where the curve does not reach it."""
    try:
        return float(curve.linear(np.array([level]))[0])
    except ImageError:
        return None


def _as_array(array: Any) -> NDArray[Any]:
    """An array of whatever can be one.

    Raises
    ------
    ImageError
        If it is the name of a file, no array, one whose axes are named as columns and rows, or
        rows of different lengths.
    """
    if isinstance(array, str | bytes | os.PathLike):
        raise ImageError(
            f"{os.fspath(array)!r} is the name of a file, no array: open it with "
            "acutance.open_image(name), and measure what that returns"
        )
    axes = tuple(str(name).lower() for name in getattr(array, "dims", ()))
    if axes in _COLUMNS_FIRST:
        raise ImageError(
            f"the axes of the {type(array).__name__} are {axes[0]} and {axes[1]}, and an image has "
            "rows first: give its transpose, or across and along are exchanged"
        )
    if isinstance(array, list | tuple) and array and all(map(_is_image, array)):
        raise ImageError(
            f"the {type(array).__name__} holds {len(array)} image{'s' * (len(array) > 1)}, and "
            "one is measured at a time: give one of them; a list to measure_edges is one of pairs "
            "(image, region)"
        )
    try:
        found: NDArray[Any] = np.asanyarray(array)
    except (TypeError, ValueError) as error:
        raise ImageError(
            f"the {type(array).__name__} given cannot be made an array ({error}): give "
            "rows of equal length"
        ) from error
    if found.dtype == object and found.ndim == 0:
        raise ImageError(
            f"a {type(array).__name__} is no array: give rows and columns of numbers; a file is "
            "opened by its name, acutance.open_image(name)"
        )
    return found


def _is_image(one: Any) -> bool:
    """Whether a part of what was given is an image itself."""
    return isinstance(one, Image) or (isinstance(one, np.ndarray) and one.ndim > 1)
