"""Simulated stars and groups of bars, and their measurements, each made once."""

from __future__ import annotations

from functools import cache

import numpy as np

from acutance.geometry.bar_group import Bars
from acutance.optics import Detector, Exponential, Gaussian, Sensor, Sharpening
from acutance.simulate import bars, reference_systems, star
from acutance.targets.periodic import BarsOptions, StarOptions, measure_bars, measure_star

CYCLES = 24
STATED = StarOptions(dark=200.0, bright=1200.0, level_std=1.0)
STATED_BARS = BarsOptions(dark=200.0, bright=1200.0, level_std=1.0)
FREQ = np.arange(10, 51, 5) / 100
TAPS = (-0.08, 0.16, -0.32, 0.7, -1.56, 3.2, -1.56, 0.7, -0.32, 0.16, -0.08)


def _both_axes(taps):
    """A kernel applied to rows and to columns."""
    return Sharpening(tuple(map(tuple, np.outer(taps, taps).tolist())))


SENSORS = {
    **reference_systems(),
    # Neither symmetric nor equal in both directions: its OTF has an imaginary part.
    "trail": Sensor(
        [Gaussian(0.25, 0.45), Exponential(0.5, "across"), Exponential(0.2, "along"), Detector()]
    ),
    # Restored by a kernel whose lobes lie further out than fine states of the PSF do.
    "long kernel": Sensor([Gaussian(0.75), Detector(), _both_axes(TAPS)]),
    # Repeated 9 px away, further than any kernel that was learned from.
    "echo": Sensor([Gaussian(0.5), Detector(), _both_axes([0.06, *8 * [0], 1, *8 * [0], 0.06])]),
}


def star_scene(name="gaussian", seed=1, **arguments):
    """A small star and its truth."""
    arguments = {
        "snr": 100.0, "centre": (36.2, 34.9), "shape": (72, 72), "radius_px": 32.0,
        "cycles": CYCLES, **arguments,
    }  # fmt: skip
    return star(SENSORS[name], rng=np.random.default_rng(seed), **arguments)


def bars_scene(name="gaussian", seed=1, **arguments):
    """Three groups of bars and their truth."""
    arguments = {"snr": 100.0, "angle_deg": 6.0, "periods_px": (8, 4, 2.3), **arguments}
    return bars(SENSORS[name], rng=np.random.default_rng(seed), **arguments)


def measured_star(name="gaussian", seed=1, *, stated=True):
    """Measurement and truth of a star, made once, whichever of these are left out."""
    return _measured_star(name, seed, stated)


def measured_bars(name="gaussian", seed=1, *, stated=True):
    """Measurement and truth of groups of bars, once as well."""
    return _measured_bars(name, seed, stated)


@cache
def _measured_star(name, seed, stated):
    image, truth = star_scene(name, seed)
    return measure_star(image, cycles=CYCLES, options=STATED if stated else None), truth


@cache
def _measured_bars(name, seed, stated):
    image, truth = bars_scene(name, seed)
    return measure_bars(image, options=STATED_BARS if stated else None), truth


def stated_groups(truth):
    """Where the groups are, as a caller states it."""
    return tuple(
        Bars(g.row, g.col, g.normal_deg, g.period_px, g.count, g.length_px) for g in truth.groups
    )


def errors_of(curve, truth):
    """Errors of an MTF at 0.1 to 0.5 c/px, and their standard deviations."""
    found = [curve(f) for f in FREQ]
    return np.array([one.value for one in found]) - truth, np.array([one.std for one in found])
