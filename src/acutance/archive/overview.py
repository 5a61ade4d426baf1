"""What an archive holds, counted."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import Connection, func, select

from acutance.archive.connection import Database
from acutance.archive.tables import about, images, measurements, runs, targets

__all__ = ["Overview", "SensorCount", "overview_of"]


@dataclass(frozen=True)
class SensorCount:
    """What an archive holds of one sensor; of ``None`` where the sensor is not known.

    Attributes
    ----------
    sensor : str or None
    measured, rejected, images : int
    first, last : datetime or None
        Of the acquisitions.
    """

    sensor: str | None
    measured: int
    rejected: int
    images: int
    first: datetime | None
    last: datetime | None


@dataclass(frozen=True)
class Overview:
    """What an archive holds.

    Attributes
    ----------
    place : str
    schema_version : int
    measured, rejected, images, targets, runs : int
    sensors : tuple of SensorCount
    """

    place: str
    schema_version: int
    measured: int
    rejected: int
    images: int
    targets: int
    runs: int
    sensors: tuple[SensorCount, ...]

    def to_dict(self) -> dict[str, Any]:
        """All counts by name, for JSON."""
        found = asdict(self)
        for one in found["sensors"]:
            for name in ("first", "last"):
                one[name] = None if one[name] is None else one[name].isoformat()
        return found


def overview_of(database: Database) -> Overview:
    """Count what an archive holds."""
    return database.read(lambda connection: _counted(connection, database.place))


def _counted(connection: Connection, place: str) -> Overview:
    measured = func.count(measurements.c.verdict)
    found = (
        select(
            images.c.sensor,
            measured,
            func.count() - measured,
            func.count(images.c.id.distinct()),
            func.min(images.c.acquired),
            func.max(images.c.acquired),
        )
        .select_from(measurements.join(images))
        .group_by(images.c.sensor)
        .order_by(images.c.sensor.nulls_last())
    )
    sensors = tuple(SensorCount(*row) for row in connection.execute(found))
    target_count, run_count = (
        connection.execute(select(func.count()).select_from(table)).scalar_one()
        for table in (targets, runs)
    )
    return Overview(
        place=place,
        schema_version=connection.execute(select(about.c.schema_version)).scalar_one(),
        measured=sum(one.measured for one in sensors),
        rejected=sum(one.rejected for one in sensors),
        images=sum(one.images for one in sensors),
        targets=target_count,
        runs=run_count,
        sensors=sensors,
    )
