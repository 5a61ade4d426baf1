"""The GML inside JPEG 2000 images of Airbus, and of TIFF files made from them."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta

from acutance.raster.metadata.findings import Findings, find

__all__ = ["read_gml"]

_DATASET = re.compile(r"DS_([A-Z]{3,4}\d\w?)_(\d{14})(\d)_")
"""Of a data strip: satellite, time to a tenth of a second."""


def read_gml(text: str, source: str) -> Findings:
    """The satellite and the time in the name of the data strip the coverage comes from.

    Parameters
    ----------
    text : str
    source : str
        Name of the file and of the tag.
    """
    found = _DATASET.search(text)
    if found is None:
        return Findings()
    satellite, digits, tenth = found.groups()
    try:
        whole = datetime.strptime(digits, "%Y%m%d%H%M%S").replace(tzinfo=UTC)
    except ValueError:
        return find(source, {"sensor": (satellite, "name of the data strip")})
    when = whole + timedelta(seconds=int(tenth) / 10)
    place = f"name of the data strip, {found[0].rstrip('_')}"
    return find(source, {"sensor": (satellite, place), "acquired": (when, place)})
