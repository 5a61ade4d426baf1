"""Documents of Gaofen and ZiYuan satellites (ProductMetaData)."""

from __future__ import annotations

import math
from datetime import datetime, timedelta
from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, lon_lat, number, word
from acutance.raster.metadata.sun import sun_angles
from acutance.raster.metadata.times import utc_time
from acutance.raster.metadata.xml_document import text_at

__all__ = ["read_gaofen"]

_CORNERS = ("TopLeft", "TopRight", "BottomRight", "BottomLeft")
_BEIJING = timedelta(hours=8)
_NEAR_DEG = 2.0
_PER_ROLL = 1.25
"""The zenith angle on the ground is up to so many times the one at the satellite."""


def read_gaofen(root: Element, source: str) -> Findings:
    """What such a document says.

    Its times name no zone: some are UTC, some Beijing time. The sun it states tells which, from the
    time and the place; where it does not, the time stays empty. SatelliteZenith is an elevation in
    some products: it is left out where it contradicts the attitude.

    Parameters
    ----------
    root : Element
        ProductMetaData.
    source : str
        Name of the file.
    """
    centre, zenith = _centre(root), number(text_at(root, "SolarZenith"))
    azimuth = number(text_at(root, "SolarAzimuth"))
    elevation = None if zenith is None else 90.0 - zenith
    acquired, place, notes = _time(root, source, centre, elevation, azimuth)
    view, view_note = _view_zenith(root, source)
    spacing = number(text_at(root, "ImageGSD"))
    band = word(text_at(root, "Bands"))
    correction = word(text_at(root, "MtfCorrection"))
    mtf = (f"{source}: MtfCorrection is {correction}",) if correction else ()
    return find(
        source,
        {
            "sensor": (
                word(text_at(root, "SatelliteID"), text_at(root, "SensorID")),
                "SatelliteID, SensorID",
            ),
            "level": (text_at(root, "ProductLevel"), "ProductLevel"),
            "acquired": (acquired, place),
            "bands": ((f"B{band}",) if band and band.isdecimal() else None, "Bands"),
            "gsd_m": (None if spacing is None else (spacing, spacing), "ImageGSD"),
            "view_zenith_deg": (view, "SatelliteZenith"),
            "sun_elevation_deg": (elevation, "SolarZenith"),
            "sun_azimuth_deg": (azimuth, "SolarAzimuth"),
        },
        notes=(*notes, *view_note, *mtf),
        centre=centre,
    )  # fmt: skip


def _time(
    root: Element,
    source: str,
    centre: tuple[float, float] | None,
    elevation: float | None,
    azimuth: float | None,
) -> tuple[datetime | None, str, tuple[str, ...]]:
    """The time of the middle line, its zone by the sun."""
    written = utc_time(text_at(root, "CenterTime")) or utc_time(text_at(root, "StartTime"))
    if written is None:
        return None, "", ()
    agreeing = [] if centre is None or elevation is None or azimuth is None else [
        (when, zone)
        for when, zone in ((written, "UTC"), (written - _BEIJING, "Beijing time"))
        if _is_near(sun_angles(when, *centre), elevation, azimuth)
    ]  # fmt: skip
    if len(agreeing) != 1:
        note = f"{source}: CenterTime names no zone, and the sun does not tell it: time stays empty"
        return None, "", (note,)
    when, zone = agreeing[0]
    return when, f"CenterTime, which by the stated sun is {zone}", ()


def _is_near(sun: tuple[float, float], elevation: float, azimuth: float) -> bool:
    away = abs((sun[1] - azimuth + 180.0) % 360.0 - 180.0) * math.cos(math.radians(elevation))
    return abs(sun[0] - elevation) < _NEAR_DEG and away < _NEAR_DEG


def _view_zenith(root: Element, source: str) -> tuple[float | None, tuple[str, ...]]:
    stated = number(text_at(root, "SatelliteZenith"))
    roll, pitch = (
        number(text_at(root, name)) for name in ("RollSatelliteAngle", "PitchSatelliteAngle")
    )
    if stated is None or roll is None or pitch is None:
        return None, ()
    off_nadir = math.hypot(roll, pitch)
    if off_nadir - _NEAR_DEG <= stated <= _PER_ROLL * off_nadir + _NEAR_DEG:
        return stated, ()
    return None, (
        f"{source}: SatelliteZenith {stated:g} contradicts the attitude, {off_nadir:.1f} degrees "
        "off nadir: the view zenith stays empty",
    )


def _centre(root: Element) -> tuple[float, float] | None:
    corners = [
        lon_lat(text_at(root, f"{one}Longitude"), text_at(root, f"{one}Latitude"))
        for one in _CORNERS
    ]
    known = [one for one in corners if one is not None]
    if len(known) < len(_CORNERS) or max(known)[0] - min(known)[0] > 180.0:
        return None
    return sum(lon for lon, _ in known) / 4, sum(lat for _, lat in known) / 4
