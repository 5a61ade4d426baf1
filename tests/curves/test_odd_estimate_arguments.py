"""Estimates of what is no number are refused in words, as are lines and bars."""

import math

import numpy as np
import pytest

from acutance.curves import Estimate, Estimates
from acutance.errors import OptionError
from acutance.geometry import Bars, Line

WRONG = ["x", b"x", [], {}, ["a"], 1j, list, object(), np.zeros((3, 3))]


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda x: Estimate(x, 0.1),
        lambda x: Estimate(0.3, x),
        lambda x: Estimate(0.3, 0.1, lowest=x),
        lambda x: Estimate(0.3, 0.1, highest=x),
        lambda x: Estimate(0.3, 0.1).interval(x),
        lambda x: Estimate(0.3, 0.1).probability_above(x),
        lambda x: Estimate.from_dict(x),
        lambda x: Estimates(x if isinstance(x, str) else "x", [0.1]),
        lambda x: Estimates([0.3], [0.1], lowest=x),
        lambda x: Line(x, 1.0, 3.0),
        lambda x: Line(1.0, 1.0, 3.0, curvature_per_px=x),
        lambda x: Bars(1.0, x, 3.0, 4.0, 3, 9.0),
        lambda x: Bars(1.0, 1.0, 3.0, 4.0, x, 9.0),
    ],
)
def test_what_is_no_number_is_refused(call, wrong):
    with pytest.raises(OptionError, match=r"give|has to be|has to hold"):
        call(wrong)


def test_estimates_have_one_deviation_each():
    with pytest.raises(OptionError, match=r"shape \(2,\) with deviations of shape \(1,\): give"):
        Estimates([0.3, 0.4], [0.1])
    assert len(Estimates([0.3, 0.4], [0.1, 0.1])) == 2


def test_what_does_not_exist_is_nan():
    assert math.isnan(Estimate(math.nan, math.nan).probability_above(0.3))
    assert math.isnan(Estimate.from_dict({"value": None, "std": None}).value)
