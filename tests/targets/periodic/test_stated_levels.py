"""Levels that a caller states of bars and stars: both, in order, and finite."""

import math

import pytest

from acutance import OptionError
from acutance.targets.periodic import BarsOptions, StarOptions
from acutance.targets.periodic.stated_contrast import stated_levels


@pytest.mark.parametrize("options", [BarsOptions, StarOptions])
@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"level_std": 3.0}, "no levels are stated"),
        ({"dark": 1.0}, "one level was given"),
        ({"bright": 1.0, "level_std": 1.0}, "one level was given"),
        ({"dark": 3.0, "bright": 2.0}, "dark has to be the lower one"),
        ({"dark": 3.0, "bright": math.nan}, "bright has to be a number"),
        ({"dark": 3.0, "bright": math.inf}, "dark has to be the lower one"),
        ({"dark": 1.0, "bright": 2.0, "level_std": -1.0}, "0 or more"),
        ({"dark": 1.0, "bright": 2.0, "level_std": math.nan}, "level_std has to be a number"),
        ({"dark": 1.0, "bright": 2.0, "level_std": math.inf}, "0 or more"),
    ],
)
def test_levels_that_mean_nothing_are_refused(options, stated, message):
    with pytest.raises(OptionError, match=message):
        options(**stated)


def test_levels_are_optional():
    assert stated_levels(None, None, 0.0) is None
    assert stated_levels(200.0, 1200.0, 1.0) is not None


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ({"inner_px": -5.0}, r"inner_px \(--inner\) is -5"),
        ({"inner_px": math.nan}, "inner_px has to be a number"),
        ({"centre": (math.inf, 3.0)}, "two finite numbers"),
        ({"centre": (math.nan, 3.0)}, "a number, a number"),
    ],
)
def test_a_star_lies_somewhere(place, message):
    with pytest.raises(OptionError, match=message):
        StarOptions(**place)


def test_the_middle_of_a_star_need_not_be_left_out():
    assert StarOptions(inner_px=0.0).inner_px == 0
