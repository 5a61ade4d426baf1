"""The MTF as CSV."""

import csv as csv_format
import io

import numpy as np
import pytest

from acutance import BarsOptions, measure_bars, simulate
from acutance.optics import Detector, Gaussian, Sensor
from acutance.report import csv


def read(text):
    return list(csv_format.DictReader(io.StringIO(text)))


def test_the_grid_runs_from_zero_to_one_in_steps_of_two_hundredths(measurement):
    rows = read(csv(measurement))
    assert [float(row["freq_cpp"]) for row in rows] == pytest.approx([i / 50 for i in range(51)])


def test_values_and_intervals_are_those_of_the_measurement(measurement):
    row = next(row for row in read(csv(measurement)) if row["freq_cpp"] == "0.50")
    low, high = measurement.mtf_nyquist.interval(0.95)
    assert float(row["mtf"]) == pytest.approx(measurement.mtf_nyquist.value, abs=1e-6)
    assert float(row["std"]) == pytest.approx(measurement.mtf_nyquist.std, abs=1e-6)
    assert (float(row["low95"]), float(row["high95"])) == pytest.approx((low, high), abs=1e-6)
    assert float(row["freq_cpm"]) == pytest.approx(0.5 / 0.7, abs=1e-6)


def test_without_a_gsd_there_are_no_cycles_per_metre(vague_measurement):
    assert csv(vague_measurement).splitlines()[0] == "freq_cpp,mtf,std,low95,high95"


def test_pulses_are_counted_as_pulses(pulse):
    assert csv([pulse, pulse]).startswith("pulse,method,orientation,freq_cpp")


def test_many_measurements_are_told_apart(measurement, vague_measurement):
    rows = read(csv([measurement, vague_measurement]))
    assert len(rows) == 102
    assert {row["edge"] for row in rows} == {"1", "2"}
    assert rows[0]["method"] == "spline"
    assert "freq_cpm" not in rows[0]
    assert "freq_cpm" in read(csv([measurement, measurement]))[0]


@pytest.fixture(scope="module")
def bars():
    """Two groups of bars of one direction: they show the sensor across track alone."""
    sensor = Sensor([Gaussian(0.4), Detector(1.0)])
    image, _ = simulate.bars(
        sensor, periods_px=(6, 3), count=3, angle_deg=6, snr=100, rng=np.random.default_rng(1)
    )
    return measure_bars(image, options=BarsOptions(count=3))


def test_a_direction_that_bars_do_not_show_has_no_rows(bars):
    assert bars.measured_directions == ("across",)
    assert {row["direction"] for row in read(csv(bars))} == {"across", "normal"}
    assert {row["orientation"] for row in read(csv([bars, bars]))} == {"across"}
