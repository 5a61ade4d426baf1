"""From rows of an archive to series: one metric of one sensor, band, product level, direction.

Where GSDs lie apart as those of products do, a series is of one of them, too: images that do not
tell their sensor would else be joined to one.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from acutance.archive.columns import Columns
from acutance.archive.measured_again import measured_again_notes
from acutance.archive.natural_order import natural_key
from acutance.archive.restored_images import restored_notes
from acutance.archive.trends.gsd import SAME_GSD, gsd_classes
from acutance.archive.trends.possible_dates import impossible_date_notes, possible_dates
from acutance.archive.trends.series import Series
from acutance.curves import MAIN_NUMBERS, METRICS
from acutance.curves.grid import Floats
from acutance.errors import NothingSelectedError, OptionError

__all__ = [
    "NO_SENSOR",
    "all_series",
    "by_gsd",
    "gsd_words",
    "one_series",
    "pixel_side_m",
    "random_and_systematic",
    "target_codes",
    "unmeasured_directions",
    "years_of",
]

NO_SENSOR = "images without a sensor"
"""What series of them are called by."""

_PRODUCT = ("sensor", "band", "level")
_ONE_OF = (*_PRODUCT, "orientation")
"""What a trend is of one of."""
_MIXED = ("method", "kind")
"""What differs in how it measures: its change looks like one of the sensor."""


class TargetCodes(TypedDict):
    """Fields of a series, (n,) each."""

    target: NDArray[np.int64]
    site: NDArray[np.int64]


def one_series(rows: Columns, metric: str) -> Series:
    """The series of rows that are of one sensor, band, product level, direction and class of GSD.

    Parameters
    ----------
    rows : Columns
        Of `acutance.Archive.measurements`.
    metric : str

    Raises
    ------
    OptionError
        If there is no such metric, no rows, or they are of several sensors, bands, levels
        or directions.
    """
    _require_metric(metric)
    if not len(rows):
        raise NothingSelectedError("the archive holds nothing that is selected: widen the filters")
    for name in _ONE_OF:
        found = _words(rows, name)
        if len(found) > 1:
            raise OptionError(
                f"the measurements are of {len(found)} {name}s, {', '.join(found)}: select one "
                f"({name}=..., --{name})"
            )
    sizes = [gsd_words(pixel_side_m(rows, mask)) for mask in by_gsd(rows)]
    if len(sizes) > 1:
        raise OptionError(
            f"the measurements are of {len(sizes)} GSDs, {', '.join(sizes)}: select one, by "
            "sensor, band, image or date"
        )
    return _series(rows, metric, np.ones(len(rows), bool))


def all_series(rows: Columns, metric: str) -> Iterator[Series]:
    """A series for each sensor, band, product level, direction and class of GSD of rows.

    Parameters
    ----------
    rows : Columns
    metric : str
    """
    _require_metric(metric)
    for ours in _masks_by(rows, _ONE_OF):
        classes = by_gsd(rows, ours)
        for mask in classes:
            size = gsd_words(pixel_side_m(rows, mask)) if len(classes) > 1 else None
            yield _series(rows, metric, mask, size)


def unmeasured_directions(rows: Columns) -> Iterator[tuple[str, str]]:
    """What was measured in one direction alone: the series that is not there, and the direction.

    ("QB02, pan, along", "across") where there are rows across and none along.

    Parameters
    ----------
    rows : Columns
    """
    for ours in _masks_by(rows, _PRODUCT):
        classes = by_gsd(rows, ours)
        alone = [mask for mask in classes if len(set(rows["orientation"][mask].tolist())) == 1]
        across = [mask for mask in alone if rows["orientation"][mask][0] == "across"]
        # Of pixels that are far from square across and along are classes of their own.
        if 2 * len(across) == len(alone):
            continue
        for mask in alone:
            size = gsd_words(pixel_side_m(rows, mask)) if len(classes) > 1 else None
            measured = str(rows["orientation"][mask][0])
            other = "along" if measured == "across" else "across"
            yield _title(rows, mask, size, other), measured


def _masks_by(rows: Columns, names: tuple[str, ...]) -> Iterator[NDArray[np.bool_]]:
    """A mask for each combination of words of some columns, in natural order."""
    keys = [tuple(one) for one in zip(*(rows[name].tolist() for name in names), strict=True)]
    index = {key: at for at, key in enumerate(dict.fromkeys(keys))}
    label = np.array([index[key] for key in keys], int)
    for key in sorted(index, key=lambda one: tuple(map(natural_key, one))):
        yield label == index[key]


def by_gsd(rows: Columns, mask: NDArray[np.bool_] | None = None) -> list[NDArray[np.bool_]]:
    """Masks of the classes of GSD among some rows, the finest first; unknown GSDs apart.

    Where all known GSDs are of one class, the unknown ones are taken to be of it.
    """
    ours = np.ones(len(rows), bool) if mask is None else mask
    label = np.full(len(rows), -1)
    label[ours] = gsd_classes(pixel_side_m(rows, ours))
    known = np.unique(label[ours & (label >= 0)]).tolist()
    if len(known) < 2:
        return [ours]
    masks = [ours & (label == one) for one in (*known, -1)]
    return [one for one in masks if one.any()]


def pixel_side_m(rows: Columns, mask: NDArray[np.bool_]) -> Floats:
    """GSD of some rows along the axis of the image nearest to their directions, metres, (n,).

    That along the direction itself changes with the slope of the target where pixels are not
    square, and the sensor does not. It stands where the image's pixels are not known, or others
    than those that were measured.

    Parameters
    ----------
    rows : Columns
    mask : (m,) bool array
        Which n of the rows.
    """
    row_m, col_m, measured = (rows[name][mask] for name in ("gsd_row_m", "gsd_col_m", "gsd_m"))
    # Whichever axis the track is along: that decides what a direction is called.
    side = np.where(np.abs(rows["normal_deg"][mask]) <= 45.0, col_m, row_m)
    finer = measured < np.minimum(row_m, col_m) * (1 - SAME_GSD)
    coarser = measured > np.maximum(row_m, col_m) * (1 + SAME_GSD)
    return np.where(np.isnan(side) | finer | coarser, measured, side)


def gsd_words(gsd_m: Floats) -> str:
    """The GSD of a class, from smallest to largest: "GSD 30 m"."""
    known = gsd_m[np.isfinite(gsd_m)]
    if known.size == 0:
        return "GSD unknown"
    low, high = f"{known.min():.3g}", f"{known.max():.3g}"
    return f"GSD {low} m" if low == high else f"GSD {low} to {high} m"


def _require_metric(metric: str) -> None:
    if not isinstance(metric, str) or metric not in METRICS:
        raise OptionError(f"there is no metric {metric!r}, only {', '.join(METRICS)}")


def _title(rows: Columns, mask: NDArray[np.bool_], size: str | None, orientation: str) -> str:
    """What the rows of a mask are of: "QB02, pan, across"."""
    sensor, band, level = (rows[name][mask][0] for name in _PRODUCT)
    parts = (sensor or NO_SENSOR, _band_words(band), level, size, orientation)
    return ", ".join(str(part) for part in parts if part is not None)


def _band_words(band: str | None) -> str | None:
    """The name of a band; of one that is known by its number alone, that it is a band."""
    return f"band {band}" if band is not None and band.isdecimal() else band


def _words(rows: Columns, name: str) -> list[str]:
    """All names of a column in order, last how rows without any are selected."""
    names = set(rows[name].tolist())
    without = ["'' (of those without a name)"] if None in names else []
    return sorted(str(one) for one in names - {None}) + without


def _series(rows: Columns, metric: str, mask: NDArray[np.bool_], size: str | None = None) -> Series:
    value = rows[metric][mask]
    std, systematic = random_and_systematic(rows, metric, mask)
    image = rows["image_id"][mask]
    names = dict(zip(image.tolist(), rows["image"][mask].tolist(), strict=True))
    return Series(
        metric=metric, when=years_of(rows["acquired"][mask]), value=value, std=std,
        systematic_std=systematic, image=image, gsd_m=pixel_side_m(rows, mask),
        **target_codes(rows, mask),
        image_names={number: name for number, name in names.items() if name is not None},
        name=_title(rows, mask, size, rows["orientation"][mask][0]),
        notes=(
            *_unnamed(rows, mask), *_mixed(rows, mask), *restored_notes(rows, mask),
            *measured_again_notes(rows, mask), *impossible_date_notes(rows, mask),
        ),
    )  # fmt: skip


def target_codes(rows: Columns, mask: NDArray[np.bool_]) -> TargetCodes:
    """Which target and which site some rows are of, as a series has them.

    Parameters
    ----------
    rows : Columns
    mask : (m,) bool array
        Which n of the rows.
    """
    sites, names = (rows[name][mask].tolist() for name in ("site", "target"))
    targets = [None if name is None else (site, name)
               for site, name in zip(sites, names, strict=True)]  # fmt: skip
    return {"target": _codes(targets), "site": _codes(sites)}


def _codes(words: Sequence[Hashable | None]) -> NDArray[np.int64]:
    """A number from 0 on for every word, -1 for none."""
    index = {one: at for at, one in enumerate(dict.fromkeys(words)) if one is not None}
    return np.array([-1 if one is None else index[one] for one in words], np.int64)


def random_and_systematic(
    rows: Columns, metric: str, mask: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Random and systematic parts of the stated deviations, (n,) each.

    Budgets are of the main numbers; the largest of their systematic shares stands in for others.

    Parameters
    ----------
    rows : Columns
    metric : str
    mask : (m,) bool array
        Which n of the rows.
    """
    std = rows[f"{metric}_std"][mask]
    if metric in MAIN_NUMBERS:
        systematic = np.nan_to_num(rows[f"{metric}_systematic_std"][mask])
    else:
        with np.errstate(invalid="ignore", divide="ignore"):
            shares = [rows[f"{name}_systematic_std"][mask] / rows[f"{name}_std"][mask]
                      for name in MAIN_NUMBERS]  # fmt: skip
        share = np.max([np.where(np.isfinite(one), one, 0.0) for one in shares], axis=0)
        systematic = np.nan_to_num(share * std)
    systematic = np.minimum(systematic, np.nan_to_num(std))
    return np.sqrt(np.maximum(std**2 - systematic**2, 0.0)), systematic


def years_of(acquired: NDArray[np.datetime64]) -> Floats:
    """Years with decimals; ``nan`` where there is no date, or one that no image can have."""
    acquired = possible_dates(acquired)
    year = acquired.astype("datetime64[Y]")
    begin, end = (one.astype("datetime64[us]") for one in (year, year + 1))
    return np.asarray(1970 + year.astype(float) + (acquired - begin) / (end - begin))


def _unnamed(rows: Columns, mask: NDArray[np.bool_]) -> Iterator[str]:
    images = np.unique(rows["image_id"][mask]).size
    missing = [name for name in ("sensor", "band") if rows[name][mask][0] is None]
    if missing and images > 1:
        yield f"No {' and no '.join(missing)} is named: {images} images are taken to be of one."


def _mixed(rows: Columns, mask: NDArray[np.bool_]) -> Iterator[str]:
    for name in _MIXED:
        found = sorted({str(one) for one in rows[name][mask].tolist() if one is not None})
        if len(found) > 1:
            yield (
                f"Measurements of {len(found)} {name}s are mixed ({', '.join(found)}): where one "
                "takes over from another, that looks like a change of the sensor."
            )
