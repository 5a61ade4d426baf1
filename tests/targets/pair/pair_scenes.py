"""Simulated pairs, and what is measured on them, shared by the tests of this folder."""

from __future__ import annotations

from functools import cache

import numpy as np

import acutance as ac
from acutance.curves.grid import Floats
from acutance.simulate import PairTruth

SYSTEMS = {
    **ac.simulate.reference_systems(),
    # One-sided light down the columns only: phase, and two axes that differ.
    "trail": ac.Sensor(
        [ac.optics.Gaussian(0.3), ac.optics.Exponential(0.5, "along"), ac.optics.Detector()]
    ),
}
REFERENCE = SYSTEMS["gaussian"]
SMALL = (64, 64)
NYQUIST = 0.01
"""What the MTF at Nyquist may be wrong by at SNR 100."""


def rendered(
    system: str = "smeared",
    ratio: float = 2.0,
    seed: int = 1,
    shape: tuple[int, int] = (96, 104),
    shift: tuple[float, float] = (1.3, -0.6),
    snr: float | None = 100.0,
) -> tuple[Floats, Floats, PairTruth]:
    """A pair that is simulated once, whichever of these are left out."""
    return _rendered(system, ratio, seed, shape, shift, snr)


@cache
def _rendered(
    system: str,
    ratio: float,
    seed: int,
    shape: tuple[int, int],
    shift: tuple[float, float],
    snr: float | None,
) -> tuple[Floats, Floats, PairTruth]:
    return ac.simulate.pair(
        SYSTEMS[system],
        REFERENCE,
        ratio=ratio,
        shape=shape,
        shift_px=shift,
        gain=1.2,
        offset=30.0,
        snr=snr,
        rng=np.random.default_rng(seed),
    )


def measured(
    system: str = "smeared",
    ratio: float = 2.0,
    seed: int = 1,
    method: str = "kernel-fit",
    shape: tuple[int, int] = (96, 104),
) -> ac.BiresolutionMeasurement:
    """What is measured of it, once as well."""
    return _measured(system, ratio, seed, method, shape)


@cache
def _measured(
    system: str, ratio: float, seed: int, method: str, shape: tuple[int, int]
) -> ac.BiresolutionMeasurement:
    low, high, _ = rendered(system, ratio, seed, shape)
    return ac.measure_biresolution(low, high, reference_mtf=REFERENCE, method=method)


def both(measurement: ac.BiresolutionMeasurement) -> tuple[Floats, Floats]:
    """MTF at Nyquist across and along: values and standard deviations."""
    found = [one.mtf_nyquist for one in (measurement.across, measurement.along)]
    return np.array([one.value for one in found]), np.array([one.std for one in found])
