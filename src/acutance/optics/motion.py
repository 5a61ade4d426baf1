"""Blur made by motion during the exposure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.block import Axis, Transfer, along_axis, require, require_axis, require_count

__all__ = ["Jitter", "Smear", "Tdi"]

_MAX_STAGES = 10_000
"""More than any detector has: a product over the stages stays quick."""


@dataclass(frozen=True)
class Smear:
    """Steady motion during the exposure: ``sinc(length f)`` along one axis.

    Parameters
    ----------
    length_px : float
        Distance travelled in pixels, at least 0.
    axis : {"along", "across"}, optional
        "along" is the row axis (the flight direction of a pushbroom), "across" the columns'.
    """

    length_px: float
    axis: Axis = "along"

    def __post_init__(self) -> None:
        require(self, length_px=self.length_px)
        require_axis(self, self.axis)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        return np.sinc(self.length_px * along_axis(u, v, self.axis))


@dataclass(frozen=True)
class Jitter:
    """Vibration, many periods in one exposure, with normally distributed displacements.

    Parameters
    ----------
    sigma_px : float
        Standard deviation of the displacement in pixels, per axis; at least 0.
    """

    sigma_px: float

    def __post_init__(self) -> None:
        require(self, sigma_px=self.sigma_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        radial_squared = np.asarray(u) ** 2 + np.asarray(v) ** 2
        return np.exp(-2 * (math.pi * self.sigma_px) ** 2 * radial_squared)


@dataclass(frozen=True)
class Tdi:
    """Time delay and integration: the charge follows the image in steps, and not quite.

    Every stage adds an exposure displaced by the drift against the one before it, which gives
    ``sin(N x) / (N sin x)`` with ``x = pi * (drift . frequency)``. Within a stage the charge
    moves in `phases` steps while the image moves evenly: ``sinc(v / phases)``.

    Parameters
    ----------
    stages : int
        Number of stages N, 1 to 10 000.
    drift_px : float, optional
        Displacement per stage along the columns of the detector (the row axis), from a line
        rate that does not match the ground speed; of any sign.
    drift_across_px : float, optional
        Displacement per stage across, from a yaw error; of any sign.
    phases : int, optional
        Clock phases per line, 1 to 10 000.
    """

    stages: int
    drift_px: float = 0.0
    drift_across_px: float = 0.0
    phases: int = 4

    def __post_init__(self) -> None:
        require_count(self, _MAX_STAGES, stages=self.stages, phases=self.phases)
        require(self, -1.0, 1.0, drift_px=self.drift_px, drift_across_px=self.drift_across_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        cycles = self.drift_across_px * np.asarray(u) + self.drift_px * np.asarray(v)
        stage = np.arange(self.stages) - 0.5 * (self.stages - 1)
        steps = sum(np.cos(2 * math.pi * k * cycles) for k in stage) / self.stages
        return np.asarray(steps * np.sinc(np.asarray(v) / self.phases))
