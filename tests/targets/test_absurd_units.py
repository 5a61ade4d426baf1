"""Images in absurd units are refused in words by every kind, those in other units measured."""

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.errors import ImageError
from acutance.optics import Detector, Gaussian, Sensor

SENSOR = Sensor([Gaussian(0.4), Detector()])
KINDS = ("edge", "pulse", "points", "bars", "star")


def image_of(kind):
    return getattr(simulate, kind)(SENSOR, snr=100, rng=np.random.default_rng(1))[0]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("exponent", [-300, -200, 100, 300])
@pytest.mark.parametrize("kind", KINDS)
def test_units_whose_powers_cannot_be_represented_are_refused(kind, exponent):
    with pytest.raises(ImageError, match="powers of the contrast"):
        getattr(ac, f"measure_{kind}")(image_of(kind) * 10.0**exponent)


@pytest.mark.filterwarnings("error")
def test_a_pair_in_absurd_units_is_refused():
    low, high, _ = simulate.pair(SENSOR, SENSOR, ratio=3, shape=(64, 64), snr=100,
                                 rng=np.random.default_rng(1))  # fmt: skip
    for exponent in (-150, 150):
        with pytest.raises(ImageError, match="powers of the contrast"):
            ac.measure_biresolution(low * 10.0**exponent, high * 10.0**exponent, ratio=3)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("exponent", [-70, 70])
def test_other_units_give_the_same_numbers(exponent):
    image = image_of("bars")
    usual, found = (ac.measure_bars(one) for one in (image, image * 10.0**exponent))
    assert found.across.mtf_nyquist.value == pytest.approx(usual.across.mtf_nyquist.value, rel=1e-4)


def test_one_absurd_value_is_no_unit():
    image = image_of("edge")
    image[3, 3] = 1e200
    assert ac.measure_edge(image).verdict.word != "invalid"
