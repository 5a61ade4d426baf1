"""Entries as rows of a table: one for each direction that was measured, one for a rejection."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC
from typing import Any

from acutance.archive.entry import Entry
from acutance.archive.exchange.entry_document import entry_document
from acutance.archive.packing import json_bytes
from acutance.archive.rows import image_row, rows_of, target_row
from acutance.archive.tables import VERDICTS, metric_columns, systematic_columns

__all__ = ["FLAGS", "MOMENTS", "NUMBERS", "TEXTS", "flat_columns", "flat_rows"]

_OF_IMAGE_NUMBERS = (
    "gsd_row_m", "gsd_col_m", "view_zenith_deg", "view_azimuth_deg", "sun_elevation_deg",
    "sun_azimuth_deg",
)  # fmt: skip
_OF_IMAGE_TEXTS = ("path", "content", "sensor", "level")

TEXTS = (
    "key", "sensor", "level", "band", "site", "target", "target_kind", "kind", "method",
    "orientation", "path", "content", "verdict", "stage", "reason", "run_uid",
)  # fmt: skip
MOMENTS = ("acquired", "measured_at")
NUMBERS = (
    "lon", "lat", *_OF_IMAGE_NUMBERS, "snr", "angle_deg", "gsd_m",
    *metric_columns(),
    *systematic_columns(), "normal_deg",
)  # fmt: skip
FLAGS = ("measured",)


def flat_columns(with_documents: bool) -> tuple[str, ...]:
    """Names of the columns; "document" is last."""
    columns = (*TEXTS, *MOMENTS, *FLAGS, *NUMBERS)
    return (*columns, "document") if with_documents else columns


def flat_rows(entry: Entry) -> Iterator[dict[str, Any]]:
    """Rows of an entry; the first has the whole entry as its document, in JSON.

    Directions that follow from the prior are rows too, with "measured" false.
    """
    rows = rows_of(entry)
    image, own = image_row(entry.image), rows.measurement
    target = {} if entry.target is None else target_row(entry.target)
    shared = {
        **{name: image[name] for name in (*_OF_IMAGE_TEXTS, *_OF_IMAGE_NUMBERS)},
        **{name: own[name] for name in ("key", "band", "kind", "method", "stage", "reason", "snr")},
        "site": target.get("site"),
        "target": target.get("name"),
        "target_kind": target.get("kind"),
        "lon": target.get("lon"),
        "lat": target.get("lat"),
        "verdict": None if own["verdict"] is None else VERDICTS[own["verdict"]],
        "run_uid": None if entry.run is None else entry.run.uid,
        "acquired": image["acquired"],
        "measured_at": None if own["measured_at"] is None else own["measured_at"].astimezone(UTC),
    }
    document = json_bytes(entry_document(entry)).decode()
    for number, direction in enumerate(rows.directions or ({},)):
        # The column of the tables has an older name, which means an acute angle elsewhere.
        own_normal = {"normal_deg": direction.get("angle_deg")}
        yield shared | direction | own_normal | {"document": None if number else document}
