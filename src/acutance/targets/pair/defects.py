"""Defective pixels of either image of a pair: values far beyond all others, in one image alone.

A single such value, as an undeclared fill or a hot pixel, turns a registration and is the largest
part of the spectra of every window it lies in. A lamp or a mirror is as bright, but both images
show it.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, uniform_filter

from acutance.curves.grid import Floats
from acutance.targets.pair.tile import FAR_PX

__all__ = ["Defects", "beyond_any_scene", "find_defects", "means_of_cells", "repaired"]

_BEYOND: Final = 10.0
"""Distance from the median of a value that may be defective, in units of the distance that 99 % of
the image stay within: glints that bright are rare, and what is lost of them is one pixel."""
_NO_SCENE: Final = 1e6
"""Such a distance is left out whatever the other image shows: it has no digits left beside it."""
_SHOWN: Final = 0.2
"""Share of a value's light at least that is in the brightest pixel of the other image."""
_NOTHING: Final = 2.0
"""Distances within which the other image shows nothing out of the ordinary."""
_AROUND_PX: Final = 10
"""How far off the other image may show it, in low pixels: the largest shift that is looked for
unless stated, and the blur."""


class Defects(NamedTuple):
    """Where the pixels of a tile are defective.

    Attributes
    ----------
    low : (h, w) bool array
    high : bool array
        Of the samples, which reach FAR_PX low pixels beyond.
    """

    low: NDArray[np.bool_]
    high: NDArray[np.bool_]


def find_defects(low: Floats, samples: Floats, per_px: tuple[int, int]) -> Defects:
    """Values of one image alone that lie far beyond all others.

    Parameters
    ----------
    low : (h, w) array
        NaN where there are no data.
    samples : ((h + 2 FAR_PX) n, (w + 2 FAR_PX) m) array
        Of the high image, on the same ground and FAR_PX low pixels around it.
    per_px : (int, int)
        Samples of a low pixel, n down and m across.
    """
    of_low, of_high = _distance(low), _distance(samples)
    bright_low, bright_high = of_low > _BEYOND, of_high > _BEYOND
    if bright_low.any():
        cells = _around(_distance(means_of_cells(samples, per_px)))
        shown = cells[FAR_PX:-FAR_PX, FAR_PX:-FAR_PX]
        bright_low &= shown < _SHOWN * of_low
    if bright_high.any():
        near = np.pad(_around(of_low), FAR_PX, mode="edge")
        shown = np.repeat(np.repeat(near, per_px[0], axis=0), per_px[1], axis=1)
        share = _SHOWN / (per_px[0] * per_px[1])
        bright_high &= shown < np.maximum(_NOTHING, share * of_high)
    return Defects(bright_low, bright_high)


def beyond_any_scene(values: Floats) -> NDArray[np.bool_]:
    """Values beside which the others have no digits left."""
    return _distance(values) > _NO_SCENE


def means_of_cells(samples: Floats, per_px: tuple[int, int]) -> Floats:
    """Means of samples over low pixels."""
    rows, cols = (size // per for size, per in zip(samples.shape, per_px, strict=True))
    return np.asarray(samples.reshape(rows, per_px[0], cols, per_px[1]).mean(axis=(1, 3)))


def repaired(field: Floats, bad: NDArray[np.bool_], reach: int) -> Floats:
    """A field whose bad values are the mean of the others around, out to a reach."""
    known = np.where(bad, 0.0, field)
    share = uniform_filter((~bad).astype(float), 2 * reach + 1, mode="nearest")
    total = uniform_filter(known, 2 * reach + 1, mode="nearest")
    everywhere = float(np.median(field[~bad])) if not bad.all() else 0.0
    near = np.where(share > 0.05, total / np.maximum(share, 0.05), everywhere)
    return np.where(bad, near, field)


def _distance(field: Floats) -> Floats:
    """From the median, in units of what 99 % of the field stay within; 0 where it is even."""
    known = np.isfinite(field)
    if not known.any():
        return np.zeros(field.shape)
    away = np.abs(np.where(known, field, np.nan) - np.median(field[known]))
    usual = float(np.quantile(away[known], 0.99))
    return np.where(known, away / usual, 0.0) if usual > 0 else np.zeros(field.shape)


def _around(distance: Floats) -> Floats:
    """The largest distance near every place."""
    return np.asarray(maximum_filter(distance, 2 * _AROUND_PX + 1, mode="nearest"))
