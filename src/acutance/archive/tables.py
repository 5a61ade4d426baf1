"""The tables of an archive, the same on SQLite and PostgreSQL."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Column,
    Date,
    DateTime,
    Double,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    TypeDecorator,
)
from sqlalchemy.engine import Dialect

from acutance.curves import MAIN_NUMBERS, METRICS

__all__ = [
    "APPLICATION",
    "METADATA",
    "SCHEMA_VERSION",
    "VERDICTS",
    "about",
    "directions",
    "documents",
    "images",
    "measurements",
    "metric_columns",
    "runs",
    "systematic_columns",
    "targets",
]

APPLICATION = "acutance"
SCHEMA_VERSION = 2

VERDICTS = ("invalid", "doubtful", "usable", "good")
"""Words of verdicts from worst to best; a row holds the place in this list."""

METADATA = MetaData()


class _Moment(TypeDecorator[datetime]):
    """A moment in UTC. SQLite has no time zones: there the text is that of UTC."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: Any, dialect: Dialect) -> Any:
        if value is None or dialect.name == "postgresql":
            return value
        return value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: Any, dialect: Dialect) -> Any:
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


_NUMBER = BigInteger().with_variant(Integer, "sqlite")
"""Of rows: SQLite counts by itself in columns of exactly this type."""


def _number() -> Column[int]:
    return Column("id", _NUMBER, primary_key=True)


def _json(name: str, **how: Any) -> Column[Any]:
    return Column(name, JSON(none_as_null=True), **how)


def metric_columns() -> tuple[str, ...]:
    """Names of the columns of numbers: every metric, and its standard deviation."""
    return tuple(name for metric in METRICS for name in (metric, f"{metric}_std"))


def systematic_columns() -> tuple[str, ...]:
    """Names of the columns of what of a standard deviation does not average out."""
    return tuple(f"{name}_systematic_std" for name in MAIN_NUMBERS)


about = Table(
    "acutance_archive",
    METADATA,
    Column("application", String, primary_key=True),
    Column("schema_version", Integer, nullable=False),
    Column("software", String, nullable=False),
    Column("created", _Moment, nullable=False),
)
"""Whose database this is; one row."""

images = Table(
    "images",
    METADATA,
    _number(),
    Column("identity", String, nullable=False, unique=True),
    Column("content", String, index=True),
    Column("path", String),
    Column("name", String, index=True),
    Column("sensor", String),
    Column("level", String),
    Column("acquired", _Moment),
    Column("gsd_row_m", Double),
    Column("gsd_col_m", Double),
    Column("view_zenith_deg", Double),
    Column("view_azimuth_deg", Double),
    Column("sun_elevation_deg", Double),
    Column("sun_azimuth_deg", Double),
    _json("sources", nullable=False),
    Index("images_sensor_acquired", "sensor", "acquired"),
)

targets = Table(
    "targets",
    METADATA,
    _number(),
    Column("identity", String, nullable=False, unique=True),
    Column("name", String, nullable=False, index=True),
    Column("kind", String, nullable=False),
    Column("site", String, index=True),
    Column("valid_from", Date),
    Column("valid_to", Date),
    Column("lon", Double),
    Column("lat", Double),
    _json("definition", nullable=False),
)

runs = Table(
    "runs",
    METADATA,
    _number(),
    Column("uid", String, nullable=False, unique=True),
    Column("started", _Moment, nullable=False),
    Column("ended", _Moment),
    Column("software", String, nullable=False),
    _json("plan", nullable=False),
    _json("summary"),
)

measurements = Table(
    "measurements",
    METADATA,
    _number(),
    Column("key", String, nullable=False, unique=True),
    Column("image_id", ForeignKey("images.id"), nullable=False, index=True),
    Column("target_id", ForeignKey("targets.id"), index=True),
    Column("run_id", ForeignKey("runs.id"), index=True),
    Column("band", String),
    Column("kind", String),
    Column("method", String),
    Column("verdict", Integer),
    Column("snr", Double),
    Column("measured_at", _Moment),
    Column("added", _Moment, nullable=False),
    Column("stage", String),
    Column("reason", String),
    _json("rejected_values"),
)
"""Measurements, and rejections: these have a stage and a reason, and no verdict and no numbers."""

directions = Table(
    "directions",
    METADATA,
    Column(
        "measurement_id", ForeignKey("measurements.id", ondelete="CASCADE"), primary_key=True
    ),
    Column("orientation", String, primary_key=True),
    Column("measured", Boolean, nullable=False),
    Column("angle_deg", Double),
    Column("gsd_m", Double),
    *(Column(name, Double) for name in (*metric_columns(), *systematic_columns())),
)  # fmt: skip
"""The numbers, a row for each direction; `measured` is false where they follow from the prior."""

documents = Table(
    "documents",
    METADATA,
    Column(
        "measurement_id", ForeignKey("measurements.id", ondelete="CASCADE"), primary_key=True
    ),
    Column("document", LargeBinary, nullable=False),
)  # fmt: skip
"""Whole documents, apart from the numbers, so that lists do not read past them."""
