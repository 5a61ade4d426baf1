"""Undeclared fill is left out of every kind of measurement, and a note names it."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.targets.kinds import KINDS
from acutance.targets.region import read_data

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])


def note(measurement):
    return next(check for check in measurement.checks if check.name == "undeclared_fill")


def beyond(shape, angle_deg, share):
    """The pixels beyond a straight line."""
    rows, cols = np.indices(shape)
    along = np.cos(np.radians(angle_deg)) * cols + np.sin(np.radians(angle_deg)) * rows
    return along > np.quantile(along, 1 - share)


def edge(shape=(60, 60)):
    image, _ = simulate.edge(
        SENSOR, angle_deg=6.0, shape=shape, snr=100, rng=np.random.default_rng(4)
    )
    return image


@pytest.mark.parametrize("value", [0.0, 4095.0, -32768.0])
def test_an_edge_beside_fill_is_measured_as_beside_declared_nodata(value):
    image = edge()
    corner = beyond(image.shape, 50.0, 0.2)
    image[corner] = value
    found = ac.measure_edge(image)
    declared = ac.measure_edge(ac.Image.from_array(image, nodata=value))
    assert found.mtf_nyquist.value == declared.mtf_nyquist.value
    assert found.mtf_nyquist.std == declared.mtf_nyquist.std
    check = note(found)
    assert (check.passed, check.severity, check.value) == (False, "note", np.count_nonzero(corner))
    assert f"{np.count_nonzero(corner)} pixels" in check.message
    assert f"the value {value:.9g} " in check.message
    assert found.verdict.word == "usable"
    assert note(declared).passed


def test_the_border_of_fill_is_no_edge():
    """Without an edge in the data there is none, however high the step to the fill is."""
    image = np.random.default_rng(0).normal(500.0, 5.0, (80, 80))
    image[beyond(image.shape, 6.0, 0.5)] = 0.0
    with pytest.raises(ac.NoEdgeError, match="without data"):
        ac.measure_edge(image)
    assert ac.measure_edges(image).measurements == ()
    stated = ac.Image.from_array(image, nodata=np.nan)
    assert ac.measure_edge(stated).failed_checks


def test_fill_is_not_averaged_with_the_edges_of_a_target():
    image = edge((80, 80))
    image[beyond(image.shape, 95.0, 0.3)] = 0.0
    found = ac.measure_edges(image)
    assert found.measurements
    assert all(one.dark > 100 for one in found.measurements)


def test_a_region_of_fill_holds_no_data():
    image = edge((80, 80))
    image[beyond(image.shape, 0.0, 0.5)] = 0.0
    with pytest.raises(ac.NoDataError, match="a constant fill of 0"):
        ac.measure_edge(image, (10, 39, 40, 30))


def test_points_bars_stars_and_pulses_leave_fill_out():
    scenes = {
        "pulse": simulate.pulse(
            SENSOR, width_px=3.3, angle_deg=6.0, shape=(60, 60), snr=100,
            rng=np.random.default_rng(1),
        )[0],
        "bars": simulate.bars(SENSOR, snr=100, rng=np.random.default_rng(1))[0],
        "star": simulate.star(
            SENSOR, cycles=36, radius_px=32.0, shape=(80, 80), snr=100,
            rng=np.random.default_rng(1),
        )[0],
        "points": simulate.points(SENSOR, snr=100, rng=np.random.default_rng(1))[0],
    }  # fmt: skip
    for kind, image in scenes.items():
        room = KINDS[kind]
        rng, size = np.random.default_rng(3), (20, image.shape[1])
        wide = rng.normal(np.median(image), np.std(image) / 50, size)
        filled = np.vstack([image, wide, np.zeros(size)])
        found = room.load(room.measure)(filled)
        assert note(found).value == wide.size, kind
        assert note(room.load(room.measure)(image)).passed, kind


def test_pairs_leave_fill_of_either_image_out():
    rng = np.random.default_rng(0)
    fine = np.cumsum(np.cumsum(rng.normal(0, 1, (240, 240)), axis=0), axis=1)
    fine = 1000 + 100 * (fine - fine.mean()) / fine.std() + 20 * rng.normal(size=fine.shape)
    low = fine.reshape(80, 3, 80, 3).mean(axis=(1, 3))
    low[beyond(low.shape, 30.0, 0.15)] = 0.0
    found = ac.measure_biresolution(low, fine, ratio=3)
    assert note(found).value > 100
    assert "the value 0 " in note(found).message


def test_reading_leaves_the_image_itself_alone():
    image = edge()
    image[beyond(image.shape, 50.0, 0.2)] = 0.0
    source = ac.Image.from_array(image)
    pixels, fill = read_data(source, ac.Box.whole(image.shape))
    assert np.isnan(pixels).sum() == fill.count
    assert np.array_equal(source.read(), image)
