"""The start of the fit: parameters recovered without noise, refusal where there is no edge."""

import numpy as np
import pytest

from acutance.errors import NoEdgeError
from acutance.geometry.line import Line
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.targets.straight.first_fit import fit_first
from acutance.targets.straight.first_fit_model import bounded_solution, compared, gauss_newton

ROWS, COLS = (places.ravel().astype(float) for places in np.indices((40, 40)))
LINE = Line(19.5, 19.5, 6.0)


def fit(value, line, **options):
    levels = {"dark": 200.0, "bright": 1200.0} | options
    return fit_first(ROWS, COLS, value, line, **levels)


def edge(blur, line=LINE, dark=200.0, height=1000.0):
    return dark + height * blur.esf(line.normal_distance(ROWS, COLS))


@pytest.mark.parametrize(
    "blur", [GaussianPixel(0.4), GaussianPixel(0.8), GaussianPixel(1.5), GaussianPixel(0.5, 1.1)]
)
def test_parameters_are_recovered(blur):
    found = fit(edge(blur), LINE.moved(0.3, -0.6), dark=150.0, bright=1100.0, noise=1.0)
    distance = found.line.normal_distance(np.array([5.0, 35.0]), np.array([10.0, 30.0]))
    true = LINE.normal_distance(np.array([5.0, 35.0]), np.array([10.0, 30.0]))
    assert np.max(np.abs(distance - true)) < 2e-3
    assert found.line.normal_deg == pytest.approx(LINE.normal_deg, abs=2e-3)
    assert found.blur.width_px == pytest.approx(blur.width_px, rel=5e-3)
    assert found.dark == pytest.approx(200.0, abs=1.0)
    assert found.height == pytest.approx(1000.0, abs=2.0)
    assert found.noise < 1.0


def test_noise_is_that_of_the_pixels():
    rng = np.random.default_rng(13)
    found = fit(edge(GaussianPixel(0.5)) + 10 * rng.standard_normal(ROWS.size), LINE, noise=25.0)
    assert found.noise == pytest.approx(10.0, rel=0.1)


def test_a_blur_far_wider_than_the_start_is_reached():
    found = fit(edge(GaussianPixel(4.0)), LINE, sigma_px=0.5, noise=5.0)
    assert found.blur.width_px == pytest.approx(GaussianPixel(4.0).width_px, rel=0.02)


def test_an_edge_sharper_than_a_pixel_ends_at_the_smallest_blur():
    found = fit(edge(GaussianPixel(0.05, 0.2)), LINE, noise=1.0)
    assert found.blur.sigma_px == pytest.approx(0.35)


def test_flat_ground_holds_no_edge():
    with pytest.raises(NoEdgeError, match="no straight target"):
        fit(np.full(ROWS.size, 700.0), LINE, dark=700.0, bright=700.0)


def test_pure_noise_holds_no_edge():
    rng = np.random.default_rng(14)
    refused = 0
    for _ in range(10):
        with pytest.raises(NoEdgeError):
            fit(700 + 10 * rng.standard_normal(ROWS.size), LINE, dark=695.0, bright=705.0, noise=10)
        refused += 1
    assert refused == 10


def test_an_edge_the_wrong_way_round_is_refused():
    with pytest.raises(NoEdgeError):
        fit(1400 - edge(GaussianPixel(0.5)), LINE)


@pytest.mark.parametrize("steps", [[], [3.2, 0.9]])
def test_jacobian_is_the_derivative_of_the_model(steps):
    rng = np.random.default_rng(15)
    s, t = rng.uniform(-5, 5, 200), rng.uniform(-20, 20, 200)
    value = rng.standard_normal(200)
    p = np.array([3.0, 40.0, 0.1, 0.01, 0.6, 1.2, 0.15, *steps])
    _, jacobian = compared(s, t, value, p)
    for k, step in enumerate(1e-6 * np.eye(p.size)):
        high, low = (compared(s, t, value, p + sign * step)[0] for sign in (1, -1))
        assert np.max(np.abs(jacobian[k] - (low - high) / 2e-6)) < 1e-5


def test_penalties_pull_to_what_is_expected():
    s = np.linspace(-5, 5, 50)
    start = np.array([0.0, 1.0, 0.0, 0.0, 0.5, 1.0, 0.0])
    value, _ = compared(s, s, np.zeros(50), start + np.array([0, 0, 0, 0, 0.1, 0.2, 0.1]))
    far = np.full(7, 1e9)
    expected = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.3, 0.02])
    free, held = (
        gauss_newton(s, s, -value, start, expected, weight, -far, far, 0.0, 9.0)[0]
        for weight in (np.zeros(7), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1e3, 1e3]))
    )
    assert free[6] == pytest.approx(0.1, abs=1e-3)
    assert held[5:] == pytest.approx([1.3, 0.02], abs=1e-3)


def test_pixels_without_a_value_hold_no_edge():
    with pytest.raises(NoEdgeError, match="no straight target"):
        fit(np.full(ROWS.size, np.nan), LINE)


def testbounded_solution_obeys_its_bounds_and_is_the_minimum_within_them():
    rng = np.random.default_rng(16)
    for _ in range(20):
        root = rng.standard_normal((4, 4))
        gram, gradient = root @ root.T + np.eye(4), 3 * rng.standard_normal(4)
        low, high = np.full(4, -0.4), np.full(4, 0.6)
        step = bounded_solution(gram, gradient, low, high)
        assert np.all((step >= low) & (step <= high))
        free = (step > low) & (step < high)
        assert (gradient - gram @ step)[free] == pytest.approx(np.zeros(free.sum()), abs=1e-9)
    assert bounded_solution(gram, gradient, low - 100, high + 100) == pytest.approx(
        np.linalg.solve(gram, gradient)
    )


def test_a_step_beside_the_pixels_is_refused_without_its_meaningless_distance():
    with pytest.raises(NoEdgeError, match="a step lies outside the pixels around the one"):
        fit(edge(GaussianPixel(10.0), LINE.moved(30.0, 0.0)), LINE)
