"""The impulse method of 2003: its own numbers, and its biases."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.curves import Otf2d
from acutance.targets.points import survey_errors
from acutance.targets.points.published import GaussianPsf, SdsuMirrorsOptions, sdsu_2003_mirrors

# Tables 5.13 and 5.14: FWHM across and along, MTF at Nyquist across and along.
CAMPAIGNS = {
    "2003-08-23": (1.796, 1.764, 0.06, 0.06),
    "2003-09-15": (1.566, 1.610, 0.12, 0.10),
    "2003-10-21": (1.666, 1.647, 0.09, 0.09),
}
# Table 5.9, August 23, mirrors 1 to 20, cm.
ACROSS_CM = [0, 12, -2.4, -2.4, 4, 1.8, 2.4, 1.2, 1.8, -1.8, 0, 2.4, 2.4, -1.2, -1.8, -0.6, 1.8,
             -1.2, 1.8, -1.2]  # fmt: skip
ALONG_CM = [0, 3, -2.4, 1.8, -2.4, 3.6, -1.8, -1.8, -1.8, -1.8, 2.4, 3, 2.4, 1.8, 1.8, 3.6, 2.4,
            1.8, -1.8, 2.4]  # fmt: skip
NO_ERROR = ((0.0, 0.0), (0.0, 0.0))


@pytest.mark.parametrize("date", CAMPAIGNS)
def test_published_widths_give_the_published_mtf(date):
    across, along, mtf_across, mtf_along = CAMPAIGNS[date]
    psf = Otf2d(GaussianPsf(across / 2.3548, along / 2.3548, NO_ERROR))
    for angle, width, mtf in ((0.0, across, mtf_across), (90.0, along, mtf_along)):
        response = psf.response(angle)
        assert response.fwhm_px.value == pytest.approx(width, abs=1e-3)
        assert response.mtf_nyquist.value == pytest.approx(mtf, abs=0.0075)


def test_the_survey_table_has_the_published_rmse():
    """The table gives 3.16 cm across and 2.35 along; 3.31 and 2.31 were printed."""
    surveyed = np.stack([np.arange(20) * 10.2, np.arange(20) * 1.25], axis=1)
    error = np.stack([ALONG_CM, ACROSS_CM], axis=1) / 70.0
    found = survey_errors(surveyed + error, surveyed, pixel_m=(0.7, 0.7), reference="first")
    assert found.errors_cm is not None
    assert found.errors_cm[0] == pytest.approx(ACROSS_CM, abs=1e-6)
    assert found.rmse_cm == pytest.approx((3.31, 2.31), abs=0.17)


def test_gaussians_sampled_as_points_are_found_exactly():
    """The model's own images: sigma 0.7 by 0.8 px, twenty phases."""
    places = np.stack([12 + np.arange(6) * 10.2, 12 + np.arange(6) * 1.25], axis=1)
    rows, cols = np.indices((80, 32))
    image = np.full(rows.shape, 100.0)
    for row, col in places:
        image += 900 * np.exp(-0.5 * (((cols - col) / 0.7) ** 2 + ((rows - row) / 0.8) ** 2))
    found = sdsu_2003_mirrors(image, np.rint(places))
    assert found.psf.sigma_x_px == pytest.approx(0.7, abs=1e-4)
    assert found.psf.sigma_y_px == pytest.approx(0.8, abs=1e-4)
    assert [one.row for one in found.mirrors] == pytest.approx(places[:, 0], abs=1e-4)
    assert found.aligned.peak_over_background == pytest.approx(9.0, rel=0.01)


def test_the_ring_around_nine_pixels_determines_nothing():
    """Section 3.2.2: the area from 3 x 3 to 5 x 5 is not used for the parameters."""
    places = np.array([[12.2, 12.3], [12.4, 30.1], [30.3, 12.1], [30.0, 30.4]])
    rows, cols = np.indices((44, 44))
    image, ring = np.full(rows.shape, 100.0), np.zeros(rows.shape, bool)
    for row, col in places:
        image += 900 * np.exp(-0.5 * (((cols - col) / 0.7) ** 2 + ((rows - row) / 0.8) ** 2))
        away = np.maximum(np.abs(rows - round(row)), np.abs(cols - round(col)))
        ring |= away == 2
    changed = np.where(ring, image + 40.0, image)
    psf, other = (sdsu_2003_mirrors(one, np.rint(places)).psf for one in (image, changed))
    assert other.sigma_x_px == pytest.approx(psf.sigma_x_px, abs=1e-9)
    wide = SdsuMirrorsOptions(window_px=5)
    assert abs(sdsu_2003_mirrors(changed, np.rint(places), wide).psf.sigma_x_px - 0.7) > 0.03


def test_the_background_lies_outside_of_the_widest_window():
    """Which has nine pixels a side: what its outermost ring holds is no background."""
    rows, cols = np.indices((21, 21))
    away = np.maximum(np.abs(rows - 10), np.abs(cols - 10))
    image = 100.0 + 900 * np.exp(-0.5 * (np.hypot(rows - 10, cols - 10) / 0.7) ** 2)
    found = sdsu_2003_mirrors(image + 50.0 * (away == 4), np.array([[10, 10]]))
    assert found.aligned.background_mean == pytest.approx(100.0, abs=1e-6)


def test_places_alone_are_aligned_unless_each_source_is_scaled():
    """One mirror of four at half the light: it is half as high in the common fit, or as high."""
    places = np.array([[12.2, 12.3], [12.4, 30.1], [30.3, 12.1], [30.0, 30.4]])
    rows, cols = np.indices((44, 44))
    image = np.full(rows.shape, 100.0)
    for (row, col), peak in zip(places, (900, 900, 900, 450), strict=True):
        image += peak * np.exp(-0.5 * (((cols - col) / 0.7) ** 2 + ((rows - row) / 0.8) ** 2))
    plain = sdsu_2003_mirrors(image, np.rint(places))
    scaled = sdsu_2003_mirrors(image, np.rint(places), SdsuMirrorsOptions(scaled=True))
    assert plain.value.reshape(4, 9).max(axis=1)[3] < 0.65
    assert plain.aligned.rmse > 30
    assert scaled.value.reshape(4, 9).max(axis=1)[3] > 0.8
    assert scaled.aligned.rmse < 1e-3
    for found in (plain, scaled):
        assert found.aligned.mean_peak == pytest.approx(3150 / 4, rel=0.03)


def test_mirrors_of_a_sharp_sensor_are_measured_as_the_report_does():
    """Without noise, 20 mirrors: nearly right, where scaled mirrors are a tenth too high."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.35), ac.optics.Detector()])
    image, truth = ac.simulate.points(sensor)
    mtf = [
        Otf2d(sdsu_2003_mirrors(image, np.rint(truth.positions), options).psf)
        .response(0.0)
        .mtf_nyquist.value
        for options in (SdsuMirrorsOptions(), SdsuMirrorsOptions(window_px=5, scaled=True))
    ]
    assert truth.response("across").mtf_nyquist.value == pytest.approx(0.348, abs=1e-3)
    assert mtf == pytest.approx([0.347, 0.379], abs=2e-3)


@pytest.mark.parametrize("unit", [1.0, 1e-4, 1e-6, 1e4])
@pytest.mark.parametrize("level", [-300.0, 100.0])
def test_a_mirror_without_a_width_of_its_own_is_left_out(unit, level):
    """Two rows hold all of its light: the narrower and the brighter a Gaussian, the better."""
    places = np.stack([12 + np.arange(6) * 10.2, 12 + np.arange(6) * 1.25], axis=1)
    rows, cols = np.indices((80, 32))
    image = level + np.random.default_rng(3).normal(scale=2.0, size=rows.shape)
    for row, col in places:
        height = 0.8 if row != places[3, 0] else 0.2
        image += 900 * np.exp(-0.5 * (((cols - col) / 0.7) ** 2 + ((rows - row) / height) ** 2))
    middle = round(places[3, 0])
    image[middle - 1, :] = image[middle, :]
    found = sdsu_2003_mirrors(unit * image, np.rint(places))
    (left_out,) = found.left_out
    assert (left_out.row, left_out.reason) == (middle, "no minimum")
    assert [one.row for one in found.mirrors] == pytest.approx(np.delete(places[:, 0], 3), abs=0.01)
    assert found.psf.sigma_x_px == pytest.approx(0.7, abs=0.003)
    assert found.psf.sigma_y_px == pytest.approx(0.8, abs=0.003)
    assert found.aligned.rmse == pytest.approx(2.0 * unit, rel=0.2)


def test_no_source_with_a_gaussian_says_why():
    image = 100 + np.random.default_rng(2).normal(size=(24, 24))
    image[12, 12] = np.nan
    with pytest.raises(ac.SupportError, match=r"none of 1 sources .* are missing: choose"):
        sdsu_2003_mirrors(image, np.array([[12.0, 12.0]]))


def test_a_background_below_zero_has_no_ratio_in_a_document():
    place = np.array([[12.0, 12.0]])
    rows, cols = np.indices((24, 24))
    bell = np.exp(-0.5 * (((cols - 12) / 0.7) ** 2 + ((rows - 12) / 0.8) ** 2))
    below, above = (sdsu_2003_mirrors(level + 900 * bell, place) for level in (-50.0, 100.0))
    assert below.aligned.to_dict()["peak_over_background"] is None
    assert above.aligned.to_dict()["peak_over_background"] == pytest.approx(9.0, rel=0.01)


def test_for_images_of_its_own_model_the_stated_deviations_are_the_scatter():
    rows, cols = np.indices((80, 32))
    u, v = np.array([0.25, 0.0]), np.array([0.0, 0.25])
    truth = GaussianPsf(0.7, 0.8, NO_ERROR).otf(u, v)
    errors = []
    for seed in range(30):
        rng = np.random.default_rng([3, seed])
        shift = rng.uniform(0, 1, (1, 2))
        places = np.stack([12 + np.arange(6) * 10.2, 12 + np.arange(6) * 1.25], axis=1) + shift
        image = 100 + rng.normal(scale=10.0, size=rows.shape)
        for row, col in places:
            image += 900 * np.exp(-0.5 * (((cols - col) / 0.7) ** 2 + ((rows - row) / 0.8) ** 2))
        psf = sdsu_2003_mirrors(image, np.rint(places)).psf
        errors.append((psf.otf(u, v) - truth).real / np.linalg.norm(psf.factor(u, v), axis=1))
    assert 0.95 < np.sqrt(np.mean(np.square(errors))) < 1.3


def test_windows_have_odd_sides():
    with pytest.raises(ac.OptionError, match="window_px is 4"):
        SdsuMirrorsOptions(window_px=4)
