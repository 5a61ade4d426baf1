"""Corrections of images from a file: CSV with a header, or JSON, a list of objects."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import orjson

from acutance.archive.image_corrections import CORRECTED, ImageCorrection
from acutance.errors import OptionError

__all__ = ["read_correction_file"]

_TEXTS: Final = ("image", "sensor", "level", "band", "acquired", "reason")
_SIDES: Final = ("gsd_row_m", "gsd_col_m")
_COLUMNS: Final = ("image", *CORRECTED, *_SIDES, "reason")


def read_correction_file(place: str | os.PathLike[str]) -> list[ImageCorrection]:
    """The corrections of a file; empty cells leave what is there.

    Parameters
    ----------
    place : path
        ``.json``, or CSV. Columns: image, and fields of `ImageCorrection`; the GSD also as
        ``gsd_row_m`` and ``gsd_col_m``.

    Raises
    ------
    OptionError
        If it cannot be read, holds what is not known, or two values of one image under one name:
        all faults are named at once.
    """
    path = Path(place)
    try:
        text = path.read_text(encoding="utf-8-sig")
        rows = list(_json_rows(text) if path.suffix.lower() == ".json" else _csv_rows(text))
    except (OSError, ValueError, csv.Error) as error:
        raise OptionError(f"the corrections {path} cannot be read: {error}") from error
    found, faults = {}, []
    for place_of, row in rows:
        try:
            found[place_of] = _correction(row)
        except OptionError as error:
            faults.append(f"  - {place_of}: {error}")
    faults += _contradictions(found)
    if faults:
        raise OptionError("\n".join((f"the corrections {path} cannot be used:", *faults)))
    if not found:
        raise OptionError(f"the corrections {path} are empty: write a row an image")
    return list(found.values())


def _contradictions(found: Mapping[str, ImageCorrection]) -> Iterator[str]:
    """Rows that give one image two values: which of them is meant, no order of rows says."""
    stated: dict[tuple[str, str], tuple[str, Any]] = {}
    for place, one in found.items():
        for name, value in one.columns.items():
            before, other = stated.setdefault((one.image, name), (place, value))
            if other != value:
                yield (
                    f"  - {before} and {place}: {name} of {one.image} is {other} and {value}: "
                    "leave one of them"
                )


def _json_rows(text: str) -> Iterator[tuple[str, dict[str, Any]]]:
    document = orjson.loads(text)
    listed = document if isinstance(document, list) else [document]
    for number, row in enumerate(listed, start=1):
        if not isinstance(row, Mapping):
            raise ValueError(f"entry {number} is no object")
        yield f"entry {number}", {key: one for key, one in row.items() if one is not None}


def _csv_rows(text: str) -> Iterator[tuple[str, dict[str, Any]]]:
    reader = csv.DictReader(io.StringIO(text, newline=""), restkey="beyond the header")
    header = list(reader.fieldnames or ())
    if len(header) == 1 and (";" in header[0] or "\t" in header[0]):
        raise ValueError(
            "its columns are not divided by commas: save it with commas between columns, and "
            "points in decimals"
        )
    for row in reader:
        cells = {key.strip(): text for key, one in row.items() if (text := _stripped(one))}
        if cells:
            yield (
                f"line {reader.line_num}",
                {key: one if key in _TEXTS else _number(one) for key, one in cells.items()},
            )


def _stripped(cell: Any) -> Any:
    """A cell without spaces around it; those beyond the header are a list."""
    return cell.strip() if isinstance(cell, str) else cell


def _number(cell: Any) -> Any:
    """A number, if it is one; what is none is refused with its name."""
    try:
        return float(cell)
    except (TypeError, ValueError):
        return cell


def _correction(row: Mapping[str, Any]) -> ImageCorrection:
    unknown = [key for key in row if key not in _COLUMNS]
    if unknown:
        raise OptionError(f"there is no {', '.join(unknown)}, only {', '.join(_COLUMNS)}")
    if "image" not in row:
        raise OptionError("the image is not named")
    sides = [row[name] for name in _SIDES if name in row]
    if len(sides) == 1 or (sides and "gsd_m" in row):
        raise OptionError(f"give gsd_m, or both of {', '.join(_SIDES)}")
    values = {key: one for key, one in row.items() if key not in _SIDES}
    if isinstance(values.get("gsd_m"), list):
        values["gsd_m"] = tuple(values["gsd_m"])
    if sides:
        values["gsd_m"] = (sides[0], sides[1])
    return ImageCorrection(**values)
