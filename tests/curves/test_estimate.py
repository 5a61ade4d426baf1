import math

import pytest

from acutance.curves import Estimate


def test_prints_two_digits_of_the_standard_deviation() -> None:
    assert str(Estimate(0.15112, 0.0032)) == "0.1511 ± 0.0032"
    assert str(Estimate(1.4567, 0.12)) == "1.46 ± 0.12"
    assert str(Estimate(12.3, 4.0)) == "12.3 ± 4.0"
    assert str(Estimate(0.0, 1e-15)) == "0.000000 ± 1e-15"
    assert str(Estimate(0.25)) == "0.2500"
    assert str(Estimate(math.nan, math.nan)) == "undefined"


def test_a_format_holds_for_value_and_deviation() -> None:
    assert f"{Estimate(0.15112, 0.0032):.3f}" == "0.151 ± 0.003"
    assert f"{Estimate(0.15112, 0.0032)}" == "0.1511 ± 0.0032"
    assert f"{Estimate(0.25):.2f}" == "0.25"
    assert f"{Estimate(0.25, math.nan):.2f}" == "0.25"
    assert f"{Estimate(math.nan, math.nan):.2f}" == "undefined"


def test_interval_is_symmetric_and_normal() -> None:
    low, high = Estimate(1.0, 0.1).interval(0.95)
    assert low == pytest.approx(1 - 0.1959964)
    assert high == pytest.approx(1 + 0.1959964)
    low, high = Estimate(1.0, 0.1).interval(0.6826895)
    assert high - low == pytest.approx(0.2)


def test_scaling_carries_the_standard_deviation() -> None:
    scaled = Estimate(2.0, 0.5).scaled(-0.7)
    assert (scaled.value, scaled.std) == (-1.4, 0.35)
    assert float(scaled) == -1.4


def test_document_has_none_where_there_is_no_number() -> None:
    assert Estimate(math.nan, 1.0).to_dict() == {"value": None, "std": None, "interval95": None}
    assert Estimate(1.0, math.nan).to_dict() == {"value": 1.0, "std": None, "interval95": None}
    document = Estimate(0.2, 0.01).to_dict()
    assert document["interval95"] == pytest.approx([0.1804004, 0.2195996])
