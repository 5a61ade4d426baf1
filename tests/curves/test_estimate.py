import json
import math
import operator
import pickle

import numpy as np
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


@pytest.mark.parametrize("spec", [">20", "20", "*^20", "<20", ""])
def test_a_width_alone_pads_the_usual_text(spec: str) -> None:
    found = Estimate(0.7209610678478439, 0.0031371295100954687)
    assert format(found, spec) == format("0.7210 ± 0.0031", spec)
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


def test_numbers_scale_and_shift_an_estimate() -> None:
    rer = Estimate(2.0, 0.5)
    assert 3 * rer == rer * 3 == Estimate(6.0, 1.5)
    assert -0.5 * rer == rer / -2 == Estimate(-1.0, 0.25)
    assert -rer == Estimate(-2.0, 0.5)
    assert rer + 0.25 == 0.25 + rer == Estimate(2.25, 0.5)
    assert rer - 0.25 == Estimate(1.75, 0.5)
    assert 1 - rer == Estimate(-1.0, 0.5)
    assert np.float64(3) * rer == np.int64(3) * rer == Estimate(6.0, 1.5)
    assert np.float64(1) - rer == Estimate(-1.0, 0.5)
    assert type((np.float64(3) * rer).value) is float
    assert float(rer) == 2.0


def test_numpy_integers_and_short_floats_are_numbers_as_any_other() -> None:
    """-uint8(3) is 253, and 1 / uint8(3) has the three digits of half precision."""
    rer = Estimate(5.0, 0.1)
    for kind in (np.uint8, np.uint64, np.int8, np.float16, np.float32):
        assert rer - kind(3) == rer - 3
        assert rer / kind(3) == rer / 3
    assert rer - np.int8(-128) == rer + 128


def test_estimates_compare_by_value() -> None:
    rer = Estimate(0.5, 0.1)
    assert rer > 0.4
    assert rer >= 0.5
    assert rer <= 0.5
    assert rer < np.float64(0.6)
    assert 0.4 < rer <= Estimate(0.5, 0.3)
    assert not rer < Estimate(0.5)
    assert not Estimate(math.nan, math.nan) > 0
    assert sorted([rer, Estimate(0.2, 9.0), Estimate(0.3)])[1] == Estimate(0.3)


@pytest.mark.parametrize("operation", [operator.add, operator.sub, operator.mul, operator.truediv])
def test_the_covariance_of_two_estimates_is_not_guessed(operation) -> None:
    with pytest.raises(TypeError, match=r"two estimates has no standard deviation.*covariance"):
        operation(Estimate(1.0, 0.1), Estimate(2.0, 0.1))


def test_a_truth_is_a_number_as_any_other() -> None:
    rer, truth = Estimate(0.5, 0.1, lowest=0.0), Estimate(0.25)
    assert rer - truth == rer - 0.25 == Estimate(0.25, 0.1, lowest=-0.25)
    assert truth - rer == 0.25 - rer
    assert truth + rer == rer + truth == rer + 0.25
    assert truth * rer == rer * truth == rer * 0.25
    assert rer / truth == rer / 0.25
    assert truth - Estimate(0.5) == Estimate(-0.25)
    assert math.isnan((Estimate(0.5, math.nan) - truth).std)


@pytest.mark.parametrize("other", [1, 0.25, Estimate(0.25)])
def test_an_estimate_is_no_denominator(other) -> None:
    with pytest.raises(TypeError, match=r"not linear in it: use float\(\) of the estimate"):
        other / Estimate(0.5, 0.1)


@pytest.mark.parametrize("other", ["0.5", None, [1.0], np.ones(2), 1j])
def test_an_estimate_adds_and_compares_to_nothing_but_numbers(other) -> None:
    rer = Estimate(1.0, 0.1)
    for operation in (operator.add, operator.sub, operator.mul, operator.truediv, operator.lt):
        with pytest.raises(TypeError):
            operation(rer, other)
        with pytest.raises(TypeError):
            operation(other, rer)


def test_equal_where_all_fields_are() -> None:
    rer = Estimate(0.5, 0.1)
    assert rer == Estimate(0.5, 0.1)
    assert rer != Estimate(0.5, 0.2)
    assert rer != Estimate(0.5, 0.1, lowest=0.0)
    assert rer != 0.5
    assert len({rer, Estimate(0.5, 0.1), Estimate(0.4, 0.1)}) == 2


@pytest.mark.parametrize(
    "number",
    [Estimate(0.5, 0.1, 0.0), Estimate(0.5, math.nan), Estimate(math.nan, math.nan)],
)
def test_equal_after_pickling(number: Estimate) -> None:
    copy = pickle.loads(pickle.dumps(number))
    assert copy == number
    assert hash(copy) == hash(number)


def test_an_interval_ends_at_what_the_quantity_cannot_fall_below() -> None:
    mtf = Estimate(0.01, 0.02, lowest=0.0)
    low, high = mtf.interval(0.95)
    assert low == 0.0
    assert high == pytest.approx(0.01 + 0.02 * 1.9599640)
    assert mtf.interval(0.3)[0] == Estimate(0.01, 0.02).interval(0.3)[0] > 0
    assert math.isnan(Estimate(math.nan, math.nan, lowest=0.0).interval()[0])


def test_a_lower_bound_follows_shift_and_scale_and_ends_with_the_sign() -> None:
    width = Estimate(1.0, 0.2, lowest=0.0)
    assert (2 * width + 3).lowest == 3.0
    assert (width / 4).lowest == 0.0
    assert (1 - width).lowest is None
    assert (-width).lowest is None
    assert str(Estimate(110998.4, 3578.2)) == "111000 ± 3600"
    assert (1 - width).highest == 1.0
    share = Estimate(0.9, 0.2, lowest=0.0, highest=1.0)
    assert (1 - share).interval() == (0.0, pytest.approx(0.1 + 1.96 * 0.2, abs=1e-4))
    assert share.interval()[1] == 1.0
    assert Estimate.from_dict(share.to_dict()) == share


def test_document_has_none_where_there_is_no_number() -> None:
    assert Estimate(math.nan, 1.0).to_dict() == {"value": None, "std": None, "interval95": None}
    assert Estimate(1.0, math.nan).to_dict() == {"value": 1.0, "std": None, "interval95": None}
    document = Estimate(0.2, 0.01).to_dict()
    assert document["interval95"] == pytest.approx([0.1804004, 0.2195996])
    assert "lowest" not in document
    clipped = Estimate(0.01, 0.02, lowest=0.0).to_dict()
    assert clipped["interval95"] == [0.0, pytest.approx(0.0491993)]
    assert clipped["lowest"] == 0.0


@pytest.mark.parametrize(
    "number",
    [
        Estimate(0.1 / 3, 0.02 / 7, lowest=0.0),
        Estimate(0.5),
        Estimate(0.5, math.nan),
        Estimate(math.nan, math.nan),
    ],
)
def test_a_document_loses_nothing(number: Estimate) -> None:
    assert Estimate.from_dict(json.loads(json.dumps(number.to_dict()))) == number


def test_the_probability_of_a_limit_is_that_of_the_interval() -> None:
    number = Estimate(0.2, 0.01, lowest=0.0)
    low, high = number.interval(0.95)
    assert number.probability_above(low) == pytest.approx(0.975)
    assert number.probability_above(high) == pytest.approx(0.025)
    assert number.probability_above(0.0) == 1.0
    assert Estimate(0.97, 0.05, highest=1.0).probability_above(1.01) == 0.0
    assert [Estimate(0.2).probability_above(limit) for limit in (0.2, 0.21)] == [1.0, 0.0]
    assert math.isnan(Estimate(math.nan, 0.1, lowest=0.0).probability_above(-1.0))
    assert math.isnan(Estimate(0.2, math.nan).probability_above(0.1))
