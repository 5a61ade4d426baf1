"""Learn from optics how two-dimensional transfer functions depart from a Gaussian through a pixel.

Sensors of every family (`acutance.optics.FAMILIES`) are drawn at random, and each is taken in all
eight positions that turns by a quarter and mirrors give it. What the mean's own modes leave of a
sensor's optical transfer function (OTF), in the states of `otf_modes`, is its departure. The
principal directions of a family's departures, each with the root of its mean square, are what
`otf_families` reads.

Frequencies are counted in cycles per width of the mean, so the states are the same for all
sensors.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache
from itertools import product
from pathlib import Path
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.otf_families import FAMILY_LOG_AMPLITUDES
from acutance.numerics.otf_modes import MeanOtf, ProcessModes
from acutance.numerics.stacked import stacked
from acutance.optics import Sensor, draw_sensor

__all__ = [
    "departure",
    "fitted_mean",
    "learn_families",
    "principal_directions",
    "tamed",
    "write_families",
]

_FREE: Final = 6
"""Modes of the mean that have no part in departures: level, three widths, two places."""
_HIGHEST: Final = 2.6
_STEP: Final = 0.05
"""Highest frequency of the nodes and their distance, in cycles per width."""
_NEXT_TO_ZERO: Final = (0.001, 0.005, 0.012)
_ANGLES: Final = 24
_MEAN_STEPS: Final = 25
_SETTLED_PX: Final = 1e-3
_LEFT: Final = 3e-4
"""What the states may leave of an OTF, relative to coefficients of one."""
_NEGLIGIBLE: Final = 1e-3
"""Share of the mean square of a family's first direction below which directions are left out."""


def departure(sensor: Sensor, *, turned: bool = False, signs: tuple[int, int] = (1, 1)) -> Floats:
    """Coefficients of the states, (r,), by which a sensor's OTF departs from its mean.

    Parameters
    ----------
    sensor : Sensor
    turned : bool, optional
        Whether rows and columns of its pixels change places.
    signs : (int, int), optional
        -1 mirrors the sensor, across and along.
    """
    _, left = _fit_of_mean(sensor, turned=turned, signs=signs)
    return np.asarray(_fit_of_states() @ left)


def fitted_mean(sensor: Sensor) -> MeanOtf:
    """The Gaussian through a pixel that a sensor's OTF is about."""
    return _fit_of_mean(sensor)[0]


def _fit_of_mean(
    sensor: Sensor, *, turned: bool = False, signs: tuple[int, int] = (1, 1)
) -> tuple[MeanOtf, Floats]:
    """The mean, and what its own modes leave of the OTF at the nodes, (2 n,)."""
    mean = MeanOtf(0.2, 0.0, 0.2)
    for _ in range(_MEAN_STEPS):
        u, v = _nodes() / mean.width_px
        otf = sensor.otf(signs[0] * (v if turned else u), signs[1] * (u if turned else v))
        wanted, free = stacked(np.asarray(otf)), stacked(mean.modes(u, v)[:, :_FREE])
        fitted = np.linalg.lstsq(free, wanted, rcond=None)[0]
        moved = _widened(mean, fitted[1:4] / fitted[0])
        if abs(moved.width_px - mean.width_px) < _SETTLED_PX:
            break
        mean = moved
    return mean, wanted - free @ fitted


def principal_directions(departures: Floats, negligible: float = _NEGLIGIBLE) -> Floats:
    """Directions in which departures vary about none, by what they change of the OTF.

    Departures larger than the usual one of their family count like it: how large they are is for
    the data of a target to decide, not for the rare sensor that departs ten times as far.

    Parameters
    ----------
    departures : (n, r) array
    negligible : float, optional
        Directions of a smaller share of the first one's mean square are left out.

    Returns
    -------
    (r, k) array
        Columns times their standard normal variables give a random departure.
    """
    usual = departures * tamed(departures @ _states().T)[:, None]
    sensors, power, _ = np.linalg.svd(usual @ _states().T, full_matrices=False)
    kept = power**2 > negligible * power[0] ** 2
    return np.asarray(usual.T @ sensors[:, kept] / math.sqrt(len(usual)))


def tamed(changes: Floats) -> Floats:
    """Factors (n,) by which changes of an OTF, (n, m), are no larger than about the usual one."""
    size = np.sqrt(np.mean(changes**2, axis=1))
    return np.asarray(1 / np.hypot(1.0, size / np.median(size)))


def learn_families(
    sensors_per_family: int, seed: int, families: Iterable[str] = FAMILY_LOG_AMPLITUDES
) -> dict[str, Floats]:
    """The directions of every family, (r, k) each."""
    found = {}
    for number, family in enumerate(families):
        rng = np.random.default_rng((seed, number))
        sensors = [draw_sensor(family, rng) for _ in range(sensors_per_family)]
        every = product(sensors, (False, True), (1, -1), (1, -1))
        drawn = [departure(one, turned=turned, signs=(x, y)) for one, turned, x, y in every]
        found[family] = principal_directions(np.array(drawn))
    return found


def write_families(path: Path, directions: dict[str, Floats], kernels: Floats) -> None:
    """Keep the directions in a file that `otf_families` and, of kernels, `otf_kernels` read."""
    parts = {**directions, "kernels": kernels}
    np.savez_compressed(
        path, allow_pickle=False, **{name: d.astype("<f4") for name, d in parts.items()}
    )


def _widened(mean: MeanOtf, change: Floats) -> MeanOtf:
    """The mean with its widths changed by a bounded step."""
    xx, xy, yy = np.array([mean.xx, mean.xy, mean.yy]) + np.clip(change, -0.1, 0.1)
    return MeanOtf(max(float(xx), 0.02), float(xy), max(float(yy), 0.02))


@cache
def _nodes() -> Floats:
    """Frequencies across and along, (2, n), evenly spread over lengths and half a turn.

    Those next to zero count more: every curve is divided by the value there.
    """
    freq = np.append(np.repeat(_NEXT_TO_ZERO, 3), np.arange(_STEP / 2, _HIGHEST, _STEP))
    angle = math.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
    return np.stack([np.outer(freq, wave(angle)).ravel() for wave in (np.cos, np.sin)])


@cache
def _states() -> Floats:
    """The states at the nodes, (2 n, r)."""
    return stacked(ProcessModes(1.0).otf_modes(*_nodes()))


@cache
def _fit_of_states() -> Floats:
    """Coefficients of the states for values at the nodes, (r, 2 n): least squares with a ridge."""
    states = _states()
    gram = states.T @ states + _LEFT**2 * np.eye(states.shape[1])
    return np.asarray(np.linalg.solve(gram, states.T))
