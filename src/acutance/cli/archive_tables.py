"""What the commands of an archive print: tables as wide as the terminal, and one measurement."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from acutance.archive import Entry, TargetEntry
    from acutance.archive.overview import SensorCount
    from acutance.targets.record import Record

__all__ = ["entry_text", "print_measurements", "print_rejections", "print_sensors", "print_table"]

_WIDE = 110
_GAP = 2
_NARROWEST = 6
_UNKNOWN = "–"
_TITLES = {"acquired": "date", "orientation": "dir."}
_NUMBERS = {"mtf_nyquist": "MTF(0.5)", "rer": "RER", "fwhm_px": "FWHM [px]"}
_SHRINKS = ("sensor", "band", "target", "kind", "image", "reason")
"""Columns of names and sentences, narrower where the terminal is: names are cut off there."""
_WRAPPED = ("reason",)
"""Columns whose sentences go on in the next line."""


def print_measurements(rows: Sequence[Mapping[str, Any]]) -> None:
    """Print rows of measurements; eighty columns have neither kind, band nor deviations.

    They have the image only where no date tells which it is.
    """
    wide = _width() >= _WIDE
    names = ["id", "acquired", "sensor", "target", "orientation", "verdict"]
    if wide:
        names[3:4] = ["band", "target", "kind", "image"]
    elif all(row["acquired"] is None for row in rows):
        names[1:2] = ["image"]
    names = _known(names, rows)
    cells = [[*(_cell(row, name) for name in names), *_estimates(row, wide)] for row in rows]
    header = [*(_TITLES.get(name, name) for name in names), *_NUMBERS.values()]
    print_table(header, cells, numbers=("id", *_NUMBERS.values()))


def print_rejections(rows: Sequence[Mapping[str, Any]]) -> None:
    """Print what was not measured, and why."""
    names = _known(["id", "acquired", "sensor", "image", "target", "stage", "reason"], rows)
    cells = [[_cell(row, name) for name in names] for row in rows]
    print_table([_TITLES.get(name, name) for name in names], cells, numbers=("id",))


def _known(names: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Columns without those of which nothing is known."""
    return [name for name in names if any(row[name] is not None for row in rows)]


def print_sensors(sensors: Iterable[SensorCount]) -> None:
    """Print how much there is of each sensor."""
    rows = [
        (
            one.sensor or _UNKNOWN, str(one.measured), str(one.rejected), str(one.images),
            *(_UNKNOWN if when is None else f"{when:%Y-%m-%d}" for when in (one.first, one.last)),
        )
        for one in sensors
    ]  # fmt: skip
    counts = ("measured", "rejected", "images")
    print_table(("sensor", *counts, "first", "last"), rows, numbers=counts)


def print_table(
    header: Sequence[str], rows: Sequence[Sequence[str]], numbers: Sequence[str] = ()
) -> None:
    """Print a table that is no wider than the terminal.

    Parameters
    ----------
    header : sequence of str
    rows : sequence of sequences of str
    numbers : sequence of str, optional
        Columns that are aligned to the right.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    for name, width in zip(header, _widths(header, rows), strict=True):
        table.add_column(
            Text(name), justify="right" if name in numbers else "left", width=width,
            no_wrap=name not in _WRAPPED, overflow="fold" if name in _WRAPPED else "ellipsis",
        )  # fmt: skip
    for row in rows:
        table.add_row(*map(Text, row))
    Console(file=sys.stdout, width=_width(), highlight=False).print(table)


def entry_text(entry: Entry) -> str:
    """The numbers of an entry, and what is known of its image and its target."""
    from acutance.archive.dates import day_or_minute
    from acutance.raster.gsd import gsd_in_words

    image, target, record = entry.image, entry.target, entry.record
    if record is not None:
        lines = [*_record_lines(record)]
    else:
        assert entry.rejected is not None
        lines = [f"not measured ({entry.rejected.stage}): {entry.rejected.reason}"]
    known = {
        "sensor": image.sensor,
        "band": entry.band,
        "acquired": None if image.acquired is None else day_or_minute(image.acquired, " UTC"),
        "image": image.path,
        "content": image.content,
        "level": image.level,
        "GSD": None if image.gsd_m is None else gsd_in_words(image.gsd_m),
        "target": None if target is None else target.name,
        "survey": None if record is None else _survey_words(record),
        "place": _place(target),
        "site": None if target is None else target.site,
        "key": entry.key,
        "run": None
        if entry.run is None
        else f"{entry.run.started:%Y-%m-%d %H:%M} UTC, acutance {entry.run.software}",
    }
    lines += [f"  {name:<9} {value}" for name, value in known.items() if value is not None]
    return "\n".join(lines)


def _place(target: TargetEntry | None) -> str | None:
    if target is None or target.lon is None or target.lat is None:
        return None
    return f"longitude {target.lon:.5f}, latitude {target.lat:.5f}"


def _survey_words(record: Record) -> str | None:
    """How far a batch found a line from where the survey has it."""
    found = record.document.get("survey_line")
    if found is None:
        return None
    metres = "" if found["distance_m"] is None else f" ({found['distance_m']:.2f} m)"
    return (
        f"the line lies {found['distance_px']:.2f} px{metres} from the surveyed one, turned by "
        f"{found['turn_deg']:.1f} degrees; looked for within {found['search_px']:.1f} px"
    )


def _record_lines(record: Record) -> Iterable[str]:
    from acutance.report.labels import title_of
    from acutance.report.tables.measurement import numbers_table
    from acutance.report.text import table_text

    yield title_of(record)
    yield f"  {_measured_words(record)}"
    yield f"  {record.verdict}"
    yield f"\n{table_text(numbers_table(record), drop_last=1)}\n"


def _measured_words(record: Record) -> str:
    """Band, region and GSD of the pixels, the angle, and when it was measured."""
    from acutance.curves import Estimate
    from acutance.report.labels import provenance

    found = provenance(record)
    del found["image"]
    measured = found.pop("measured")
    words = [one if name == "region" else f"{name} {one}" for name, one in found.items()]
    angle = record.document.get("angle_deg")
    if angle is not None:
        words.append(f"{Estimate(angle['value'], angle['std'])}° to the grid")
    return ", ".join([*words, f"measured {measured}"])


def _widths(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[int]:
    """Widths of the columns: names and sentences, the widest first, give way to the numbers."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    shrinking = [i for i, name in enumerate(header) if name in _SHRINKS]
    while shrinking and sum(widths) + _GAP * (len(widths) - 1) > _width():
        widest = max(shrinking, key=widths.__getitem__)
        if widths[widest] <= _NARROWEST:
            break
        widths[widest] -= 1
    return widths


def _estimates(row: Mapping[str, Any], with_std: bool) -> list[str]:
    from acutance.curves import Estimate

    found = []
    for name in _NUMBERS:
        value, std = row[name], row[f"{name}_std"]
        if value is None:
            found.append(_UNKNOWN)
        else:
            shown = str(Estimate(value, 0.0 if std is None else std))
            found.append(shown if with_std else f"{value:.3f}")
    return found


def _cell(row: Mapping[str, Any], name: str) -> str:
    value = row[name]
    if value is None:
        return _UNKNOWN
    return f"{value:%Y-%m-%d}" if name == "acquired" else str(value)


def _width() -> int:
    """Columns of the terminal; 120 where the table goes into a file."""
    return shutil.get_terminal_size((120, 24)).columns
