"""One nodata value for all bands, as a GeoTIFF has it, of bands that may have one each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rasterio.enums import ColorInterp

from acutance.raster.dataset import declared_nodata
from acutance.raster.pixels import equals_nodata, storable_nodata

__all__ = ["UnifiedNodata", "unified_nodata"]


@dataclass(frozen=True)
class UnifiedNodata:
    """The nodata values of the bands of a file, and the one of its copy.

    Parameters
    ----------
    own : tuple of (float or None)
        Of every band.
    common : float or None
        Of all bands of the copy.
    untouched : tuple of int
        Bands of transparency, from 1: no value of theirs means that there are no data.
    """

    own: tuple[float | None, ...]
    common: float | None
    untouched: tuple[int, ...] = ()

    @property
    def differ(self) -> bool:
        """Whether pixels have to be changed in any band."""
        return any(self._differs(band) for band in range(1, len(self.own) + 1))

    def _differs(self, band: int) -> bool:
        own = self.own[band - 1]
        if self.common is None or band in self.untouched:
            return False
        return own is None or not np.array_equal(own, self.common, equal_nan=True)

    def unified(self, pixels: NDArray[Any], band: int) -> tuple[NDArray[Any], int]:
        """Pixels of a band with the common value, and how many with data were moved off it.

        Parameters
        ----------
        pixels : (rows, cols) array
            With the band's own value where there are no data.
        band : int
            From 1.
        """
        if not self._differs(band):
            return pixels, 0
        assert self.common is not None
        without = equals_nodata(pixels, self.own[band - 1])
        taken = equals_nodata(pixels, self.common) & ~without
        found = pixels.copy()
        # Of floats it is NaN, which no pixel equals.
        if taken.any():
            found[taken] = int(self.common) + (1 if self.common <= 0 else -1)
        found[without] = self.common
        return found, int(np.count_nonzero(taken))

    def notes(self, moved: dict[int, int]) -> tuple[str, ...]:
        """What became of values that differ, in a sentence.

        Parameters
        ----------
        moved : dict of int to int
            By band, how many pixels with data were moved.
        """
        if not self.differ:
            return ()
        stated = [one for band, one in enumerate(self.own, 1) if band not in self.untouched]
        listed = ", ".join(dict.fromkeys("none" if one is None else f"{one:g}" for one in stated))
        bands = ", ".join(f"{count} of band {band}" for band, count in moved.items() if count)
        steps = f"; pixels with data of that value were moved by one step: {bands}" if bands else ""
        return (
            f"the bands have different nodata values ({listed}), in the new file all have "
            f"{self.common:g}{steps}",
        )


def unified_nodata(dataset: Any, stated: float | None) -> UnifiedNodata:
    """The nodata values of an open file, and the one its copy as GeoTIFF can have.

    Where bands have different ones it is NaN of floats, and of integers the first.

    Parameters
    ----------
    dataset : rasterio dataset
    stated : float or None
        Instead of what the file declares; NaN where every value is data.
    """
    bands = range(1, dataset.count + 1)
    dtype = np.dtype(dataset.dtypes[0])
    if stated is not None:
        own_values = (stated,) * dataset.count
        return UnifiedNodata(own_values, storable_nodata(dtype, stated), tuple(bands))
    own = tuple(declared_nodata(dataset, band) for band in bands)
    alpha = tuple(band for band in bands if dataset.colorinterp[band - 1] == ColorInterp.alpha)
    known = [
        value
        for band, one in zip(bands, own, strict=True)
        if band not in alpha and (value := storable_nodata(dtype, one)) is not None
    ]
    found = UnifiedNodata(own, known[0] if known else None, alpha)
    return UnifiedNodata(own, np.nan, alpha) if found.differ and dtype.kind == "f" else found
