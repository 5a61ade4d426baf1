"""Sensors whose blur changes over the field of view."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

from acutance.arguments import require_numbers
from acutance.optics import Gaussian, Sensor
from acutance.optics.block import require
from acutance.optics.sensor import require_sensor
from acutance.simulate.limits import require_shape

__all__ = ["SensorField", "SoftCorners", "TiltedFocus", "sensor_at"]


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
        require_sensor(self.sensor)
        require_shape(self.shape, 10**12)
        require(self, corner_px=self.corner_px)

    def at(self, row: float, col: float) -> Sensor:
        """The sensor at a place in pixels."""
        require_numbers(row=row, col=col)
        half_rows, half_cols = (0.5 * (size - 1) for size in self.shape)
        away = math.hypot(row - half_rows, col - half_cols)
        added = self.corner_px * away / max(math.hypot(half_rows, half_cols), 0.5)
        return _blurred(self.sensor, added, added)


@dataclass(frozen=True)
class TiltedFocus:
    """A sensor whose detector line is tilted: sharp in one column, and less so away from it.

    Defocus is proportional to the distance from the column of best focus, and so is its blur, a
    Gaussian. With astigmatism the blur across differs from the one along.

    Parameters
    ----------
    sensor : Sensor
        In best focus.
    shape : (rows, cols)
        Of the image.
    across_px, along_px : float
        Standard deviations of the added blur along the column axis and along the row axis, in the
        column farthest from the focus.
    focus_col : float, optional
        Column of best focus; the first one unless given.
    """

    sensor: Sensor
    shape: tuple[int, int]
    across_px: float
    along_px: float
    focus_col: float = 0.0

    def __post_init__(self) -> None:
        require_sensor(self.sensor)
        require_shape(self.shape, 10**12)
        require(self, across_px=self.across_px, along_px=self.along_px)
        require(self, 0.0, self.shape[1] - 1.0, focus_col=self.focus_col)

    def at(self, row: float, col: float) -> Sensor:
        """The sensor at a place in pixels: the same one in every row."""
        require_numbers(row=row, col=col)
        farthest = max(self.focus_col, self.shape[1] - 1 - self.focus_col, 0.5)
        share = abs(col - self.focus_col) / farthest
        return _blurred(self.sensor, self.across_px * share, self.along_px * share)


def _blurred(sensor: Sensor, across_px: float, along_px: float) -> Sensor:
    """A sensor with a Gaussian blur of two standard deviations added."""
    if across_px == along_px == 0:
        return sensor
    return replace(sensor, blocks=[*sensor.blocks, Gaussian(across_px, along_px)])


def sensor_at(sensor: Sensor | SensorField, row: float, col: float) -> Sensor:
    """The sensor at a place: itself where it is the same everywhere.

    Raises
    ------
    OptionError
        If it is neither a sensor nor a field of them.
    """
    at = getattr(sensor, "at", None)
    return require_sensor(sensor if at is None else at(row, col))
