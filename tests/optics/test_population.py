"""Sensors drawn at random: in their families, in their ranges, the same for the same seed."""

import numpy as np
import pytest

from acutance.errors import OptionError
from acutance.optics import FAMILIES, Sharpening, Smear, draw_sensor


@pytest.mark.parametrize("family", list(FAMILIES))
def test_sensors_of_a_family_differ_and_can_be_drawn_again(family):
    drawn = [draw_sensor(family, np.random.default_rng(seed)) for seed in (1, 1, 2, 3)]
    assert drawn[0] == drawn[1]
    nyquist = [abs(complex(sensor.otf(0.5, 0.0))) for sensor in drawn]
    assert len(set(nyquist)) == 3
    assert all(0.01 < value < 1 for value in nyquist)
    assert all(abs(complex(sensor.otf(0.0, 0.0)) - 1) < 1e-9 for sensor in drawn)


def test_families_have_the_cause_they_are_named_after():
    rng = np.random.default_rng(5)
    kernels = [draw_sensor("sharpened", rng).blocks[-1] for _ in range(20)]
    assert all(isinstance(kernel, Sharpening) for kernel in kernels)
    assert {len(kernel.kernel) for kernel in kernels} >= {3, 5, 15}
    smear = [block for block in draw_sensor("smear", rng).blocks if isinstance(block, Smear)]
    assert 0.5 <= smear[0].length_px <= 2.2


def test_a_family_that_is_none_is_refused():
    with pytest.raises(OptionError, match="telescope, halo"):
        draw_sensor("tele", np.random.default_rng(0))
