"""The last pass: which sensor it is, and what that is worth."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.numerics.marginal_likelihood import Prior, regress
from acutance.numerics.normal_equations import Normal
from acutance.targets.points import tuned
from acutance.targets.points.among_sensors import Equations, among_sensors
from acutance.targets.points.psf_prior import PsfDirections
from acutance.targets.points.sensor_density import drawn_sensors

PIXEL = ac.optics.Detector()


def measured(sensor, snr, seed, **layout):
    rng = np.random.default_rng(seed)
    layout = ac.simulate.mirror_columns((12.0, 12.0), **layout) + rng.uniform(0, 1, (1, 2))
    image, truth = ac.simulate.points(sensor, positions=layout, snr=snr, rng=rng)
    return ac.measure_points(image, positions=layout), truth


def families(found):
    return found.details.fit.families


def seen(weights, noise):
    """The equations of a PSF without background, every direction seen with the same noise."""
    directions = PsfDirections(GaussianPixel2d(0.2, 0.0, 0.2))
    prior = Prior(
        directions.block.astype(float), directions.scale, np.zeros(directions.size),
        tuned.LOG_AMPLITUDE, tuned.LOG_AMPLITUDE_STD, 1.0, 1e-6,
    )  # fmt: skip
    freq, angle = np.meshgrid(np.linspace(0.0, 1.0, 21), np.radians(np.arange(0, 180, 15.0)))
    columns = directions.transform((freq * np.cos(angle)).ravel(), (freq * np.sin(angle)).ravel())
    design = np.vstack([columns.real, columns.imag])
    data = design @ weights(directions)
    data += noise * np.random.default_rng(0).standard_normal(data.size)
    normal = Normal(design.T @ design, design.T @ data, float(data @ data), float(data.size))
    return Equations(normal, prior, 1.0, regress(normal, prior, noise**2)), directions, design


def test_a_drawn_sensor_is_found_again():
    sensors = drawn_sensors()
    kernels = sensors.about((1.38, 1.38))
    name = kernels.name[kernels.part]
    largest = np.argmax(np.where(name == "sharpened", np.abs(kernels.centres).sum(axis=1), 0))

    def weights(directions):
        own = np.zeros(directions.size)
        own[directions.learned] = sensors.directions @ kernels.centres[largest]
        return own

    equations, directions, design = seen(weights, 2e-3)
    found = among_sensors(equations, directions)
    assert sum(found.share.values()) == pytest.approx(1.0)
    assert found.share["other"] < 0.05
    assert sum(found.share.get(one, 0.0) for one in tuned.COMPENSATED) > 0.9
    left = design @ (found.posterior.beta - weights(directions))
    normal = design @ (equations.likeliest.beta - weights(directions))
    assert np.sqrt(np.mean(left**2)) < min(1e-3, 0.9 * np.sqrt(np.mean(normal**2)))


def test_what_no_sensor_has_keeps_the_normal_prior():
    rng = np.random.default_rng(3)

    def strange(directions):
        own = np.zeros(directions.size)
        own[directions.block == 7] = 0.1 * rng.standard_normal(np.sum(directions.block == 7))
        return own

    equations, directions, _ = seen(strange, 1e-3)
    found = among_sensors(equations, directions)
    assert found.share["other"] > 0.999


def test_blurs_wider_than_all_that_were_drawn_keep_the_normal_prior():
    sensor = ac.Sensor([ac.optics.Gaussian(2.2), PIXEL])
    found, truth = measured(sensor, 100.0, 5, count=3, step=(30.2, 1.3), apart_px=30.4)
    assert families(found) == {"other": 1.0}
    number, true = found.across.fwhm_px, truth.response("across").fwhm_px.value
    assert abs(number.value - true) < 3 * number.std < 0.1 * true


@pytest.mark.parametrize(
    ("blocks", "named"),
    [
        ([ac.optics.Diffraction(1.3, obscuration=0.3)], {"telescope"}),
        ([ac.optics.Gaussian(0.5), ac.optics.Halo(0.1, 2.5)], {"halo"}),
        ([ac.optics.Gaussian(0.5), ac.optics.Sharpening.both_axes(0.4)], {"sharpened", "restored"}),
    ],
)
def test_families_are_named(blocks, named):
    optics = [one for one in blocks if not isinstance(one, ac.optics.Sharpening)]
    kernels = [one for one in blocks if isinstance(one, ac.optics.Sharpening)]
    found, _ = measured(ac.Sensor([*optics, PIXEL, *kernels]), 200.0, 6)
    assert sum(families(found).get(name, 0.0) for name in named) > 0.8


def test_sharpened_products_are_right_and_their_deviations_small():
    """With principal directions alone the error is .03 at Nyquist, .06 at .25 c/px."""
    errors, z = [], []
    for seed in range(4):
        rng = np.random.default_rng([9, seed])
        blur, kernel = rng.uniform(0.4, 0.6), rng.uniform(0.1, 0.5)
        sensor = ac.Sensor(
            [ac.optics.Gaussian(blur), PIXEL, ac.optics.Sharpening.both_axes(kernel)]
        )
        found, truth = measured(sensor, 200.0, [10, seed])
        true = truth.response("across")
        for number, wanted in (
            (found.across.mtf_nyquist, true.mtf_nyquist),
            (found.across.mtf(0.25), true.mtf(0.25)),
        ):
            errors.append(number.value - wanted.value)
            z.append(errors[-1] / number.std)
    assert np.sqrt(np.mean(np.square(errors))) < 0.02
    assert np.abs(z).max() < 3
