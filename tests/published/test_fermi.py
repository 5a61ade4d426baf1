"""The parametric edge: closed forms against numbers, exactness, intervals that hold."""

import math
from dataclasses import replace

import numpy as np
import pytest
from closed_form_edge import edge_band, gaussian_pixel_mtf

from acutance import simulate
from acutance.errors import OptionError
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.published import FermiOptions, fermi
from acutance.targets.straight.published.fermi_sum import FermiSum

SINGLE = FermiSum(np.array([1.0]), np.array([0.0]), np.array([0.25]))
OVERSHOOT = FermiSum(np.array([1.2, -0.2]), np.array([0.0, 1.2]), np.array([0.25, 0.35]))


def esf_of(terms):
    return lambda s: terms.value(s.ravel()).reshape(s.shape)


@pytest.mark.parametrize("terms", [SINGLE, OVERSHOOT])
@pytest.mark.parametrize("what", ["value", "slope", "transfer"])
def test_gradients_match_finite_differences(terms, what):
    x = np.linspace(-2, 2, 9) if what != "transfer" else np.array([0.0, 0.1, 0.5, 1.0])
    gradient = getattr(terms, f"{what}_gradient")(x)
    vector = terms.to_vector()
    for i in range(vector.size):
        step = np.zeros_like(vector)
        step[i] = 1e-6
        above = getattr(FermiSum.from_vector(vector + step), what)(x)
        below = getattr(FermiSum.from_vector(vector - step), what)(x)
        np.testing.assert_allclose(gradient[:, i], (above - below) / 2e-6, atol=1e-8)


@pytest.mark.parametrize(("what", "derivative"), [("value", "slope"), ("slope", "bend")])
def test_derivatives_match_finite_differences(what, derivative):
    x = np.linspace(-1, 2, 13)
    numeric = (getattr(OVERSHOOT, what)(x + 1e-6) - getattr(OVERSHOOT, what)(x - 1e-6)) / 2e-6
    np.testing.assert_allclose(getattr(OVERSHOOT, derivative)(x), numeric, atol=1e-7)


def test_transfer_is_the_fourier_transform_of_the_slope():
    x = np.arange(-20, 20, 0.01)
    freq = np.array([0.0, 0.2, 0.5, 0.9])
    numeric = np.exp(-2j * np.pi * np.outer(freq, x)) @ OVERSHOOT.slope(x) * 0.01
    np.testing.assert_allclose(OVERSHOOT.transfer(freq), numeric, atol=1e-10)


@pytest.mark.parametrize("terms", [SINGLE, OVERSHOOT])
def test_a_fermi_edge_is_measured_exactly(terms):
    fit = fermi(edge_band(esf_of(terms)))
    freq = fit.response.mtf.freq_cpp
    truth = terms.transfer(freq) * np.exp(2j * np.pi * freq * terms.centroid_px)
    np.testing.assert_allclose(fit.response.mtf.otf, truth, atol=1e-6)
    assert fit.line.angle_deg == pytest.approx(6.0, abs=1e-6)
    assert fit.dark == pytest.approx(200.0, abs=1e-4)
    assert np.abs(fit.residual).max() < 1e-4


def test_a_wrong_start_line_is_put_right():
    trimmed = edge_band(esf_of(SINGLE), angle_deg=7.0)
    start = trimmed.line.moved(0.3, 0.8)
    moved = EdgePixels(trimmed.image, start, trimmed.dark, trimmed.bright, 0.9, 0.0)
    fit = fermi(moved)
    assert fit.line.angle_deg == pytest.approx(7.0, abs=1e-6)
    assert abs(float(trimmed.line.normal_distance(fit.line.row, fit.line.col))) < 1e-6


def test_offset_deviation_is_that_of_the_middle_of_the_edge():
    trimmed = edge_band(esf_of(SINGLE), snr=50, rng=np.random.default_rng(5))
    x, y = trimmed.line.normal
    end = replace(trimmed.line, row=trimmed.line.row + 25 * x, col=trimmed.line.col - 25 * y)
    from_end = fermi(EdgePixels(trimmed.image, end, 200.0, 1200.0, 0.5, 20.0)).line
    from_middle = fermi(trimmed).line
    assert from_end.offset_std_px == pytest.approx(from_middle.offset_std_px, rel=1e-3)
    assert from_end.row == pytest.approx(from_middle.row, abs=1e-4)


def _standardised(terms, options, draws, snr):
    truth = abs(terms.transfer(np.array([0.5]))[0])
    rng = np.random.default_rng(11)
    clean = edge_band(esf_of(terms), angle_deg=7.0, shape=(30, 24))
    errors = {"mtf": [], "angle": []}
    for _ in range(draws):
        image = clean.image + rng.normal(0, 1000 / snr, clean.image.shape)
        line = clean.line.moved(rng.normal(0, 0.05), rng.normal(0, 0.2))
        fit = fermi(EdgePixels(image, line, 200.0, 1200.0, 0.5, 1000 / snr), options)
        nyquist = fit.response.mtf_nyquist
        errors["mtf"].append((nyquist.value - truth) / nyquist.std)
        errors["angle"].append((fit.line.angle_deg - 7.0) / fit.line.angle_std_deg)
    return {name: np.array(values) for name, values in errors.items()}


@pytest.mark.parametrize(("terms", "count", "draws"), [(SINGLE, 1, 400), (OVERSHOOT, 2, 200)])
def test_intervals_hold_and_the_estimate_is_unbiased(terms, count, draws):
    found = _standardised(terms, FermiOptions(max_terms=count), draws, snr=60)
    for errors in found.values():
        # Mean within 3.3 and scatter within 3.5 of their own standard deviations.
        assert abs(errors.mean()) < 3.3 / math.sqrt(draws)
        assert abs(errors.std() - 1) < 3.5 / math.sqrt(2 * draws)
        coverage = np.mean(np.abs(errors) < 1.96)
        assert abs(coverage - 0.95) < 3.3 * math.sqrt(0.95 * 0.05 / draws)


def test_criterion_chooses_the_number_of_terms():
    rng = np.random.default_rng(2)
    single = fermi(edge_band(esf_of(SINGLE), snr=50, rng=rng))
    double = fermi(edge_band(esf_of(OVERSHOOT), snr=50, rng=rng))
    assert single.response.mtf.factor.shape[1] == 2 + 3
    assert double.response.mtf.factor.shape[1] == 2 + 6
    assert double.response.overshoot.value == pytest.approx(
        OVERSHOOT.value(np.linspace(0, 5, 501)).max() - 1, abs=0.02
    )


def test_another_shape_leaves_a_bias_of_some_thousandths():
    response = fermi(edge_band()).response
    assert response.mtf_nyquist.value / gaussian_pixel_mtf(0.5) == pytest.approx(1, abs=0.01)
    one = fermi(edge_band(), FermiOptions(max_terms=1)).response
    assert one.mtf_nyquist.value / gaussian_pixel_mtf(0.5) > 1.02


@pytest.mark.parametrize("snr", [None, 100])
def test_two_shoots_are_found_though_one_alone_does_not_help(snr):
    sensor = simulate.reference_systems()["sharpened"]
    rng = np.random.default_rng(7)
    image, truth = simulate.edge(sensor, angle_deg=7.0, shape=(60, 40), snr=snr, rng=rng)
    response = fermi(EdgePixels(image, truth.line, truth.dark, truth.bright, 0.5, 0.0)).response
    assert response.mtf.factor.shape[1] == 2 + 9
    assert response.overshoot.value == pytest.approx(0.09, abs=0.01)
    assert response.mtf(0.25).value == pytest.approx(truth.mtf(0.25).value, abs=0.01)


@pytest.mark.parametrize("wrong", [{"max_terms": 4}, {"criterion": "aic"}])
def test_meaningless_options_are_refused(wrong):
    with pytest.raises(OptionError, match="found"):
        FermiOptions(**wrong)
