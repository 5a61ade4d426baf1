"""Trends of products whose pixels are not square."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Archive, Entry, ImageEntry
from acutance.archive.trends.measured_series import pixel_side_m

OBLONG_M = (0.6, 0.8)


def entry_of(record: ac.Record, i: int, sides_m: tuple[float, float], slope_deg: float) -> Entry:
    """An edge of image i, whose normal turns away from the row."""
    document, slope = record.document, np.radians(slope_deg)
    along_normal = np.hypot(sides_m[1] * np.cos(slope), sides_m[0] * np.sin(slope))
    shown = {
        "line": {**document["line"], "normal_deg": slope_deg},
        "gsd_m": float(along_normal),
        "image": {**document["image"], "pixel_gsd_m": list(sides_m)},
    }
    image = ImageEntry(
        path=f"/images/{i}.tif", content=f"{i:064x}", sensor="S1", gsd_m=sides_m,
        acquired=datetime(2026, 1, 1, tzinfo=UTC) + timedelta(days=10 * i),
    )  # fmt: skip
    return Entry(record=ac.Record({**record.document, **shown}), image=image, band="pan")


@pytest.fixture
def archive(tmp_path: Any) -> Any:
    with Archive(tmp_path / "archive.db") as opened:
        yield opened


def test_slopes_of_targets_are_no_change_of_the_pixels(archive: Any, edge_record: Any) -> None:
    slopes = [35.0 if i == 4 else 3.0 for i in range(12)]
    archive.add_entries(entry_of(edge_record, i, OBLONG_M, slope) for i, slope in enumerate(slopes))
    rows = archive.measurements()
    assert rows["gsd_m"].max() - rows["gsd_m"].min() > 0.05
    assert (set(rows["gsd_row_m"]), set(rows["gsd_col_m"])) == ({0.6}, {0.8})
    trend = archive.trend("fwhm_px")
    assert not trend.events
    assert not any("GSD" in note for note in trend.notes)


@pytest.mark.parametrize("track", ["y", "x"])
def test_the_side_is_that_of_the_axis_whatever_the_direction_is_called(
    archive: Any, track: str
) -> None:
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    for orientation in ("across", "along"):
        pixels, _ = ac.simulate.edge(
            sensor, angle_deg=7, shape=(60, 60), snr=200, rng=np.random.default_rng(1),
            orientation=orientation,
        )  # fmt: skip
        image = ac.Image.from_array(pixels, gsd_m=ac.Gsd(*OBLONG_M), along_track=track)
        archive.add(
            ac.measure_edge(image), image=ImageEntry(path=f"{orientation}.tif", gsd_m=OBLONG_M)
        )
    rows = archive.measurements()
    nearer_columns = np.abs(rows["normal_deg"]) < 45
    named = {"y": "across", "x": "along"}[track]
    assert set(rows["orientation"][nearer_columns].tolist()) == {named}
    for mask, side in ((nearer_columns, OBLONG_M[1]), (~nearer_columns, OBLONG_M[0])):
        assert pixel_side_m(rows, mask).tolist() == [side]


def test_other_pixels_of_a_side_are_a_change(archive: Any, edge_record: Any) -> None:
    archive.add_entries(
        entry_of(edge_record, i, OBLONG_M if i < 6 else (0.6, 0.6), 3.0) for i in range(12)
    )
    (event,) = archive.trend("fwhm_px").events
    assert event.name == "GSD 0.8 to 0.6 m"
