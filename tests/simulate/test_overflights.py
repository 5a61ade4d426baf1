"""Images of one site on many days: what differs from day to day is what was said to."""

import sys
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import EdgeTarps, overflights
from acutance.simulate.campaign import render_site

TARP = EdgeTarps("edge", 40.0, 40.0, 6.0, 30.0, 200.0, 1200.0)
DAYS = [datetime(2026, 1, 1, tzinfo=UTC) + timedelta(days=40 * at) for at in range(6)]


def sensor_on(when: datetime) -> ac.Sensor:
    days = (when - DAYS[0]) / timedelta(days=1)
    return ac.Sensor([ac.optics.Gaussian(0.4 + 0.001 * days), ac.optics.Detector()], gsd_m=1.0)


def drawn(rng_seed=3, **changed):
    wanted = {"noise_std": 10.0, "air_px": 0.0, "rng": np.random.default_rng(rng_seed)} | changed
    return list(overflights(sensor_on, [TARP], (80, 80), DAYS, **wanted))


def test_each_day_has_the_sensor_of_that_day():
    for one in drawn():
        found = ac.measure_edge(one.pixels.astype(float), (12, 22, 56, 36))
        true = one.sensor.response(6.0).metrics()["mtf_nyquist"].value
        assert abs(found.mtf_nyquist.value - true) < 3.5 * found.mtf_nyquist.std
    first, last = drawn()[0], drawn()[-1]
    assert first.sensor.otf(0.5, 0.0) > last.sensor.otf(0.5, 0.0) + 0.1


def test_the_site_is_off_by_the_shift_that_is_told():
    seen = drawn(noise_std=0.0, pointing_px=3.0)
    for one in seen:
        line = ac.measure_edge(one.pixels.astype(float), (12, 22, 56, 36)).line
        along = np.radians(6.0)
        expected = (40.0 + one.shift_px[1]) * np.cos(along) + (40.0 + one.shift_px[0]) * np.sin(
            along
        )
        assert line.col * np.cos(along) + line.row * np.sin(along) == pytest.approx(
            expected, abs=0.02
        )
    assert 1.0 < np.std([one.shift_px for one in seen]) < 6.0


def test_the_air_blurs_each_image_by_an_amount_of_its_own():
    seen = drawn(air_px=0.3)
    assert len({one.air_px for one in seen}) == len(seen)
    assert max(one.air_px for one in seen) > 0.1
    one = max(seen, key=lambda found: found.air_px)
    found = ac.measure_edge(one.pixels.astype(float), (12, 22, 56, 36)).mtf_nyquist
    bare = one.sensor.response(6.0).metrics()["mtf_nyquist"].value
    expected = bare * np.exp(-2 * (np.pi * 0.5 * one.air_px) ** 2)
    assert abs(found.value - expected) < 3.5 * found.std < abs(found.value - bare)


def test_the_air_changes_no_pixel_size(monkeypatch):
    seen = []

    def rendered(sensor, *arguments):
        seen.append(sensor.pixel_m)
        return render_site(sensor, *arguments)

    monkeypatch.setattr(sys.modules[overflights.__module__], "render_site", rendered)
    oblong = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=1.0, gsd_along_m=1.5)
    (one,) = overflights(
        lambda _: oblong, [TARP], (80, 80), DAYS[:1],
        noise_std=10.0, air_px=0.3, rng=np.random.default_rng(3),
    )  # fmt: skip
    assert one.air_px > 0
    assert seen == [(1.5, 1.0)] == [one.sensor.pixel_m]


def test_negative_deviations_are_refused():
    with pytest.raises(ac.ModelError, match="0 or more"):
        drawn(air_px=-0.1)
