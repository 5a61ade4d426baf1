"""Ground drawn in squares is seen exactly; ground noise is the paper's."""

import math

import numpy as np
import pytest

from acutance.errors import ModelError
from acutance.optics import Detector, Exponential, Gaussian, Sensor, preset
from acutance.simulate import GroundNoise, edge, pulse, reference_systems, render_raster

GENERIC = preset("generic-2005")
SKEWED = Sensor([Gaussian(0.3), Exponential(0.4, "across"), Exponential(0.2, "along"), Detector()])


@pytest.mark.parametrize("name", reference_systems())
@pytest.mark.parametrize("subpixels", [1, 2, 5, 20])
def test_a_strip_of_squares_is_two_steps(name, subpixels):
    sensor = reference_systems()[name]
    for axis, normal in ((1, 0.0), (0, 90.0)):
        ground = np.zeros((64 * subpixels, 64 * subpixels))
        inside = [slice(None)] * 2
        inside[axis] = slice(30 * subpixels, 33 * subpixels)
        ground[tuple(inside)] = 1.0
        image = render_raster(sensor, ground, subpixels)
        esf = sensor.profile(normal).esf
        # Pixel 30 begins at 29.5; the copies one period away have tails, too.
        place = np.arange(64.0)[:, None] + 64.0 * np.arange(-30, 31)
        expected = np.sum(esf(place - 29.5) - esf(place - 32.5), axis=1)
        line = image[0] if axis == 1 else image[:, 0]
        # Beyond the eighth alias band and for ESF tails beyond the table: 1e-5 of contrast.
        np.testing.assert_allclose(line, expected, atol=3e-5)


def test_a_single_square_is_an_integral_of_the_psf():
    """A square of 1/5 px off centre, by quadrature over the Gaussian of a sensor."""
    sigma, subpixels = 0.5, 5
    ground = np.zeros((24 * subpixels, 24 * subpixels))
    ground[12 * subpixels + 4, 11 * subpixels + 1] = 1.0
    image = render_raster(Sensor([Gaussian(sigma)]), ground, subpixels)
    erf = np.vectorize(math.erf)

    def part(centre):
        places = np.arange(24.0) - centre
        limits = ((places + way) / (sigma * math.sqrt(2)) for way in (0.1, -0.1))
        upper, lower = (erf(one) for one in limits)
        return 0.5 * (upper - lower)

    np.testing.assert_allclose(image, np.outer(part(12.4), part(10.8)), atol=1e-9)


def test_levels_and_shapes_are_kept():
    rng = np.random.default_rng(1)
    ground = 300 + rng.standard_normal((30 * 4, 17 * 4))
    image = render_raster(SKEWED, ground, 4)
    assert image.shape == (30, 17)
    assert image.mean() == pytest.approx(ground.mean(), abs=1e-9)


def test_the_field_is_twenty_white_fields():
    """Variance 2000 and the correlation of squares with random origins (3.4.3.1)."""
    noise, rng = GroundNoise(), np.random.default_rng(2)
    assert noise.std == pytest.approx(math.sqrt(2000))
    lags = (0, 1, 5, 12, 20)
    found = np.zeros((len(lags), 2))
    for _ in range(12):
        field = noise.field((30, 30), rng)
        assert field.shape == (600, 600)
        for i, lag in enumerate(lags):
            across = np.mean(field[:, : 600 - lag] * field[:, lag:])
            down = np.mean(field[: 600 - lag] * field[lag:])
            found[i] += np.array([across, down]) / 12
    expected = [sum(100 * max(0.0, 1 - lag / g) for g in range(1, 21)) for lag in lags]
    np.testing.assert_allclose(found, np.array(expected)[:, None] * [1, 1], atol=45)


def test_grids_of_the_grains_begin_anywhere():
    noise = GroundNoise(grains=(10,), subpixels=10)
    starts = set()
    for seed in range(60):
        row = noise.field((3, 3), np.random.default_rng(seed))[0]
        starts.add(int(np.flatnonzero(np.diff(row))[0] + 1) % 10)
    assert starts == set(range(10))


@pytest.mark.parametrize("sensor", [GENERIC, SKEWED], ids=["generic", "asymmetric"])
def test_noise_in_the_image_is_as_strong_as_stated(sensor):
    # Grains up to a pixel, as the paper's, in coarser steps.
    noise, rng = GroundNoise(grains=(1, 2, 3, 4, 5), subpixels=5), np.random.default_rng(3)
    images = np.array([noise.seen_by(sensor, (60, 60), rng) for _ in range(16)])
    assert np.sqrt(np.mean(images**2)) == pytest.approx(noise.std_seen_by(sensor), rel=0.01)
    neighbours = np.mean(images[:, :, 1:] * images[:, :, :-1]) / np.mean(images**2)
    assert 0.25 < neighbours < 0.5


@pytest.mark.parametrize("target", [edge, pulse])
def test_targets_on_uneven_ground(target):
    noise = GroundNoise()
    image, truth = target(GENERIC, ground_noise=noise, rng=np.random.default_rng(4))
    clean, _ = target(GENERIC)
    expected = noise.seen_by(GENERIC, image.shape, np.random.default_rng(4))
    np.testing.assert_allclose(image - clean, expected, atol=1e-9)
    assert truth.ground_noise == noise


def test_what_cannot_be_drawn_is_refused():
    rng = np.random.default_rng(5)
    with pytest.raises(ModelError, match="does not fill whole pixels"):
        render_raster(GENERIC, np.zeros((10, 12)), 5)
    with pytest.raises(ModelError, match="million are possible"):
        GroundNoise().field((600, 600), rng)
    with pytest.raises(ModelError, match="without rng"):
        pulse(GENERIC, ground_noise=GroundNoise())
    with pytest.raises(ModelError, match="all 1 or more"):
        GroundNoise(grains=())
