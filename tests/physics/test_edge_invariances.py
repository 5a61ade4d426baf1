"""What must not change the MTF of an edge: place, gain, offset, mirror, transposition."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import acutance as ac
from acutance import simulate

ASYMMETRIC = simulate.reference_systems()["asymmetric"]
SHARPENED = simulate.reference_systems()["sharpened"]


@cache
def measured_edge():
    """A noisy edge of an asymmetric system and its measurement."""
    image, _ = simulate.edge(
        ASYMMETRIC, angle_deg=7.3, shape=(50, 44), snr=80, rng=np.random.default_rng(1)
    )
    return image, ac.measure_edge(image)


def assert_same(one, other, tolerance=0.02):
    """Same curve and same error bars, to a small part of a standard deviation."""
    allowed = tolerance * np.maximum(one.mtf.std, other.mtf.std) + 1e-9
    assert np.all(np.abs(one.mtf.value - other.mtf.value) <= allowed)
    assert np.all(np.abs(one.mtf.std - other.mtf.std) <= allowed)
    assert abs(one.rer.value - other.rer.value) <= tolerance * one.rer.std
    assert abs(one.fwhm_px.value - other.fwhm_px.value) <= tolerance * one.fwhm_px.std


@settings(max_examples=15, deadline=None, derandomize=True)
@given(exponent=st.floats(-3, 3), offset=st.floats(-1e4, 1e4))
def test_gain_and_offset_change_nothing(exponent, offset):
    image, found = measured_edge()
    gain = 10.0**exponent
    assert_same(found, ac.measure_edge(gain * (image + offset)), tolerance=0.1)


@pytest.mark.parametrize(
    "turn",
    [
        pytest.param(lambda image: -image, id="negative"),
        pytest.param(lambda image: image[::-1], id="rows mirrored"),
        pytest.param(lambda image: image[:, ::-1], id="columns mirrored"),
        pytest.param(lambda image: image.T, id="transposed"),
        pytest.param(np.rot90, id="turned by 90 degrees"),
    ],
)
def test_mirrors_and_transposition_change_nothing(turn):
    image, found = measured_edge()
    other = ac.measure_edge(np.ascontiguousarray(turn(image)))
    assert_same(found, other)
    assert other.line.angle_deg == pytest.approx(found.line.angle_deg, abs=1e-3)


def test_phase_turns_round_with_the_polarity():
    image, found = measured_edge()
    negative = ac.measure_edge(-image)
    close = 0.02 * found.mtf.std + 1e-9
    assert np.all(np.abs(negative.mtf.otf - np.conj(found.mtf.otf)) <= 2 * close)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(row=st.integers(0, 40), col=st.integers(0, 40))
def test_place_in_a_larger_image_changes_nothing(row, col):
    image, found = measured_edge()
    scene = np.full((100, 100), np.nan)
    scene[row : row + 50, col : col + 44] = image
    other = ac.measure_edge(scene, (row, col, 50, 44))
    assert_same(found, other)
    assert other.line.row - row == pytest.approx(found.line.row, abs=1e-6)
    assert other.line.col - col == pytest.approx(found.line.col, abs=1e-6)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(
    angle_deg=st.floats(-43, 43).filter(lambda angle: abs(angle) > 2),
    offset_px=st.floats(-3, 3),
    orientation=st.sampled_from(["across", "along"]),
    polarity=st.sampled_from(["rising", "falling"]),
)
def test_a_shift_of_the_edge_changes_nothing(angle_deg, offset_px, orientation, polarity):
    image, truth = simulate.edge(
        SHARPENED, angle_deg=angle_deg, orientation=orientation, polarity=polarity,
        shape=(60, 60), offset_px=offset_px,
    )  # fmt: skip
    found = ac.measure_edge(image)
    half = truth.mtf.freq_cpp <= 0.5
    value = np.interp(truth.mtf.freq_cpp[half], found.mtf.freq_cpp, found.mtf.value)
    assert np.max(np.abs(value - truth.mtf.value[half])) <= 0.002
    # Its place is found as well, whatever the direction.
    place = truth.line.normal_distance(found.line.row, found.line.col)
    assert abs(place) < 0.005
