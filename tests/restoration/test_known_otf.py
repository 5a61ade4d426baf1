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


@pytest.mark.parametrize("normal_deg", [0.0, 45.0, 90.0])
def test_a_record_states_the_deviations_of_its_measurement(mirrors, normal_deg):
    own = mirrors.response_at(normal_deg).mtf_nyquist
    found = known_otf(mirrors.record).otf.response(normal_deg).mtf_nyquist
    assert found.value == pytest.approx(own.value, abs=0.5 * own.std)
    assert found.std == pytest.approx(own.std, rel=0.2)


def test_slices_of_wide_deviations_stay_wide(mirrors):
    record = mirrors.record
    slices = OtfSlices.of_otf2d(mirrors.otf)
    wide = {**record.to_dict(), "plane": OtfSlices(
        slices.normal_deg, slices.freq_cpp, slices.otf, 4 * slices.factor
    ).to_dict()}  # fmt: skip
    found = known_otf(wide).otf.response(0.0).mtf(0.25)
    assert found.std > 3 * mirrors.across.mtf(0.25).std
