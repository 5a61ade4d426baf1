"""Learn from optics which kernels sharpen and restore products.

Sensors of the families that are processed (`acutance.optics.FAMILIES`) are drawn at random. Each
one's optical transfer function (OTF) is fitted by the mean, the states of `otf_modes` and all taps
of a kernel together, the taps under a tight prior: they are what the states do not follow. The
principal directions of the taps, in all eight positions that turns by a quarter and mirrors give
them, each with the root of its mean square, are what `otf_kernels` reads.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from acutance.curves.grid import Floats
from acutance.numerics.learn_otf import fitted_mean, tamed
from acutance.numerics.otf_kernels import KERNEL_REACH, blur_before, turns
from acutance.numerics.otf_modes import Complexes, MeanOtf, ProcessModes
from acutance.numerics.stacked import stacked
from acutance.optics import Sensor, draw_sensor

__all__ = ["learn_kernels", "taps_of"]

_PROCESSED: Final = ("sharpened", "restored", "processed")
"""The families that kernels act in."""
_DIRECTIONS: Final = 40
_HIGHEST_CPP: Final = 1.2
_STEP_CPP: Final = 0.05
"""Highest frequency of the nodes and their distance: targets show nothing finer."""
_NOISE: Final = 2e-4
"""Deviation of the OTF in the mean over all nodes; that of a single one is .009. With so little at
every one, stars of SNR 100 behind 20 sensors are measured about as well."""
_MEAN_STD: Final = 100.0
_STATE_STD: Final = 0.05
_TAP_STD: Final = 0.02
"""Prior deviations of the coefficients."""
_USUAL_BLUR: Final = MeanOtf(0.1, 0.0, 0.1)
"""Behind which directions of taps are told apart."""


def learn_kernels(sensors_per_family: int, seed: int) -> Floats:
    """Principal directions of the taps, (15, 15, k)."""
    found = []
    for number, family in enumerate(_PROCESSED):
        rng = np.random.default_rng((seed, number))
        found += [taps_of(draw_sensor(family, rng)) for _ in range(sensors_per_family)]
    every = product(found, (False, True), (1, -1), (1, -1))
    drawn = np.array([(one.T if turned else one)[::y, ::x] for one, turned, x, y in every])
    return _principal(drawn.reshape(len(drawn), -1)).reshape(*found[0].shape, -1)


def taps_of(sensor: Sensor) -> Floats:
    """Taps that a sensor's OTF has beyond the states, (15, 15)."""
    mean = fitted_mean(sensor)
    u, v = _nodes()
    own = mean.modes(u, v) * _MEAN_STD
    states = ProcessModes(mean.width_px).otf_modes(u, v) * _STATE_STD
    taps = blur_before(mean).otf(u, v)[:, None] * _tap_transfers() * _TAP_STD
    design = stacked(np.hstack([own, states, taps]))
    gram = design.T @ design + _NOISE**2 * len(design) * np.eye(design.shape[1])
    beta = cho_solve(cho_factor(gram), design.T @ stacked(np.asarray(sensor.otf(u, v), complex)))
    side = 2 * KERNEL_REACH + 1
    return np.asarray(_TAP_STD * beta[-(side**2) :].reshape(side, side))


def _principal(taps: Floats) -> Floats:
    """Directions in which taps (n, 225) vary about none, by what they change of the OTF."""
    modes = stacked(blur_before(_USUAL_BLUR).otf(*_nodes())[:, None] * _tap_transfers())
    changes = taps @ modes.T / math.sqrt(len(modes))
    usual = tamed(changes)
    sensors = np.linalg.svd(usual[:, None] * changes, full_matrices=False)[0]
    kept = sensors[:, :_DIRECTIONS]
    return np.asarray((usual[:, None] * taps).T @ kept / math.sqrt(len(taps)))


@cache
def _nodes() -> tuple[Floats, Floats]:
    """Frequencies (n,) over half of all directions."""
    half = np.arange(0.0, _HIGHEST_CPP + _STEP_CPP / 2, _STEP_CPP)
    u, v = (one.ravel() for one in np.meshgrid(np.append(-half[:0:-1], half), half))
    inside = np.hypot(u, v) < _HIGHEST_CPP + _STEP_CPP
    return u[inside], v[inside]


@cache
def _tap_transfers() -> Complexes:
    """Transfer of every tap at the nodes, (n, 225)."""
    u, v = _nodes()
    both = turns(v)[:, :, None] * turns(u)[:, None, :]
    return np.asarray(both.reshape(u.size, -1))
