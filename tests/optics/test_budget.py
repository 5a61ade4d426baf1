"""Budgets, curves on the ground, and the PSF of a numerical model."""

import math

import numpy as np
import pytest

from acutance.errors import ModelError
from acutance.optics import (
    BLOCKS,
    Detector,
    Exponential,
    Gaussian,
    RasterPsf,
    Sensor,
    Sharpening,
    Smear,
    budget,
    describe_block,
    numerical_psf,
    on_the_ground,
    preset,
    presets,
    psf_on_the_ground,
)
from acutance.simulate import reference_systems

GENERIC = preset("generic-2005")
OBLONG = Sensor([Gaussian(0.5), Detector()], gsd_m=0.7, gsd_along_m=0.9)


@pytest.mark.parametrize("name", presets())
@pytest.mark.parametrize("freq", [0.0, 0.3, 0.5])
def test_the_rows_multiply_to_the_whole(name, freq):
    sensor = preset(name)
    table = budget(sensor, freq)
    assert math.prod(row.across for row in table.rows) == pytest.approx(table.across)
    assert math.prod(row.along for row in table.rows) == pytest.approx(table.along)
    assert table.across == pytest.approx(sensor.mtf(0.0, "across")(freq).value)
    assert table.along == pytest.approx(sensor.mtf(0.0, "along")(freq).value)


@pytest.mark.parametrize("name", reference_systems())
def test_every_kind_of_block_has_a_budget(name):
    table = budget(reference_systems()[name])
    assert math.prod(row.across for row in table.rows) == pytest.approx(table.across)


def test_a_block_of_one_frequency_gives_one_number():
    sharpening = Sharpening.both_axes(0.2)
    assert np.shape(sharpening.otf(np.float64(0.5), np.float64(0.0))) == ()
    row = budget(Sensor([Detector(), sharpening])).rows[1]
    assert row.across == pytest.approx(1.0 + 4 * 0.2)


def test_the_budget_of_the_generic_sensor():
    rows = budget(GENERIC).rows
    expected = [math.exp(-2 * (math.pi * 0.39 * 0.5) ** 2), 2 / math.pi]
    assert [row.across for row in rows[:2]] == pytest.approx(expected)
    assert (rows[2].across, rows[2].along) == pytest.approx((1.0, np.sinc(0.125)))
    assert rows[3].along == pytest.approx(1 / (1 + (0.5 / 1.4) ** 2))
    assert [row.description for row in rows] == [
        "Gaussian sigma 0.39 px",
        "Detector width 1 px",
        "Smear length 0.25 px, axis along",
        "Butterworth cutoff 1.4 c/px",
    ]
    assert all(row.formula and row.source for row in rows)
    assert budget(OBLONG).freq_cpm == pytest.approx((0.5 / 0.7, 0.5 / 0.9))
    assert budget(Sensor([Detector()])).freq_cpm is None


def test_blocks_of_ones_own_have_a_row_too():
    psf = RasterPsf(np.ones((1, 1)), 0.05)
    row = budget(Sensor([psf])).rows[0]
    assert (row.description, row.formula) == ("RasterPsf step 0.05 px", "")
    with pytest.raises(ModelError, match="at least 0"):
        budget(GENERIC, -0.1)


def test_every_block_is_in_the_catalogue():
    assert all(kind.make.__name__ == name for name, kind in BLOCKS.items())
    assert describe_block(Gaussian(0.4, 0.5)) == "Gaussian sigma 0.4 px, sigma along 0.5 px"


@pytest.mark.parametrize(("orientation", "gsd"), [("across", 0.7), ("along", 0.9)])
def test_curves_on_the_ground(orientation, gsd):
    response = OBLONG.response(0.0, orientation)
    ground = on_the_ground(response)
    assert ground.gsd_m == pytest.approx(gsd)
    assert np.trapezoid(ground.lsf_per_m, ground.distance_m) == pytest.approx(1.0, abs=1e-6)
    at_nyquist = np.interp(ground.nyquist_cpm, ground.freq_cpm, ground.mtf)
    assert at_nyquist == pytest.approx(response.mtf_nyquist.value)
    half = 0.5 * ground.lsf_per_m.max()
    width = np.ptp(ground.distance_m[ground.lsf_per_m > half])
    assert width == pytest.approx(response.fwhm_m.value, abs=0.1)
    with pytest.raises(ModelError, match="need the GSD"):
        on_the_ground(Sensor([Detector()]).response())


def test_the_psf_on_the_ground():
    sensor = Sensor([Gaussian(0.5)], gsd_m=0.7, gsd_along_m=0.9)
    x, psf = psf_on_the_ground(sensor, 4.0, 0.1)
    sigma_x, sigma_y = 0.35, 0.45
    expected = np.exp(-0.5 * (x[None, :] / sigma_x) ** 2 - 0.5 * (x[:, None] / sigma_y) ** 2)
    np.testing.assert_allclose(psf, expected / (2 * math.pi * sigma_x * sigma_y), atol=1e-10)
    with pytest.raises(ModelError, match=r"below 0\.35"):
        psf_on_the_ground(sensor, 4.0, 0.4)
    with pytest.raises(ModelError, match="needs the GSD"):
        psf_on_the_ground(Sensor([Gaussian(0.5)]))


def test_samples_of_a_known_psf_have_its_otf():
    step, places = 0.05, np.arange(-100, 101) * 0.05
    line = np.exp(-0.5 * (places / 0.4) ** 2)
    psf = RasterPsf(np.outer(line, line) / line.sum() ** 2, step)
    u = np.array([0.0, 0.2, 0.5, -0.7])
    np.testing.assert_allclose(psf.otf(u, u[::-1]), Gaussian(0.4).otf(u, u[::-1]), atol=1e-12)
    grid = psf.otf(u, u[:, None])
    np.testing.assert_allclose(grid, Gaussian(0.4).otf(u, u[:, None]), atol=1e-12)
    transposed = psf.otf(u[:, None], u[:3])
    np.testing.assert_allclose(transposed, Gaussian(0.4).otf(u[:, None], u[:3]), atol=1e-12)
    assert abs(psf.otf(20.3, 0.0)) == pytest.approx(abs(psf.otf(0.3, 0.0)))


def test_the_numerical_psf_draws_rectangles_with_samples():
    """The 20 samples of a detector transfer sin(20 x) / (20 sin x), not a sinc."""
    psf = numerical_psf(GENERIC)
    assert psf.samples.shape == (100, 100)
    assert psf.samples.sum() == pytest.approx(1.0)
    row = math.sin(math.pi * 0.5) / (20 * math.sin(math.pi * 0.025))
    expected = np.prod([one.across for one in budget(GENERIC).rows]) * row / (2 / math.pi)
    assert abs(psf.otf(0.5, 0.0)) == pytest.approx(expected, abs=5e-5)
    # Printed as .2684; the raster explains .0003 of the .0019 above the closed form.
    assert abs(psf.otf(0.5, 0.0)) == pytest.approx(0.2668, abs=5e-5)
    assert abs(psf.otf(0.0, 0.5)) == pytest.approx(0.2603, abs=5e-5)
    assert abs(np.angle(psf.otf(0.3, 0.4))) < 1e-12


def test_a_numerical_psf_makes_a_whole_system():
    psf = numerical_psf(GENERIC)
    whole = Sensor([psf, Detector(psf.step_px)], gsd_m=1.0).response(6.0)
    exact = GENERIC.response(6.0)
    assert np.max(np.abs(whole.mtf.value[:51] - exact.mtf.value[:51])) < 5e-4
    assert whole.fwhm_m.value == pytest.approx(exact.fwhm_m.value, abs=2e-3)


def test_asymmetric_and_odd_kernels_stay_in_place():
    sensor = Sensor([Gaussian(0.4), Exponential(0.2), Detector(0.95), Smear(0.35)])
    psf = numerical_psf(sensor, trim_px=8.0)
    assert psf.samples.shape == (161, 161)
    u = np.array([0.1, 0.3, 0.5])
    np.testing.assert_allclose(psf.otf(u, u), sensor.otf(u, u), atol=2e-3)


@pytest.mark.parametrize("wrong", [{"subpixels": 1}, {"trim_px": 0.5}, {"trim_px": 40.0}])
def test_grids_that_mean_nothing_are_refused(wrong):
    with pytest.raises(ModelError, match="2 to 100 samples and 1 to 16 px"):
        numerical_psf(GENERIC, **wrong)
