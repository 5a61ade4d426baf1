"""How far a measured line lies from its survey: kept with the measurement.

The map of an image is some metres off, and a survey too. Both show in these distances, of many
images together, and a target taken for another one in a single distance.
"""

from __future__ import annotations

from typing import Any

from acutance.batch.find_line import away_from_survey
from acutance.batch.place_target import PlacedTarget
from acutance.geometry.line import Line
from acutance.targets.record import Record

__all__ = ["with_survey_distance"]


def with_survey_distance(record: Record, placed: PlacedTarget) -> Record:
    """The record of a surveyed edge or pulse with its distance from the survey.

    Parameters
    ----------
    record : Record
    placed : PlacedTarget
        Where the survey has the target; of an outline or of points nothing is added.

    Returns
    -------
    Record
        With the field ``survey_line``: distance_px at the middle of the surveyed line (distance_m
        where the GSD is known), turn_deg, and how far was looked (search_px).
    """
    if placed.target.shape != "LineString" or "line" not in record.document:
        return record
    written = record.document["line"]
    line = Line(
        row=written["row"], col=written["col"], normal_deg=written["normal_deg"],
        length_px=written["length_px"] or 0.0,
    )  # fmt: skip
    width = record.document.get("width_px") or {"value": 0.0}
    away = away_from_survey(placed, line, width["value"] or 0.0)
    gsd_m = record.image.gsd_along(line.normal_deg)
    found: dict[str, Any] = {
        "distance_px": away.distance_px,
        "distance_m": None if gsd_m is None else away.distance_px * gsd_m,
        "turn_deg": away.turn_deg,
        "search_px": placed.search_px,
    }
    return Record({**record.document, "survey_line": found})
