"""Entries of the tables that publications print."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from datetime import UTC, date, datetime, time
from importlib import resources
from typing import Any, Final

from acutance.archive.entry import Entry, ImageEntry, TargetEntry
from acutance.curves import METRICS
from acutance.errors import OptionError
from acutance.targets.record import SCHEMA, Record

__all__ = ["PUBLISHED", "published_entries"]

PUBLISHED: Final = ("kompsat3-2014", "quickbird-2003")
"""Names of the publications."""
METHOD: Final = "published"
_DIRECTIONS: Final = ("across", "along")
_VERDICT: Final = {"word": "usable", "message": "published: nothing was checked here"}


def published_entries(name: str) -> list[Entry]:
    """The rows of a publication's tables, for `acutance.Archive.add_entries`.

    Parameters
    ----------
    name : str
        Of `PUBLISHED`.

    Returns
    -------
    list of Entry
        One a printed row and direction; of mirrors one with both directions.

    Raises
    ------
    OptionError
        If there is no such publication.

    Examples
    --------
    >>> archive.add_entries(published_entries("kompsat3-2014"))  # doctest: +SKIP
    """
    if not isinstance(name, str) or name not in PUBLISHED:
        raise OptionError(f"there is no publication {name!r}, only {', '.join(PUBLISHED)}")
    file = resources.files("acutance.archive.published").joinpath(f"{name}.toml")
    document = tomllib.loads(file.read_text(encoding="utf-8"))
    return [entry for table in document["table"] for entry in _entries(name, document, table)]


def _entries(name: str, document: Mapping[str, Any], table: Mapping[str, Any]) -> Iterator[Entry]:
    for number, values in enumerate(table["rows"], 1):
        row: dict[str, Any] = {"site": table.get("site"), "level": None, "snr": None}
        row |= dict(zip(table["columns"], values, strict=True))
        for column in table.get("percent", ()):
            row[column] = round(row[column] / 100, 6)
        parts = {one: _numbers(row, one, table) for one in _DIRECTIONS}
        parts = {one: part for one, part in parts.items() if part}
        # Mirrors show both directions at once; edges and pulses one each.
        together = [tuple(parts)] if table["kind"] == "points" else [(one,) for one in parts]
        for directions in together:
            own = {one: parts[one] for one in directions}
            record = _record(document, table, row, own)
            key = f"published/{name}/{table['name']}/{number}/{'+'.join(directions)}"
            yield Entry(
                record=record, image=_image(document, row, own), target=_target(table, row),
                band=table.get("band"), key=key,
            )  # fmt: skip


def _numbers(row: Mapping[str, Any], direction: str, table: Mapping[str, Any]) -> dict[str, Any]:
    """The part of a document for one direction; empty where nothing was printed."""
    own = {
        column.partition(".")[2]: value
        for column, value in row.items()
        if column.startswith(f"{direction}.")
    }
    gsd_m = own.pop("gsd_m", table.get("gsd_m"))
    if not own:
        return {}
    widths = [name for name in own if name.endswith("_px")]
    if gsd_m is not None:
        own |= {name.replace("_px", "_m"): round(own[name] * gsd_m, 6) for name in widths}
    numbers = dict.fromkeys(METRICS) | {
        metric: {"value": value, "std": None, "interval95": None} for metric, value in own.items()
    }
    return {"gsd_m": gsd_m, **numbers}


def _record(
    document: Mapping[str, Any], table: Mapping[str, Any], row: Mapping[str, Any],
    parts: Mapping[str, dict[str, Any]],
) -> Record:  # fmt: skip
    gsd_m = next(iter(parts.values()))["gsd_m"]
    printed = {name: value for name, value in row.items() if "." not in name and value is not None}
    shared: dict[str, Any] = {
        "schema": SCHEMA,
        "kind": table["kind"],
        "method": METHOD,
        "image": {
            "path": None, "band": 1, "gsd_m": gsd_m,
            "pixel_gsd_m": None if gsd_m is None else [gsd_m, gsd_m],
            "roi": [0, 0, 0, 0], "crs": None, "along_track": "y", "linearized": None,
        },
        "snr": row["snr"],
        "checks": [],
        "verdict": _VERDICT,
        "options": {"edge": row["edge"]} if "edge" in row else {},
        "measured_at": _moment(row["date"]).isoformat(),
        "published": {
            "source": document["source"], "table": table["name"],
            "not_printed": document["not_printed"],
            "row": {name: str(value) if isinstance(value, date) else value
                    for name, value in printed.items()},
        },
    }  # fmt: skip
    if len(parts) > 1:
        return Record.from_dict({**shared, **parts})
    ((direction, part),) = parts.items()
    return Record.from_dict({**shared, "orientation": direction, **part})


def _image(
    document: Mapping[str, Any], row: Mapping[str, Any], parts: Mapping[str, dict[str, Any]]
) -> ImageEntry:
    gsd_m = next(iter(parts.values()))["gsd_m"]
    return ImageEntry(
        sensor=document["sensor"], level=row["level"], acquired=_moment(row["date"]),
        gsd_m=None if gsd_m is None else (gsd_m, gsd_m),
        sources={"acquired": "printed, without its time", "site": row["site"]},
    )  # fmt: skip


def _target(table: Mapping[str, Any], row: Mapping[str, Any]) -> TargetEntry:
    edge = f", edge {row['edge']}" if "edge" in row else ""
    return TargetEntry(name=f"{table['target']}{edge}", kind=table["kind"], site=row["site"])


def _moment(day: date) -> datetime:
    return datetime.combine(day, time.min, UTC)
