"""Sides of one value: wings that end in an image without noise, and clips."""

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import edge, pulse, reference_systems


def _share(found):
    (check,) = (one for one in found.checks if one.name == "saturation")
    return check.value


@pytest.mark.parametrize(
    ("name", "shape", "angle_deg"),
    [("halo", (60, 40), 6.0), ("asymmetric", (60, 40), 6.0), ("asymmetric", (60, 60), 3.0)],
)
def test_wings_that_end_are_not_clipped(name, shape, angle_deg):
    image, _ = edge(reference_systems()[name], shape=shape, angle_deg=angle_deg)
    found = ac.measure_edge(image)
    assert _share(found) == 0.0
    assert found.verdict.word != "invalid"


def test_wings_of_a_pulse_are_not_clipped():
    image, _ = pulse(reference_systems()["asymmetric"], width_px=3.0, shape=(40, 35), angle_deg=7.0)
    assert _share(ac.measure_pulse(image)) == 0.0


@pytest.mark.parametrize(("snr", "level"), [(None, 1195.0), (None, 1199.9), (1e4, 1199.9)])
def test_wings_that_are_cut_off_are_clipped(snr, level):
    image, _ = edge(
        reference_systems()["halo"], shape=(60, 50), snr=snr, rng=np.random.default_rng(1)
    )
    found = ac.measure_edge(np.minimum(image, level))
    assert _share(found) > 0.3
    assert found.verdict.word == "invalid"
