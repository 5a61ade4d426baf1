"""Curves of what is no curve are refused in words, and so is reading them at what is no place."""

import math

import numpy as np
import pytest

from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.errors import OptionError
from acutance.geometry import Line

FREQ = np.arange(101) * 0.01
PLACES = np.arange(-200, 201) * 0.05
MTF = Mtf(FREQ, np.exp(-FREQ).astype(complex), np.ones((101, 2), complex))
ESF = Esf(PLACES, 0.5 + 0.5 * np.tanh(PLACES), np.ones((401, 2)))
LSF = Lsf(PLACES, 0.5 / np.cosh(PLACES) ** 2, np.ones((401, 2)))
LINE = Line(1.0, 2.0, 5.0)
NO_NUMBERS = ["x", b"x", {}, ["a"], 1j, list, object()]
MANY = [np.zeros((2, 2)), [0.1, 0.2]]


@pytest.mark.parametrize("wrong", [*NO_NUMBERS, None, math.nan, math.inf, 20.0, [0.1, math.nan]])
@pytest.mark.parametrize(
    "read", [MTF.near, MTF.row, MTF.gradient, MTF.value_and_row, ESF.at, ESF.row, LSF.gradient]
)
def test_a_curve_is_read_at_its_places(read, wrong):
    with pytest.raises(OptionError, match=r"call a curve|has to be|outside the curve|no place"):
        read(wrong)


@pytest.mark.parametrize("wrong", [*NO_NUMBERS, *MANY])
@pytest.mark.parametrize(
    "read",
    [
        MTF.value_and_row,
        ESF.at,
        ESF.row,
        lambda x: ESF.passing(x, 0.0),
        lambda x: ESF.passing(0.5, x),
        lambda x: Response(ESF, LSF, MTF, x),
    ],
)
def test_one_number_is_asked_for(read, wrong):
    with pytest.raises(OptionError, match=r"it has to be a number"):
        read(wrong)


def test_only_places_of_the_grid_are_near():
    assert MTF.near(np.array([0.1, 0.25])).freq_cpp.tolist() == [0.1, 0.25]
    with pytest.raises(OptionError, match=r"0\.254 is no place of .*0 to 1: call the curve"):
        MTF.near(np.array([0.1, 0.254]))


@pytest.mark.parametrize("wrong", [*NO_NUMBERS, 3.0, [0.1, 0.2], np.zeros(5), np.zeros((3, 2))])
@pytest.mark.parametrize(
    "make",
    [
        lambda x: Mtf(x, MTF.otf, MTF.factor),
        lambda x: Mtf(FREQ, x, MTF.factor),
        lambda x: Mtf(FREQ, MTF.otf, x),
        lambda x: Mtf(FREQ, MTF.otf, MTF.factor, x),
        lambda x: Esf(x, ESF.value, ESF.factor),
        lambda x: Lsf(PLACES, x, ESF.factor),
        lambda x: Esf(PLACES, ESF.value, x),
        lambda x: Response(x, LSF, MTF),
        lambda x: Response(ESF, x, MTF),
        lambda x: Response(ESF, LSF, x),
        lambda x: Response(ESF, LSF, MTF, 1.0, x),
    ],
)
def test_curves_are_made_of_arrays_that_belong_together(make, wrong):
    with pytest.raises(OptionError, match=r"needs|give|choose"):
        make(wrong)


@pytest.mark.parametrize(
    "places", [FREQ[::-1], FREQ**2, FREQ * math.nan, np.append(FREQ[:-1], math.inf), FREQ * 0]
)
def test_places_are_a_regular_grid(places):
    with pytest.raises(OptionError, match="needs a regular grid of increasing, finite numbers"):
        Mtf(places, MTF.otf, MTF.factor)


def test_rounded_places_are_a_grid():
    step = 1 / 3
    places = np.round(np.arange(20) * step, 6)
    rounded = Mtf(places, np.exp(-places).astype(complex), np.zeros((20, 0), complex))
    assert rounded(1.0).value == pytest.approx(math.exp(-1.0), abs=1e-3)


def test_three_places_are_too_few_to_read_between_them():
    few = Esf(PLACES[:3], ESF.value[:3], ESF.factor[:3])
    for at in (-9.97, np.array([-9.97])):
        with pytest.raises(OptionError, match="a curve of 3 places cannot be read"):
            few(at)


@pytest.mark.parametrize("wrong", [*NO_NUMBERS, *MANY])
@pytest.mark.parametrize(
    "change", [lambda x: LINE.moved(x, 0.0), lambda x: LINE.moved(0.0, x), LINE.bent, LINE.slid]
)
def test_a_line_is_changed_by_numbers(change, wrong):
    with pytest.raises(OptionError, match="it has to be a number"):
        change(wrong)
