"""The light and the heavy half of a measurement of points."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import acutance as ac

SENSOR = ac.simulate.reference_systems()["asymmetric"]


@pytest.fixture(scope="module", params=["psf-fit", "gaussian-2003"])
def measured(request):
    image, truth = ac.simulate.points(SENSOR, snr=80.0, rng=np.random.default_rng(1))
    return ac.measure_points(image, method=request.param, surveyed=truth.positions, gsd_m=0.7)


def test_a_pickled_measurement_equals_itself(measured):
    again = pickle.loads(pickle.dumps(measured))
    assert again == measured
    assert again.details.stamps == measured.details.stamps
    # Tables are made again from the blur: equal but for the last digits.
    again_otf, otf = again.across.mtf.otf, measured.across.mtf.otf
    assert again_otf == pytest.approx(otf, rel=1e-12, abs=1e-12)


def test_without_details_it_is_light_and_has_the_same_document(measured):
    light = measured.without_details()
    assert light.details is None
    assert light.to_dict() == measured.to_dict()
    assert light.without_details() == measured
    stored = pickle.dumps(light)
    assert len(stored) < 60_000
    assert pickle.loads(stored).to_dict() == measured.to_dict()


def test_curves_of_the_light_half_are_those_of_the_whole(measured):
    light = pickle.loads(pickle.dumps(measured.without_details()))
    for angle_deg in (0.0, 33.0, 90.0):
        one, other = measured.response_at(angle_deg), light.response_at(angle_deg)
        assert other.mtf.otf == pytest.approx(one.mtf.otf, abs=1e-12)
        assert other.mtf.std == pytest.approx(one.mtf.std, rel=0.05, abs=1e-4)
        for name, number in one.metrics().items():
            assert other.metrics()[name].std == pytest.approx(number.std, rel=0.03, abs=1e-4), name


def test_the_record_is_the_document(measured):
    record = ac.Record.from_dict(measured.to_dict())
    assert record == measured.record
    assert pickle.loads(pickle.dumps(measured.record)) == record
    # Most of it are the slices of the plane and their covariance.
    assert len(pickle.dumps(measured.record)) < 32_000
    assert record.across.mtf_nyquist.value == measured.across.mtf_nyquist.value
    assert record.document["sources"] == [one.to_dict() for one in measured.sources]


def test_details_hold_the_pixels_of_every_source(measured):
    assert len(measured.details.stamps) == len(measured.sources)
    assert len(measured.sources) + len(measured.rejected) == 20
    for source, stamp in zip(measured.sources, measured.details.stamps, strict=True):
        row, col = round(source.row.value), round(source.col.value)
        up, left = row - stamp.origin[0], col - stamp.origin[1]
        assert stamp.pixels[up, left] == measured.details.pixels[row, col]
        assert abs(stamp.residual[up, left]) < 0.2 * source.peak
    fitted = measured.details.fit is not None
    assert fitted == (measured.method == "psf-fit")
    assert (measured.details.published is None) == fitted
    assert (measured.aligned is None) == fitted
