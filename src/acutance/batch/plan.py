"""What a batch is to do: images, targets, archive, and what is stated of them."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import date, datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from acutance.arguments import require_path
from acutance.batch.path_text import path_as_text
from acutance.batch.plan_options import faults_of_plan
from acutance.errors import OptionError
from acutance.raster.document_faults import document_faults
from acutance.raster.gsd import Gsd
from acutance.raster.linearization import table_of
from acutance.raster.metadata.findings import ANGLES
from acutance.raster.metadata.times import is_possible, possible_days, time_or_day
from acutance.raster.nearest_name import nearest_name

__all__ = ["BatchPlan", "StatedOfImages", "is_plan_file", "plan_of", "read_plan"]

Texts = str | list[str]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid")


def _angle(name: str) -> Any:
    low, high = ANGLES[name]
    return Field(default=None, ge=low, le=high)


class _Stated(_Model):
    """What is stated of images, instead of what they say themselves."""

    images: Texts | None = None
    sensor: str | None = Field(default=None, min_length=1)
    level: str | None = Field(default=None, min_length=1)
    acquired: datetime | date | None = None
    band_names: list[str] | None = Field(default=None, min_length=1)
    gsd_m: float | list[float] | None = None
    height_m: float | None = Field(default=None, ge=-1000, le=10000)
    view_zenith_deg: float | None = _angle("view_zenith_deg")
    view_azimuth_deg: float | None = _angle("view_azimuth_deg")
    sun_elevation_deg: float | None = _angle("sun_elevation_deg")
    sun_azimuth_deg: float | None = _angle("sun_azimuth_deg")
    metadata: Texts | None = None
    nodata: float | None = None
    along_track: Literal["x", "y"] | None = None
    linearize: str | float | None = None

    @field_validator("acquired", mode="before")
    @classmethod
    def _a_time(cls, value: Any) -> Any:
        # A number would be taken for seconds since 1970.
        found = value if value is None or isinstance(value, date) else time_or_day(value)
        if found is None and value is not None:
            raise ValueError("write a time, 2026-01-05T10:00:00Z, or a day, 2026-01-05")
        if found is not None and not is_possible(found):
            raise ValueError("{} to {} are the days of images".format(*possible_days()))
        return found

    @field_validator("gsd_m")
    @classmethod
    def _of_an_image(cls, value: Any) -> Any:
        sides = value if isinstance(value, list) else [value]
        if len(sides) not in (1, 2):
            raise ValueError("write metres, .7, or [ROW, COLUMN] where they differ")
        if value is not None:
            Gsd.given(Gsd(sides[0], sides[-1]))
        return value


class _Plan(_Model):
    """The file."""

    images: Texts
    targets: str
    archive: str
    bands: list[str | int] | None = Field(default=None, min_length=1)
    workers: int | None = Field(default=None, ge=1)
    dask: str | None = None
    stated: list[_Stated] = Field(default_factory=list)
    edge: dict[str, Any] = Field(default_factory=dict)
    pulse: dict[str, Any] = Field(default_factory=dict)
    points: dict[str, Any] = Field(default_factory=dict)
    star: dict[str, Any] = Field(default_factory=dict)
    bars: dict[str, Any] = Field(default_factory=dict)
    scene: dict[str, Any] = Field(default_factory=dict)

    @field_validator("stated", mode="before")
    @classmethod
    def _one_or_several(cls, value: Any) -> Any:
        return [value] if isinstance(value, Mapping) else value


_KINDS = ("edge", "pulse", "points", "star", "bars", "scene")


@dataclass(frozen=True)
class StatedOfImages:
    """What is stated of the images that match; None leaves it to the images.

    Parameters
    ----------
    images : tuple of str
        Patterns of paths; all images without any.
    sensor, level : str or None
    acquired : datetime or date, or None
        A date where the time is not known.
    band_names : tuple of str or None
        In the order of the file.
    gsd_m : (row, col) or None
    height_m : float or None
        Of the ground above the ellipsoid, at targets that state none of their own; for images
        located by RPC.
    view_zenith_deg, view_azimuth_deg, sun_elevation_deg, sun_azimuth_deg : float or None
    metadata : tuple of str or None
        Documents to read instead of those beside the image.
    nodata : float or None
    along_track : {"x", "y"} or None
    linearize : str, float or None
        As of `acutance.open_image`.
    """

    images: tuple[str, ...] = ()
    sensor: str | None = None
    level: str | None = None
    acquired: datetime | date | None = None
    band_names: tuple[str, ...] | None = None
    gsd_m: tuple[float, float] | None = None
    height_m: float | None = None
    view_zenith_deg: float | None = None
    view_azimuth_deg: float | None = None
    sun_elevation_deg: float | None = None
    sun_azimuth_deg: float | None = None
    metadata: tuple[str, ...] | None = None
    nodata: float | None = None
    along_track: Literal["x", "y"] | None = None
    linearize: str | float | None = None


@dataclass(frozen=True)
class BatchPlan:
    """What a batch is to do.

    Parameters
    ----------
    images : tuple of str
        Paths and patterns of paths (``"images/**/*.tif"``).
    targets : str or mapping
        A GeoJSON file, or its document.
    archive : str
        A file, or the URL of a database.
    bands : tuple of (str or int), or None
        Names or numbers of the bands to measure; all without it.
    workers : int or None
        Processes; all cores without it.
    dask : str or None
        Address of a scheduler whose workers are used instead.
    stated : tuple of StatedOfImages
        Later ones go before earlier ones.
    options : mapping of str to mapping
        By kind: the method, and options of its measurement.
    """

    images: tuple[str, ...]
    targets: str | Mapping[str, Any]
    archive: str
    bands: tuple[str | int, ...] | None = None
    workers: int | None = None
    dask: str | None = None
    stated: tuple[StatedOfImages, ...] = ()
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """All of it, for JSON."""
        return {
            **{one.name: getattr(self, one.name) for one in fields(self)},
            "images": [path_as_text(one) for one in self.images],
            "stated": [_set_values(one) for one in self.stated],
            "options": {kind: dict(one) for kind, one in self.options.items()},
        }


def _set_values(stated: StatedOfImages) -> dict[str, Any]:
    values = ((one.name, getattr(stated, one.name)) for one in fields(stated))
    return {
        name: value.isoformat() if isinstance(value, date) else value
        for name, value in values
        if value is not None
    }


def is_plan_file(path: str) -> bool:
    """Whether a file is a plan and no image, by the ending of its name."""
    return path.lower().endswith(".toml")


def read_plan(path: str | os.PathLike[str]) -> BatchPlan:
    """The plan of a TOML file; paths in it are relative to the file.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    BatchPlan

    Raises
    ------
    OptionError
        If it cannot be read, or holds what is not known: all faults are named at once.
    """
    require_path(plan=path)
    name = Path(path)
    try:
        document = tomllib.loads(name.read_text(encoding="utf-8-sig"))
    except OSError as error:
        near = nearest_name(name)
        meant = "" if near is None else f", is {name.with_name(near)} meant?"
        reason = error.strerror or str(error)
        raise OptionError(f"the plan {name} cannot be read ({reason}){meant}") from error
    except (ValueError, RecursionError) as error:
        raise OptionError(f"the plan {name} cannot be read ({error}): write a TOML file") from error
    return plan_of(document, str(name), name.parent)


def plan_of(document: Mapping[str, Any], name: str, folder: Path | None = None) -> BatchPlan:
    """The plan of a document.

    Parameters
    ----------
    document : mapping
    name : str
        Of the file, for messages.
    folder : Path, optional
        What paths are relative to; the current folder without it.

    Raises
    ------
    OptionError
        If it holds what is not known, or lacks what is needed: all faults are named at once.
    """
    try:
        given = _Plan.model_validate(document)
    except ValidationError as error:
        faults = [one.in_words("key") for one in document_faults(error, document)]
        # Faults of options alone are found where they are used; here they are seen with the others.
        tables = {kind: document.get(kind) for kind in _KINDS}
        of_plan = {kind: one for kind, one in tables.items() if isinstance(one, Mapping)}
        faults += [one for several in faults_of_plan(of_plan).values() for one in several]
        listed = "\n".join(f"  - {one}" for one in faults)
        raise OptionError(f"the plan {name} cannot be used:\n{listed}") from None
    at = Path() if folder is None else folder
    return BatchPlan(
        images=tuple(_below(at, one) for one in _texts(given.images)),
        targets=_below(at, given.targets),
        archive=given.archive if "://" in given.archive else _below(at, given.archive),
        bands=None if given.bands is None else tuple(given.bands),
        workers=given.workers,
        dask=given.dask,
        stated=tuple(_stated(one, at) for one in given.stated),
        options={kind: getattr(given, kind) for kind in _KINDS if getattr(given, kind)},
    )


def _stated(given: _Stated, folder: Path) -> StatedOfImages:
    gsd = given.gsd_m
    sides = (gsd, gsd) if isinstance(gsd, float) else None if gsd is None else (gsd[0], gsd[-1])
    documents = None if given.metadata is None else _texts(given.metadata)
    plain = {
        name: getattr(given, name)
        for name in _Stated.model_fields
        if name not in ("images", "band_names", "gsd_m", "metadata", "linearize")
    }
    table = table_of(given.linearize)
    return StatedOfImages(
        images=tuple(_pattern(folder, one) for one in _texts(given.images or [])),
        band_names=None if given.band_names is None else tuple(given.band_names),
        gsd_m=sides,
        metadata=None if documents is None else tuple(_below(folder, one) for one in documents),
        linearize=given.linearize if table is None else _below(folder, table),
        **plain,
    )


def _texts(value: Texts) -> Sequence[str]:
    return [value] if isinstance(value, str) else value


def _pattern(folder: Path, pattern: str) -> str:
    """A pattern of images: a name alone is one in every folder, others start at the plan."""
    if Path(pattern).name == pattern:
        return pattern
    return os.path.abspath(_below(folder, pattern))


def _below(folder: Path, path: str) -> str:
    """A path of a plan, seen from the current folder; a name of GDAL's own as it is."""
    if path.startswith(("/vsi", "~")) or ":" in path[2:]:
        return os.path.expanduser(path)
    return str(folder / path)
