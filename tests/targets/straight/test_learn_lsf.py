"""What the prior of line spread functions learns, and whether its file is what it says."""

import numpy as np
import pytest

from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.optics import FAMILIES, Detector, Diffraction, Gaussian, Halo, Sensor, draw_sensor
from acutance.targets.straight.learn_lsf import departure, learn, principal_directions, write
from acutance.targets.straight.lsf_prior import directions
from acutance.targets.straight.spline import SIZE
from acutance.targets.straight.tuned import FAMILY_LOG_AMPLITUDES


def test_a_gaussian_through_a_pixel_does_not_depart():
    assert np.abs(departure(Sensor([Gaussian(0.5), Detector()])).coefficients).max() < 2e-3


def test_a_halo_departs_on_both_sides_and_an_aperture_has_a_tail():
    halo = departure(Sensor([Gaussian(0.4), Halo(0.1, 3.0), Detector()])).coefficients
    assert halo[-1] == pytest.approx(0, abs=1e-9)
    assert np.abs(halo[:-1] - halo[-2::-1]).max() < 1e-3
    assert halo[:-1].max() > 0.01
    aperture = departure(Sensor([Diffraction(1.2, 0.3), Detector()])).coefficients
    # The LSF falls like a / s^2 with a = 1 / (pi^2 cutoff (1 - obscuration)).
    width = GaussianPixel(0.6).width_px
    assert aperture[-1] * width == pytest.approx(1 / (np.pi * 1.2 * 0.7), rel=0.3)


def test_principal_directions_have_the_mean_square_of_the_departures():
    rng = np.random.default_rng(2)
    even = np.zeros((300, SIZE + 1))
    even[:, :SIZE] = rng.normal(size=(300, 1)) * np.hanning(SIZE)
    found = principal_directions(even, 1e-3)
    assert found.shape == (SIZE + 1, 1)
    assert np.sum(found**2) == pytest.approx(np.mean(np.sum(even**2, axis=1)))


def test_the_file_explains_sensors_that_it_was_not_learned_from():
    prior = directions(GaussianPixel(0.5))
    for number, family in enumerate(FAMILY_LOG_AMPLITUDES):
        own = prior.block == 2 + number
        lsf = np.diff(prior.esf[2 : 3 + SIZE, own], axis=0) / 0.2
        basis = np.linalg.qr(np.vstack([lsf, prior.tail[own]]))[0]
        rng = np.random.default_rng((77, number))
        drawn = np.array([departure(draw_sensor(family, rng)).coefficients for _ in range(12)])
        left = drawn - drawn @ basis @ basis.T
        assert np.sum(left**2) < 0.05 * np.sum(drawn**2), family


def test_learning_writes_every_family(tmp_path):
    found = learn(4, seed=1, families=["halo", "smear"])
    write(tmp_path / "found.npz", found)
    with np.load(tmp_path / "found.npz") as kept:
        assert set(kept.files) == {"halo", "smear"}
        for name in kept.files:
            assert kept[name] == pytest.approx(found[name], abs=1e-6)
    # Some are of the density alone.
    of_density = {"scatter", "aberrated", "peaked", "deferred"}
    assert set(FAMILY_LOG_AMPLITUDES) == set(FAMILIES) - of_density
