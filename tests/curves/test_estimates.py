"""Curves answer arrays of places as they answer single ones."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from acutance import OptionError
from acutance.curves import Esf, Estimate, Estimates, Lsf, Mtf
from acutance.curves.grid import DISTANCE_PX, FREQ_CPP

RNG = np.random.default_rng(5)
LATENT = RNG.normal(size=(3, 2))
ESF = Esf(DISTANCE_PX, np.tanh(DISTANCE_PX), RNG.normal(size=(DISTANCE_PX.size, 3)), LATENT)
LSF = Lsf(DISTANCE_PX, np.cosh(DISTANCE_PX) ** -2, RNG.normal(size=(DISTANCE_PX.size, 2)))
MTF = Mtf(
    FREQ_CPP,
    np.exp(-3 * FREQ_CPP**2 + 0.4j * FREQ_CPP**3),
    0.01 * (RNG.normal(size=(FREQ_CPP.size, 3)) + 1j * RNG.normal(size=(FREQ_CPP.size, 3))),
    LATENT,
)


@pytest.mark.parametrize("curve", [ESF, LSF, MTF], ids=["esf", "lsf", "mtf"])
@pytest.mark.parametrize("places", [[0.0, 0.123, 0.5], (1.0,), np.array([[0.2, 0.3], [0.4, 0.99]])])
def test_an_array_is_answered_as_its_numbers_are(curve, places) -> None:
    found = curve(places)
    assert isinstance(found, Estimates)
    assert found.value.shape == found.std.shape == np.shape(places)
    alone = [curve(float(place)) for place in np.ravel(places)]
    np.testing.assert_allclose(found.value.ravel(), [one.value for one in alone], rtol=1e-12)
    np.testing.assert_allclose(found.std.ravel(), [one.std for one in alone], rtol=1e-12)
    assert {one.lowest for one in alone} == {found.lowest}


@pytest.mark.parametrize(
    "place", [1, np.float64(1), np.array(1.0), np.int32(1), Fraction(1), Estimate(1.0, 0.1)]
)
def test_a_number_of_any_type_gives_an_estimate(place) -> None:
    found = MTF(place)
    assert isinstance(found, Estimate)
    assert found == MTF(1.0)
    assert type(found.value) is float


def test_on_its_own_grid_a_curve_answers_its_arrays() -> None:
    np.testing.assert_allclose(MTF(FREQ_CPP).value, MTF.value, rtol=1e-10)
    np.testing.assert_allclose(MTF(FREQ_CPP).std, MTF.std, rtol=1e-8)
    np.testing.assert_allclose(ESF(DISTANCE_PX).std, ESF.std, rtol=1e-8)


def test_estimates_are_indexed_sliced_and_iterated() -> None:
    found = Estimates(np.array([0.9, 0.5, 0.1]), np.array([0.01, 0.02, 0.2]), lowest=0.0)
    assert len(found) == 3
    assert found[1] == Estimate(0.5, 0.02, 0.0)
    assert list(found)[-1] == found[-1] == Estimate(0.1, 0.2, 0.0)
    assert found[1:].value.tolist() == [0.5, 0.1]
    assert found[found.value > 0.3].std.tolist() == [0.01, 0.02]
    assert repr(found) == "<Estimates: 0.900 ± 0.010, 0.500 ± 0.020, 0.10 ± 0.20>"


def test_intervals_are_those_of_each_number() -> None:
    found = Estimates(np.array([0.9, 0.1]), np.array([0.01, 0.2]), lowest=0.0)
    low, high = found.interval(0.9)
    assert [*zip(low, high, strict=True)] == [pytest.approx(one.interval(0.9)) for one in found]
    assert low[1] == 0.0
    assert Estimates(found.value, found.std).interval(0.9)[0][1] < 0
    with pytest.raises(OptionError, match="between 0 and 1"):
        found.interval(95)


def test_the_mtf_is_bounded_and_spread_functions_are_not() -> None:
    assert MTF(0.5).lowest == MTF([0.5]).lowest == 0.0
    assert ESF(0.5).lowest is LSF([0.5]).lowest is None


@pytest.mark.parametrize("places", [[0.1, 1.5, 2.0], [0.1, -0.5], [0.1, math.nan], 1.5, math.nan])
def test_outside_the_curve_is_an_error_that_says_where(places) -> None:
    first = next(place for place in np.ravel(places) if not 0 <= place <= 1)
    with pytest.raises(OptionError, match=f"^{first:g} lies outside the curve, .* from 0 to 1"):
        MTF(places)


@pytest.mark.parametrize("places", ["a", "0.25", [0.1, "a"], None, [None], 1j, [[0.1], [0.2, 0.3]]])
def test_what_is_no_number_is_refused_by_name(places) -> None:
    with pytest.raises(OptionError, match=r"freq_cpp is .*, which is no number"):
        MTF(places)


def test_estimates_print_their_numbers() -> None:
    few, many = MTF([0.1, 0.2]), MTF(FREQ_CPP)
    assert repr(few) == f"<Estimates: {few[0]}, {few[1]}>"
    assert repr(many) == f"<Estimates: 101 of them, {many[0]} to {many[100]}>"
    assert repr(MTF([[0.1, 0.2]])) == f"<Estimates: 1 x 2 of them, {few[0]} to {few[1]}>"
    assert repr(MTF([])) == "<Estimates: 0 of them>"
