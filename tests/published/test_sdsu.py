"""The South Dakota State University pipeline: its steps, and the gains they are known for."""

import math

import numpy as np
import pytest
from closed_form_edge import edge_band, gaussian_pixel_mtf

import acutance as ac
from acutance import simulate
from acutance.errors import OptionError, PhaseError, SupportError
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.published import SdsuOptions, sdsu_2005
from acutance.targets.straight.published.edge_location import (
    fermi_locations,
    fermi_sum_locations,
)
from acutance.targets.straight.published.local_polynomial import modified_savitzky_golay

NYQUIST = 0.5
IRRATIONAL_DEG = math.degrees(math.atan((math.sqrt(5) - 1) / 6))


@pytest.mark.parametrize(("order", "gain"), [(2, 0.98016), (4, 0.99958)])
def test_window_has_its_published_gain_at_nyquist(order, gain):
    x = np.arange(-4, 4, 0.0005) + 0.00025
    grid = np.arange(-40, 41) * 0.05
    smoothed = modified_savitzky_golay(
        x, np.cos(2 * np.pi * NYQUIST * x), np.ones_like(x), grid, order
    )
    assert smoothed[40] == pytest.approx(gain, abs=2e-5)


@pytest.mark.parametrize(("order", "gain"), [(2, 0.98016), (4, 0.99958)])
def test_pipeline_along_the_normal_has_the_gains_of_its_steps(order, gain):
    trimmed = edge_band(angle_deg=IRRATIONAL_DEG, shape=(500, 40))
    options = SdsuOptions(order=order, distance="normal", smoothing_points=0, replicates=0)
    found = sdsu_2005(trimmed, options).response.mtf_nyquist.value
    expected = gain * np.sinc(NYQUIST * 0.05) * gaussian_pixel_mtf(NYQUIST)
    # Line and finite number of samples leave 1e-3.
    assert found / expected == pytest.approx(1.0, abs=1.5e-3)


def test_adjacent_difference_costs_its_sinc():
    trimmed = edge_band(angle_deg=IRRATIONAL_DEG, shape=(300, 60))
    response = sdsu_2005(trimmed, SdsuOptions(smoothing_points=0, replicates=0)).response
    x = response.esf.distance_px
    slope = np.gradient(response.esf.value, x, edge_order=2)
    for freq in (0.5, 0.8):
        # np.gradient is a central difference: its own gain is known, too.
        exact = abs(np.sum(slope * np.exp(-2j * np.pi * freq * x))) * 0.05
        exact /= np.sinc(2 * freq * 0.05)
        found = abs(response.mtf.otf[round(freq * 100)])
        assert found / exact == pytest.approx(np.sinc(freq * 0.05), abs=4e-4)


@pytest.mark.parametrize("angle_deg", [6.0, 13.0])
def test_row_distance_stretches_the_frequency_axis(angle_deg):
    trimmed = edge_band(angle_deg=angle_deg, shape=(300, 60))
    row = sdsu_2005(trimmed, SdsuOptions(replicates=0)).response
    for freq in (0.25, 0.5):
        truth = gaussian_pixel_mtf(freq / math.cos(math.radians(angle_deg)))
        assert row.mtf(freq).value / truth == pytest.approx(1.0, abs=4e-3)
    assert SdsuOptions().distance == "row"


def test_normal_distance_of_a_small_region_is_nearly_unbiased():
    response = sdsu_2005(edge_band(), SdsuOptions(distance="normal")).response
    assert response.mtf_nyquist.value / gaussian_pixel_mtf(0.5) == pytest.approx(1, abs=4e-3)
    assert response.rer.value == pytest.approx(0.6823, abs=2e-3)
    assert response.fwhm_px.value == pytest.approx(1.2084, abs=6e-3)


def test_fermi_location_is_exact_for_a_fermi_edge():
    rng = np.random.default_rng(3)
    centre = 20 + rng.uniform(-0.5, 0.5, 30)
    x = np.arange(40)
    rows = 300 + 900 / (1 + np.exp(-(x - centre[:, None]) / 0.35))
    found = fermi_locations(rows, centre + rng.normal(0, 0.2, 30), 0.6)
    np.testing.assert_allclose(found, centre, atol=1e-6)


def test_sum_of_fermi_functions_is_exact_for_edges_that_shoot_unequally():
    rng = np.random.default_rng(3)
    centre = 20 + rng.uniform(-0.5, 0.5, 30)
    u = (np.arange(40) - centre[:, None]) / 0.45
    rows = 300 + 900 * sum(
        height / (1 + np.exp(offset - u)) for height, offset in ((1.3, 0), (-0.1, -4), (-0.2, 4))
    )
    expected = centre + rng.normal(0, 0.2, 30)
    np.testing.assert_allclose(fermi_sum_locations(rows, expected, 0.6), centre, atol=1e-5)
    assert np.ptp(fermi_locations(rows, expected, 0.6) - centre) > 0.01


@pytest.mark.parametrize(("rows", "one_deg", "sum_deg"), [(20, 0.2, 0.08), (40, 0.06, 0.02)])
def test_sum_places_edges_of_sharpened_products(rows, one_deg, sum_deg):
    """QuickBird report, 3.3.1: what the sum is for; without lobes one function is as good."""
    optics = ac.optics
    blurred = [optics.Gaussian(0.5), optics.Detector()]

    def largest_error(sensor, location):
        errors = []
        for angle_deg in (5.3, 6.0, 7.7):
            image, truth = simulate.edge(sensor, angle_deg=angle_deg, shape=(rows, 40))
            trimmed = EdgePixels(image, truth.line, truth.dark, truth.bright, 0.5, 0.0)
            options = SdsuOptions(order=2, location=location, replicates=0)
            line = sdsu_2005(trimmed, options).line
            errors.append(abs(line.normal_deg - truth.line.normal_deg))
        return max(errors)

    sharpened = ac.Sensor([*blurred, optics.Sharpening.both_axes(0.3)])
    assert largest_error(sharpened, "fermi") > one_deg
    assert largest_error(sharpened, "fermi-sum") < sum_deg
    assert largest_error(ac.Sensor(blurred), "fermi-sum") < 0.07


def test_places_do_not_depend_on_the_unit():
    """Narrow edges: all but one or two of the seven pixels are on a plateau."""
    rng = np.random.default_rng(1)
    centre = rng.uniform(8, 11, 60)
    rows = 1 / (1 + np.exp((centre[:, None] - np.arange(20)) / 0.15))
    rows += rng.normal(scale=0.01, size=rows.shape)
    one, *others = (fermi_locations(unit * rows, centre, 0.3) for unit in (1.0, 1e-9, 1e9))
    for other in others:
        np.testing.assert_allclose(other, one, atol=1e-7)


def test_fermi_location_survives_a_step_within_one_pixel():
    rows = np.where(np.arange(30) < 15, 100.0, 900.0)[None, :].repeat(4, axis=0)
    found = fermi_locations(rows, np.full(4, 14.4), 0.5)
    assert np.all(np.abs(found - 14.5) < 0.3)


def test_a_band_narrower_than_the_trim_is_refused_and_says_why():
    with pytest.raises(
        SupportError, match=r"needs 5\.7 px .* method_options with a smaller trim_px"
    ):
        sdsu_2005(edge_band(shape=(40, 10), angle_deg=3.0, offset_px=0.0))


def test_a_shorter_trim_measures_that_band():
    response = sdsu_2005(
        edge_band(shape=(40, 10), angle_deg=6.0, offset_px=0.0),
        SdsuOptions(trim_px=5.0, smoothing_points=9, distance="normal"),
    ).response
    assert response.mtf_nyquist.value == pytest.approx(gaussian_pixel_mtf(0.5), rel=0.02)


@pytest.mark.parametrize(
    "wrong",
    [
        {"order": 3},
        {"distance": "column"},
        {"trim_px": 1.0},
        {"location": "cubic"},
        {"smoothing_points": 8},
    ],
)
def test_meaningless_options_are_refused(wrong):
    with pytest.raises(OptionError, match="found"):
        SdsuOptions(**wrong)


@pytest.mark.parametrize("beside_deg", [-0.03, 0.0, 0.06])
def test_quartic_over_four_phases_is_refused_and_a_parabola_is_not(beside_deg):
    # Measured all the same, the sharpened system is wrong by up to .2 near tan = 1/4.
    sensor = simulate.reference_systems()["sharpened"]
    angle_deg = math.degrees(math.atan(0.25)) + beside_deg
    image, truth = simulate.edge(sensor, angle_deg=angle_deg, shape=(40, 60), offset_px=0.1)
    trimmed = EdgePixels(image, truth.line, truth.dark, truth.bright, 0.5, 0.0)
    with pytest.raises(PhaseError, match=r"gives 4 distinct .* or a polynomial of order 2"):
        sdsu_2005(trimmed, SdsuOptions(distance="normal", order=4))
    fit = sdsu_2005(trimmed, SdsuOptions(distance="normal", order=2, replicates=0))
    assert fit.response.mtf(0.25).value == pytest.approx(truth.mtf(0.25).value, abs=0.015)


def test_longer_edge_gives_a_quartic_its_phases_again():
    sensor = simulate.reference_systems()["sharpened"]
    image, truth = simulate.edge(sensor, angle_deg=13.9, shape=(110, 70))
    trimmed = EdgePixels(image, truth.line, truth.dark, truth.bright, 0.5, 0.0)
    fit = sdsu_2005(trimmed, SdsuOptions(distance="normal", order=4, replicates=0))
    assert fit.response.mtf(0.25).value == pytest.approx(truth.mtf(0.25).value, abs=2e-3)


@pytest.mark.parametrize("offset_px", [0.0, 0.03, 0.4])
@pytest.mark.parametrize("phases", [7, 10, 11, 13])
def test_phases_next_to_a_tenth_of_a_pixel_apart_are_enough_for_a_quartic(phases, offset_px):
    sensor = simulate.reference_systems()["sharpened"]
    angle_deg = math.degrees(math.atan(1 / phases))
    image, truth = simulate.edge(
        sensor, angle_deg=angle_deg, shape=(60, 50), offset_px=offset_px, snr=200,
        rng=np.random.default_rng(phases),
    )  # fmt: skip
    trimmed = EdgePixels(image, truth.line, truth.dark, truth.bright, 0.005 * 1000, 0.0)
    fit = sdsu_2005(trimmed, SdsuOptions(distance="normal", order=4, replicates=0))
    assert fit.response.mtf(0.25).value == pytest.approx(truth.mtf(0.25).value, abs=0.02)
