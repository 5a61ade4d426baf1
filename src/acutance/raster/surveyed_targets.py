"""Targets as their owners survey them: features of a GeoJSON file, each with its kind."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError, RegionError
from acutance.raster.coordinates import PIXELS
from acutance.raster.document_faults import DocumentFault, document_faults
from acutance.raster.geojson import declared_crs, load_geojson
from acutance.raster.geolocation import LONLAT_CRS, require_known_crs
from acutance.raster.site import find_site

__all__ = ["KINDS", "SurveyedTarget", "read_targets", "targets_of"]

KINDS = ("edge", "pulse", "points", "star", "bars", "scene")

_OF_KIND = {
    "edge": ("orientation", "side_m", "side_px"),
    "pulse": ("width_m", "width_px", "fit_width", "side_m", "side_px"),
    "points": (),
    "star": ("cycles",),
    "bars": ("count",),
    "scene": (),
}
"""Properties that belong to some kinds only."""
_GEOMETRY = {
    "edge": ("LineString", "Polygon", "Point"),
    "pulse": ("LineString", "Polygon", "Point"),
    "points": ("MultiPoint", "Polygon"),
    "star": ("Polygon", "Point"),
    "bars": ("Polygon", "Point"),
    "scene": ("Polygon",),
}
_SHAPES = tuple(dict.fromkeys(sum(_GEOMETRY.values(), ())))
_NO_SIZE = "a Point needs size_m (or size_px), the side of the square around it"
_STD_M, _CATALOGUE_STD_M = 5.0, 15.0
"""Of a satellite receiver's position in an image located by its vendor; of seconds of arc."""
_STD_PX = 2.0
_PLACES = {"position_std_m": "on the ground", "position_std_px": "in pixels"}
_FREE = frozenset(("description", "source", "id", "fid"))
"""Properties that say nothing of the measurement."""


@dataclass(frozen=True, eq=False)
class SurveyedTarget(ShortRepr):
    """A target as its owner describes it.

    Parameters
    ----------
    name : str
    kind : str
        One of `KINDS`.
    crs : str
        Of the coordinates; "pixel" for column and row.
    shape : {"LineString", "Polygon", "Point", "MultiPoint"} or None
        None for a scene that is the whole image.
    points : tuple of (x, y)
        Of the line, the outline (open), the point or the points.
    site : str or None
    valid_from, valid_to : date or None
        Both inclusive.
    bands : tuple of (str or int), or None
        Names or numbers of the bands that see it; None for all.
    position_std_m, position_std_px : float
        Standard deviation of its place in an image, in metres of coordinates on the ground, in
        pixels of such in pixels.
    height_m : float or None
        Above the ellipsoid, for images located by RPC.
    size_m, size_px : float or None
        Side of the square around a Point.
    method : str or None
        None is that of the plan, or the reference.
    settings : mapping
        What its kind has besides: width_m, cycles, count, orientation, side_m, ...
    options : mapping
        Options of its measurement, by the names of the kind's options.
    definition : mapping
        The feature as given, with its CRS.
    """

    name: str
    kind: str
    crs: str
    shape: str | None
    points: tuple[tuple[float, float], ...]
    site: str | None
    valid_from: date | None
    valid_to: date | None
    bands: tuple[str | int, ...] | None
    position_std_m: float
    position_std_px: float
    height_m: float | None
    size_m: float | None
    size_px: float | None
    method: str | None
    settings: Mapping[str, Any]
    options: Mapping[str, Any]
    definition: Mapping[str, Any]

    @property
    def in_pixels(self) -> bool:
        """Whether its coordinates are pixels."""
        return self.crs.lower() == PIXELS

    def summary(self) -> str:
        """Name, kind and shape."""
        return f"{self.name}: {self.kind}, {self.shape or 'whole image'}"


class _Properties(BaseModel):
    """What stands in the properties of a feature."""

    model_config = ConfigDict(extra="forbid")

    kind: Literal["edge", "pulse", "points", "star", "bars", "scene"]
    name: str | None = Field(default=None, min_length=1)
    site: str | None = Field(default=None, min_length=1)
    valid_from: date | None = None
    valid_to: date | None = None
    bands: list[str | int] | None = Field(default=None, min_length=1)
    position_std_m: float | None = Field(default=None, ge=0, le=1000)
    position_std_px: float | None = Field(default=None, ge=0, le=1000)
    height_m: float | None = Field(default=None, ge=-1000, le=10000)
    size_m: float | None = Field(default=None, gt=0)
    size_px: float | None = Field(default=None, gt=0)
    method: str | None = None
    orientation: Literal["across", "along"] | None = None
    side_m: float | None = Field(default=None, gt=0)
    side_px: float | None = Field(default=None, gt=0)
    width_m: float | None = Field(default=None, gt=0)
    width_px: float | None = Field(default=None, gt=0)
    fit_width: bool | None = None
    cycles: int | None = Field(default=None, ge=4, le=1000)
    count: int | None = Field(default=None, ge=2, le=40)
    options: dict[str, Any] = Field(default_factory=dict)

    @field_validator("valid_from", "valid_to", mode="before")
    @classmethod
    def _a_text(cls, value: Any) -> Any:
        # A number would be taken for seconds since 1970.
        if value is not None and not isinstance(value, str | date):
            raise ValueError("write a date, 2026-01-31")
        return value


def read_targets(path: str) -> tuple[SurveyedTarget, ...]:
    """The targets of a GeoJSON file, in its order.

    Parameters
    ----------
    path : str

    Raises
    ------
    OptionError
        If it is no such file, holds no feature, or holds what is not known: all faults of all
        features are named at once.
    """
    try:
        document = load_geojson(path)
    except RegionError as error:
        raise OptionError(str(error)) from error
    return targets_of(document, path)


def targets_of(
    document: Mapping[str, Any], name: str, crs: str | None = None
) -> tuple[SurveyedTarget, ...]:
    """The targets of a GeoJSON document.

    Parameters
    ----------
    document : mapping
        A FeatureCollection, or one Feature.
    name : str
        Of the file, for messages.
    crs : str, optional
        Of its coordinates, if not the one it declares; longitude and latitude without either.

    Raises
    ------
    OptionError
        As of `read_targets`.
    """
    kind = document.get("type")
    features = document.get("features") if kind == "FeatureCollection" else [document]
    if kind not in ("FeatureCollection", "Feature") or not isinstance(features, list):
        raise OptionError(f"{name} holds a {kind!r}: write the targets as a FeatureCollection")
    if not features:
        raise OptionError(f"{name} holds no features: write one for every target")
    try:
        crs = crs or declared_crs(document, name)
    except RegionError as error:
        raise OptionError(str(error)) from error
    found: list[SurveyedTarget] = []
    faults = _faults_of_crs(crs)
    for number, feature in enumerate(features, start=1):
        try:
            found.append(_target(feature, number, crs or LONLAT_CRS))
        except _FaultsError as error:
            faults.extend(error.faults)
    count = Counter(_title(one, number) for number, one in enumerate(features, start=1))
    faults.extend(f"{count[one]} features have the name {one!r}" for one in count if count[one] > 1)
    if faults:
        raise OptionError(f"{name} cannot be used:\n" + "\n".join(f"  - {one}" for one in faults))
    return tuple(found)


def _faults_of_crs(crs: str | None) -> list[str]:
    if crs is None or crs.lower() == PIXELS:
        return []
    try:
        require_known_crs(crs)
    except RegionError as error:
        return [str(error)]
    return []


def _title(feature: Any, number: int) -> str:
    """What a feature is called, well formed or not: its name, its site, its id, else its number."""
    if not isinstance(feature, Mapping):
        return str(number)
    given = feature.get("properties")
    given = given if isinstance(given, Mapping) else {}
    title = given.get("name") or given.get("site") or feature.get("id") or number
    return str(title) if isinstance(title, str | int) else str(number)


class _FaultsError(ValueError):
    """What is wrong with a feature, fault by fault."""

    def __init__(self, label: str, faults: Sequence[str]) -> None:
        super().__init__(label)
        self.faults = [f"{label}: {fault}" for fault in faults]


def _target(feature: Any, number: int, crs: str) -> SurveyedTarget:
    label = f"target {number}"
    if not isinstance(feature, Mapping) or feature.get("type") != "Feature":
        raise _FaultsError(label, ["it is no GeoJSON Feature"])
    given = feature.get("properties")
    given = dict(given) if isinstance(given, Mapping) else {}
    title = _title(feature, number)
    label = f"{label} ({title})" if title != str(number) else label
    known = {key: value for key, value in given.items() if key not in _FREE}
    try:
        properties = _Properties.model_validate(known)
    except ValidationError as error:
        faults = [_fault(one) for one in document_faults(error, known)]
        raise _FaultsError(label, [*faults, *_faults_beside(feature, known, crs)]) from None
    return _checked(feature, properties, label, title, crs)


def _faults_beside(feature: Mapping[str, Any], given: Mapping[str, Any], crs: str) -> list[str]:
    """What is wrong with a feature besides properties that are not well formed."""
    kind = given.get("kind") if given.get("kind") in KINDS else None
    shape, _, faults = _geometry(feature.get("geometry"), kind, crs)
    faults += _of_other_kinds(given, kind)
    if feature.get("geometry") is not None:
        faults += _of_other_coordinates(given, crs)
    if shape == "Point" and not given.keys() & {"size_m", "size_px"}:
        faults.append(_NO_SIZE)
    return faults


def _of_other_kinds(names: Iterable[str], kind: str | None) -> list[str]:
    """Properties that belong to some kinds, and not to this one."""
    if kind is None:
        return []
    others = set(sum(_OF_KIND.values(), ())) - set(_OF_KIND[kind])
    return [f"{one} is no property of the kind {kind!r}" for one in sorted(others & set(names))]


def _of_other_coordinates(given: Mapping[str, Any], crs: str) -> list[str]:
    """A deviation in metres of a place in pixels, or the other way round: it would do nothing."""
    own = "position_std_px" if crs.lower() == PIXELS else "position_std_m"
    return [
        f"{name} is of places {where}, its own is {_PLACES[own]}: give {own}"
        for name, where in _PLACES.items()
        if name != own and given.get(name) is not None
    ]


def _fault(fault: DocumentFault) -> str:
    one_of = f": one of {', '.join(KINDS)}" if fault.kind == "missing" else ""
    return fault.in_words("property") + one_of


def _checked(
    feature: Mapping[str, Any], given: _Properties, label: str, title: str, crs: str
) -> SurveyedTarget:
    """The target of properties that are well formed by themselves, if they fit together."""
    shape, points, faults = _geometry(feature.get("geometry"), given.kind, crs)
    size_m, std_m = given.size_m, given.position_std_m
    if feature.get("geometry") is None and given.kind != "scene":
        shape, points, crs, size_m, faults = _of_catalogue(given, size_m)
        std_m = _CATALOGUE_STD_M if std_m is None else std_m
    own = {name for name in given.model_fields_set if name in _OF_KIND[given.kind]}
    faults += _of_other_kinds(given.model_fields_set, given.kind)
    faults += _of_other_coordinates(dict(given), crs)
    if shape == "Point" and size_m is None and given.size_px is None:
        faults.append(_NO_SIZE)
    if given.valid_from and given.valid_to and given.valid_to < given.valid_from:
        faults.append(f"valid_to {given.valid_to} is before valid_from {given.valid_from}")
    if given.width_m is not None and given.width_px is not None:
        faults.append("width_m and width_px are both given: keep one")
    if faults:
        raise _FaultsError(label, faults)
    return SurveyedTarget(
        name=given.name or title,
        kind=given.kind,
        crs=crs,
        shape=shape,
        points=points,
        site=given.site,
        valid_from=given.valid_from,
        valid_to=given.valid_to,
        bands=None if given.bands is None else tuple(given.bands),
        position_std_m=_STD_M if std_m is None else std_m,
        position_std_px=_STD_PX if given.position_std_px is None else given.position_std_px,
        height_m=given.height_m,
        size_m=size_m,
        size_px=given.size_px,
        method=given.method,
        settings={name: getattr(given, name) for name in sorted(own)},
        options=given.options,
        definition={**json.loads(json.dumps(feature, default=str)), "crs": crs},
    )


Points = tuple[tuple[float, float], ...]
Shape = tuple[str | None, Points, list[str]]


def _geometry(geometry: Any, kind: str | None, crs: str) -> Shape:
    """Shape and points of a feature, or what is wrong with them; any shape of an unknown kind."""
    if geometry is None:
        return None, (), []
    shape = geometry.get("type") if isinstance(geometry, Mapping) else None
    shapes = _SHAPES if kind is None else _GEOMETRY[kind]
    if shape not in shapes:
        what = "targets take" if kind is None else f"the kind {kind!r} takes"
        return None, (), [f"its geometry is {shape!r}: {what} {' or '.join(shapes)}"]
    coordinates = geometry.get("coordinates")
    if shape == "Point":
        coordinates = [coordinates]
    elif shape == "Polygon" and isinstance(coordinates, list):
        if len(coordinates) != 1:
            return None, (), [f"its Polygon has {len(coordinates)} rings: give one"]
        coordinates = coordinates[0]
    try:
        points = tuple((float(one[0]), float(one[1])) for one in coordinates)
    except (TypeError, ValueError, IndexError, KeyError):
        return None, (), ["its coordinates are not pairs of numbers"]
    return shape, *_usable(shape, points, crs)


def _usable(shape: str, points: Points, crs: str) -> tuple[Points, list[str]]:
    if shape == "Polygon" and len(points) > 1 and points[0] == points[-1]:
        points = points[:-1]
    least = {"LineString": 2, "Polygon": 3, "Point": 1, "MultiPoint": 1}[shape]
    if len(points) < least or (shape == "LineString" and len(points) > 2):
        wanted = "2 points, its ends" if shape == "LineString" else f"{least} or more points"
        return points, [f"its {shape} has {len(points)} points: give {wanted}"]
    array = np.array(points)
    if not np.isfinite(array).all():
        return points, ["a coordinate is no finite number"]
    if crs == LONLAT_CRS and (np.abs(array) > (360.0, 90.0)).any():
        return points, [
            f"{array[0, 0]:g}, {array[0, 1]:g} is no longitude and latitude: add the CRS of the "
            'coordinates to the file, "crs": "EPSG:32631", or "crs": "pixel"'
        ]
    return points, []


def _of_catalogue(
    given: _Properties, size_m: float | None
) -> tuple[str | None, Points, str, float | None, list[str]]:
    """The place of a site that stands in the catalogue."""
    nowhere: tuple[str | None, Points, str] = (None, (), LONLAT_CRS)
    if given.site is None:
        return *nowhere, size_m, ["it has no geometry, and names no site of the catalogue"]
    try:
        site = find_site(given.site)
    except OptionError as error:
        return *nowhere, size_m, [str(error)]
    if site.longitude_deg is None or site.latitude_deg is None:
        return *nowhere, size_m, [f"the coordinates of {site.title} are not published: give them"]
    place = ((site.longitude_deg, site.latitude_deg),)
    return "Point", place, LONLAT_CRS, size_m or site.extent_m, []
