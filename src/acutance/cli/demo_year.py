"""The year of the demonstration: one site many times, a sensor that loses focus."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

from acutance.cli.terminal import say

if TYPE_CHECKING:
    from acutance.archive.trends import Trend
    from acutance.optics import Sensor
    from acutance.report.html import Section
    from acutance.simulate import EdgeTarps

__all__ = [
    "BEGIN",
    "IMAGES",
    "REFOCUS",
    "YEAR",
    "SimulatedYear",
    "measure_year",
    "true_nyquist",
    "year_section",
]

YEAR = "year"
SENSOR = "SIM-1"
GSD_M, CRS = 0.7, "EPSG:32614"
SIDE_PX, NOISE_STD, AIR_PX = 160, 8.0, 0.07
IMAGES, STEP_DAYS = 36, 10
BEGIN = datetime(2026, 1, 4, 17, 20, tzinfo=UTC)
REFOCUS = datetime(2026, 9, 1, tzinfo=UTC)
SIGMA_PX, GROWTH_PX = 0.40, 0.06
"""Blur of the optics at the beginning and after the refocusing, and what a year adds to it."""
_WEST_M, _NORTH_M = 678_000.0, 4_910_000.0


@dataclass(frozen=True, eq=False)
class SimulatedYear:
    """The archive of the year, its trends, and the truth.

    Parameters
    ----------
    archive : Path
    trends : dict of str to Trend
        By direction.
    """

    archive: Path
    trends: dict[str, Trend]

    @property
    def page(self) -> str:
        """The file that has everything."""
        return f"{YEAR}.html"


def measure_year(folder: Path, seed: int) -> SimulatedYear:
    """Draw the images of a year, measure them as a batch, and write the page of the sensor.

    The archive of an earlier demonstration is begun anew.
    """
    import numpy as np

    from acutance.archive import Archive
    from acutance.archive.trends import Event
    from acutance.batch import run_batch
    from acutance.report.archive.sensor_page import sensor_page_and_states

    images = folder / "images"
    images.mkdir(exist_ok=True)
    say(f"rendering {IMAGES} images of a year")
    _write_images(images, np.random.default_rng(seed))
    targets = folder / "targets.geojson"
    targets.write_text(json.dumps(_survey()), encoding="utf-8")
    say("measuring them as a batch")
    place = folder / f"{YEAR}.db"
    for earlier in folder.glob(f"{YEAR}.db*"):
        earlier.unlink()
    run_batch(images=str(images / "*.tif"), targets=targets, archive=place, workers=1)
    event = Event(REFOCUS, "refocus")
    with Archive(place) as archive:
        page, states = sensor_page_and_states(archive, SENSOR, events=[event])
    trends = {state.name: state.trend for state in states if state.trend is not None}
    (folder / f"{YEAR}.html").write_text(page, encoding="utf-8")
    return SimulatedYear(place, trends)


def _sensor_on(when: datetime) -> Sensor:
    """A sensor whose blur grows evenly with time, until it is refocused."""
    from acutance import optics

    begin = REFOCUS if when >= REFOCUS else BEGIN
    years = (when - begin) / timedelta(days=365.25)
    sigma_px = SIGMA_PX + GROWTH_PX * years
    return optics.Sensor([optics.Gaussian(sigma_px), optics.Detector(1.0)], gsd_m=GSD_M)


def _tarps() -> tuple[EdgeTarps, ...]:
    from acutance.simulate import EdgeTarps

    middle, levels = SIDE_PX / 2, (200.0, 1200.0)
    return (
        EdgeTarps("across-1", 40.0, middle - 40, 6.0, 30.0, *levels),
        EdgeTarps("along-1", 40.0, middle + 40, 96.0, 30.0, *levels),
        EdgeTarps("across-2", 115.0, middle - 40, 8.0, 30.0, *levels),
        EdgeTarps("along-2", 115.0, middle + 40, 98.0, 30.0, *levels),
    )


def _write_images(folder: Path, rng: Any) -> None:
    """One GeoTIFF an image, each with its own error of location."""
    from acutance.raster import write_geotiff
    from acutance.simulate import overflights

    dates = [BEGIN + timedelta(days=STEP_DAYS * at) for at in range(IMAGES)]
    seen = overflights(
        _sensor_on, _tarps(), (SIDE_PX, SIDE_PX), dates,
        noise_std=NOISE_STD, air_px=AIR_PX, rng=rng,
    )  # fmt: skip
    for one in seen:
        write_geotiff(
            folder / f"{SENSOR}-{one.acquired:%Y%m%d}.tif",
            one.pixels,
            transform=(GSD_M, 0.0, _WEST_M, 0.0, -GSD_M, _NORTH_M),
            crs=CRS,
            tags={"SENSOR": SENSOR, "ACQUISITION_DATETIME": one.acquired.isoformat()},
        )


def _survey() -> dict[str, Any]:
    """The tarps as their owner surveyed them: lines on the map."""
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "LineString", "coordinates": _ends(tarp)},
            "properties": {"name": tarp.name, "kind": "edge", "site": "Brookings"},
        }
        for tarp in _tarps()
    ]
    return {"type": "FeatureCollection", "crs": CRS, "features": features}


def _ends(tarp: EdgeTarps) -> list[list[float]]:
    """Both ends of the edge on the map."""
    from acutance.geometry import Line

    edge = Line(tarp.row, tarp.col, tarp.normal_deg)
    ends = (edge.slid(way * 0.45 * tarp.side_px) for way in (-1, 1))
    return [[_WEST_M + GSD_M * (end.col + 0.5), _NORTH_M - GSD_M * (end.row + 0.5)] for end in ends]


def true_nyquist(when: datetime) -> float:
    """MTF at Nyquist of the sensor through the air of an average day."""
    # A half-normal blur has the mean transfer 1 / sqrt(1 + (2 pi f scale)^2).
    air = 1 / math.sqrt(1 + (2 * math.pi * 0.5 * AIR_PX) ** 2)
    return air * float(abs(_sensor_on(when).otf(0.5, 0.0)))


def year_section(year: SimulatedYear) -> Section:
    """What the index says of the year."""
    from acutance.report.archive import trend_plate
    from acutance.report.html import Link, Section, Table
    from acutance.report.labels import word_estimate

    last = BEGIN + timedelta(days=STEP_DAYS * (IMAGES - 1))
    days = (BEGIN, REFOCUS - timedelta(days=1), REFOCUS + timedelta(days=1), last)
    rows = tuple(
        (
            f"{day:%Y-%m-%d}",
            *(word_estimate(trend.at(day)).value_and_std for trend in year.trends.values()),
            f"{true_nyquist(day):.4f}",
        )
        for day in days
    )
    columns = ("Day", *(f"MTF at Nyquist, {name}" for name in year.trends), "Truth")
    return Section(
        "A year of a sensor",
        paragraphs=(
            f"{IMAGES} images of one site with four edge tarps, one every {STEP_DAYS} days, "
            "through air that differs. The optics lose focus until they are refocused. The images "
            "are measured as a batch and kept in an archive; the trend finds loss and step. "
            "The truth is that of the average air.",
        ),
        plates=(trend_plate(year.trends["across"]),),
        tables=(Table(columns, rows, "lrrr"),),
        links=(Link("The year of the sensor: state, trends, images", year.page),),
    )
