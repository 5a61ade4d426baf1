"""Simulated edges: exact pixels, honest truth, noise as described."""

import math

import numpy as np
import pytest
from scipy.special import erf

from acutance.errors import ModelError
from acutance.optics import Detector, Exponential, Gaussian, Sensor
from acutance.optics.interpolation import interpolation_weight
from acutance.simulate import Noise, Regrid, edge, reference_systems, render_edge, resample

SENSOR = Sensor([Gaussian(0.4), Detector()], gsd_m=0.7)
SKEWED = Sensor([Gaussian(0.3), Exponential(0.4, "across"), Detector()], gsd_m=0.7)


def contrast(image):
    return (image - 200.0) / 1000.0


def pixel_integrals(line, shape, sigma):
    """The edge blurred by a Gaussian and integrated over every pixel by 2-D quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    rows, cols = np.indices(shape)
    total = np.zeros(shape)
    for y, wy in zip(nodes / 2, weights / 2, strict=True):
        for x, wx in zip(nodes / 2, weights / 2, strict=True):
            s = line.normal_distance(rows + y, cols + x)
            total += wy * wx * 0.5 * (1 + erf(s / (sigma * math.sqrt(2))))
    return total


@pytest.mark.parametrize("orientation", ["across", "along"])
@pytest.mark.parametrize("polarity", ["rising", "falling"])
@pytest.mark.parametrize("angle", [6.0, -6.0, 33.0])
def test_pixels_are_integrals_of_the_blurred_edge(orientation, polarity, angle):
    image, truth = edge(
        SENSOR,
        angle_deg=angle,
        orientation=orientation,
        polarity=polarity,
        shape=(41, 36),
        offset_px=0.31,
    )
    np.testing.assert_allclose(
        contrast(image), pixel_integrals(truth.line, (41, 36), 0.4), atol=1e-7
    )
    assert truth.orientation == orientation
    assert truth.line.angle_deg == pytest.approx(abs(angle))
    ends = image[20, [0, -1]] if orientation == "across" else image[[0, -1], 18]
    rising = ends[1] > ends[0]
    assert rising == (polarity == "rising")
    assert truth.line.normal_distance(20.0, 17.5) == pytest.approx(-0.31)


def test_truth_is_the_response_of_the_sensor_along_the_normal():
    _, truth = edge(SENSOR, angle_deg=14.0)
    expected = SENSOR.response(14.0)
    assert truth.mtf_nyquist == expected.mtf_nyquist
    assert (truth.rer, truth.fwhm_px) == (expected.rer, expected.fwhm_px)
    assert truth.response.gsd_m == 0.7
    assert (truth.dark, truth.bright, truth.noise) == (200.0, 1200.0, None)


def test_flip_transpose_and_polarity():
    image, _ = edge(SENSOR, angle_deg=6.0, shape=(30, 30))
    np.testing.assert_allclose(
        edge(SENSOR, angle_deg=-6.0, polarity="falling", shape=(30, 30))[0], image[:, ::-1]
    )
    np.testing.assert_allclose(
        edge(SENSOR, angle_deg=-6.0, orientation="along", shape=(30, 30))[0], image.T
    )
    np.testing.assert_allclose(
        edge(SENSOR, angle_deg=6.0, polarity="falling", shape=(30, 30))[0], 1400 - image
    )


def test_the_trail_of_an_asymmetric_sensor_does_not_turn_with_the_edge():
    rising, up = edge(SKEWED, shape=(30, 30))
    falling, down = edge(SKEWED, polarity="falling", shape=(30, 30))
    # Exchanging dark and bright inverts the image about the same 50 % points.
    np.testing.assert_allclose(falling, 1400 - rising, atol=1e-6)
    flipped, _ = edge(SKEWED, angle_deg=-6.0, polarity="falling", shape=(30, 30))
    assert np.max(np.abs(flipped[:, ::-1] - rising)) > 20
    np.testing.assert_allclose(down.mtf.otf, np.conj(up.mtf.otf), atol=1e-12)


def test_the_line_is_where_the_image_passes_half_way():
    image, truth = edge(SKEWED, shape=(200, 40), angle_deg=3.0)
    rows, cols = np.indices(image.shape)
    distance = truth.line.normal_distance(rows, cols).ravel()
    near = np.abs(distance) < 0.05
    line = np.polyfit(distance[near], contrast(image).ravel()[near], 1)
    assert line[1] == pytest.approx(0.5, abs=1e-3)


def test_snr_is_contrast_over_white_noise():
    rng = np.random.default_rng(3)
    image, truth = edge(SENSOR, shape=(300, 200), snr=50.0, rng=rng)
    clean, _ = edge(SENSOR, shape=(300, 200))
    residual = image - clean
    assert truth.noise == Noise(read=20.0)
    assert np.std(residual) == pytest.approx(20.0, rel=0.01)
    neighbours = np.mean(residual[:, 1:] * residual[:, :-1]) / np.var(residual)
    assert abs(neighbours) < 0.015


def test_noise_is_the_generators_own():
    images = [edge(SENSOR, snr=50, rng=np.random.default_rng(seed))[0] for seed in (5, 5, 6)]
    assert np.array_equal(images[0], images[1])
    assert not np.array_equal(images[0], images[2])


def test_shot_noise_grows_with_the_signal():
    rng = np.random.default_rng(4)
    noise = Noise(read=3.0, shot_gain=0.25)
    for level in (100.0, 1600.0):
        noisy = noise.added_to(np.full((400, 400), level), rng)
        assert np.var(noisy) == pytest.approx(9.0 + 0.25 * level, rel=0.015)
        assert np.mean(noisy) == pytest.approx(level, abs=0.2)


def test_saturation_comes_before_quantisation():
    image = np.array([[10.2, 99.6, 180.0]])
    found = Noise(quantum=4.0, saturation=102.0).added_to(image, None)
    assert found.tolist() == [[12.0, 100.0, 104.0]]
    assert image[0, 2] == 180.0


@pytest.mark.parametrize("name", reference_systems())
@pytest.mark.parametrize("angle", [7.0, -7.0])
def test_truth_of_a_shifted_image_is_exact(name, angle):
    sensor = reference_systems()[name]
    regrid = Regrid(shift_row_px=-0.3, shift_col_px=0.37)
    image, truth = edge(sensor, angle_deg=angle, regrid=regrid, offset_px=0.2)
    expected = render_edge(regrid.system(sensor), truth.line, image.shape, 200.0, 1200.0)
    np.testing.assert_allclose(image, expected, atol=2e-4)
    plain, _ = edge(sensor, angle_deg=angle, offset_px=0.2)
    assert np.max(np.abs(image - plain)) > 5
    assert truth.mtf_nyquist.value < sensor.response(angle).mtf_nyquist.value


@pytest.mark.parametrize(("scale", "kernel"), [(1.0, "cubic"), (1.0, "nearest"), (1.02, "spline")])
def test_whole_pixels_of_a_shift_change_nothing(scale, kernel):
    near, far = (
        edge(SKEWED, regrid=Regrid(row, col, scale, kernel))
        for row, col in ((-0.25, 0.5), (999_999.75, -20_001.5))
    )
    np.testing.assert_allclose(near[0], far[0], atol=1e-6)
    assert near[1].rer.value == pytest.approx(far[1].rer.value, abs=1e-9)


@pytest.mark.parametrize("sensor", [SENSOR, SKEWED], ids=["symmetric", "asymmetric"])
def test_truth_of_a_stretched_image_is_the_mean_over_phases(sensor):
    regrid = Regrid(scale=1.031, kernel="bilinear")
    # Along 921 rows the edge passes three whole cycles of phase in columns, 29 in rows.
    image, truth = edge(sensor, shape=(921, 130), regrid=regrid)
    expected = render_edge(regrid.system(sensor), truth.line, image.shape, 200.0, 1200.0)
    deviation = contrast(image) - contrast(expected)
    rows, cols = np.indices(image.shape)
    distance = truth.line.normal_distance(rows, cols)
    steep = np.abs(distance) < 0.25
    assert np.std(deviation[steep]) < 0.03
    for low in np.arange(-1.5, 1.5, 0.25):
        inside = (distance >= low) & (distance < low + 0.25)
        assert np.mean(deviation[inside]) == pytest.approx(0.0, abs=4e-3)
    # Pixels of another size, blurred by the mean kernel: both have to show.
    assert truth.mtf_nyquist.value == pytest.approx(
        sensor.mtf(6.0)(0.5 / 1.031).value * np.sinc(0.5 / 1.031) ** 2, rel=0.02
    )
    assert truth.response.gsd_m == pytest.approx(0.7 * 1.031)


def test_resampling_correlates_the_noise():
    rng = np.random.default_rng(8)
    regrid = Regrid(shift_col_px=0.5)
    image, _ = edge(SENSOR, shape=(300, 200), snr=50.0, regrid=regrid, rng=rng)
    clean, _ = edge(SENSOR, shape=(300, 200), regrid=regrid)
    residual = image - clean
    taps = np.array([-1, 9, 9, -1]) / 16
    assert np.var(residual) == pytest.approx(400.0 * taps @ taps, rel=0.02)
    lag = np.mean(residual[:, 1:] * residual[:, :-1]) / np.var(residual)
    assert lag == pytest.approx(taps[1:] @ taps[:-1] / (taps @ taps), abs=0.015)
    down = np.mean(residual[1:] * residual[:-1]) / np.var(residual)
    assert abs(down) < 0.015


@pytest.mark.parametrize(("kernel", "degree"), [("nearest", 0), ("bilinear", 1), ("cubic", 2)])
def test_kernels_reproduce_polynomials(kernel, degree):
    rows, cols = np.indices((12, 14)).astype(float)
    places = np.array([4.3, 5.0, 6.75])[:, None], np.array([4.1, 6.5, 8.9])[None, :]
    for power in range(degree + 1):
        found = resample(cols**power + 2 * rows**power, *places, kernel=kernel)
        np.testing.assert_allclose(found, places[1] ** power + 2 * places[0] ** power, atol=1e-12)
    beyond = resample(cols ** (degree + 1), *places, kernel=kernel)
    assert np.max(np.abs(beyond - places[1] ** (degree + 1))) > 0.05


@pytest.mark.parametrize("kernel", ["spline", "lanczos"])
def test_long_kernels_are_those_of_the_optics(kernel):
    image = np.random.default_rng(2).normal(size=(40, 42))
    row, col = 19.3, 21.8
    down = interpolation_weight(kernel, np.arange(40) - row)
    right = interpolation_weight(kernel, np.arange(42) - col)
    found = resample(image, np.array([[row]]), np.array([[col]]), kernel=kernel)
    assert found.item() == pytest.approx(float(down @ image @ right), abs=1e-7)
    flat = resample(np.full((9, 9), 3.0), np.array([[0.2]]), np.array([[4.6]]), kernel=kernel)
    assert flat.item() == pytest.approx(3.0, abs=1e-12)


def test_a_kernel_that_there_is_not_is_refused():
    with pytest.raises(ModelError, match=r"resample: kernel is 'sinc', .* 'spline', 'lanczos'"):
        resample(np.zeros((9, 9)), np.array([[4.5]]), np.array([[4.5]]), kernel="sinc")


def test_large_images_are_fine():
    image, _ = edge(reference_systems()["diffraction"], shape=(20, 700), angle_deg=6.0)
    assert np.all(np.diff(image, axis=1) > 0)
    assert 200 < image[10, 0] < 201
    assert 1199 < image[10, -1] < 1200


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"angle_deg": 50.0}, "other orientation"),
        ({"orientation": "vertical"}, "'vertical'"),
        ({"polarity": "up"}, "'up'"),
        ({"dark": 5.0, "bright": 5.0}, "dark has to be lower"),
        ({"snr": 50.0}, "without rng"),
        ({"snr": 50.0, "noise": Noise(read=1.0)}, "both set the white noise"),
        ({"snr": -1.0}, "snr is -1"),
    ],
)
def test_contradictions_are_refused(arguments, words):
    with pytest.raises(ModelError, match=words):
        edge(SENSOR, **arguments)
    with pytest.raises(ModelError, match="'sinc'"):
        Regrid(kernel="sinc")
