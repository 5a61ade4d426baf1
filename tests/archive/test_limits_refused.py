"""Limits that every value keeps, or none, are refused wherever a limit is stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance.archive.specification import Requirement, Specification
from acutance.archive.trends import Series, fit_trend


@pytest.fixture
def overshoot() -> Series:
    rng = np.random.default_rng(2)
    value = np.maximum(rng.normal(0, 1e-4, 20), 0)
    return Series(
        metric="overshoot", when=2022 + 0.1 * np.arange(20), value=value,
        std=np.full(20, 1e-4), image=np.arange(20),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("metric", "sense", "limit"),
    [("overshoot", "minimum", 0), ("undershoot", "maximum", 0), ("mtf_nyquist", "minimum", -1),
     ("mtf_nyquist", "maximum", -0.1)],
)  # fmt: skip
def test_specifications_and_requirements_have_one_rule(
    metric: str, sense: str, limit: float
) -> None:
    never = f"{metric} is never below 0; state a limit above"
    with pytest.raises(ac.OptionError, match=never):
        Specification.of({"requirement": [{"metric": metric, sense: limit}]})
    with pytest.raises(ac.OptionError, match=never):
        ac.targets.ToleranceLimit.of(f"{metric} {'>=' if sense == 'minimum' else '<='} {limit}")


def test_numbers_that_may_be_negative_have_such_limits() -> None:
    assert Requirement(metric="rer", minimum=-0.1).limit == -0.1
    assert ac.targets.ToleranceLimit.of("rer >= -0.1").limit == -0.1


@pytest.mark.parametrize("limit", [0.0, -3.0])
def test_a_trend_refuses_them(overshoot: Series, limit: float) -> None:
    with pytest.raises(ac.OptionError, match="overshoot is never below 0; state a limit above"):
        fit_trend(overshoot).crosses(limit)


def test_bands_end_where_the_intervals_do(overshoot: Series) -> None:
    bands = fit_trend(overshoot).bands()
    for low, high in (bands.band50, bands.band95, bands.images95):
        assert low.min() >= 0
        assert high.max() > 0


def test_a_number_without_a_bound_keeps_its_bands(overshoot: Series) -> None:
    bands = fit_trend(replace(overshoot, metric="rer", value=overshoot.value - 5e-5)).bands()
    assert bands.band95[0].min() < 0
