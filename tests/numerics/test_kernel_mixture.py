"""A mixture of kernels after linear data: against the formulas kernel by kernel."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.numerics.kernel_mixture import Further, Kernels, combinations_of, mixture

SCALES = (0.5, 1.3)


@pytest.fixture
def kernels():
    """Nine kernels of six parameters in three parts, two of which have one name."""
    rng = np.random.default_rng(0)
    return Kernels(
        0.3 * rng.normal(size=(9, 6)), rng.normal(size=9), np.repeat([0, 1, 2], 3),
        0.3 * rng.normal(size=(3, 6, 2)), np.array([0.1, 0.2, 0.3]), np.array(["a", "b", "a"]),
        SCALES,
    )  # fmt: skip


@pytest.fixture
def told():
    rng = np.random.default_rng(1)
    root = rng.normal(size=(6, 6))
    return combinations_of(0.5 * root @ root.T, 0.5 * rng.normal(size=6), 1e-9)


def one_by_one(kernels, told):
    """Log weights, means and covariances of all kernels by the textbook's formulas."""
    log_weight, means, covariances = [], [], []
    for scale in kernels.scales:
        for centre, weight, part in zip(
            kernels.centres, kernels.log_weight, kernels.part, strict=True
        ):
            factor = scale * kernels.factors[part]
            before = factor @ factor.T + kernels.floor[part] ** 2 * np.eye(6)
            seen = np.eye(told.values.size) + told.columns.T @ before @ told.columns
            off = told.values - told.columns.T @ centre
            gain = before @ told.columns @ np.linalg.inv(seen)
            misfit = off @ np.linalg.solve(seen, off) + np.linalg.slogdet(seen)[1]
            log_weight.append(weight - np.log(len(kernels.scales)) - 0.5 * misfit)
            means.append(centre + gain @ off)
            covariances.append(before - gain @ told.columns.T @ before)
    return np.array(log_weight), np.array(means), np.array(covariances)


def test_the_mixture_is_that_of_its_kernels_one_by_one(kernels, told):
    found = mixture(kernels, told)
    log_weight, means, covariances = one_by_one(kernels, told)
    evidence = np.logaddexp.reduce(log_weight)
    weight = np.exp(log_weight - evidence)
    mean = weight @ means
    away = means - mean
    assert found.log_evidence == pytest.approx(evidence, rel=1e-12)
    assert found.mean == pytest.approx(mean, abs=1e-12)
    wanted = np.tensordot(weight, covariances, 1) + (weight[:, None] * away).T @ away
    assert found.covariance == pytest.approx(wanted, abs=1e-12)
    part = np.tile(kernels.part, 2)
    assert found.share == pytest.approx(
        {"a": weight[part != 1].sum(), "b": weight[part == 1].sum()}
    )


def test_combinations_are_what_the_data_say():
    information = np.diag([4.0, 1e-6, 9.0])
    told = combinations_of(information, information @ np.array([1.0, 5.0, -2.0]), 1e-2)
    assert told.values.size == 2
    assert told.columns @ told.columns.T == pytest.approx(np.diag([4.0, 0.0, 9.0]))
    assert told.columns.T @ np.array([1.0, 7.0, -2.0]) == pytest.approx(told.values)


def test_unlikely_kernels_are_out_of_the_question(kernels, told):
    far = kernels._replace(centres=kernels.centres + 60.0 * (kernels.part == 2)[:, None])
    found = mixture(far, told)
    kept = far.some(found.is_likely(40.0))
    assert kept.name.tolist() == ["a", "b"]
    assert kept.part.tolist() == [0, 0, 0, 1, 1, 1]
    assert mixture(kept, told).mean == pytest.approx(found.mean, abs=1e-9)
    assert mixture(kept, told).log_evidence == pytest.approx(found.log_evidence, rel=1e-12)


def test_a_further_parameter_gains_what_its_own_mixture_says(kernels, told):
    """Written as a seventh parameter of unit variance, which the data see beside the others."""
    rng = np.random.default_rng(2)
    slopes, projection, information = rng.normal(size=(6, 2)), np.array([1.0, -2.0]), 40.0
    further = Further(slopes, projection, np.full(2, information))
    found = mixture(kernels, told).log_weight_with(further, np.arange(9))
    for number in range(2):
        whole = np.zeros((7, 7))
        whole[:6, :6] = told.columns @ told.columns.T
        whole[6, :6] = whole[:6, 6] = slopes[:, number]
        whole[6, 6] = information
        says = np.append(told.columns @ told.values, projection[number])
        for scale, own in zip(kernels.scales, found[number], strict=True):
            for centre, weight, part, gained in zip(
                kernels.centres, kernels.log_weight, kernels.part, own, strict=True
            ):
                before = np.eye(7)
                factor = scale * kernels.factors[part]
                before[:6, :6] = factor @ factor.T + kernels.floor[part] ** 2 * np.eye(6)
                start = np.append(centre, 0.0)
                after = np.linalg.inv(np.linalg.inv(before) + whole)
                pull = says - whole @ start
                wanted = weight - np.log(2) + 0.5 * pull @ after @ pull + says @ start
                wanted += 0.5 * np.linalg.slogdet(after)[1] - 0.5 * np.linalg.slogdet(before)[1]
                wanted -= 0.5 * start @ whole @ start + 0.5 * told.values @ told.values
                assert gained == pytest.approx(wanted, rel=1e-10)
