"""Directions of a measurement of points: phase, axes, along track, GSDs."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac

LEANING = ac.Sensor(
    [
        ac.optics.Gaussian(0.4),
        ac.optics.Exponential(0.5, "across"),
        ac.optics.Exponential(0.25, "along"),
        ac.optics.Smear(0.8, "along"),
        ac.optics.Detector(),
    ]
)
LAYOUT = ac.simulate.mirror_columns((12.3, 12.1), count=5)
UP_TO_NYQUIST = slice(0, 51)


@pytest.fixture(scope="module")
def scene():
    return ac.simulate.points(LEANING, positions=LAYOUT)


@pytest.fixture(scope="module")
def measured(scene):
    image, _ = scene
    return ac.measure_points(image, positions=LAYOUT, gsd_m=ac.Gsd(0.5, 0.8))


@pytest.mark.parametrize("angle_deg", [0.0, 33.0, 90.0, 140.0])
def test_modulus_and_phase_are_those_of_the_sensor(measured, angle_deg):
    true = LEANING.response_along(angle_deg).mtf.otf[UP_TO_NYQUIST]
    found = measured.response_at(angle_deg).mtf.otf[UP_TO_NYQUIST]
    # The sensor has a phase to get wrong: its conjugate lies far off.
    assert np.abs(true - true.conj()).max() > 0.04
    assert np.abs(found - true).max() < 0.003


def test_across_and_along_are_not_exchanged(measured):
    for name, angle_deg in (("across", 0.0), ("along", 90.0)):
        response, true = getattr(measured, name), LEANING.response_along(angle_deg)
        assert np.abs(response.mtf.value - true.mtf.value)[UP_TO_NYQUIST].max() < 0.003
        assert response.fwhm_px.value == pytest.approx(true.fwhm_px.value, abs=0.02)
    other = LEANING.response_along(90.0).mtf.value - LEANING.response_along(0.0).mtf.value
    assert np.abs(other[UP_TO_NYQUIST]).max() > 0.05


def test_the_psf_trails_to_higher_columns(measured):
    distance_px, psf = measured.psf(4.0, 0.1)
    light = psf.sum(axis=0)
    middle = light @ distance_px / light.sum()
    skew = light @ (distance_px - middle) ** 3 / light.sum()
    assert skew > 0.1


def test_metres_are_those_of_the_direction(measured):
    assert measured.image.pixel_gsd_m == (0.5, 0.8)
    assert measured.image.gsd_m is None
    assert measured.across.fwhm_m.value == pytest.approx(0.8 * measured.across.fwhm_px.value)
    assert measured.along.fwhm_m.value == pytest.approx(0.5 * measured.along.fwhm_px.value)


@pytest.mark.parametrize("method", ["psf-fit", "gaussian-2003"])
def test_a_transposed_image_flown_along_its_rows_gives_the_same(scene, method):
    image, _ = scene
    error = 0.05 * np.random.default_rng(5).normal(size=LAYOUT.shape)
    gsd = ac.Gsd(0.5, 0.8)
    upright = ac.measure_points(
        ac.Image.from_array(image, gsd_m=gsd), surveyed=LAYOUT + error, method=method
    )
    turned = ac.measure_points(
        ac.Image.from_array(image.T, gsd_m=ac.Gsd(0.8, 0.5), along_track="x"),
        surveyed=(LAYOUT + error)[:, ::-1],
        method=method,
    )
    assert turned.image.along_track == "x"
    assert turned.record.image.along_track == "x"
    for name in ("across", "along"):
        one, other = getattr(upright, name), getattr(turned, name)
        assert other.mtf.otf == pytest.approx(one.mtf.otf, abs=2e-5)
        for number, value in one.metrics().items():
            assert other.metrics()[number].value == pytest.approx(value.value, abs=2e-4), number
    assert turned.survey.rmse_px == pytest.approx(upright.survey.rmse_px, abs=1e-5)
    assert turned.survey.rmse_cm == pytest.approx(upright.survey.rmse_cm, abs=1e-3)


def test_a_survey_is_compared_in_its_own_directions(scene):
    """Surveyed 0.3 px off to and fro in columns only: 24 cm across at 0.8 m, none along."""
    image, _ = scene
    surveyed = LAYOUT + np.array([[0.0, 0.3], [0.0, -0.3]] * 5)
    found = ac.measure_points(image, surveyed=surveyed, gsd_m=ac.Gsd(0.5, 0.8))
    assert found.survey.rmse_px == pytest.approx((0.3, 0.0), abs=0.002)
    assert found.survey.rmse_cm == pytest.approx((24.0, 0.0), abs=0.2)
    assert [one.name for one in found.failed_checks if one.name == "survey_px"]
