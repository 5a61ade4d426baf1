"""Surveys that are off as a whole."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.errors import OptionError
from acutance.targets.points import survey_errors

COLUMN = np.stack([16 + np.arange(10) * 10.2, 16 + np.arange(10) * 1.25], axis=1)
SQUARE = np.array([(20 + 5.25 * row, 20 + 5.25 * col) for row in range(4) for col in range(4)])
ERROR = np.random.default_rng(1).normal(0, 0.02, (16, 2))


@pytest.mark.parametrize("shift", [(0.0, 0.0), (2.5, -1.0), (5.0, 3.0), (-12.0, 15.0)])
@pytest.mark.parametrize("layout", [COLUMN, SQUARE], ids=["column", "square"])
def test_the_shift_is_found_and_reported(layout, shift):
    surveyed = layout - np.array(shift) + ERROR[: len(layout)]
    found = survey_errors(layout, surveyed)
    assert found.point.tolist() == found.source.tolist() == list(range(len(layout)))
    assert found.shift_px == pytest.approx(shift[::-1], abs=0.02)
    assert max(found.rmse_px) < 0.04
    assert found.rival_px is None


def test_a_grid_is_not_matched_one_spacing_off():
    """Shifted by more than half of the spacing, with a mirror missing."""
    found = survey_errors(np.delete(SQUARE, 3, axis=0), SQUARE + np.array([3.0, 3.0]))
    assert found.shift_px == pytest.approx((-3.0, -3.0), abs=1e-6)
    assert len(found.point) == 15


def test_of_a_part_of_a_grid_the_smaller_shift_is_taken_and_the_other_said():
    part = SQUARE[:12]
    found = survey_errors(SQUARE, part + np.array([1.5, 0.0]))
    assert found.shift_px == pytest.approx((0.0, -1.5), abs=1e-6)
    assert found.rival_px == pytest.approx((0.0, 3.75), abs=1e-6)


def test_a_survey_of_another_place_matches_nothing():
    rng = np.random.default_rng(3)
    with pytest.raises(OptionError, match="surveyed positions lie within 2 px"):
        survey_errors(COLUMN, COLUMN + rng.uniform(200, 300, COLUMN.shape))


def test_a_survey_that_matches_nothing_leaves_the_measurement():
    sensor = ac.Sensor([ac.optics.Gaussian(0.45), ac.optics.Detector()])
    image, truth = ac.simulate.points(sensor, snr=60, rng=np.random.default_rng(8))
    found = ac.measure_points(image, surveyed=truth.positions + 500.0)
    [failed] = [one for one in found.checks if one.name == "survey_px"]
    assert not failed.passed
    assert "0 of 20 surveyed positions lie within 2 px" in failed.message
    assert found.survey is None
    assert len(found.sources) == 20
    assert found.to_dict()["survey"] is None
    shifted = ac.measure_points(image, surveyed=truth.positions + 5.0)
    assert shifted.survey.shift_px == pytest.approx((-5.0, -5.0), abs=0.02)
