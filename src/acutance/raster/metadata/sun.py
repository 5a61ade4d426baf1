"""Where the sun stood: a time and a place can be checked by it."""

from __future__ import annotations

import math
from datetime import UTC, datetime

__all__ = ["sun_angles"]

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)


def sun_angles(when: datetime, lon_deg: float, lat_deg: float) -> tuple[float, float]:
    """Elevation and azimuth of the sun in degrees, to a few hundredths, without refraction.

    The short series of the Astronomical Almanac, good from 1950 to 2050.

    Parameters
    ----------
    when : datetime
        Aware.
    lon_deg, lat_deg : float
        Of the place, WGS 84.
    """
    days = (when - _J2000).total_seconds() / 86400.0
    mean_longitude = math.radians(280.460 + 0.9856474 * days)
    anomaly = math.radians(357.528 + 0.9856003 * days)
    longitude = mean_longitude + math.radians(
        1.915 * math.sin(anomaly) + 0.020 * math.sin(2 * anomaly)
    )
    obliquity = math.radians(23.439 - 4e-7 * days)
    right_ascension = math.atan2(math.cos(obliquity) * math.sin(longitude), math.cos(longitude))
    declination = math.asin(math.sin(obliquity) * math.sin(longitude))
    sidereal = math.radians(280.46062 + 360.98564737 * days + lon_deg)
    hour_angle, lat = sidereal - right_ascension, math.radians(lat_deg)
    up = math.sin(lat) * math.sin(declination) + math.cos(lat) * math.cos(declination) * math.cos(
        hour_angle
    )
    east = -math.cos(declination) * math.sin(hour_angle)
    north = math.cos(lat) * math.sin(declination) - math.sin(lat) * math.cos(
        declination
    ) * math.cos(hour_angle)
    elevation = math.degrees(math.asin(max(-1.0, min(1.0, up))))
    return elevation, math.degrees(math.atan2(east, north)) % 360.0
