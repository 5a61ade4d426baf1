"""The reference estimator on simulated edges: accuracy, invariance, noise, outliers."""

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import acutance.simulate as sim
from acutance.errors import NoEdgeError
from acutance.geometry.line import Line
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.simulate.noise import Noise
from acutance.simulate.resample import Regrid
from acutance.targets.straight.fit_edge import fit_edge
from acutance.targets.straight.pixels import EdgePixels

SYSTEMS = sim.reference_systems()
# Commensurable angles (1/8, 1/5, 1/4, 1/3, 1/2) repeat their sample phases.
ANGLES_DEG = (2.0, 7.125, 11.31, 14.036, 18.435, 26.565, 43.0)
FREQ_CPP = np.arange(0, 0.501, 0.02)


def band_of(image, line, *, noise=10.0, dark=200.0, bright=1200.0):
    """A band as the finder hands it over: line and levels roughly known."""
    return EdgePixels(image, line.moved(0.1, 0.2), dark, bright, 0.6, noise)


@functools.cache
def noisy_edge(seed=0, system="gaussian", **options):
    given = {"angle_deg": 6.0, "shape": (40, 40), "snr": 100.0} | options
    return sim.edge(SYSTEMS[system], rng=np.random.default_rng(seed), **given)


def numbers(fit):
    response = fit.response
    found = (response.mtf(0.25), response.mtf_nyquist, response.rer, response.fwhm_px)
    return np.array([x for number in found for x in (number.value, number.std)])


@pytest.mark.parametrize("angle_deg", ANGLES_DEG)
@pytest.mark.parametrize("system", SYSTEMS)
def test_without_noise_the_truth_is_returned(system, angle_deg):
    image, truth = sim.edge(SYSTEMS[system], angle_deg=angle_deg, shape=(60, 60), offset_px=0.13)
    fit = fit_edge(band_of(image, truth.line, noise=1.0))
    mtf = np.array([fit.response.mtf(f).value - truth.mtf(f).value for f in FREQ_CPP])
    # Tails and rings that leave the region might be slopes of the ground.
    far = system in ("diffraction", "sharpened")
    assert np.max(np.abs(mtf)) < (0.005 if far else 0.001)
    assert abs(fit.response.rer.value - truth.rer.value) < (0.004 if far else 0.001)
    assert abs(fit.response.fwhm_px.value - truth.fwhm_px.value) < (0.02 if far else 0.01)
    assert fit.line.normal_deg == pytest.approx(truth.line.normal_deg, abs=1e-3)
    assert abs(fit.line.normal_distance(truth.line.row, truth.line.col)) < (2e-3 if far else 1e-3)
    assert fit.dark == pytest.approx(truth.dark, abs=2.0)
    assert fit.bright == pytest.approx(truth.bright, abs=2.0)


def test_an_asymmetric_system_keeps_its_phase():
    image, truth = sim.edge(SYSTEMS["asymmetric"], angle_deg=6.0, shape=(60, 60))
    fit = fit_edge(band_of(image, truth.line, noise=1.0))
    inside = fit.response.mtf.freq_cpp < 0.401
    phase = fit.response.mtf.phase_rad[inside]
    expected = [
        np.angle(np.interp(f, truth.mtf.freq_cpp, truth.mtf.otf))
        for f in fit.response.mtf.freq_cpp[inside]
    ]
    assert np.max(np.abs(phase)) > 0.02
    assert np.max(np.abs(phase - expected)) < 3e-3


@given(
    gain=st.floats(1e-3, 1e3),
    offset=st.floats(-1e4, 1e4),
    row=st.integers(-3, 900),
    col=st.integers(-900, 3),
)
@settings(max_examples=15, deadline=None)
def test_gain_offset_and_place_change_nothing(gain, offset, row, col):
    image, truth = noisy_edge()
    plain = fit_edge(band_of(image, truth.line))
    offset *= gain
    scaled = band_of(
        gain * image + offset,
        truth.line,
        noise=10 * gain,
        dark=200 * gain + offset,
        bright=1200 * gain + offset,
    )
    found = fit_edge(scaled)
    assert numbers(found) == pytest.approx(numbers(plain), rel=1e-5)
    assert found.dark == pytest.approx(gain * plain.dark + offset, rel=1e-6, abs=1e-6 * gain)
    # The whole pattern moved by whole pixels within a larger frame of unknown ones.
    inside = (slice(5 + row % 7, 45 + row % 7), slice(5 + col % 7, 45 + col % 7))
    frame = np.full((60, 60), np.nan)
    frame[inside] = image
    moved = Line(
        truth.line.row + inside[0].start, truth.line.col + inside[1].start, truth.line.normal_deg
    )
    assert numbers(fit_edge(band_of(frame, moved))) == pytest.approx(numbers(plain), rel=1e-6)


@given(flip_rows=st.booleans(), flip_cols=st.booleans(), transpose=st.booleans())
@settings(max_examples=8, deadline=None)
def test_flips_and_transposition_change_nothing(flip_rows, flip_cols, transpose):
    image, truth = noisy_edge(shape=(40, 36))
    start = truth.line.moved(0.1, 0.2)
    plain = fit_edge(EdgePixels(image, start, 200, 1200, 0.6, 10))
    row, col, normal = start.row, start.col, start.normal_deg
    if flip_rows:
        image, row, normal = image[::-1], image.shape[0] - 1 - row, -normal
    if flip_cols:
        image, col, normal = image[:, ::-1], image.shape[1] - 1 - col, 180.0 - normal
    if transpose:
        image, row, col, normal = image.T, col, row, 90.0 - normal
    found = fit_edge(EdgePixels(image, Line(row, col, normal), 200, 1200, 0.6, 10))
    assert numbers(found) == pytest.approx(numbers(plain), rel=1e-5)


def test_the_start_of_the_line_changes_nothing_that_matters():
    image, truth = noisy_edge()
    fits = [
        fit_edge(EdgePixels(image, truth.line.moved(*moved), 180, 1230, width, 15))
        for moved, width in (((0.0, 0.0), 0.5), ((0.3, -0.5), 0.8), ((-0.3, 0.5), 0.6))
    ]
    found = np.array([numbers(fit) for fit in fits])
    assert np.all(np.ptp(found[:, ::2], axis=0) < 0.2 * found[0, 1::2])


def test_the_blur_it_departs_from_changes_nothing_that_matters():
    """Blurs of the same width and another aperture: the linear model finds its way back.

    Which sensors are alike is judged by departures from the best blur: apertures of real first fits
    differ by less."""
    image, truth = noisy_edge(1)
    variance = 0.4**2 + 1 / 12
    fits = []
    for aperture in (0.85, 1.0, 1.1):
        blur = GaussianPixel(np.sqrt(variance - aperture**2 / 12), aperture)
        fits.append(fit_edge(EdgePixels(image, truth.line, 200, 1200, 0.4, 10, blur)))
    found = np.array([numbers(fit) for fit in fits])
    assert np.all(np.ptp(found[:, ::2], axis=0) < 0.4 * found[1, 1::2])


def test_noise_that_depends_on_the_signal_is_read_on_either_side():
    noise = Noise(read=2.0, shot_gain=0.3)
    image, truth = noisy_edge(3, shape=(80, 60), snr=None, noise=noise)
    fit = fit_edge(band_of(image, truth.line))
    assert fit.noise_dark == pytest.approx(float(noise.std(np.array(200.0))), rel=0.06)
    assert fit.noise_bright == pytest.approx(float(noise.std(np.array(1200.0))), rel=0.06)


@pytest.mark.parametrize("seed", range(4))
def test_outliers_are_bounded(seed):
    image, truth = noisy_edge(seed)
    clean = fit_edge(band_of(image, truth.line)).response.mtf_nyquist
    rng = np.random.default_rng(100 + seed)
    spikes = rng.choice(image.size, image.size // 20, replace=False)
    spoilt = image.copy()
    spoilt.flat[spikes] += 300.0 * rng.choice([-1.0, 1.0], spikes.size)
    fit = fit_edge(band_of(spoilt, truth.line))
    assert abs(fit.response.mtf_nyquist.value - clean.value) < 2 * clean.std
    assert np.mean(fit.weights.reshape(image.shape).flat[spikes] < 0.5) > 0.9
    kept = np.ones(image.size, bool)
    kept[spikes] = False
    noise = np.hypot(fit.noise_dark, fit.noise_bright) / np.sqrt(2)
    left = fit.residual[kept] * (fit.bright - fit.dark)
    assert noise == pytest.approx(np.sqrt(np.mean(left**2)), rel=0.015)
    careless = fit_edge(band_of(spoilt, truth.line), robust=False)
    assert careless.response.mtf_nyquist.std > 1.5 * fit.response.mtf_nyquist.std
    assert np.all(careless.weights == 1.0)


def test_correlated_noise_widens_the_intervals():
    regrid = Regrid(0.5, 0.5)
    image, truth = noisy_edge(5, snr=50.0, regrid=regrid, shape=(60, 60))
    fit = fit_edge(band_of(image, truth.line))
    white, white_truth = noisy_edge(5, snr=50.0, shape=(60, 60))
    plain = fit_edge(band_of(white, white_truth.line))
    assert fit.correlation.inflation > 1.5
    assert plain.correlation.inflation == 1.0
    # Interpolation lowers the noise of a pixel, not what there is to know.
    assert fit.noise_dark < 0.8 * plain.noise_dark
    assert fit.response.rer.std > 0.8 * plain.response.rer.std


def test_missing_pixels_are_left_out():
    image, truth = noisy_edge()
    holed = image.copy()
    holed[10:14, 15:25] = np.nan
    fit = fit_edge(band_of(holed, truth.line))
    assert fit.residual.size == fit.weights.size == np.count_nonzero(np.isfinite(holed))
    plain = fit_edge(band_of(image, truth.line))
    assert fit.response.rer.std > plain.response.rer.std
    assert abs(fit.response.rer.value - plain.response.rer.value) < 2 * plain.response.rer.std


def test_evidence_describes_the_pixels():
    image, truth = noisy_edge()
    fit = fit_edge(band_of(image, truth.line))
    rows, cols = np.indices(image.shape)
    distance = fit.line.normal_distance(rows, cols).ravel()
    assert fit.distance_px == pytest.approx(distance, abs=1e-9)
    model = np.interp(fit.distance_px, fit.response.esf.distance_px, fit.response.esf.value)
    near = np.abs(fit.distance_px) < 8
    assert (
        np.max(np.abs(fit.value - fit.residual - model)[near]) < 5e-3
    )  # the ground, which is no part of the ESF
    assert np.std(fit.residual) == pytest.approx(0.01, rel=0.1)
    assert fit.response.esf(0.0).value == pytest.approx(0.5, abs=1e-6)


def test_unknown_phases_are_filled_by_what_sensors_can_be():
    """At tan = 1/2 samples are 0.447 px apart: what lies between them is not known.

    A normal prior is 2.2 deviations off on average."""
    z = []
    for seed in range(10):
        image, truth = noisy_edge(seed, "diffraction", angle_deg=26.565, snr=1000.0)
        fwhm = fit_edge(band_of(image, truth.line)).response.fwhm_px
        z.append((fwhm.value - truth.fwhm_px.value) / fwhm.std)
    assert abs(np.mean(z)) < 1
    assert 0.4 < np.std(z) < 1.5


def test_a_region_without_an_edge_is_refused():
    rng = np.random.default_rng(9)
    image = 700 + 10 * rng.standard_normal((40, 40))
    with pytest.raises(NoEdgeError):
        fit_edge(EdgePixels(image, Line(19.5, 19.5, 6.0), 695, 705, 0.6, 10))
