"""Regression with Student-t residuals against integrals done by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from acutance.numerics.student_regression import StudentModel, scatter_nodes, step_evidences

NODES = np.linspace(-4.5, 6.0, 60)


def model(**changes: object) -> StudentModel:
    rng = np.random.default_rng(2)
    value = 1 + 0.05 * rng.normal(size=9)
    made = StudentModel(
        np.ones((9, 1)), value, np.full(9, 0.02**2), np.array([1 / 0.5**2]), 5.0, 0.04,
        float(np.log(0.04)),
    )  # fmt: skip
    return replace(made, **changes)  # type: ignore[arg-type]


def brute_force(made: StudentModel) -> tuple[float, float, float]:
    """Log evidence, mean and deviation of a level, on a grid of level and scatter."""
    level = np.linspace(0.7, 1.3, 401)
    scatter = np.geomspace(1e-3, 2.0, 401)
    scale = np.sqrt(scatter[:, None, None] ** 2 + made.variance)
    density = stats.t.logpdf(made.value - level[None, :, None], made.degrees, scale=scale).sum(2)
    density += stats.norm.logpdf(level, scale=0.5)
    prior = stats.halfcauchy.pdf(scatter, scale=made.scatter_prior) * scatter
    weight = np.exp(density - density.max()) * prior[:, None]
    step = (level[1] - level[0]) * np.log(scatter[1] / scatter[0])
    total = weight.sum()
    mean = float((weight * level).sum() / total)
    std = float(np.sqrt((weight * (level - mean) ** 2).sum() / total))
    return float(density.max() + np.log(total * step)), mean, std


def test_evidence_and_level_are_those_of_a_grid() -> None:
    made = model()
    log_evidence, mean, std = brute_force(made)
    found = scatter_nodes(made, NODES)
    own = float(found.share @ found.mode[:, 0])
    spread = found.share @ (found.covariance[:, 0, 0] + (found.mode[:, 0] - own) ** 2)
    assert found.log_evidence == pytest.approx(log_evidence, abs=0.1)
    assert own == pytest.approx(mean, abs=0.05 * std)
    assert np.sqrt(spread) == pytest.approx(std, rel=0.06)


def test_a_step_that_is_there_is_the_likeliest() -> None:
    value = model().value + 0.3 * (np.arange(9) >= 4)
    places = np.arange(2, 8)[:, None]
    found = step_evidences(model(value=value), places, 1 / 0.2**2)
    assert places[found.argmax(), 0] == 4
    none = step_evidences(model(value=value), np.zeros((1, 0), np.int64), 1 / 0.2**2)
    assert found.max() > none[0] + 3


def test_an_outlier_moves_heavy_tails_less() -> None:
    value = model().value.copy()
    value[3] += 2.0
    levels = {}
    for degrees in (3.0, 300.0):
        made = model(value=value, degrees=degrees, precision=np.zeros(1))
        found = scatter_nodes(made, NODES)
        levels[degrees] = float(found.share @ found.mode[:, 0])
    assert abs(levels[3.0] - 1) < 0.03 < abs(levels[300.0] - 1)
