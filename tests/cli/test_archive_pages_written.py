"""``acutance archive trend --report``, ``acutance archive report``: pages and drawings as files."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Archive

BEGIN = datetime(2024, 1, 10, 10, tzinfo=UTC)


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """Six images of one target."""
    place = tmp_path_factory.mktemp("archive") / "campaign.db"
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)
    with Archive(place) as made:
        for at in range(6):
            pixels, _ = ac.simulate.edge(
                sensor, angle_deg=6.0, shape=(60, 44), snr=100, rng=np.random.default_rng(at)
            )
            day = BEGIN + timedelta(days=60 * at)
            made.add(ac.measure_edge(pixels, gsd_m=0.7), sensor="QB02", acquired=day)
    return place


def test_a_trend_is_written_as_page_and_drawing(acutance, archive, tmp_path):
    page, figure = tmp_path / "t.html", tmp_path / "t.png"
    done = acutance("archive", "trend", archive, "--report", page, "--figure", figure)
    assert done.exit_code == 0, done.stderr
    assert "Trend of MTF at Nyquist" in page.read_text(encoding="utf-8")
    assert figure.read_bytes()[:4] == b"\x89PNG"


def test_the_page_of_a_sensor_ends_with_the_command(acutance, archive, tmp_path):
    page = tmp_path / "s.html"
    done = acutance("archive", "report", archive, "QB02", page)
    assert done.exit_code == 0, done.stderr
    text = page.read_text(encoding="utf-8")
    assert "<pre>acutance" in text
    assert "Through time" in text


def test_what_cannot_be_written_or_is_not_there_is_told(acutance, archive, tmp_path):
    done = acutance("archive", "report", archive, "QB03", tmp_path / "s.html")
    assert done.exit_code == 4
    assert "its sensors are QB02" in done.stderr
    assert acutance("archive", "report", archive, "QB02", tmp_path / "s.txt").exit_code == 2
