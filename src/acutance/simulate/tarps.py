"""Tarps on the ground: where they lie, what they are made of, what of them can be measured."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.arguments import require_all, require_kind, require_numbers, require_whole
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.geometry.line import Line
from acutance.optics.block import require
from acutance.optics.sensor import normal_direction_deg
from acutance.simulate.limits import MAX_SCENE_PIXELS, require_darker, require_shape
from acutance.simulate.scene import Patch

__all__ = ["EdgeTarps", "PulseTarp", "tarp_patches", "tarp_region", "tarp_rows"]

GUARD_PX = 3.0
"""Distance a region keeps from the ends of a target."""


@dataclass(frozen=True)
class EdgeTarps:
    """Two square tarps side by side, the darker one first along the normal.

    Parameters
    ----------
    name : str
    row, col : float
        Middle of their common edge in pixels.
    normal_deg : float
        Direction from the dark to the bright one, from the column axis towards the row axis.
    side_px : float
        Side of a tarp.
    dark, bright : float
        Their levels, in image units; dark below bright.

    Raises
    ------
    ModelError
        If a number makes no sense, or the dark tarp is not the darker one.
    OptionError
        If the name is no text.
    """

    name: str
    row: float
    col: float
    normal_deg: float
    side_px: float
    dark: float
    bright: float

    def __post_init__(self) -> None:
        require_kind(str, name=self.name)
        require(self, 8.0, side_px=self.side_px)
        require(self, -math.inf, row=self.row, col=self.col, normal_deg=self.normal_deg)
        require(self, -math.inf, dark=self.dark, bright=self.bright)
        advice = "turn the normal by 180 degrees to exchange the tarps"
        require_darker(self.dark, self.bright, advice, of="EdgeTarps: ")


@dataclass(frozen=True)
class PulseTarp:
    """One long tarp on the ground.

    Parameters
    ----------
    name : str
    row, col : float
        Its centre in pixels.
    normal_deg : float
        Direction across it, from the column axis towards the row axis.
    width_px, length_px : float
        Its sides, the first along the normal.
    level : float
        In image units.
    """

    name: str
    row: float
    col: float
    normal_deg: float
    width_px: float
    length_px: float
    level: float

    def __post_init__(self) -> None:
        require_kind(str, name=self.name)
        require(self, above=True, width_px=self.width_px, length_px=self.length_px)
        require(self, -math.inf, row=self.row, col=self.col, normal_deg=self.normal_deg)
        require(self, -math.inf, level=self.level)


def tarp_rows(
    shape: tuple[int, int], count: int, *, turn_deg: float = 6.0
) -> tuple[EdgeTarps | PulseTarp, ...]:
    """Edge tarps and pulse tarps in turn, spread evenly over a large image.

    Parameters
    ----------
    shape : (rows, cols)
        Of the image.
    count : int
        Number of targets.
    turn_deg : float, optional
        Tilt of all of them.

    Returns
    -------
    tuple of EdgeTarps and PulseTarp
        Edges across, pulses, edges along, in turn; every one at phases of its own.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind.
    ModelError
        If there are none, they are turned too far, or each would have less than 90 by 90 pixels.
    """
    require_shape(shape, MAX_SCENE_PIXELS)
    require_numbers(count=count, turn_deg=turn_deg)
    if count < 1 or not abs(turn_deg) <= 45:
        raise ModelError(
            f"{count} targets turned by {turn_deg:g} deg were requested: there has to be 1 or "
            "more, turned by -45 to 45"
        )
    require_whole(1, count=count)
    cols = max(1, round(math.sqrt(count * shape[1] / shape[0])))
    rows = math.ceil(count / cols)
    pitch = (shape[0] / rows, shape[1] / cols)
    if min(pitch) < 90:
        raise ModelError(
            f"{count} targets in {shape[0]} by {shape[1]} px have {min(pitch):.0f} px each, 90 are "
            "needed: use a larger image or fewer targets"
        )
    tarps: list[EdgeTarps | PulseTarp] = []
    for i in range(count):
        row = (i // cols + 0.5) * pitch[0] - 0.5 + 0.37 * (i % 7)
        col = (i % cols + 0.5) * pitch[1] - 0.5 + 0.29 * (i % 5)
        across, along = turn_deg, normal_direction_deg(turn_deg, "along")
        if i % 3 == 1:
            tarps.append(PulseTarp(f"pulse-{i + 1}", row, col, across, 3.0, 50.0, 1200.0))
        else:
            normal = across if i % 3 == 0 else along
            tarps.append(EdgeTarps(f"edge-{i + 1}", row, col, normal, 30.0, 200.0, 1200.0))
    return tuple(tarps)


def tarp_patches(tarp: EdgeTarps | PulseTarp, first: float, second: float) -> list[Patch]:
    """The rectangles of a target with levels of their own; a pulse has the first level alone.

    Raises
    ------
    OptionError
        If it is no such target.
    """
    require_all((EdgeTarps, PulseTarp), "tarp", [tarp])
    middle = Line(tarp.row, tarp.col, tarp.normal_deg)
    if isinstance(tarp, PulseTarp):
        sides = (tarp.width_px, tarp.length_px, tarp.normal_deg)
        return [Patch(tarp.row, tarp.col, *sides, first)]
    side = tarp.side_px
    halves = [
        (middle.moved(way * 0.5 * side, 0.0), level) for way, level in ((-1, first), (1, second))
    ]
    return [Patch(at.row, at.col, side, side, tarp.normal_deg, level) for at, level in halves]


def tarp_region(tarp: EdgeTarps | PulseTarp) -> Floats:
    """Corners of what may be measured of a target, (4, 2) as (row, col).

    Raises
    ------
    OptionError
        If it is no such target.
    """
    require_all((EdgeTarps, PulseTarp), "tarp", [tarp])
    if isinstance(tarp, PulseTarp):
        across, along = 0.5 * tarp.width_px + 14.0, 0.5 * tarp.length_px - GUARD_PX
    else:
        across, along = tarp.side_px - GUARD_PX, 0.5 * tarp.side_px - GUARD_PX
    return _rectangle(tarp.row, tarp.col, tarp.normal_deg, across, along)


def _rectangle(row: float, col: float, normal_deg: float, across: float, along: float) -> Floats:
    x, y = Line(row, col, normal_deg).normal
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.array(
        [
            (row + a * across * y + b * along * x, col + a * across * x - b * along * y)
            for a, b in corners
        ]
    )
