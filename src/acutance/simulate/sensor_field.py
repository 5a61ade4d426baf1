"""Sensors whose blur changes over the field of view."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

from acutance.optics import Gaussian, Sensor
from acutance.optics.block import require
from acutance.simulate.limits import require_shape

__all__ = ["SensorField", "SoftCorners", "sensor_at"]


class SensorField(Protocol):
    """A sensor that is another one at every place of the image."""

    def at(self, row: float, col: float) -> Sensor:
        """The sensor at a place in pixels; integers are pixel centres."""
        ...


@dataclass(frozen=True)
class SoftCorners:
    """A sensor with a Gaussian blur that grows from the middle of the image to its corners.

    The standard deviation of the added blur is proportional to the distance from the middle.

    Parameters
    ----------
    sensor : Sensor
        In the middle.
    shape : (rows, cols)
        Of the image.
    corner_px : float
        Standard deviation of the added blur in the corners.
    """

    sensor: Sensor
    shape: tuple[int, int]
    corner_px: float

    def __post_init__(self) -> None:
        require_shape(self.shape, 10**12)
        require(self, corner_px=self.corner_px)

    def at(self, row: float, col: float) -> Sensor:
        """The sensor at a place in pixels."""
        half_rows, half_cols = (0.5 * (size - 1) for size in self.shape)
        away = math.hypot(row - half_rows, col - half_cols)
        added = self.corner_px * away / max(math.hypot(half_rows, half_cols), 0.5)
        if added == 0:
            return self.sensor
        return replace(self.sensor, blocks=[*self.sensor.blocks, Gaussian(added)])


def sensor_at(sensor: Sensor | SensorField, row: float, col: float) -> Sensor:
    """The sensor at a place: itself where it is the same everywhere."""
    return sensor if isinstance(sensor, Sensor) else sensor.at(row, col)
