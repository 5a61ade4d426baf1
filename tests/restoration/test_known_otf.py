"""What a document says of a sensor is as uncertain as the measurement it was written from."""

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.restoration.known_otf import known_otf
from acutance.targets.slices import OtfSlices


@pytest.fixture(scope="module")
def mirrors():
    sensor = simulate.reference_systems()["gaussian"]
    image, truth = simulate.points(sensor, snr=80, rng=np.random.default_rng(1))
    return ac.measure_points(image, positions=truth.positions)


@pytest.fixture(scope="module")
def known(mirrors):
    """What is known of their sensor by their record."""
    return known_otf(mirrors.record).otf


@pytest.mark.parametrize("normal_deg", [0.0, 45.0, 90.0])
def test_a_record_states_the_deviations_of_its_measurement(mirrors, known, normal_deg):
    own = mirrors.response_at(normal_deg).mtf_nyquist
    found = known.response(normal_deg).mtf_nyquist
    assert found.value == pytest.approx(own.value, abs=0.02 * own.std)
    assert found.std == pytest.approx(own.std, rel=0.02)


@pytest.mark.parametrize("normal_deg", [22.5, 67.5, 110.0])
def test_between_its_slices_a_record_is_close_to_its_measurement(mirrors, known, normal_deg):
    own = mirrors.response_at(normal_deg).mtf_nyquist
    found = known.response(normal_deg).mtf_nyquist
    assert found.value == pytest.approx(own.value, abs=0.2 * own.std)
    assert found.std == pytest.approx(own.std, rel=0.15)


def test_no_prior_draws_a_record_away_from_what_it_states(mirrors):
    """An error that all directions share, as scenes whose parts differ state it."""
    slices = OtfSlices.of_otf2d(mirrors.otf)
    softer = (slices.otf.real * np.log(slices.otf.real))[:, None]
    stated = OtfSlices(
        slices.normal_deg, slices.freq_cpp, slices.otf,
        np.concatenate([3 * slices.factor, 0.1 * softer], axis=1),
    )  # fmt: skip
    document = {**mirrors.record.to_dict(), "plane": stated.to_dict()}
    found = known_otf(document).otf.response(0.0)
    assert found.mtf_nyquist.value == pytest.approx(mirrors.across.mtf_nyquist.value, abs=1e-4)
    assert found.rer.value == pytest.approx(mirrors.across.rer.value, abs=1e-3)


def test_the_same_blur_in_all_directions_is_that_of_the_direction_measured():
    sensor = simulate.reference_systems()["gaussian"]
    image, _ = simulate.bars(sensor, snr=100, rng=np.random.default_rng(5))
    bars = ac.measure_bars(image)
    for given in (bars, bars.record):
        otf = known_otf(given, isotropic=True).otf
        for normal_deg in (0.0, 30.0, 90.0):
            found = otf.response(normal_deg).mtf_nyquist
            assert found.value == pytest.approx(bars.across.mtf_nyquist.value, abs=1e-3)
            assert found.std == pytest.approx(bars.across.mtf_nyquist.std, rel=0.1)


def test_slices_of_wide_deviations_stay_wide(mirrors):
    record = mirrors.record
    slices = OtfSlices.of_otf2d(mirrors.otf)
    wide = {**record.to_dict(), "plane": OtfSlices(
        slices.normal_deg, slices.freq_cpp, slices.otf, 4 * slices.factor
    ).to_dict()}  # fmt: skip
    found = known_otf(wide).otf.response(0.0).mtf(0.25)
    assert found.std > 3 * mirrors.across.mtf(0.25).std
