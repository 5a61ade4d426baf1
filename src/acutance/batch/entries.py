"""What is known of an image and of a target, as an archive keeps it."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.archive.dates import as_utc
from acutance.archive.entry import ImageEntry, TargetEntry
from acutance.batch.plan import StatedOfImages
from acutance.errors import RegionError
from acutance.geometry.angles import wrap_direction
from acutance.raster.geolocation import LONLAT_CRS, transform_points
from acutance.raster.metadata import ImageStatement
from acutance.raster.metadata.times import is_day
from acutance.raster.surveyed_targets import SurveyedTarget

if TYPE_CHECKING:
    from acutance.batch.measure_image import BatchTask

__all__ = ["entry_of_facts", "image_entry", "image_facts", "stated_entry", "target_entry"]

_FIELDS = (
    "sensor", "level", "acquired", "gsd_m",
    "view_zenith_deg", "view_azimuth_deg", "sun_elevation_deg", "sun_azimuth_deg",
)  # fmt: skip


def image_entry(task: BatchTask, statement: ImageStatement) -> ImageEntry:
    """An image with what the plan states of it, and where it says nothing with what it says itself.

    Parameters
    ----------
    task : BatchTask
    statement : ImageStatement
    """
    values: dict[str, Any] = {}
    sources: dict[str, Any] = {}
    for name in _FIELDS:
        own, found = getattr(task.stated, name), getattr(statement, name)
        if own is not None:
            values[name], sources[name] = own, "stated in the plan"
        elif found is not None:
            values[name], sources[name] = found.value, found.source
    if statement.conflicts:
        sources["conflicts"] = list(statement.conflicts)
    if statement.notes:
        sources["notes"] = list(statement.notes)
    when = values.get("acquired")
    if when is not None:
        values["acquired"] = as_utc(when, "acquired")
        if is_day(when):
            sources["acquired"] += ": a day without a time, kept as its beginning"
    return ImageEntry(path=task.path, content=task.content, sources=sources, **values)


def image_facts(statement: ImageStatement, has_gsd: bool) -> dict[str, Any]:
    """What an image says of itself, for JSON: the GSD where it has no other to be measured with.

    Parameters
    ----------
    statement : ImageStatement
    has_gsd : bool
        Whether the pixels have a GSD without its documents.
    """
    facts: dict[str, Any] = {}
    for name in _FIELDS:
        found = getattr(statement, name)
        if found is not None and not (name == "gsd_m" and has_gsd):
            facts[name] = found.value
    if "acquired" in facts:
        facts["acquired"] = as_utc(facts["acquired"], "acquired").isoformat()
    return facts


def entry_of_facts(facts: Mapping[str, Any]) -> ImageEntry:
    """What `image_facts` gave, and a file may have kept since."""
    values = dict(facts)
    if "acquired" in values:
        values["acquired"] = datetime.fromisoformat(values["acquired"])
    if "gsd_m" in values:
        values["gsd_m"] = tuple(values["gsd_m"])
    return ImageEntry(**values)


def stated_entry(stated: StatedOfImages) -> ImageEntry | None:
    """What the plan states of an image, apart from what it says itself; None if that is nothing."""
    values = {name: getattr(stated, name) for name in _FIELDS}
    if all(value is None for value in values.values()):
        return None
    if values["acquired"] is not None:
        values["acquired"] = as_utc(values["acquired"], "acquired")
    return ImageEntry(**values)


def target_entry(target: SurveyedTarget) -> TargetEntry:
    """A target with its middle in longitude and latitude, where it has one."""
    lon, lat = _middle(target)
    return TargetEntry(
        name=target.name,
        kind=target.kind,
        definition=target.definition,
        site=target.site,
        valid_from=target.valid_from,
        valid_to=target.valid_to,
        lon=lon,
        lat=lat,
    )


def _middle(target: SurveyedTarget) -> tuple[float | None, float | None]:
    if target.in_pixels or not target.points:
        return None, None
    points = np.array(target.points)
    try:
        lon, lat = transform_points(points[:, 0], points[:, 1], target.crs, LONLAT_CRS)
    except RegionError:
        return None, None
    if not (np.isfinite(lon).all() and np.isfinite(lat).all()):
        return None, None
    # Points on both sides of the antimeridian have their middle there too.
    middle = lon[0] + np.mean(wrap_direction(lon - lon[0]))
    return float(wrap_direction(middle)), float(lat.mean())
