"""Whether a filter belongs to an image: its pixel size, its band, what was done before."""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from acutance.errors import OptionError
from acutance.raster import Image
from acutance.raster.restored_tag import BEFORE_TAG, RESTORED_TAG
from acutance.restoration.restoration_filter import RestorationFilter

__all__ = [
    "chosen_bands",
    "match_notes",
    "require_match",
    "require_unrestored",
    "restored_tags",
]

_GSD_SHARE = 0.02


def chosen_bands(
    first: Image, filter: RestorationFilter, bands: int | Sequence[int] | Literal["all"] | None
) -> list[int]:
    """The bands to be filtered.

    Raises
    ------
    OptionError
        If none was named, and none follows from the filter, or one is no number.
    """
    if isinstance(bands, str) and bands == "all":
        alpha = getattr(first.source, "alpha_band", None)
        return [one for one in range(1, first.band_count + 1) if one != alpha]
    if bands is not None:
        return _numbers(bands)
    if first.band_count == 1:
        return [1]
    if filter.band is None:
        raise OptionError(
            f"the image has {first.band_count} bands, and the filter was measured in none of "
            "them: say which to filter (bands, --band N or --band all)"
        )
    return [filter.band]


def _numbers(bands: Any) -> list[int]:
    """Bands as numbers, each once, whatever kind of integers they were given as."""
    try:
        numbers = [operator.index(one) for one in (bands if np.iterable(bands) else [bands])]
    except TypeError:
        raise OptionError(f"bands is {bands!r:.80}: give numbers from 1, or 'all'") from None
    if not numbers:
        # Without this a copy of the image would be written and tagged as restored.
        raise OptionError("bands is empty, no band was named: give numbers from 1, or 'all'")
    return list(dict.fromkeys(numbers))


def require_match(
    image: Image, filter: RestorationFilter, bands: Sequence[int], all_stated: bool
) -> None:
    """Refuse pixels of another size, and another band, than those that were measured.

    Raises
    ------
    OptionError
        If these are others; it says in what, and what to do.
    """
    gsd, known = image.gsd() if image.states_gsd else None, filter.gsd_m
    if gsd is not None and known is not None:
        for own, measured in zip((gsd.row_m, gsd.col_m), known, strict=True):
            if not math.isclose(own, measured, rel_tol=_GSD_SHARE):
                raise OptionError(
                    f"the image has pixels of {gsd.row_m:.4g} by {gsd.col_m:.4g} m, the filter was "
                    f"made for {known[0]:.4g} by {known[1]:.4g} m: design one for this product, or "
                    "accept the mismatch (accept_mismatch=True, --accept-mismatch)"
                )
    other = [band for band in bands if band != filter.band]
    if filter.band is not None and image.band_count > 1 and other and not all_stated:
        raise OptionError(
            f"the filter was measured in band {filter.band}, band {other[0]} was asked for: design "
            "one for it, state that all bands are alike (bands='all', --band all), or accept the "
            "mismatch (accept_mismatch=True, --accept-mismatch)"
        )


def require_unrestored(path: str, tags: dict[str, str]) -> None:
    """Refuse an image whose tags say that a filter was applied to it.

    Raises
    ------
    OptionError
        If it was; it names the filter.
    """
    if RESTORED_TAG in tags:
        raise OptionError(
            f"{path} was restored before ({tags[RESTORED_TAG]}): a second time would sharpen what "
            "is sharp; give the original, or accept it (accept_mismatch=True, --accept-mismatch)"
        )


def restored_tags(applied: str, tags: Mapping[str, str]) -> dict[str, str]:
    """Items of an image that a filter is applied to: this one, and those of earlier times.

    Parameters
    ----------
    applied : str
        The filter, in a line.
    tags : mapping of str to str
        What the image has before.
    """
    earlier = [tags[name] for name in (BEFORE_TAG, RESTORED_TAG) if name in tags]
    return {RESTORED_TAG: applied} | ({BEFORE_TAG: " | ".join(earlier)} if earlier else {})


def match_notes(image: Image, filter: RestorationFilter, bands: Sequence[int]) -> tuple[str, ...]:
    """What could not be compared with the filter, and what was copied as it is."""
    notes = []
    if image.gsd() is None or filter.gsd_m is None:
        of = "the image" if image.gsd() is None else "the filter"
        notes.append(f"the pixel size was not compared: that of {of} is not known")
    others = [band for band in bands if band != filter.band]
    if image.band_count > 1 and filter.band is None:
        notes.append("the band was not compared: the filter is of none")
    elif image.band_count > 1 and others:
        notes.append(f"filtered though the filter is of band {filter.band}: {_listed(others)}")
    copied = [band for band in range(1, image.band_count + 1) if band not in bands]
    if copied:
        notes.append(f"copied unfiltered: {_listed(copied)}")
    return tuple(notes)


def _listed(bands: Sequence[int]) -> str:
    return f"band{'s' if len(bands) > 1 else ''} {', '.join(map(str, bands))}"
