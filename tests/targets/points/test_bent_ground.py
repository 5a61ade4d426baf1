"""Ground that bends under point sources: a common bend and a wing of the PSF are one."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import mirror_columns, reference_systems

SYSTEMS = reference_systems()
PEAK = 1000.0


def measured(name, sag, *, axis=0, seed=1, snr=200.0):
    """Mirrors on ground that lies so far off its slope 13 px from each, relative to the peak."""
    rng = np.random.default_rng(seed)
    places = mirror_columns((12.3, 12.1)) + rng.uniform(-0.4, 0.4, 2)
    image, _ = ac.simulate.points(SYSTEMS[name], positions=places, snr=snr, rng=rng)
    away = np.indices(image.shape)[axis] - 0.5 * image.shape[axis]
    return ac.measure_points(image + sag * PEAK * (away / 13.0) ** 2)


def check_of(found):
    return next(check for check in found.checks if check.name == "background_curvature")


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sag", [0.006, -0.006])
def test_bent_ground_is_named(sag, axis):
    check = check_of(measured("defocused", sag, axis=axis))
    assert not check.passed
    assert check.value == pytest.approx(0.006, rel=0.3)


@pytest.mark.parametrize("name", sorted(SYSTEMS))
def test_even_ground_passes(name):
    assert check_of(measured(name, 0.0)).value == 0


def test_few_sources_do_not_show_it():
    image, _ = ac.simulate.points(SYSTEMS["halo"], positions=mirror_columns((12.3, 12.1), count=3))
    assert check_of(ac.measure_points(image)).value == 0
