"""What bars and stars have in common as measurements: limits of checks, and light copies."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from periodic_scenes import (
    CYCLES,
    STATED,
    STATED_BARS,
    bars_scene,
    measured_bars,
    measured_star,
    star_scene,
)

from acutance.errors import OptionError
from acutance.targets import Record
from acutance.targets.periodic import (
    BARS_CHECKS,
    STAR_CHECKS,
    BarsOptions,
    StarOptions,
    measure_bars,
    measure_star,
)

MEASURED = {"bars": measured_bars, "star": measured_star}


def _absurd(checks):
    """Limits that nothing keeps."""
    return {check.name: math.inf if check.sense == ">=" else -math.inf for check in checks}


def test_every_check_of_bars_has_its_limit():
    asked, _ = measured_bars()
    assert tuple(check.name for check in asked.checks) == BARS_CHECKS
    limits = _absurd(asked.checks)
    found = measure_bars(bars_scene()[0], options=replace(STATED_BARS, limits=limits))
    assert [check.name for check in found.failed_checks] == list(BARS_CHECKS)
    assert found.options["limits"] == limits
    with pytest.raises(OptionError, match="no check 'sweep_deg'"):
        BarsOptions(limits={"sweep_deg": 3.0})


def test_every_check_of_a_star_has_its_limit():
    asked, _ = measured_star()
    assert tuple(check.name for check in asked.checks) == STAR_CHECKS
    limits = _absurd(asked.checks)
    options = replace(STATED, limits=limits)
    found = measure_star(star_scene()[0], cycles=CYCLES, options=options)
    assert [check.name for check in found.failed_checks] == list(STAR_CHECKS)
    assert found.options["limits"] == limits
    with pytest.raises(OptionError, match="no check 'bars'"):
        StarOptions(limits={"bars": 3.0})


@pytest.mark.parametrize("kind", MEASURED)
def test_copies_are_equal(kind):
    found, _ = MEASURED[kind]()
    assert pickle.loads(pickle.dumps(found)) == found
    assert Record.from_dict(found.to_dict()) == found.record
    light = found.without_details()
    assert light.details is None
    assert light.to_dict() == found.to_dict()
    assert pickle.loads(pickle.dumps(light)) == found
    assert pickle.loads(pickle.dumps(light)).to_dict() == found.to_dict()


@pytest.mark.parametrize("kind", MEASURED)
def test_light_copies_are_small_and_keep_the_deviations(kind):
    found, _ = MEASURED[kind](stated=False)
    stored = pickle.dumps(found.without_details())
    assert len(stored) <= 60_000
    # The slices of a star in four directions are most of its record.
    assert len(pickle.dumps(found.record)) <= {"bars": 15_000, "star": 24_000}[kind]
    light = pickle.loads(stored)
    freq = np.arange(1, 10) * 0.1
    for angle in (0.0, 6.0, 33.0, 90.0):
        one, other = found.response_at(angle), light.response_at(angle)
        assert [other.mtf(f).std for f in freq] == pytest.approx(
            [one.mtf(f).std for f in freq], rel=0.01
        )
        assert other.mtf_nyquist.value == pytest.approx(one.mtf_nyquist.value, abs=1e-6)
        assert other.rer.std == pytest.approx(one.rer.std, rel=0.01)
