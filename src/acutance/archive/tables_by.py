"""Tables of measurements across and along the track, by sensor, band, site, date.

A cell of several measurements is their mean with random effects (`acutance.archive.weighted_means`)
over images; every leading group has its average. The tables of the QuickBird and KOMPSAT-3
documents are of this form.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.columns import Columns, csv_text
from acutance.archive.group_words import NO_WORD, group_words
from acutance.archive.mean_of_images import mean_of_images
from acutance.archive.measured_again import measured_again_notes
from acutance.archive.measurements import Measurements
from acutance.archive.mixed_methods import mixed_methods_notes
from acutance.archive.natural_order import natural_key
from acutance.archive.restored_images import restored_notes
from acutance.archive.trends.measured_series import random_and_systematic, target_codes
from acutance.archive.trends.series import Series
from acutance.arguments import require_texts
from acutance.curves import METRICS, Estimate
from acutance.curves.aligned_columns import align_columns
from acutance.errors import NothingSelectedError, OptionError

__all__ = ["GROUPS", "MeasurementTable", "TableRow", "table_by"]

GROUPS: Final = (
    "sensor", "band", "level", "site", "target", "date", "kind", "method", "image", "verdict",
)  # fmt: skip
"""What measurements can be grouped by."""
ORIENTATIONS: Final = ("across", "along")
_NEVER_MIXED: Final = ("sensor", "band", "level")
PRINTED: Final = ("prf_fwhm_px", "prf_fwhm_m")
"""Numbers of published tables that are no metric: widths of pulse responses, the target's included.
They are read from the documents."""
AVERAGE: Final = "average"
_MEANS: Final = (
    "± of a mean holds the scatter between images (of one image: between its targets), and between "
    "targets and sites that come again; it is widened for how few they are: 1.96 of it hold "
    "95 % (Student's t)."
)
_SINGLE: Final = "* one measurement: ± is its own deviation, without that scatter."


@dataclass(frozen=True)
class TableRow:
    """One row.

    Attributes
    ----------
    group : tuple of str
        Values of the columns the table is grouped by; an average has "average" after those it is
        of.
    images, measurements : int
    gsd_m : (float, float) or None
        Smallest and largest.
    cells : dict of (str, str) to Estimate
        By orientation and metric; what was not measured is missing.
    counts : dict of (str, str) to int
        The measurements of every cell.
    images_by : dict of str to int
        Images in which something of a direction was measured.
    gsd_by : dict of str to ((float, float) or None)
        Of a direction.
    """

    group: tuple[str, ...]
    images: int
    measurements: int
    gsd_m: tuple[float, float] | None
    cells: dict[tuple[str, str], Estimate]
    counts: dict[tuple[str, str], int]
    images_by: dict[str, int]
    gsd_by: dict[str, tuple[float, float] | None]

    @property
    def is_average(self) -> bool:
        """Whether it is the average of the rows before it."""
        return AVERAGE in self.group


@dataclass(frozen=True)
class MeasurementTable:
    """Rows of means across and along.

    Attributes
    ----------
    by : tuple of str
    metrics : tuple of str
    rows : tuple of TableRow
        In the order of their groups, averages after them.
    image_notes : tuple of str
        What is peculiar about images of the means.
    """

    by: tuple[str, ...]
    metrics: tuple[str, ...]
    rows: tuple[TableRow, ...]
    image_notes: tuple[str, ...] = ()

    @property
    def columns(self) -> tuple[tuple[str, str], ...]:
        """Orientation and metric of the columns that hold something."""
        found = {key for row in self.rows for key in row.cells}
        every = ((one, metric) for one in ORIENTATIONS for metric in self.metrics)
        return tuple(key for key in every if key in found)

    @property
    def header(self) -> tuple[str, ...]:
        """Titles of all columns."""
        return (*self.by, *self._image_header, "GSD [m]",
                *(f"{metric} {one}" for one, metric in self.columns))  # fmt: skip

    @property
    def notes(self) -> tuple[str, ...]:
        """What has to be known of images and deviations to read the means."""
        return (*self.image_notes, *self._deviation_notes)

    @property
    def _deviation_notes(self) -> tuple[str, ...]:
        if not any(count > 1 for row in self.rows for count in row.counts.values()):
            return ()
        return (_MEANS, _SINGLE) if any(map(_single_cells, self.rows)) else (_MEANS,)

    @property
    def _image_header(self) -> tuple[str, ...]:
        """One column of images, or one a direction where these were seen in different ones."""
        if all(count == row.images for row in self.rows for count in row.images_by.values()):
            return ("images",)
        shown = dict.fromkeys(orientation for orientation, _ in self.columns)
        return tuple(f"images {orientation}" for orientation in shown)

    def __str__(self) -> str:
        """The table with its header and notes, as it is printed."""
        sides = "l" * len(self.by) + "r" * (len(self.header) - len(self.by))
        aligned = align_columns([self.header, *self.texts()], sides, indent="")
        return "\n".join([aligned, "", *self.notes] if self.notes else [aligned])

    def texts(self) -> Iterator[tuple[str, ...]]:
        """The rows as text; where some cells are means, those of one measurement have a star."""
        sides, is_mixed = (
            [title.partition(" ")[2] for title in self._image_header],
            self._deviation_notes,
        )
        for row in self.rows:
            images = (row.images_by.get(side, 0) if side else row.images for side in sides)
            starred = _single_cells(row) if is_mixed else set()
            cells = (
                f"{'*' if key in starred else ''}{_text(row.cells.get(key))}"
                for key in self.columns
            )
            yield (*row.group, *map(str, images), _gsd_text(row.gsd_m), *cells)

    def of_direction(self, orientation: str) -> MeasurementTable:
        """What was measured in one direction; images are those in which it was."""
        rows = tuple(
            replace(
                row,
                images=row.images_by[orientation],
                gsd_m=row.gsd_by[orientation],
                cells={key: one for key, one in row.cells.items() if key[0] == orientation},
                counts={key: one for key, one in row.counts.items() if key[0] == orientation},
                images_by={orientation: row.images_by[orientation]},
            )
            for row in self.rows
            if orientation in row.images_by
        )
        return replace(self, rows=tuple(row for row in rows if not _repeats(row, rows)))

    def to_csv(self) -> str:
        """The text of a table with all digits: of each mean its deviation and count as well."""
        ends = "", "_std", "_count"
        names = (f"{metric}_{one}{end}" for one, metric in self.columns for end in ends)
        header = (*self.by, "is_average", "images", "measurements", "gsd_min_m", "gsd_max_m")
        return csv_text((*header, *names), (_csv_row(row, self.columns) for row in self.rows))

    def to_dict(self) -> dict[str, Any]:
        """All rows as strict JSON types."""
        return {
            "schema": "acutance/archive-table/1",
            "by": list(self.by),
            "metrics": list(self.metrics),
            "notes": list(self.notes),
            "rows": [_row_document(row, self.by) for row in self.rows],
        }


def table_by(
    rows: Measurements,
    by: Sequence[str] = ("site", "date"),
    metrics: Sequence[str] = ("rer", "fwhm_px", "mtf_nyquist"),
) -> MeasurementTable:
    """Means across and along by what measurements are grouped by.

    Sensors, bands and product levels are never mixed: where there are several of them, they lead
    the groups.

    Parameters
    ----------
    rows : Measurements
    by : sequence of str, optional
        Of `GROUPS`.
    metrics : sequence of str, optional

    Returns
    -------
    MeasurementTable

    Raises
    ------
    OptionError
        If there is no such group or metric, or there are no rows.
    """
    by, metrics = require_texts("by", by), require_texts("metrics", metrics)
    _require(rows, by, metrics)
    numbers = _with_printed(rows, [name for name in metrics if name in PRINTED])
    words = {name: group_words(rows, name) for name in GROUPS}
    lead = [name for name in _NEVER_MIXED if name not in by and len(set(words[name])) > 1]
    names = (*lead, *by)
    keys = list(zip(*(words[name] for name in names), strict=True))
    ordered = sorted(set(keys), key=lambda key: tuple(map(natural_key, key)))
    found = [_row(numbers, key, _mask(keys, key), metrics) for key in ordered]
    fixed = max(len(lead), max((names.index(one) + 1 for one in _NEVER_MIXED if one in by
                                and len(set(words[one])) > 1), default=0))  # fmt: skip
    every = np.ones(len(rows), bool)
    return MeasurementTable(
        names, tuple(metrics), tuple(_with_averages(numbers, found, keys, fixed, metrics)),
        (*mixed_methods_notes(words, by), *restored_notes(rows, every),
         *measured_again_notes(rows, every)),
    )  # fmt: skip


def _require(rows: Columns, by: Sequence[str], metrics: Sequence[str]) -> None:
    unknown = [name for name in by if name not in GROUPS]
    if unknown or not by:
        raise OptionError(
            f"a table is by {', '.join(unknown) or 'nothing'}: choose of {', '.join(GROUPS)}"
        )
    strange = [name for name in metrics if name not in (*METRICS, *PRINTED)]
    if strange or not metrics:
        raise OptionError(
            f"there is no metric {', '.join(strange) or '(none given)'}, only "
            f"{', '.join((*METRICS, *PRINTED))}"
        )
    if not len(rows):
        raise NothingSelectedError("the archive holds nothing that is selected: widen the filters")


def _with_printed(rows: Measurements, names: Sequence[str]) -> Columns:
    """The rows with columns of printed numbers that are no metric."""
    columns = dict(rows.columns)
    records = (
        dict(zip(dict.fromkeys(rows["id"].tolist()), rows.records(), strict=True)) if names else {}
    )
    for name in names:
        found = [
            (records[number].directions[orientation].document.get(name) or {}).get("value")
            for number, orientation in zip(rows["id"].tolist(), rows["orientation"], strict=True)
        ]
        columns[name] = np.array(found, float)
        columns[f"{name}_std"] = np.full(len(rows), np.nan)
    return Columns(columns)


def _mask(keys: list[tuple[str, ...]], prefix: tuple[str, ...]) -> NDArray[np.bool_]:
    return np.array([key[: len(prefix)] == prefix for key in keys])


def _row(
    rows: Columns, group: tuple[str, ...], mask: NDArray[np.bool_], metrics: Sequence[str]
) -> TableRow:
    cells, counts, images_by, gsd_by = {}, {}, {}, {}
    for orientation in ORIENTATIONS:
        own = mask & (rows["orientation"] == orientation)
        seen = np.zeros(own.size, bool)
        for metric in metrics:
            known = own & np.isfinite(rows[metric])
            if known.any():
                cells[orientation, metric] = _cell(rows, metric, known)
                counts[orientation, metric] = int(known.sum())
                seen |= known
        if seen.any():
            images_by[orientation] = np.unique(rows["image_id"][seen]).size
            gsd_by[orientation] = _range(rows["gsd_m"][seen])
    return TableRow(
        group,
        np.unique(rows["image_id"][mask]).size,
        np.unique(rows["id"][mask]).size,
        _range(rows["gsd_m"][mask]),
        cells,
        counts,
        images_by,
        gsd_by,
    )


def _range(numbers: NDArray[np.float64]) -> tuple[float, float] | None:
    known = numbers[np.isfinite(numbers)]
    return (float(known.min()), float(known.max())) if known.size else None


def _cell(rows: Columns, metric: str, mask: NDArray[np.bool_]) -> Estimate:
    """One measurement as it is, of several the mean of the means of images."""
    value, std = rows[metric][mask], rows[f"{metric}_std"][mask]
    if value.size == 1:
        return Estimate(float(value[0]), float(std[0]))
    random, systematic = random_and_systematic(rows, metric, mask)
    series = Series(
        metric=metric, when=np.zeros(value.size), value=value, std=random,
        systematic_std=systematic, image=rows["image_id"][mask], **target_codes(rows, mask),
    )  # fmt: skip
    return mean_of_images(series).mean


def _with_averages(
    rows: Columns, found: list[TableRow], keys: list[tuple[str, ...]], fixed: int,
    metrics: Sequence[str],
) -> Iterator[TableRow]:  # fmt: skip
    """The rows, after each leading group its average, and that of all where nothing is mixed.

    Parameters
    ----------
    rows : Columns
    found : list of TableRow
    keys : list of tuple of str
        Groups of the rows of the archive.
    fixed : int
        Leading columns that averages may not run over.
    metrics : sequence of str
    """
    width = len(found[0].group)
    for at, row in enumerate(found):
        yield row
        for size in range(width - 1, fixed - 1, -1):
            prefix = row.group[:size]
            is_last = at + 1 == len(found) or found[at + 1].group[:size] != prefix
            count = sum(one.group[:size] == prefix for one in found)
            if is_last and count > 1:
                blank = ("",) * (width - size - 1)
                group = (*prefix, AVERAGE, *blank)
                yield _row(rows, group, _mask(keys, prefix), metrics)


def _repeats(average: TableRow, rows: Sequence[TableRow]) -> bool:
    """Whether an average is that of one row, which the direction has left of its group."""
    if not average.is_average:
        return False
    prefix = average.group[: average.group.index(AVERAGE)]
    own = [row for row in rows if not row.is_average and row.group[: len(prefix)] == prefix]
    return len(own) < 2


def _single_cells(row: TableRow) -> set[tuple[str, str]]:
    """Cells with the deviation of one measurement."""
    return {
        key for key, count in row.counts.items()
        if count == 1 and np.isfinite(row.cells[key].std)
    }  # fmt: skip


def _text(estimate: Estimate | None) -> str:
    return NO_WORD if estimate is None else str(estimate)


def _gsd_text(gsd_m: tuple[float, float] | None) -> str:
    if gsd_m is None:
        return NO_WORD
    low, high = gsd_m
    return f"{low:.3g}" if high <= 1.005 * low else f"{low:.3g}–{high:.3g}"


def _csv_row(row: TableRow, columns: tuple[tuple[str, str], ...]) -> tuple[Any, ...]:
    gsd_m = row.gsd_m or (None, None)
    found = (row.cells[key].to_dict() | {"n": row.counts[key]} if key in row.cells else {}
             for key in columns)  # fmt: skip
    cells = (one.get(name) for one in found for name in ("value", "std", "n"))
    return (*row.group, int(row.is_average), row.images, row.measurements, *gsd_m, *cells)


def _row_document(row: TableRow, by: tuple[str, ...]) -> dict[str, Any]:
    cells: dict[str, dict[str, Any]] = {}
    for (orientation, metric), estimate in row.cells.items():
        count = row.counts[orientation, metric]
        cells.setdefault(orientation, {})[metric] = {**estimate.to_dict(), "count": count}
    return {
        **dict(zip(by, row.group, strict=True)),
        "is_average": row.is_average,
        "images": row.images,
        "images_by_direction": row.images_by,
        "measurements": row.measurements,
        "gsd_m": None if row.gsd_m is None else list(row.gsd_m),
        **cells,
    }
