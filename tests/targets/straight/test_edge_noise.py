"""Noise read from residuals: level, outliers and correlation."""

import numpy as np
import pytest

from acutance.numerics.noise import correlation, outlier_weights, robust_scale, side_variances
from acutance.simulate.resample import resample

NORMAL = (0.9945, 0.1045)


def all_pixels(field):
    rows, cols = np.indices(field.shape)
    return field.ravel(), rows.ravel(), cols.ravel()


def test_side_variances_tell_the_sides_apart():
    rng = np.random.default_rng(7)
    esf = np.repeat([0.0, 0.5, 1.0], 4000)
    residual = np.repeat([1.0, 9.0, 3.0], 4000) * rng.standard_normal(12000)
    dark, bright = side_variances(residual, esf)
    assert dark == pytest.approx(1.0, rel=0.08)
    assert bright == pytest.approx(9.0, rel=0.08)


def test_a_side_too_small_takes_the_pooled_variance():
    esf = np.append(np.zeros(100), np.ones(19))
    residual = np.append(np.tile([1.0, 5.0], 50), np.full(19, 7.0))
    dark, bright = side_variances(residual, esf)
    assert dark == 4.0
    assert bright == pytest.approx(np.var(residual))


def test_side_variances_leave_spikes_out():
    rng = np.random.default_rng(17)
    residual = rng.standard_normal(2000)
    clean = side_variances(residual, np.zeros(2000))[0]
    assert clean == pytest.approx(np.var(residual), rel=1e-12)
    assert side_variances(residual + 7.0, np.zeros(2000))[0] == pytest.approx(clean)
    residual[::20] += 30.0
    assert side_variances(residual, np.zeros(2000))[0] == pytest.approx(1.0, rel=0.1)


def test_robust_scale_is_the_standard_deviation_of_the_bulk():
    rng = np.random.default_rng(18)
    residual = 5 * rng.standard_normal(20000)
    assert robust_scale(residual) == pytest.approx(5.0, rel=0.03)
    residual[::20] = 1e6
    assert robust_scale(residual) == pytest.approx(5.0, rel=0.1)


def test_outlier_weights():
    weights = outlier_weights(np.array([0.0, 2.9, -3.0, 6.0, -30.0]))
    assert weights == pytest.approx([1, 1, 1, 1 / 16, 1e-4])


def test_white_noise_is_left_alone():
    rng = np.random.default_rng(8)
    found = [correlation(*all_pixels(rng.standard_normal((40, 40))), [NORMAL]) for _ in range(50)]
    assert all(c.inflation == 1.0 for c in found)
    # Significances of the stronger of two lags: seldom above 3, on average near 1.1.
    assert 0.8 < np.mean([c.significance for c in found]) < 1.5


def moving_average(shape, rng):
    """White noise averaged over pairs of columns: correlation 1/2 at lag (0, 1)."""
    white = rng.standard_normal((shape[0], shape[1] + 1))
    return (white[:, 1:] + white[:, :-1]) / np.sqrt(2)


def test_moving_average_doubles_the_power_at_low_frequency():
    rng = np.random.default_rng(9)
    found = correlation(*all_pixels(moving_average((200, 200), rng)), [(1.0, 0.0)])
    assert found.strongest == pytest.approx(0.5, abs=0.03)
    assert found.inflation == pytest.approx(2.0, abs=0.1)
    assert found.significance == pytest.approx(0.5 * 200, rel=0.1)


def test_correlation_along_the_edge_inflates_all_frequencies_across_it():
    rng = np.random.default_rng(10)
    along = moving_average((200, 200), rng).T
    assert correlation(*all_pixels(along), [(1.0, 0.0)]).inflation == pytest.approx(2.0, abs=0.1)


def test_missing_pixels_do_not_bias_the_correlation():
    rng = np.random.default_rng(11)
    field, rows, cols = all_pixels(moving_average((200, 200), rng))
    kept = rng.random(field.size) < 0.5
    found = correlation(field[kept], rows[kept], cols[kept], [(1.0, 0.0)])
    assert found.strongest == pytest.approx(0.5, abs=0.05)


def test_cubic_resampling_is_noticed():
    rng = np.random.default_rng(12)
    white = rng.standard_normal((80, 80))
    rows, cols = np.meshgrid(np.arange(70) + 4.5, np.arange(70) + 4.5, indexing="ij")
    field = resample(white, rows, cols)
    found = correlation(*all_pixels(field / field.std()), [NORMAL])
    # Catmull-Rom at half a pixel, weights -1, 9, 9, -1 over 16: power at frequency 0 over variance
    # is 1 / (164 / 256) in either direction.
    assert found.significance > 10
    assert found.strongest == pytest.approx(63 / 164 * 1.0, abs=0.06)
    assert found.inflation == pytest.approx((256 / 164) ** 2, rel=0.15)


def test_too_few_pixels_say_nothing():
    found = correlation(np.ones(9), np.arange(9), np.arange(9), [NORMAL])
    assert (found.inflation, found.strongest, found.significance) == (1.0, 0.0, 0.0)
