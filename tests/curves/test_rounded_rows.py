"""Rows of a covariance factor that keep their lengths when their directions are rounded."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from acutance.curves.rounded_rows import RoundedRows, principal_axes


@pytest.fixture
def factor() -> np.ndarray:
    """Sixty draws of a smooth curve, (200, 60), one row without any scatter."""
    rng = np.random.default_rng(1)
    waves = np.cos(np.outer(np.linspace(0, 3, 200), np.arange(12)))
    drawn = 0.5 ** np.arange(12)[:, None] * rng.normal(size=(12, 60))
    rows = waves @ drawn * np.logspace(-6, 1, 200)[:, None]
    rows[17] = 0.0
    return rows


def test_deviations_are_kept_and_correlations_nearly(factor):
    turned = factor @ principal_axes(factor)
    again = RoundedRows.of(turned).factor()
    length = np.linalg.norm(factor, axis=1)
    assert np.linalg.norm(again, axis=1) == pytest.approx(length, rel=1e-14)
    scale = np.where(length > 0, length, 1.0)[:, None]
    correlation, expected = ((rows / scale) @ (rows / scale).T for rows in (again, factor))
    assert correlation == pytest.approx(expected, abs=2e-3)


def test_a_pickled_copy_is_equal_and_small(factor):
    rounded = RoundedRows.of(factor @ principal_axes(factor))
    stored = pickle.dumps(rounded)
    assert pickle.loads(stored) == rounded
    assert len(stored) < factor.nbytes / 8


def test_a_factor_without_columns():
    rounded = pickle.loads(pickle.dumps(RoundedRows.of(np.zeros((5, 0)))))
    assert rounded.factor().shape == (5, 0)


def test_axes_are_as_many_as_the_variances_need(factor):
    axes = principal_axes(factor, 1e-9)
    assert axes.shape == (60, 12)
    assert axes.T @ axes == pytest.approx(np.eye(12), abs=1e-12)
    assert factor @ axes @ axes.T == pytest.approx(factor, abs=1e-9)
    fewer = principal_axes(factor, 0.1)
    assert fewer.shape[1] < 12
    scattered = np.delete(factor, 17, axis=0)
    left = np.linalg.norm(scattered @ fewer, axis=1) / np.linalg.norm(scattered, axis=1)
    assert left.min() ** 2 >= 0.9
