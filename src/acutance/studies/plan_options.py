"""What is planned of an edge or a pulse; what is refused of mirrors, too."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.optics import Sensor, preset

__all__ = [
    "MAX_ROWS",
    "MAX_WIDTH_PX",
    "MIN_ROWS",
    "MIN_WIDTH_PX",
    "PlanOptions",
    "require_accuracy",
    "require_several_draws",
]

MIN_WIDTH_PX, MAX_WIDTH_PX = 0.5, 20.0
MIN_ROWS, MAX_ROWS = 20, 2000

_RANGES = {"snr": (1.0, 1e6), "window_px": (0.1, 1000.0)}


@dataclass(frozen=True)
class PlanOptions:
    """What is planned, and what it is varied by.

    The first number of rows and the first angle are the plan itself; of several widths it is
    the one with the least bound of a free line spread function (LSF).

    Parameters
    ----------
    target : {"edge", "pulse"}
    sensor : Sensor
    snr : float
        Height of the target over the standard deviation of the noise, 1 to a million.
    rows : tuple of int
        Image rows that cross the target, 20 to 2000. A single number is varied from half to twice.
    angles_deg : tuple of float
        Tilts against the image's columns. A single number is compared with the usual ones.
    widths_px : tuple of float
        Widths of the pulse. A single number is compared with others from 1.5 to 4 px.
    draws : int
        Simulated images a design, 2 or more; 0 leaves the simulation out.
    window_px : float
        Of the bound of a free LSF, 0.1 to 1000.
    accuracy : float, optional
        Wanted standard deviation of the MTF at Nyquist: answered by a number of rows.
    sensor_name : str, optional
        What the sensor is called.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    target: Literal["edge", "pulse"] = "edge"
    sensor: Sensor = field(default_factory=lambda: preset("generic-2005"))
    snr: float = 100.0
    rows: tuple[int, ...] = (40,)
    angles_deg: tuple[float, ...] = (6.0,)
    widths_px: tuple[float, ...] = (3.0,)
    draws: int = 200
    window_px: float = 10.0
    accuracy: float | None = None
    sensor_name: str = ""

    def __post_init__(self) -> None:
        require_types(self)
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise OptionError(f"{name} is {value:g}: give {low:g} to {high:g}")
        if self.draws < 0:
            raise OptionError(
                f"draws is {self.draws}: give 2 or more simulated images, or 0 for the bounds alone"
            )
        require_several_draws(self.draws, "bounds")
        if not self.rows or min(self.rows) < MIN_ROWS or max(self.rows) > MAX_ROWS:
            raise OptionError(
                f"rows (--rows): {_listed(self.rows)}; a target needs at least {MIN_ROWS} to be "
                f"measured, and {MAX_ROWS} are the most that are planned; beyond, deviations "
                "fall with the square root of the rows"
            )
        if not self.angles_deg or not all(0 < angle <= 30 for angle in self.angles_deg):
            raise OptionError(
                f"angles_deg (--angle): {_listed(self.angles_deg)}; an edge without tilt has no "
                "sub-pixel phases, more than 30 degrees is not planned, and tilts the other way "
                "are as good: give them without a sign; 5 to 10 are best"
            )
        if not self.widths_px or not all(
            MIN_WIDTH_PX <= width <= MAX_WIDTH_PX for width in self.widths_px
        ):
            raise OptionError(
                f"widths_px (--width-px, --width-m): {_listed(self.widths_px)} px; a pulse is "
                f"{MIN_WIDTH_PX:g} to {MAX_WIDTH_PX:g} px wide, 3 is best; check the width and the "
                "GSD"
            )
        require_accuracy(self.accuracy)


def require_several_draws(draws: int, alone: str) -> None:
    """Refuse a plan of one simulated image.

    Parameters
    ----------
    draws : int
    alone : str
        What a plan without any has, in words.

    Raises
    ------
    OptionError
        If there is one.
    """
    if draws == 1:
        raise OptionError(
            "draws (--draws) is 1: a single simulated image has no scatter; give 2 or more, or 0 "
            f"for the {alone} alone"
        )


def require_accuracy(accuracy: float | None) -> None:
    """Refuse a wanted standard deviation that is none.

    Raises
    ------
    OptionError
        If one is wanted that is not finite and above 0.
    """
    if accuracy is not None and not 0 < accuracy < math.inf:
        raise OptionError(f"accuracy is {accuracy:g}: it has to be finite and above 0")


def _listed(numbers: Sequence[float]) -> str:
    """Numbers as they are typed."""
    return ", ".join(f"{one:.4g}" for one in numbers) or "none"
