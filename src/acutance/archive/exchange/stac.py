"""STAC: a catalogue with an item for each image, and the whole documents beside it.

An item has the numbers of its measurements (extension ``mtf``); its asset "mtf:documents" has the
entries as JSON lines, so that nothing is lost.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

from acutance.archive.columns import require_library
from acutance.archive.dates import as_utc
from acutance.archive.elsewhere import elsewhere
from acutance.archive.entry import Entry, ImageEntry
from acutance.archive.exchange.entry_document import entry_document
from acutance.archive.exchange.files import refusals_in_words
from acutance.archive.exchange.stac_item import (
    EXTENSION,
    VIEW,
    image_properties,
    item_name,
    item_numbers,
)
from acutance.archive.packing import json_bytes
from acutance.errors import OptionError
from acutance.execution.partial_folder import partial_folder
from acutance.geometry.angles import wrap_direction

__all__ = ["write_stac"]

_LINES = "measurements.jsonl"
_CATALOG = "catalog.json"


@dataclass
class _Item:
    """An item as it grows."""

    image: ImageEntry
    acquired: datetime
    places: dict[tuple[float, float], None] = field(default_factory=dict)
    numbers: dict[str, list[dict[str, Any]]] = field(
        default_factory=lambda: {"mtf:measurements": [], "mtf:rejected": []}
    )


def write_stac(entries: Iterable[Entry], place: Path) -> int:
    """Write a catalogue into a new folder, and count the entries.

    Images without a date, which an item needs, are left out.

    Raises
    ------
    OptionError
        If pystac is not installed, no image has a date, or the folder is there already, or is
        called as a file.
    """
    if place.suffix.lower() == ".json":
        raise OptionError(
            f'{place} ends in ".json" as a file does, and stac is a folder of several: name a '
            "folder that is new or empty"
        )
    require_library("pystac", "stac")
    # A folder may be called "." or "..", and has a name all the same.
    place = Path(os.path.realpath(place))
    if place.exists() and (not place.is_dir() or any(place.iterdir())):
        raise OptionError(f"{place} is there already: name a folder that is new or empty")
    beside = place / _CATALOG if place.is_dir() else place
    with refusals_in_words(place), partial_folder(beside) as folder:
        # pystac takes a name with a dot for that of a file.
        part = Path(folder, "catalog")
        items, count = _write_lines(entries, part)
        _write_items(items, part)
        _put_in_place(part, place)
    return count


def _put_in_place(part: Path, place: Path) -> None:
    """Give a finished catalogue its name; a folder that is there stays, and gets what is in it."""
    if not place.is_dir():
        os.replace(part, place)
        return
    # Without its catalogue a folder is no STAC yet: that comes last.
    for one in sorted(part.iterdir(), key=lambda one: one.name == _CATALOG):
        os.replace(one, place / one.name)


def _write_lines(entries: Iterable[Entry], folder: Path) -> tuple[dict[str, _Item], int]:
    items: dict[str, _Item] = {}
    count, undated = 0, ""
    for entry in entries:
        if entry.image.acquired is None:
            undated = undated or entry.image.path or "(without a path)"
            continue
        name = item_name(entry.image)
        if name not in items:
            items[name] = _Item(entry.image, as_utc(entry.image.acquired, "acquired"))
            (folder / name).mkdir(parents=True)
        item = items[name]
        if entry.rejected is None or elsewhere(entry.rejected.values) is None:
            _add_target(item, entry)
        with (folder / name / _LINES).open("ab") as lines:
            lines.write(json_bytes(entry_document(entry)) + b"\n")
        count += 1
    if undated and not items:
        raise OptionError(
            f"image {undated} has no date, nor has any other, and an item of STAC needs one: "
            "correct the images, or export to jsonl or parquet"
        )
    return items, count


def _add_target(item: _Item, entry: Entry) -> None:
    """The numbers and the place of a target that the image shows."""
    for part, numbers in item_numbers(entry):
        item.numbers[part].append(numbers)
    target = entry.target
    if target is not None and target.lon is not None and target.lat is not None:
        item.places[target.lon, target.lat] = None


def _write_items(items: dict[str, _Item], folder: Path) -> None:
    from pystac import Catalog, CatalogType

    folder.mkdir(exist_ok=True)
    catalog = Catalog("acutance", "Images whose sharpness was measured", "Measurements of acutance")
    for name, item in items.items():
        catalog.add_item(_stac_item(name, item))
    catalog.normalize_hrefs(str(folder))
    catalog.save(CatalogType.SELF_CONTAINED)


def _stac_item(name: str, item: _Item) -> Any:
    from pystac import Asset, Item

    geometry, bbox = _geometry(list(item.places))
    own = image_properties(item.image)
    viewed = any(key.startswith("view:") for key in own)
    made = Item(
        name, geometry, bbox, item.acquired, own | item.numbers,
        stac_extensions=[EXTENSION, *([VIEW] if viewed else [])],
    )  # fmt: skip
    documents = Asset(
        f"./{_LINES}", "Whole documents", media_type="application/x-ndjson", roles=["metadata"]
    )
    made.add_asset("mtf:documents", documents)
    return made


def _geometry(
    places: list[tuple[float, float]],
) -> tuple[dict[str, Any] | None, list[float] | None]:
    """Where the targets lie, and the box about them."""
    if not places:
        return None, None
    points = [[lon if abs(lon) <= 180 else wrap_direction(lon), lat] for lon, lat in places]
    single = len(points) == 1
    geometry = {
        "type": "Point" if single else "MultiPoint",
        "coordinates": points[0] if single else points,
    }
    lat = [one[1] for one in points]
    west, east = _west_and_east([one[0] for one in points])
    return geometry, [west, min(lat), east, max(lat)]


def _west_and_east(lon: list[float]) -> tuple[float, float]:
    """The sides of the narrowest box: beyond the antimeridian west is east of east (RFC 7946)."""
    ordered = sorted(set(lon))
    gaps = [after - before for before, after in pairwise(ordered)]
    widest = max(gaps, default=0.0)
    if 360 - (ordered[-1] - ordered[0]) >= widest:
        return ordered[0], ordered[-1]
    at = gaps.index(widest)
    return ordered[at + 1], ordered[at]
