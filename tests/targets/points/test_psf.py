"""The PSF of points: every direction in the plane against its transform, and its slopes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.targets.points.psf import PsfModel
from acutance.targets.points.psf_prior import PsfDirections

BLUR = GaussianPixel2d(0.16, 0.05, 0.25)
STEP = 1e-5


@pytest.fixture(scope="module")
def places():
    return np.random.default_rng(1).uniform(-2, 2, (2, 9))


def test_the_blurs_slopes_are_its_changes(places):
    x, y = places
    slopes = BLUR.slopes(x, y)
    assert BLUR.psf(x + STEP, y) - BLUR.psf(x - STEP, y) == pytest.approx(
        2 * STEP * slopes.by_x, abs=1e-12
    )
    assert BLUR.psf(x, y + STEP) - BLUR.psf(x, y - STEP) == pytest.approx(
        2 * STEP * slopes.by_y, abs=1e-12
    )
    for name, found in (("xx", slopes.by_xx), ("xy", slopes.by_xy), ("yy", slopes.by_yy)):
        value = getattr(BLUR, name)
        more, less = (replace(BLUR, **{name: value + d}).psf(x, y) for d in (STEP, -STEP))
        assert more - less == pytest.approx(2 * STEP * found, abs=1e-12)


def test_a_round_blur_is_a_product_of_its_lines():
    """Without lean the PSF separates: across times along."""
    from acutance.numerics.gaussian_pixel import GaussianPixel

    grid = np.linspace(-2, 2, 9)
    x, y = (part.ravel() for part in np.meshgrid(grid, grid))
    found = GaussianPixel2d(0.16, 0.0, 0.36).psf(x, y)
    assert found == pytest.approx(GaussianPixel(0.4).lsf(x) * GaussianPixel(0.6).lsf(y), abs=1e-7)


def test_every_direction_is_the_transform_it_says():
    directions = PsfDirections(BLUR)
    grid = np.arange(-20, 20, 0.2)
    x, y = (part.ravel() for part in np.meshgrid(grid, grid))
    columns = directions.evaluate(x, y)
    endless = np.zeros(directions.size, bool)
    endless[-1] = True
    endless[5:][: directions.families.tail.size] = directions.families.tail != 0
    for u, v in ((0.0, 0.0), (0.3, 0.2), (-0.5, 0.1)):
        sums = np.exp(-2j * np.pi * (u * x + v * y)) @ columns * 0.04
        transform = directions.transform(np.array([u]), np.array([v]))[0]
        # Sums over cubic splines are exact but for the steps of their third derivatives.
        assert np.abs(sums - transform)[~endless].max() < 2e-4
        # What falls like 1 / r^3 goes on beyond the square.
        assert np.abs(sums - transform).max() < 0.07


def test_the_sum_and_its_slopes(places):
    x, y = places
    directions = PsfDirections(BLUR)
    weights = 0.01 * np.random.default_rng(2).normal(size=directions.size)
    psf, by_x, by_y = directions.sum_with_slopes(x, y, weights)
    assert psf == pytest.approx(BLUR.psf(x, y) + directions.evaluate(x, y) @ weights, abs=1e-10)
    step = 1e-3
    for found, dx, dy in ((by_x, step, 0.0), (by_y, 0.0, step)):
        more = directions.sum_with_slopes(x + dx, y + dy, weights)[0]
        less = directions.sum_with_slopes(x - dx, y - dy, weights)[0]
        assert (more - less) / (2 * step) == pytest.approx(found, abs=2e-3)


def test_the_gauge_leaves_flux_and_place_alone():
    """No direction looks like more light, or like light elsewhere."""
    directions = PsfDirections(BLUR)
    wide, high = BLUR.widths_px
    steps = np.arange(-4.5, 4.51, 0.3)
    x, y = (part.ravel() for part in np.meshgrid(steps * wide, steps * high))
    slopes = BLUR.slopes(x, y)
    found = directions.evaluate(x, y)
    assert np.abs(np.stack(slopes[:3]) @ found).max() < 1e-9


def test_the_otf_is_one_at_zero_and_knows_it():
    directions = PsfDirections(BLUR)
    rng = np.random.default_rng(3)
    model = PsfModel(
        directions, 0.01 * rng.normal(size=directions.size), 0.01 * np.eye(directions.size)
    )
    u, v = np.array([0.0, 0.2]), np.array([0.0, 0.1])
    assert model.otf(u, v)[0] == 1
    assert not model.factor(u, v)[0].any()
    change = 1e-6
    moved = PsfModel(directions, model.weights + change * model.latent[:, 1], model.latent)
    assert (moved.otf(u, v) - model.otf(u, v))[1] / change == pytest.approx(
        model.factor(u, v)[1, 1], rel=1e-4
    )
