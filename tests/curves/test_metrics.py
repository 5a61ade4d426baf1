"""Metrics of a Gaussian line spread function, where every number has a closed form."""

import math

import numpy as np
import pytest
from scipy.special import erf, ndtr, ndtri

from acutance.curves import MAIN_NUMBERS, Esf, Lsf, Mtf, Response, metrics

SIGMA = 0.6
DISTANCE = np.arange(-200, 201) * 0.05
FREQ = np.arange(101) * 0.01


def gaussian_response(sigma: float = SIGMA, factor_std: float = 0.0) -> Response:
    """A Gaussian system; its one latent variable is the error of sigma."""
    x = DISTANCE
    esf = ndtr(x / sigma)
    lsf = np.exp(-0.5 * (x / sigma) ** 2) / sigma / math.sqrt(2 * math.pi)
    otf = np.exp(-2 * (math.pi * sigma * FREQ) ** 2) + 0j
    by_sigma = (
        -x / sigma * lsf,
        lsf * (x**2 / sigma**3 - 1 / sigma),
        -4 * math.pi**2 * FREQ**2 * sigma * otf,
    )
    latent = np.array([[factor_std]])
    return Response(
        Esf(x, esf, by_sigma[0][:, None], latent),
        Lsf(x, lsf, by_sigma[1][:, None], latent),
        Mtf(FREQ, otf, by_sigma[2][:, None], latent),
        gsd_m=0.7,
    )


def test_values_match_the_closed_forms() -> None:
    r = gaussian_response()
    assert r.rer.value == pytest.approx(erf(0.5 / SIGMA / math.sqrt(2)), abs=1e-6)
    assert r.fwhm_px.value == pytest.approx(2.3548200 * SIGMA, abs=1e-4)
    assert r.fwhm_m is not None
    assert r.fwhm_m.value == pytest.approx(0.7 * 2.3548200 * SIGMA, abs=1e-4)
    assert r.mtf_nyquist.value == pytest.approx(math.exp(-0.5 * (math.pi * SIGMA) ** 2), abs=1e-9)
    assert r.mtf(0.123).value == pytest.approx(
        math.exp(-2 * (math.pi * SIGMA * 0.123) ** 2), abs=1e-6
    )
    f50 = math.sqrt(math.log(2) / 2) / math.pi / SIGMA
    assert r.mtf50_cpp.value == pytest.approx(f50, abs=1e-5)
    f30 = math.sqrt(-math.log(0.3) / 2) / math.pi / SIGMA
    assert r.mtf30_cpp.value == pytest.approx(f30, abs=1e-5)
    area = erf(0.5 * math.sqrt(2) * math.pi * SIGMA) / (2 * math.sqrt(2 * math.pi) * SIGMA)
    assert r.mtf_area.value == pytest.approx(area, abs=1e-4)
    assert r.half_extent_bright_px.value == pytest.approx(SIGMA * ndtri(0.95), abs=1e-4)
    assert r.half_extent_dark_px.value == pytest.approx(SIGMA * ndtri(0.95), abs=1e-4)
    assert r.edge_slope_per_px.value == pytest.approx(0.1 / (SIGMA * ndtri(0.6)), abs=1e-4)
    assert r.overshoot.value == 0
    assert r.undershoot.value == 0
    assert r.giqe_h.value == pytest.approx(ndtr(1.25 / SIGMA), abs=1e-5)
    assert metrics.full_width(r.lsf, 0.25).value == pytest.approx(
        2 * SIGMA * math.sqrt(2 * math.log(4)), abs=1e-4
    )


@pytest.mark.parametrize(
    "name",
    [
        "mtf_nyquist",
        "rer",
        "fwhm_px",
        "fwhm_m",
        "mtf50_cpp",
        "mtf30_cpp",
        "mtf_area",
        "edge_slope_per_px",
        "half_extent_dark_px",
        "half_extent_bright_px",
        "giqe_h",
    ],
)
def test_standard_deviation_is_the_derivative_times_the_latent_one(name: str) -> None:
    std, step = 0.01, 1e-3
    stated = getattr(gaussian_response(factor_std=std), name).std
    high = getattr(gaussian_response(SIGMA + step), name).value
    low = getattr(gaussian_response(SIGMA - step), name).value
    assert stated == pytest.approx(abs(high - low) / (2 * step) * std, rel=0.02)


def test_rer_at_the_peak_of_an_asymmetric_lsf_differs() -> None:
    # LSF: one-sided exponential after a Gaussian; its peak lies before the 50 % point.
    x, s, tau = DISTANCE, 0.4, 0.6
    z = s / tau - x / s
    lsf = np.exp(0.5 * (s / tau) ** 2 - x / tau) * ndtr(-z) / tau
    esf = np.cumsum(lsf) * 0.05
    esf = esf / esf[-1]
    none = np.zeros((x.size, 0))
    half = metrics.rer(Esf(x, esf, none), Lsf(x, lsf, none), "half")
    peak = metrics.rer(Esf(x, esf, none), Lsf(x, lsf, none), "peak")
    top = x[np.argmax(lsf)]
    expected = np.interp(top + 0.5, x, esf) - np.interp(top - 0.5, x, esf)
    assert peak.value == pytest.approx(expected, abs=2e-3)
    assert abs(peak.value - half.value) > 0.003


TRAIL_PX = 0.9


def trailing_edge(factor: np.ndarray) -> tuple[Esf, Lsf]:
    """An LSF that rises at once and decays as exp(-x / L), whose ESF passes 50 % at 0."""
    begun = -TRAIL_PX * math.log(2) < DISTANCE
    decay = np.where(begun, 0.5 * np.exp(-DISTANCE / TRAIL_PX), 0.0)
    return (
        Esf(DISTANCE, np.where(begun, 1 - decay, 0.0), factor),
        Lsf(DISTANCE, decay / TRAIL_PX, np.zeros_like(factor)),
    )


def test_rer_has_the_uncertainty_of_its_own_half_point() -> None:
    # Independent errors of the ESF at -0.5, 0 and 0.5 px. That at 0 moves the half point by
    # error / lsf(0), and with it RER by (lsf(0.5) - lsf(-0.5)) times as much.
    std = 0.01
    at = [int(np.argmin(np.abs(DISTANCE - place))) for place in (-0.5, 0.0, 0.5)]
    factor = np.zeros((DISTANCE.size, 3))
    factor[at, range(3)] = std
    ratio = math.exp(-0.5 / TRAIL_PX) - math.exp(0.5 / TRAIL_PX)
    expected = std * math.sqrt(2 + ratio**2)
    assert expected > 1.25 * std * math.sqrt(2)
    assert metrics.rer(*trailing_edge(factor)).estimate().std == pytest.approx(expected, rel=1e-3)


def test_an_error_of_the_edges_place_is_none_of_rer() -> None:
    lsf = trailing_edge(np.zeros((DISTANCE.size, 0)))[1].value
    moved = 0.01 * lsf[:, None]
    tilt = abs(math.exp(-0.5 / TRAIL_PX) - math.exp(0.5 / TRAIL_PX)) / (2 * TRAIL_PX)
    assert metrics.rer(*trailing_edge(moved)).estimate().std < 1e-3 * 0.01 * tilt


def test_metrics_that_cannot_be_negative_say_so() -> None:
    numbers = gaussian_response().metrics()
    assert numbers["fwhm_m"].lowest == 0
    bounded = {name for name, number in numbers.items() if number.lowest == 0}
    assert set(numbers) - bounded == {"rer", "giqe_h"}


def test_a_level_that_is_never_reached_is_undefined() -> None:
    flat = Mtf(FREQ, np.full(FREQ.size, 0.8 + 0j), np.zeros((FREQ.size, 0), complex))
    assert math.isnan(metrics.mtf_crossing(flat, 0.5).value)


def test_overshoot_and_giqe_h_of_a_sharpened_edge() -> None:
    x = DISTANCE
    bump = 0.1 * np.exp(-0.5 * ((x - 1.5) / 0.4) ** 2) - 0.1 * np.exp(-0.5 * ((x + 1.5) / 0.4) ** 2)
    esf = Esf(x, ndtr(x / 0.4) + bump, np.zeros((x.size, 0)))
    assert metrics.overshoot(esf).value == pytest.approx(0.1, abs=1e-3)
    assert metrics.undershoot(esf).value == pytest.approx(0.1, abs=1e-3)
    assert metrics.giqe_h(esf).value == pytest.approx(1.1, abs=1e-3)


def test_giqe_h_takes_no_rounding_of_a_plateau_for_a_fall() -> None:
    # Beyond 2 px nothing is uncertain, and numbers differ in their last digits alone.
    rise = np.minimum(ndtr(DISTANCE / 0.8), 0.98)
    rise -= np.where(np.arange(DISTANCE.size) % 7 == 0, 2e-16, 0.0)
    esf = Esf(DISTANCE, rise, np.zeros((DISTANCE.size, 1)))
    assert metrics.giqe_h(esf).value == pytest.approx(ndtr(1.25 / 0.8), abs=1e-3)


def test_a_thinned_curve_is_the_same_curve_at_every_other_place() -> None:
    esf = gaussian_response(factor_std=0.01).esf
    assert np.array_equal(esf.thinned.distance_px, esf.distance_px[::2])
    assert np.array_equal(esf.thinned.value, esf.value[::2])
    assert np.array_equal(esf.thinned.std, esf.std[::2])


def test_rows_give_the_deviations_of_the_main_numbers() -> None:
    r = gaussian_response(factor_std=0.01)
    stds = [getattr(r, name).std for name in MAIN_NUMBERS]
    assert np.abs(r.main_rows[:, 0]) * 0.01 == pytest.approx(stds)


def test_noise_in_quadrature_does_not_raise_the_mtf() -> None:
    # |O| of a complex number with noise in both parts is Rician: its mean is M + var / (2 M).
    true, std = 0.05, 0.02
    draws = np.random.default_rng(3).normal(scale=std, size=(20000, 2))
    otf = true + draws[:, 0] + 1j * draws[:, 1]
    factor = np.broadcast_to(std * np.array([1.0, 1j]), (otf.size, 2))
    curve = Mtf(np.arange(otf.size) * 1.0, otf, factor)
    assert np.mean(np.abs(otf)) > true + 0.003
    assert abs(np.mean(curve.value) - true) < 0.0015


def test_only_errors_in_phase_with_the_otf_are_errors_of_the_mtf() -> None:
    otf = np.exp(-3 * FREQ**2 + 2j * FREQ)
    along = 0.01 * otf / np.abs(otf)
    curve = Mtf(FREQ, otf, np.column_stack([along, 3j * along]))
    np.testing.assert_allclose(curve.std, 0.01)
    np.testing.assert_allclose(curve.value**2, np.maximum(np.abs(otf) ** 2 - 0.03**2, 0))
    assert curve(0.333).std == pytest.approx(0.01, rel=1e-4)


def test_curves_refuse_shapes_that_do_not_fit() -> None:
    with pytest.raises(ValueError, match="factor"):
        Esf(DISTANCE, DISTANCE[:-1], np.zeros((DISTANCE.size, 0)))
    with pytest.raises(ValueError, match="factor"):
        Mtf(FREQ, FREQ + 0j, np.zeros((3, 2), complex))


def test_outside_the_curve_is_an_error_that_says_its_range() -> None:
    with pytest.raises(ValueError, match="runs from 0 to 1"):
        gaussian_response().mtf(1.5)
    with pytest.raises(ValueError, match="runs from -10 to 10"):
        gaussian_response().esf(11.0)
