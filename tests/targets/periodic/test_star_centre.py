"""Stars whose middle is blank, and stars on a high level."""

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import reference_systems, star

STATED = {"dark": 200.0, "bright": 1200.0}


def _seen(name, *, finest_cpp=1.5, snr=100.0, wave="sine", cycles=36, options=None):
    sensor = reference_systems()[name]
    image, _ = star(
        sensor, snr=snr, wave=wave, cycles=cycles, finest_cpp=finest_cpp,
        rng=np.random.default_rng(5),
    )  # fmt: skip
    found = ac.measure_star(
        image, cycles=cycles, options=ac.StarOptions(wave=wave, **(options or STATED))
    )
    return found, sensor


def _largest_error(found, sensor):
    """In standard deviations, of the numbers of both directions."""
    deviations = []
    for orientation, measured in found.directions.items():
        true = sensor.response(0.0, orientation)
        for pair in (
            (measured.mtf_nyquist, true.mtf_nyquist),
            (measured.mtf(0.25), true.mtf(0.25)),
            (measured.rer, true.rer),
            (measured.fwhm_px, true.fwhm_px),
        ):
            deviations.append(abs(pair[0].value - pair[1].value) / pair[0].std)
    return max(deviations)


@pytest.mark.parametrize(
    ("name", "finest_cpp", "wave"),
    [
        ("gaussian", 0.35, "sine"),
        ("sharpened", 0.5, "sine"),
        ("sharpened", 0.35, "square"),
        ("smeared", 0.5, "square"),
    ],
)
def test_a_blank_middle_is_not_taken_for_blur(name, finest_cpp, wave):
    found, sensor = _seen(name, finest_cpp=finest_cpp, wave=wave)
    assert _largest_error(found, sensor) < 3.5
    assert found.reach_cpp[1] < finest_cpp
    assert [check.name for check in found.checks if not check.passed] == ["centre_cpp"]


@pytest.mark.parametrize("name", ["wide", "diffraction", "sharpened", "defocused"])
def test_spokes_that_a_sensor_does_not_resolve_are_no_blank_middle(name):
    found, _ = _seen(name)
    assert found.reach_cpp[1] == pytest.approx(1.3)


def test_a_stated_radius_inside_the_blank_middle_does_no_harm():
    found, sensor = _seen("gaussian", finest_cpp=0.35, options={**STATED, "inner_px": 8.0})
    assert _largest_error(found, sensor) < 3.5
    further, _ = _seen("gaussian", finest_cpp=0.35, options={**STATED, "inner_px": 24.0})
    assert further.reach_cpp[1] == pytest.approx(36 / (2 * np.pi * 24.0), rel=1e-3)


def test_a_level_of_a_million_contrasts_changes_nothing():
    sensor = reference_systems()["gaussian"]
    image, _ = star(sensor, dark=0.0, bright=1.0, snr=100, rng=np.random.default_rng(5))
    plain, high = ac.measure_star(image), ac.measure_star(image + 1e6)
    for name, one in plain.directions.items():
        other = high.directions[name]
        assert other.mtf_nyquist.value == pytest.approx(one.mtf_nyquist.value, abs=1e-4)
        assert other.mtf_nyquist.std == pytest.approx(one.mtf_nyquist.std, rel=1e-2)
