"""Tables, errors of draws, and the SNR that suffices."""

import math

import numpy as np
import pytest

from acutance.studies import Table, minimum_snr
from acutance.studies.scatter import error_columns, falling_fit, find_minimum


def test_tables_select_and_write():
    table = Table.of_rows(
        [{"name": "a", "x_px": 1.0}, {"name": "b", "x_px": math.nan}, {"name": "a", "x_px": 0.25}]
    )
    assert table.where(name="a")["x_px"].tolist() == [1.0, 0.25]
    assert table.to_csv() == "name,x_px\na,1\nb,\na,0.25\n"
    assert table.to_dict() == {"name": ["a", "b", "a"], "x_px": [1.0, None, 0.25]}
    with pytest.raises(ValueError, match="one length"):
        Table({"a": [1], "b": []})


def test_errors_are_percent_of_the_truth():
    found = error_columns("m", np.array([0.9, 1.1, 1.0, np.nan]) * 0.5, 0.5)
    assert found["m_bias_percent"] == pytest.approx(0.0, abs=1e-9)
    assert found["m_std_percent"] == pytest.approx(10.0)
    assert found["m_rms_percent"] == pytest.approx(10 * math.sqrt(2 / 3))
    assert found["m_refused"] == 1
    lucky = error_columns("m", np.array([0.5, np.nan, np.nan]), 0.5)
    assert math.isnan(lucky["m_rms_percent"])


def test_falling_fit_is_the_nearest_falling_sequence():
    assert falling_fit(np.array([3.0, 1.0, 2.0, 0.0])).tolist() == [3.0, 1.5, 1.5, 0.0]
    value = np.arange(30, 0, -1) + 8 * np.random.default_rng(2).normal(size=30)
    fit = falling_fit(value)
    assert np.all(np.diff(fit) <= 0)
    # Optimality: what is left is orthogonal to the fit and sums to nothing.
    assert (value - fit) @ fit == pytest.approx(0, abs=1e-9)
    assert fit.sum() == pytest.approx(value.sum())


def test_minimum_snr_is_found_through_scatter():
    rng = np.random.default_rng(4)
    snr = np.linspace(10, 300, 400)
    rms = 300 / snr * np.exp(0.3 * rng.normal(size=snr.size))
    order = rng.permutation(snr.size)
    assert minimum_snr(snr[order], rms[order], 5.0) == pytest.approx(63, abs=6)
    assert math.isnan(minimum_snr(snr, rms, 0.5))
    assert minimum_snr(snr, rms, 500.0) == snr[0]


def test_where_all_levels_are_good_the_lowest_is_no_minimum():
    levels = Table({"snr": [20.0, 40.0], "rms": [4.0, 2.0]})
    (all_good,) = find_minimum("m", "it", levels, "rms", 5.0)
    assert all_good.text == "it needs at most an SNR of 20, the lowest that was tried"
    (one_good,) = find_minimum("m", "it", levels, "rms", 3.0)
    assert one_good.text == "it needs an SNR of 40"
