"""Checks of points: every name is asked, every limit decides."""

from __future__ import annotations

import math

import numpy as np
import pytest

import acutance as ac
from acutance.targets import QUESTIONS
from acutance.targets.points import POINTS_CHECKS, PointsOptions
from acutance.targets.points.checks import phase_gap_px

SENSOR = ac.Sensor([ac.optics.Gaussian(0.45), ac.optics.Detector()])
LAYOUT = ac.simulate.mirror_columns((12.3, 12.1), count=3)
ABSURD = {name: math.inf if QUESTIONS[name].sense == ">=" else -math.inf for name in POINTS_CHECKS}


@pytest.fixture(scope="module")
def image():
    found, _ = ac.simulate.points(
        SENSOR, positions=LAYOUT, peak=30000.0, background=3000.0, snr=200.0,
        rng=np.random.default_rng(2),
    )  # fmt: skip
    # Unsigned integers have an end of the scale.
    return np.rint(found).astype(np.uint16)


def test_every_check_is_asked_and_no_other(image):
    found = ac.measure_points(image, positions=LAYOUT, surveyed=LAYOUT)
    assert {one.name for one in found.checks} == set(POINTS_CHECKS)
    assert {one.name for one in found.failed_checks} == {"sources", "phase_gap_px"}
    assert found.verdict.word == "usable"


@pytest.mark.parametrize("method", ["psf-fit", "gaussian-2003"])
def test_every_limit_can_fail(image, method):
    found = ac.measure_points(
        image,
        positions=LAYOUT,
        surveyed=LAYOUT,
        method=method,
        options=PointsOptions(limits=ABSURD),
    )
    assert found.failed_checks == tuple(found.checks)
    assert {one.name: one.limit for one in found.checks}.items() <= ABSURD.items()
    assert found.to_dict()["options"]["limits"] == ABSURD


def test_messages_say_what_was_found_and_what_to_do(image):
    found = {one.name: one for one in ac.measure_points(image).checks}
    assert found["sources"].message.startswith("6 sources were measured: ")
    assert "15 to 20" in found["sources"].message
    assert found["spacing_px"].message == "the two nearest sources are 10.3 px apart"


def test_parts_of_a_tarp_are_no_points():
    tarp, _ = ac.simulate.pulse(
        SENSOR, width_px=3.0, angle_deg=6.0, shape=(60, 40), snr=50, rng=np.random.default_rng(1)
    )
    found = ac.measure_points(tarp)
    assert found.verdict.word == "invalid"
    assert "no images of points" in found.verdict.sentence


def test_a_limit_without_a_check_is_refused():
    with pytest.raises(ac.OptionError, match="no check 'ground'"):
        PointsOptions(limits={"ground": 0.1})
    with pytest.raises(ac.OptionError, match="has to be a number"):
        PointsOptions(limits={"sources": "many"})


def test_the_gap_of_the_phases_is_that_of_their_grid():
    """Steps of 0.2 by 0.25 px: the middle of a cell is 0.16 px from its corners."""
    steps = np.stack(np.meshgrid(np.arange(5) * 0.2, np.arange(4) * 0.25), axis=-1).reshape(-1, 2)
    assert phase_gap_px(steps) == pytest.approx(0.16, abs=0.005)


def test_outliers_are_counted(image):
    """90 of 1840 pixels are off by 8 times the noise: too faint to be covered as spots."""
    spoilt = image.copy()
    rng = np.random.default_rng(4)
    rows, cols = (rng.integers(0, size, 90) for size in image.shape)
    spoilt[rows, cols] += 1200
    found = ac.measure_points(spoilt, positions=LAYOUT)
    failed = {one.name: one.value for one in found.failed_checks}
    assert 0.02 < failed["outliers"] < 0.06


def test_noise_that_neighbours_share_widens_the_intervals():
    """A mean of 2 by 2 pixels is low-pass above all along the diagonals."""
    rng = np.random.default_rng(3)
    clean, _ = ac.simulate.points(SENSOR, positions=LAYOUT)
    white = rng.normal(scale=12.0, size=clean.shape)
    shared = sum(np.roll(white, lag, (0, 1)) for lag in ((0, 0), (0, 1), (1, 0), (1, 1))) / 2
    plain, resampled = (
        ac.measure_points(clean + noise, positions=LAYOUT) for noise in (white, shared)
    )
    assert {one.name: one.value for one in plain.checks}["correlated_noise"] == 0.0
    assert {one.name: one.value for one in resampled.failed_checks}["correlated_noise"] > 0.35
    # The power of such noise at zero frequency is four times that of white noise.
    assert plain.details.fit.correlation.inflation == 1.0
    assert 2.5 < resampled.details.fit.correlation.inflation < 5.0
    widened = resampled.across.mtf_nyquist.std / plain.across.mtf_nyquist.std
    assert 1.3 < widened < 2.2


def test_positions_without_sources_are_doubted(image):
    elsewhere = np.concatenate([LAYOUT[:1], LAYOUT[1:] + 4.5])
    found = ac.measure_points(image, positions=elsewhere)
    failed = next(one for one in found.failed_checks if one.name == "positions")
    assert f"at {len(LAYOUT) - 1} of the {len(LAYOUT)} positions" in failed.message
    assert found.verdict.word == "doubtful"
