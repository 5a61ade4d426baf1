"""Options of a scan, and the limits of its checks."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from acutance.arguments import require_types
from acutance.curves import Estimate
from acutance.errors import OptionError
from acutance.scan.checks import SCENE_CHECKS
from acutance.targets.check import Limits, require_limits
from acutance.targets.straight.stated_target import require_softness, stated_number

__all__ = ["ScanOptions"]

_RANGES = {
    "min_length_px": (8.0, 200.0),
    "max_length_px": (16.0, 400.0),
    "half_width_px": (8.0, 60.0),
    "min_gradient_sigmas": (3.0, 100.0),
    "window_px": (128, 8192),
}
_MAX_PLACES = 20


@dataclass(frozen=True)
class ScanOptions:
    """Options of a scan.

    Parameters
    ----------
    min_length_px : float
        Shorter edges are left out.
    max_length_px : float
        Longer edges are cut into pieces, each measured by itself: objects are seldom ideal, or
        straight, all along.
    half_width_px : float
        How far the region of an edge reaches to either side; what does not belong is trimmed.
    min_gradient_sigmas : float
        Least gradient of an edge, in units of its noise on quiet ground.
    window_px : int
        Largest side of the windows in which an image is read. A small image is read in smaller
        ones, of 512 px and more, so that several processes have something to do.
    places : (int, int)
        Rows and columns of equal parts of the scene, in the middle of which sharpness is told.
    limits : mapping of str to float
        Limits of checks to be asked instead of those of the table, by name.
    target_softness_m, target_softness_px : Estimate or float, optional
        Standard deviation of the Gaussian profile of the sharpest objects' borders, with its own
        standard deviation, in metres or pixels: the sensor is the one behind it. What the scene
        shows are objects that are softer than these.

    Raises
    ------
    OptionError
        If a number makes no sense.
    """

    min_length_px: float = 15.0
    max_length_px: float = 64.0
    half_width_px: float = 20.0
    min_gradient_sigmas: float = 6.0
    window_px: int = 1024
    places: tuple[int, int] = (3, 3)
    limits: Limits = field(default_factory=dict)
    target_softness_m: Estimate | float | None = None
    target_softness_px: Estimate | float | None = None

    def __post_init__(self) -> None:
        require_types(self)
        require_softness(self)
        require_limits(self.limits, SCENE_CHECKS, "ScanOptions")
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                # Longer edges are cut into pieces.
                most = self.max_length_px // 1.5 if name == "min_length_px" else high
                raise OptionError(f"{name} is {value:g}: give {low:g} to {min(high, most):g}")
        if not all(1 <= count <= _MAX_PLACES for count in self.places):
            raise OptionError(
                f"places (--field) is {self.places[0]} x {self.places[1]}: give 1 to "
                f"{_MAX_PLACES} by row and by column"
            )
        if self.max_length_px < 1.5 * self.min_length_px:
            raise OptionError(
                f"min_length_px (--min-length) is {self.min_length_px:g}, and longer edges are cut "
                f"into pieces of at most max_length_px, {self.max_length_px:g}: give at most "
                f"{math.floor(self.max_length_px / 1.5)}, two thirds of it"
            )

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        numbers = {name: getattr(self, name) for name in _RANGES}
        return {
            **numbers,
            "places": list(self.places),
            "limits": dict(self.limits),
            "target_softness_m": stated_number(self.target_softness_m),
            "target_softness_px": stated_number(self.target_softness_px),
        }
