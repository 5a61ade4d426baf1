"""What the prior of PSFs learned from optics: departures, and their directions."""

from __future__ import annotations

import numpy as np
import pytest

from acutance import Sensor
from acutance.optics import FAMILIES, Detector, Diffraction, Gaussian, Halo, draw_sensor
from acutance.targets.points.learn_psf import departure, directions_of, learn, sampled_psf, write
from acutance.targets.points.psf_families import PARITIES, learned_families
from acutance.targets.points.psf_spline import GRIDS


def amount(one):
    """Root of the light squared in a departure's splines."""
    return np.sqrt(sum(np.sum((g.step * c) ** 2) for g, c in zip(GRIDS, one[:2], strict=True)))


def test_the_sampled_psf_holds_all_light_of_an_aperture():
    """Light beyond 32 px is not folded back: the tail of this one is 0.3 of it per radius."""
    psf = sampled_psf(Sensor([Diffraction(1.2, obscuration=0.3), Detector()]))
    row, col = np.indices(psf.shape) - psf.shape[0] // 2
    radius_px = np.hypot(row, col) / 6
    within = [psf[radius_px < reach].sum() / 36 for reach in (10.0, 20.0)]
    beyond = 1 - np.array(within)
    assert beyond[0] / beyond[1] == pytest.approx(2.0, rel=0.03)


def test_a_gaussian_through_a_pixel_does_not_depart():
    none = amount(departure(Sensor([Gaussian(0.5), Detector()])))
    halo = amount(departure(Sensor([Gaussian(0.5), Halo(0.05, 3.0), Detector()])))
    assert none < 0.02 * halo


def test_a_departure_has_the_tail_of_its_aperture():
    sensor = Sensor([Diffraction(1.2, obscuration=0.3), Detector()])
    assert departure(Sensor([Gaussian(0.5), Detector()])).tail == pytest.approx(0, abs=1e-9)
    assert 0.15 < departure(sensor).tail < 0.6


@pytest.mark.parametrize("family", FAMILIES)
def test_sensors_never_seen_lie_in_the_directions_learned(family):
    """All directions together leave a tenth of a new sensor's departure, in the median."""
    families = learned_families()
    parts = zip(GRIDS, families.coefficients, strict=True)
    basis = np.vstack([grid.step * one for grid, one in parts])
    rng = np.random.default_rng(99)
    left = []
    for _ in range(3):
        found = departure(draw_sensor(family, rng))
        flat = np.concatenate([g.step * c.ravel() for g, c in zip(GRIDS, found[:2], strict=True)])
        rest = flat - basis @ np.linalg.lstsq(basis, flat, rcond=None)[0]
        left.append(np.linalg.norm(rest) / np.linalg.norm(flat))
    assert np.median(left) < 0.1


def test_directions_of_a_trail_are_odd_across_and_their_mean_square_that_of_the_departures():
    rng = np.random.default_rng(5)
    drawn = [departure(draw_sensor("trail", rng)) for _ in range(4)]
    found = directions_of(drawn, 0.0)
    assert set(found) == set(PARITIES)
    power = {key: np.sum(rows[:, :-1] ** 2) for key, rows in found.items()}
    assert power[-1, 1] > 100 * power[-1, -1]


def test_what_is_learned_is_what_is_read(tmp_path):
    learned = learn(2, 1, ["halo"])
    write(tmp_path / "one.npz", learned)
    with np.load(tmp_path / "one.npz") as kept:
        for name, rows in learned.items():
            assert kept[name] == pytest.approx(rows, rel=1e-3, abs=1e-6)
