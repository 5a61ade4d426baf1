"""A straight or gently curved edge in the image plane."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from numpy.typing import ArrayLike

from acutance.arguments import require_floats, require_numbers
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.angles import angle_to_grid, is_nearer_columns, wrap_direction

__all__ = ["Line", "Orientation", "axis_names"]

Orientation = Literal["across", "along"]


def axis_names(along_track: str) -> tuple[Orientation, Orientation]:
    """What the axes x and y of an image are called: x across, unless it was declared along."""
    return ("along", "across") if along_track == "x" else ("across", "along")


@dataclass(frozen=True)
class Line:
    """A line with a direction: its unit normal points from dark to bright.

    A curved one is a parabola that touches the straight one in its point.

    Parameters
    ----------
    row, col : float
        A point on the line, in pixels; integers are pixel centres.
    normal_deg : float
        Direction of the normal, from the column axis (x) towards the row axis (y, downwards),
        in (-180, 180].
    angle_std_deg : float, optional
        Standard deviation of the direction.
    offset_std_px : float, optional
        Standard deviation of the position along the normal.
    length_px : float, optional
        How much of the line was used.
    curvature_per_px : float, optional
        One over its radius, positive where it bends towards the bright side.

    Raises
    ------
    OptionError
        If one of them is no number.
    """

    row: float
    col: float
    normal_deg: float
    angle_std_deg: float = 0.0
    offset_std_px: float = 0.0
    length_px: float = math.nan
    curvature_per_px: float = 0.0

    def __post_init__(self) -> None:
        require_numbers(**vars(self))

    @property
    def normal(self) -> tuple[float, float]:
        """Unit normal as its (x, y) components, that is (column, row)."""
        return unit_vector(self.normal_deg)

    @property
    def orientation(self) -> Orientation:
        """ "across" when the normal is nearer the column axis, "along" when nearer the rows'."""
        return "across" if is_nearer_columns(self.normal_deg) else "along"

    @property
    def angle_deg(self) -> float:
        """Acute angle between the edge and the nearer image axis, 0 to 45 degrees."""
        return angle_to_grid(self.normal_deg)

    def normal_distance(self, row: ArrayLike, col: ArrayLike) -> Floats:
        """Signed distance along the normal in pixels, positive on the bright side."""
        return self.distances(row, col)[0]

    def tangent_distance(self, row: ArrayLike, col: ArrayLike) -> Floats:
        """Signed distance along the line in pixels, from its point (row, col)."""
        return self.distances(row, col)[1]

    def distances(self, row: ArrayLike, col: ArrayLike) -> tuple[Floats, Floats]:
        """Signed distances along the normal and along the line: the one needs the other."""
        x, y = self.normal
        right = require_floats("col", col) - self.col
        down = require_floats("row", row) - self.row
        away, along = x * right + y * down, x * down - y * right
        if self.curvature_per_px != 0:
            away -= 0.5 * self.curvature_per_px * along**2
        return away, along

    def moved(self, offset_px: float, turn_deg: float) -> Line:
        """The line shifted along its normal, then turned about its point (small changes)."""
        require_numbers(offset_px=offset_px, turn_deg=turn_deg)
        x, y = self.normal
        return replace(
            self,
            row=self.row + offset_px * y,
            col=self.col + offset_px * x,
            normal_deg=wrap_direction(self.normal_deg + turn_deg),
        )

    def bent(self, curvature_per_px: float) -> Line:
        """The line with some more curvature."""
        require_numbers(curvature_per_px=curvature_per_px)
        return replace(self, curvature_per_px=self.curvature_per_px + curvature_per_px)

    def slid(self, along_px: float) -> Line:
        """The same line, by another of its points."""
        require_numbers(along_px=along_px)
        x, y = self.normal
        aside_px = 0.5 * self.curvature_per_px * along_px**2
        turn_deg = math.degrees(self.curvature_per_px * along_px)
        return replace(
            self,
            row=self.row + x * along_px + y * aside_px,
            col=self.col - y * along_px + x * aside_px,
            normal_deg=wrap_direction(self.normal_deg - turn_deg),
        )

    def to_dict(self) -> dict[str, float | str | None]:
        """Position, direction and what was used, for JSON."""
        return {
            "row": self.row,
            "col": self.col,
            "normal_deg": self.normal_deg,
            "length_px": self.length_px if math.isfinite(self.length_px) else None,
            "curvature_per_px": self.curvature_per_px,
            "orientation": self.orientation,
        }
