"""What the prior of PSFs learned from optics: departures, and their directions."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance import Sensor
from acutance.numerics.gaussian_pixel_2d import FWHM_OF_SIGMA, GaussianPixel2d
from acutance.optics import (
    Detector,
    Diffraction,
    Exponential,
    Gaussian,
    Halo,
    Sharpening,
    Smear,
    draw_sensor,
)
from acutance.targets.points.learn_psf import departure, directions_of, learn, sampled_psf, write
from acutance.targets.points.psf_families import PARITIES, learned_families
from acutance.targets.points.psf_prior import PsfDirections
from acutance.targets.points.psf_spline import GRIDS, parity_part
from acutance.targets.points.tuned import FAMILY_LOG_AMPLITUDES

OVERSHARP = Sensor([Diffraction(0.9), Gaussian(0.2), Detector(), Sharpening.both_axes(0.6)])


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


def test_a_departure_has_the_light_of_the_gaussian_that_the_joint_fit_counts():
    """Per light of a fit whose width is free as well, it would be 1.4 times as large."""
    found = departure(OVERSHARP)
    xx, yy = ((wide / FWHM_OF_SIGMA) ** 2 - 1 / 12 for wide in found.widths_px)
    directions = PsfDirections(GaussianPixel2d(xx, 0.0, yy))
    families = directions.families
    grids = zip(GRIDS, families.coefficients, strict=True)
    basis = np.vstack([*(grid.step * one for grid, one in grids), families.tail])
    flat = [g.step * c.ravel() for g, c in zip(GRIDS, found[:2], strict=True)]
    weights = np.linalg.lstsq(basis, np.concatenate([*flat, [found.tail]]), rcond=1e-8)[0]
    psf = sampled_psf(OVERSHARP)
    places_px = (np.arange(psf.shape[0]) - psf.shape[0] // 2) / 6
    near = np.abs(places_px) < 5
    x, y = (one.ravel() for one in np.meshgrid(places_px[near], places_px[near]))
    columns, blur = directions.summed(x, y, np.ones(x.size), np.arange(x.size))
    parts = np.column_stack([blur, columns[:, directions.learned] @ weights, columns[:, :3]])
    shares = np.linalg.lstsq(parts, psf[np.ix_(near, near)].ravel(), rcond=None)[0]
    assert shares[1] / shares[0] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("length_px", [0.0, 0.6])
def test_the_blur_of_a_departure_is_that_found_in_pixels(length_px):
    """Of all samples of the PSF together, as one source, it would be wider."""
    sensor = Sensor([Smear(length_px, "across"), *OVERSHARP.blocks])
    image, truth = ac.simulate.points(sensor)
    found = ac.measure_points(image, positions=truth.positions)
    blur = found.details.fit.model.blur
    assert departure(sensor).widths_px == pytest.approx(blur.widths_px, abs=0.01)


@pytest.mark.parametrize("family", FAMILY_LOG_AMPLITUDES)
def test_sensors_never_seen_lie_in_the_directions_learned(family):
    """All directions together leave a tenth of a new sensor's departure, in the median."""
    families = learned_families()
    parts = zip(GRIDS, families.coefficients, strict=True)
    basis = np.vstack([grid.step * one for grid, one in parts])
    rng = np.random.default_rng(99)
    left = []
    for _ in range(9 if family == "processed" else 3):
        found = departure(draw_sensor(family, rng))
        flat = np.concatenate([g.step * c.ravel() for g, c in zip(GRIDS, found[:2], strict=True)])
        rest = flat - basis @ np.linalg.lstsq(basis, flat, rcond=None)[0]
        left.append(np.linalg.norm(rest) / np.linalg.norm(flat))
    assert np.median(left) < 0.1


def test_directions_of_a_trail_are_odd_across_and_their_mean_square_that_of_the_departures():
    trails = [Exponential(length_px, "across") for length_px in (0.3, 0.4, 0.5)]
    drawn = [departure(Sensor([Gaussian(0.4), trail, Detector()])) for trail in trails]
    found = directions_of(drawn, 0.0)
    assert set(found) == set(PARITIES)
    odd = [np.sum(parity_part(grid, -1, 1) ** 2) for one in drawn for grid in one[:2]]
    # Half of the sensors trail along: theirs are the transposes.
    assert np.sum(found[-1, 1] ** 2) == pytest.approx(0.5 * np.sum(odd) / len(drawn))


def test_what_is_learned_is_what_is_read(tmp_path):
    learned = learn(2, 1, ["halo"])
    write(tmp_path / "one.npz", learned)
    with np.load(tmp_path / "one.npz") as kept:
        for name, rows in learned.items():
            assert kept[name] == pytest.approx(rows, rel=1e-3, abs=1e-6)
