"""Documents of PlanetScope and RapidEye (EarthObservation)."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from acutance.raster.metadata.findings import Findings, find, lon_lat, number, word
from acutance.raster.metadata.times import utc_time
from acutance.raster.metadata.xml_document import text_at

__all__ = ["read_planetscope"]


def read_planetscope(root: Element, source: str) -> Findings:
    """What such a document says; every satellite of the constellation is a sensor of its own.

    Parameters
    ----------
    root : Element
        EarthObservation.
    source : str
        Name of the file.
    """
    platform, acquisition = root.find(".//Platform"), root.find(".//Acquisition")
    product = root.find(".//ProductInformation")
    row, col = (number(text_at(product, name)) for name in ("rowGsd", "columnGsd"))
    return find(
        source,
        {
            "sensor": (
                word(text_at(platform, "shortName"), text_at(platform, "serialIdentifier")),
                "shortName, serialIdentifier",
            ),
            "level": (text_at(root, ".//EarthObservationMetaData/productType"), "productType"),
            "acquired": (
                utc_time(text_at(acquisition, "acquisitionDateTime")),
                "acquisitionDateTime",
            ),
            "gsd_m": (None if not (row and col) else (row, col), "rowGsd, columnGsd"),
            "view_zenith_deg": (number(text_at(acquisition, "incidenceAngle")), "incidenceAngle"),
            "sun_elevation_deg": (
                number(text_at(acquisition, "illuminationElevationAngle")),
                "illuminationElevationAngle",
            ),
            "sun_azimuth_deg": (
                number(text_at(acquisition, "illuminationAzimuthAngle")),
                "illuminationAzimuthAngle",
            ),
        },
        notes=_notes(acquisition, source),
        centre=_centre(root),
    )  # fmt: skip


def _notes(acquisition: Element | None, source: str) -> tuple[str, ...]:
    """What is not taken."""
    if text_at(acquisition, "azimuthAngle") is None:
        return ()
    return (
        f"{source}: azimuthAngle is the direction of the scan, not of the satellite: the view "
        "azimuth stays empty",
    )


def _centre(root: Element) -> tuple[float, float] | None:
    parts = (text_at(root, ".//centerOf/Point/pos") or "").split()
    return lon_lat(*parts) if len(parts) == 2 else None
