"""Two readouts of odd and even columns are named, and do not bias the numbers."""

import numpy as np
import pytest

import acutance as ac

SYSTEMS = ac.simulate.reference_systems()
MEASURES = {
    "edge": (ac.simulate.edge, ac.measure_edge),
    "pulse": (ac.simulate.pulse, ac.measure_pulse),
}


def measured(kind, seed, change=None, snr=100.0):
    """A measurement of an image after a change of its pixels, and the true MTF at Nyquist."""
    draw, measure = MEASURES[kind]
    rng = np.random.default_rng(seed)
    image, truth = draw(
        SYSTEMS[sorted(SYSTEMS)[seed % len(SYSTEMS)]], angle_deg=rng.uniform(4, 20), snr=snr,
        orientation=("across", "along")[seed % 2], shape=(52, 48), dark=200.0, bright=1200.0,
        rng=rng,
    )  # fmt: skip
    found = measure(image if change is None else change(image))
    return found, float(truth.response.mtf_nyquist.value)


def by_parity(image, axis=1, gain=0.0, offset=0.0):
    sign = np.arange(image.shape[axis]) % 2 - 0.5
    sign = sign if axis == 1 else sign[:, None]
    return image * (1 + gain * sign) + offset * sign


def check_of(found):
    return next(check for check in found.checks if check.name == "odd_even")


@pytest.mark.parametrize("kind", MEASURES)
@pytest.mark.parametrize("axis", [0, 1])
def test_gains_and_offsets_are_named_with_their_size(kind, axis):
    for seed in range(4):
        by_offset = check_of(measured(kind, seed, lambda x: by_parity(x, axis, offset=8.0))[0])
        assert by_offset.value == pytest.approx(0.008, rel=0.25)
        named = [by_offset]
        # The bright side of an edge is wide enough to see a gain, a pulse is not.
        if kind == "edge":
            by_gain = check_of(measured(kind, seed, lambda x: by_parity(x, axis, gain=0.01))[0])
            assert by_gain.value == pytest.approx(0.012, rel=0.2)
            named.append(by_gain)
        for one in named:
            assert not one.passed
            assert one.severity == "note"
            assert ("columns" if axis else "rows") in one.message


def test_numbers_of_such_images_are_right():
    errors = []
    for seed in range(16):
        found, true = measured("edge", seed, lambda x: by_parity(x, gain=0.02))
        assert found.verdict.word != "good"
        errors.append((found.mtf_nyquist.value - true) / found.mtf_nyquist.std)
    assert 0.2 < np.sqrt(np.mean(np.square(errors))) < 1.3


def furrow(image):
    """One dark line along the columns, of ground."""
    return image - 30.0 * (np.arange(image.shape[1]) == 6)


def ramp(image):
    return image + 1.5 * np.arange(image.shape[1])


@pytest.mark.parametrize("change", [None, furrow, ramp])
@pytest.mark.parametrize("kind", MEASURES)
def test_noise_furrows_and_slopes_are_none(kind, change):
    for seed in range(12):
        found, _ = measured(kind, seed, change, snr=30.0 * 3 ** (seed % 3))
        assert check_of(found).passed
