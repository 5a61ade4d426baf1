"""The properties of a STAC item of an image: extension ``mtf``, with its JSON schema."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from importlib.resources import files
from pathlib import PurePosixPath
from typing import Any

from acutance.archive.entry import Entry, ImageEntry
from acutance.archive.identity import file_name, image_identity
from acutance.archive.rows import rows_of
from acutance.archive.tables import VERDICTS
from acutance.curves import METRICS

__all__ = ["EXTENSION", "VIEW", "image_properties", "item_name", "item_numbers", "stac_schema"]

EXTENSION = "urn:acutance:stac:mtf:v1.0.0"
VIEW = "https://stac-extensions.github.io/view/v1.0.0/schema.json"

_DIGEST = 12
_LONGEST = 200
"""Bytes of a name: 255 less digest and ending."""
_VIEW_FIELDS = {
    "view:incidence_angle": "view_zenith_deg",
    "view:azimuth": "view_azimuth_deg",
    "view:sun_elevation": "sun_elevation_deg",
    "view:sun_azimuth": "sun_azimuth_deg",
}


def stac_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of the extension ``mtf`` of STAC items."""
    source = files("acutance.archive.exchange") / "schemas" / "mtf-v1.0.0.json"
    schema: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    return schema


def item_name(image: ImageEntry) -> str:
    """The name of an image's item: that of its file, and a digest of all that is known of it."""
    stem = PurePosixPath(file_name(image.path) or "image").stem
    safe = re.sub(r"[^\w-]+", "-", stem).strip("-") or "image"
    # A folder and a file are called by it, and the names of files end somewhere.
    while len(safe.encode()) > _LONGEST:
        safe = safe[:-1]
    return f"{safe}-{image_identity(image)[:_DIGEST]}"


def image_properties(image: ImageEntry) -> dict[str, Any]:
    """What STAC itself and its extension ``view`` say of an image."""
    found: dict[str, Any] = {}
    if image.sensor is not None:
        found["platform"] = image.sensor
    if image.gsd_m is not None:
        found["gsd"] = min(image.gsd_m)
    for name, field in _VIEW_FIELDS.items():
        angle = getattr(image, field)
        if angle is not None:
            # The extension has azimuths from 0 to 360 degrees.
            found[name] = angle % 360.0 if name.endswith("azimuth") else angle
    return found


def item_numbers(entry: Entry) -> Iterator[tuple[str, dict[str, Any]]]:
    """What an item holds of an entry: ("mtf:measurements" or "mtf:rejected", the part)."""
    rows = rows_of(entry)
    own, target = rows.measurement, entry.target
    shared = {
        "key": rows.key,
        "band": entry.band,
        "target": None if target is None else target.name,
        "site": None if target is None else target.site,
    }
    if entry.record is None:
        yield "mtf:rejected", shared | {"stage": own["stage"], "reason": own["reason"]}
        return
    for row in rows.directions:
        if not row["measured"]:
            continue
        numbers = {
            name: {"value": row[name], "std": row[f"{name}_std"]}
            for name in METRICS
            if row[name] is not None
        }
        yield (
            "mtf:measurements",
            shared
            | {
                "band_number": entry.record.image.band,
                "kind": own["kind"],
                "method": own["method"],
                "orientation": row["orientation"],
                "verdict": VERDICTS[own["verdict"]],
                "measured_at": own["measured_at"].isoformat(),
                "metrics": numbers,
                "conditions": {name: row[name] for name in ("angle_deg", "gsd_m")}
                | {"snr": own["snr"]},
            },
        )
