"""The KOMPSAT-3 draft: its steps, its biases, its two centres of the RER."""

import math

import numpy as np
import pytest
from closed_form_edge import edge_band, gaussian_pixel_esf, gaussian_pixel_mtf

from acutance.errors import OptionError, SupportError
from acutance.targets.straight.published import KompsatOptions, kompsat_2014
from acutance.targets.straight.published.edge_location import cubic_locations
from acutance.targets.straight.published.kompsat import start_points
from acutance.targets.straight.published.smoothing_spline import fit_smoothing_spline


def test_inflection_is_exact_for_a_cubic():
    x = np.arange(12.0)
    centre = np.array([5.2, 5.5, 5.9])
    u = x - centre[:, None]
    rows = 50 + 20 * u - 0.9 * u**3
    np.testing.assert_allclose(cubic_locations(rows, centre, 0.5), centre, atol=1e-9)


def test_a_row_that_bends_the_wrong_way_shows_no_edge():
    u = np.arange(12.0) - 5.5
    assert np.isnan(cubic_locations((20 * u + 2 * u**3)[None, :], np.array([5.5]), 0.5)).all()


@pytest.mark.parametrize("p", [0.98, 0.5])
def test_spline_is_the_smoothing_spline_of_csaps(p):
    from scipy.interpolate import make_smoothing_spline

    rng = np.random.default_rng(5)
    x = np.sort(rng.uniform(-4, 4, 400))
    y = gaussian_pixel_esf(x) + rng.normal(0, 0.02, 400)
    ours = fit_smoothing_spline(x, y, np.ones(400), smoothness=p, start=-4.0, stop=4.0)
    reference = make_smoothing_spline(x, y, lam=(1 - p) / p)
    inside = np.linspace(x[0], x[-1], 300)
    np.testing.assert_allclose(ours(inside), reference(inside), atol=2e-4)
    slope = reference.derivative()
    np.testing.assert_allclose(ours(inside, 1), slope(inside), atol=5e-3)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_spline_derivatives_match_finite_differences(order):
    x = np.linspace(0, 2, 50)
    spline = fit_smoothing_spline(
        x, np.sin(3 * x), np.ones(50), smoothness=0.9999, start=0.0, stop=2.0
    )
    h = 1e-5
    places = np.array([0.31, 1.02, 1.777])
    numeric = (spline(places + h, order - 1) - spline(places - h, order - 1)) / (2 * h)
    np.testing.assert_allclose(spline(places, order), numeric, rtol=1e-5)


def test_repeated_abscissae_count_as_often_as_they_occur():
    x = np.linspace(-2, 2, 80)
    y = gaussian_pixel_esf(x)
    same = {"smoothness": 0.98, "start": -2.0, "stop": 2.0}
    twice = fit_smoothing_spline(np.tile(x, 2), np.tile(y, 2), np.ones(160), **same)
    weighted = fit_smoothing_spline(x, y, np.full(80, 2.0), **same)
    np.testing.assert_allclose(twice(x), weighted(x), atol=1e-12)


@pytest.mark.parametrize("rows", [40, 80, 200])
def test_smoothing_spline_costs_its_closed_form_at_nyquist(rows):
    trimmed = edge_band(shape=(rows, 40))
    found = kompsat_2014(trimmed, KompsatOptions(replicates=0)).response.mtf_nyquist.value
    gain = 1 / (1 + 0.02 / 0.98 * (2 * np.pi * 0.5) ** 4 / rows)
    assert found / gaussian_pixel_mtf(0.5) == pytest.approx(gain, abs=7e-3)


def test_start_points_stand_at_the_feet_of_the_lsf():
    x = np.linspace(-8, 8, 3000)
    y = gaussian_pixel_esf(x)
    start, stop = start_points(x, y, np.ones_like(x), -8.0, 8.0, 0.98, "bend")
    assert start == pytest.approx(-stop, abs=0.06)
    # 97 % of the rise lies between the two feet of this LSF.
    assert 0.9 < stop < 1.2


def test_start_points_of_the_draft_are_the_inflection_points_of_the_lsf():
    """Step 7a: the second derivative of the LSF is zero there, at one sigma of a Gaussian."""
    x = np.linspace(-8, 8, 3000)
    y = 0.5 * (1 + np.vectorize(math.erf)(x / (0.6 * math.sqrt(2))))
    start, stop = start_points(x, y, np.ones_like(x), -8.0, 8.0, 0.98)
    assert (start, stop) == pytest.approx((-0.6, 0.6), abs=0.04)
    assert KompsatOptions().start == "inflection"


@pytest.mark.parametrize(
    ("sigma_px", "low", "high"), [(0.5, 0.0, 0.006), (0.6, -0.02, -0.005), (0.8, -0.26, -0.12)]
)
def test_inflection_points_cut_the_wings_of_wide_systems(sigma_px, low, high):
    trimmed = edge_band(lambda s: gaussian_pixel_esf(s, sigma_px), angle_deg=7.7, shape=(60, 60))
    drafted, bend = (
        kompsat_2014(trimmed, KompsatOptions(start=at, replicates=0)).response.mtf_nyquist.value
        for at in ("inflection", "bend")
    )
    assert low < drafted / bend - 1 < high


def test_draft_centres_the_rer_on_the_peak_and_half_is_available():
    def skewed(s):
        return 0.75 * gaussian_pixel_esf(s) + 0.25 * gaussian_pixel_esf(s - 1.3, 0.6)

    trimmed = edge_band(skewed, shape=(300, 60))
    # With 1 px the trim would cut the slower side and raise both values.
    stiff = {"replicates": 0, "smoothness": 0.999, "plateau_px": 2.5}
    by_draft = kompsat_2014(trimmed, KompsatOptions(**stiff)).response
    by_half = kompsat_2014(trimmed, KompsatOptions(rer_centre="half", **stiff)).response
    assert by_draft.rer_centre == "peak"
    assert by_half.rer_centre == "half"
    s = np.linspace(-4, 4, 80001)
    esf = skewed(s)
    half, peak = np.interp(0.5, esf, s), s[np.argmax(np.gradient(esf))]
    for response, centre in ((by_draft, peak), (by_half, half)):
        truth = skewed(np.array([centre + 0.5]))[0] - skewed(np.array([centre - 0.5]))[0]
        assert response.rer.value == pytest.approx(truth, abs=6e-3)
    assert by_draft.rer.value - by_half.rer.value > 0.01


def test_a_parametric_esf_is_centred_on_half():
    response = kompsat_2014(edge_band(), KompsatOptions(esf="fermi", start="bend")).response
    assert response.rer_centre == "half"
    # One Fermi function is not a Gaussian with a pixel: +5 % at Nyquist.
    assert response.mtf_nyquist.value / gaussian_pixel_mtf(0.5) == pytest.approx(1.05, abs=0.02)


@pytest.mark.parametrize(("sigma_px", "loss"), [(0.4, -0.31), (0.5, -0.39)])
def test_dividing_by_the_cosine_costs_what_it_must_at_20_degrees(sigma_px, loss):
    def esf(s):
        return gaussian_pixel_esf(s, sigma_px)

    trimmed = edge_band(esf, angle_deg=20.0, shape=(400, 60))
    stiff = {"replicates": 0, "smoothness": 0.999, "start": "bend"}
    drafted = kompsat_2014(trimmed, KompsatOptions(distance="as-drafted", **stiff)).response
    normal = kompsat_2014(trimmed, KompsatOptions(**stiff)).response
    truth = gaussian_pixel_mtf(0.5, sigma_px)
    assert normal.mtf_nyquist.value / truth == pytest.approx(1.0, abs=6e-3)
    assert drafted.mtf_nyquist.value / truth - 1 == pytest.approx(loss, abs=0.012)
    stretched = gaussian_pixel_mtf(0.5 / math.cos(math.radians(20)) ** 2, sigma_px)
    assert drafted.mtf_nyquist.value == pytest.approx(stretched, rel=0.01)


def test_plateaus_that_end_too_soon_are_refused():
    def wide(s):
        return gaussian_pixel_esf(s, 1.5)

    trimmed = edge_band(wide, shape=(40, 9), angle_deg=3.0, offset_px=0.0)
    with pytest.raises(SupportError, match="use a wider region"):
        kompsat_2014(trimmed, KompsatOptions(start="bend"))


@pytest.mark.parametrize(
    "wrong", [{"distance": "row"}, {"smoothness": 1.0}, {"plateau_px": 0.0}, {"esf": "loess"}]
)
def test_meaningless_options_are_refused(wrong):
    with pytest.raises(OptionError, match=r"found|give"):
        KompsatOptions(**wrong)
