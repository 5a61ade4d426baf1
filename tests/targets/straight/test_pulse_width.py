"""Widths of pulses: closed forms against printed numbers, the two ways to find a wrong one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from acutance import simulate
from acutance.errors import OptionError
from acutance.optics.preset import preset
from acutance.targets.straight.fit_pulse import PulsePixels, fit_pulse
from acutance.targets.straight.published import SdsuPulseOptions, sdsu_2005_pulse
from acutance.targets.straight.pulse_spectrum import (
    width_error_gain,
    width_sensitivity_per_px,
    zeros_cpp,
)
from acutance.targets.straight.pulse_width import smoothest_width

SYSTEMS = simulate.reference_systems()
QUIET = SdsuPulseOptions(replicates=0)


def band_of(system, *, width_px=3.0, stated_px=3.0, shape=(95, 60), snr=None, rng=None, **scene):
    image, truth = simulate.pulse(
        system, width_px=width_px, shape=shape, snr=snr, rng=rng, **{"angle_deg": 6.0, **scene}
    )
    line = truth.line.moved(-0.5 * width_px, 0.0)
    return PulsePixels(
        image, line, truth.left, truth.level, 0.6, 0.0, pulse_width_px=stated_px
    )  # fmt: skip


def test_zeros_are_multiples_of_the_reciprocal_width():
    np.testing.assert_allclose(zeros_cpp(3.0), [1 / 3, 2 / 3, 1.0])
    np.testing.assert_allclose(zeros_cpp(8.83 / 2.4, 0.6), [0.27180, 0.54360], atol=1e-5)
    assert zeros_cpp(0.9).size == 0
    with pytest.raises(OptionError, match="above 0"):
        zeros_cpp(0.0)


@pytest.mark.parametrize(
    ("used", "gains"), [(2.8, (0.599, 1.49, 0.98)), (3.2, (2.63, 0.81, 1.12)), (3.0, (1, 1, 1))]
)
def test_wrong_width_changes_the_mtf_by_the_ratio_of_spectra(used, gains):
    found = width_error_gain(3.0, used, [0.3, 0.4, 0.5])
    np.testing.assert_allclose(found, gains, rtol=6e-3)


def test_gain_at_zeros_is_zero_infinite_or_one():
    assert width_error_gain(2.5, 2.7, 0.4) == 0
    assert width_error_gain(2.7, 2.5, 0.4) == math.inf
    assert width_error_gain(2.5, 2.5, 0.4) == 1
    assert width_error_gain(3.0, 2.0, 0.0) == 1


def test_sensitivity_is_the_derivative_of_the_gain():
    freq = np.array([0.3, 0.4, 0.5])
    found = width_sensitivity_per_px(3.0, freq)
    np.testing.assert_allclose(found, [-3.23, 1.40, -0.33], atol=5e-3)
    step = 1e-5
    numeric = (width_error_gain(3 + step, 3.0, freq) - width_error_gain(3 - step, 3.0, freq)) / (
        2 * step
    )
    np.testing.assert_allclose(found, numeric, rtol=1e-6)


def test_ratio_method_errs_by_the_closed_form():
    trimmed = band_of(SYSTEMS["gaussian"])
    right = sdsu_2005_pulse(trimmed, QUIET).response.mtf
    for used in (2.8, 3.2):
        wrong = sdsu_2005_pulse(replace(trimmed, pulse_width_px=used), QUIET).response.mtf
        for freq in (0.3, 0.4, 0.5):
            expected = width_error_gain(3.0, used, freq)
            assert wrong(freq).value / right(freq).value == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("name", sorted(SYSTEMS))
@pytest.mark.parametrize("true_px", [2.75, 3.0, 3.25])
def test_smoothest_width_is_the_true_one(name, true_px):
    found = smoothest_width(sdsu_2005_pulse(band_of(SYSTEMS[name], width_px=true_px), QUIET))
    assert found.chosen_px == pytest.approx(true_px, abs=0.02)
    assert found.roughness.min() < 1e-3


def test_smoothest_width_under_noise():
    # Worse than the joint fit's .009 px at the same SNR, but no bias.
    rng = np.random.default_rng(5)
    found = [
        smoothest_width(
            sdsu_2005_pulse(
                band_of(SYSTEMS["gaussian"], stated_px=2.9, shape=(40, 40), snr=70, rng=rng), QUIET
            )
        ).chosen_px
        for _ in range(60)
    ]
    assert np.mean(found) == pytest.approx(3.0, abs=3.3 * np.std(found) / math.sqrt(60) + 0.003)
    assert 0.005 < np.std(found) < 0.03


def test_deformation_has_the_signs_of_the_report():
    trimmed = band_of(SYSTEMS["gaussian"])
    for used, signs, word in ((3.2, (1, -1), "too large"), (2.8, (-1, 1), "too small")):
        found = smoothest_width(sdsu_2005_pulse(replace(trimmed, pulse_width_px=used), QUIET))
        assert tuple(np.sign(found.deformation)) == signs
        for at, freq in zip(found.deformation, (0.3, 0.4), strict=True):
            # 6 degrees make the width along the row 3 / cos.
            row_px = 3.0 / math.cos(math.radians(6.0))
            assert 1 + at == pytest.approx(float(width_error_gain(row_px, used, freq)), rel=0.02)
        assert word in found.verdict
        assert found.correction_gain == pytest.approx(
            float(width_error_gain(used, 3.0 / math.cos(math.radians(6.0)), 0.5)), rel=3e-3
        )
    right = smoothest_width(
        sdsu_2005_pulse(trimmed, SdsuPulseOptions(replicates=0, distance="normal"))
    )
    assert "no deformation" in right.verdict
    assert right.to_dict()["chosen_px"] == right.chosen_px


def test_widths_to_try_are_the_callers():
    fit = sdsu_2005_pulse(band_of(SYSTEMS["gaussian"]), QUIET)
    tried = np.arange(2.75, 3.26, 0.05)
    found = smoothest_width(fit, tried)
    np.testing.assert_array_equal(found.width_px, tried)
    assert found.chosen_px == pytest.approx(3.0, abs=0.02)
    with pytest.raises(OptionError, match="at least three"):
        smoothest_width(fit, [3.0, 3.1])


def test_width_of_the_generic_sensor_is_found_where_nyquist_is_unusable():
    trimmed = band_of(preset("generic-2005"), width_px=3.68, stated_px=3.6)
    found = smoothest_width(sdsu_2005_pulse(trimmed, QUIET))
    assert found.chosen_px == pytest.approx(3.68, abs=0.01)
    assert fit_pulse(trimmed).pulse_width.value == pytest.approx(3.68, abs=0.01)
