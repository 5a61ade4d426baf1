"""Rows that cross an edge: turning the image, fitting the line, distances, sample phases.

The published edge methods all work row by row on an edge that rises to the right. Here
the edge is brought into that position once, and everything found there is taken back to
the pixels of the region.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError, PhaseError, SupportError
from acutance.geometry.line import Line
from acutance.targets.straight.pixels import EdgePixels

__all__ = [
    "MIN_ROWS",
    "Frame",
    "Locate",
    "LocatedRows",
    "RowLine",
    "crossing_rows",
    "locate_rows",
    "require_phases_for",
]

MIN_ROWS = 10
"""Fewest rows an edge may have: the lower limit of the KOMPSAT-3 draft, step 3e."""

MAX_PHASE_GAP_PX = 0.3
"""Widest gap between neighbouring sample phases along a row: four phases and a little room."""

_DISTINCT_PX = 0.08
"""Phases nearer to each other than this are one: the line's own error may part them.

Of evenly spaced ones that are a little nearer every second counts: 6, as many as a quartic needs.
"""

_REACH_PX = 3
"""Pixels on each side of the edge that must be usable for a row to locate it (seven in all)."""


@dataclass(frozen=True)
class Frame:
    """How an image is turned so that its rows cross the edge from dark to bright.

    Parameters
    ----------
    transposed : bool
        Rows and columns change places; this comes first.
    flipped : bool
        Every row then runs backwards.
    cols : int
        Columns of the turned image.
    """

    transposed: bool
    flipped: bool
    cols: int

    @classmethod
    def of(cls, trimmed: EdgePixels) -> Frame:
        """The frame in which the edge rises to the right."""
        x, y = trimmed.line.normal
        transposed = trimmed.line.orientation == "along"
        rows, cols = trimmed.image.shape
        return cls(transposed, (y if transposed else x) < 0, rows if transposed else cols)

    def turn(self, image: Floats) -> Floats:
        """The turned image; a view."""
        upright = image.T if self.transposed else image
        return upright[:, ::-1] if self.flipped else upright

    def turned_line(self, line: Line) -> tuple[float, float]:
        """Slope and column at row 0 of a `line` of the region, in the turned image."""
        row, col, (x, y) = line.row, line.col, line.normal
        if self.transposed:
            row, col, x, y = col, row, y, x
        if self.flipped:
            col, x = self.cols - 1 - col, -x
        slope = -y / x
        return slope, col - slope * row

    def line_in_region(self, line: RowLine) -> Line:
        """A line of the turned image, in pixels of the region."""
        length = math.hypot(1.0, line.slope)
        row, col, x, y = line.row, line.col, 1.0 / length, -line.slope / length
        if self.flipped:
            col, x = self.cols - 1 - col, -x
        if self.transposed:
            row, col, x, y = col, row, y, x
        return Line(
            row=row,
            col=col,
            normal_deg=math.degrees(math.atan2(y, x)),
            angle_std_deg=math.degrees(line.slope_std) / length**2,
            offset_std_px=line.col_std_px / length,
            length_px=line.rows * length,
        )


@dataclass(frozen=True)
class RowLine:
    """The line ``col + slope * (r - row)`` through the edge of every row r of a turned image.

    Parameters
    ----------
    row, col : float
        Mean of the rows used, and the edge there.
    slope : float
        Columns per row.
    slope_std, col_std_px : float
        Standard deviations by the scatter of the rows about the line.
    rows : float
        How many rows the line spans.
    """

    row: float
    col: float
    slope: float
    slope_std: float
    col_std_px: float
    rows: float

    @property
    def cosine(self) -> float:
        """Cosine of the angle between the edge's normal and the rows."""
        return 1.0 / math.hypot(1.0, self.slope)

    def at(self, row: Floats) -> Floats:
        """Column of the edge in every row."""
        return self.col + self.slope * (row - self.row)


@dataclass(frozen=True, eq=False)
class LocatedRows:
    """The rows that show the edge, with its place in each.

    Parameters
    ----------
    frame : Frame
    row : (n,) array
        Row of the turned image.
    col : (n,) array
        Sub-pixel column of the edge in that row.
    value : (n, cols) array
        The pixels of those rows; NaN where they must not be used.
    """

    frame: Frame
    row: Floats
    col: Floats
    value: Floats

    def line(self, weight: Floats | None = None) -> RowLine:
        """Least-squares line through the locations, rows weighted by `weight` (n,)."""
        weight = np.ones_like(self.row) if weight is None else weight
        total = weight.sum()
        row = float(weight @ self.row / total)
        col = float(weight @ self.col / total)
        lever = self.row - row
        spread = float(weight @ lever**2)
        if spread <= 0:
            raise SupportError("all rows that were drawn are the same one: give more rows")
        slope = float(weight @ (lever * (self.col - col)) / spread)
        misfit = self.col - col - slope * lever
        variance = float(weight @ misfit**2) / max(total - 2.0, 1.0)
        return RowLine(
            row=row,
            col=col,
            slope=slope,
            slope_std=math.sqrt(variance / spread),
            col_std_px=math.sqrt(variance / total),
            rows=float(np.ptp(self.row)) + 1.0,
        )

    def row_distance(self, line: RowLine) -> Floats:
        """Distance of every pixel from `line` along its row in pixels, (n, cols)."""
        columns = np.arange(self.value.shape[1], dtype=float)
        return columns - line.at(self.row)[:, None]

    def reach_px(self, line: RowLine) -> tuple[float, float]:
        """How far half of the rows reach to the dark and to the bright side, along the row."""
        distance = np.where(np.isfinite(self.value), self.row_distance(line), np.nan)
        low = float(-np.median(np.nanmin(distance, axis=1)))
        high = float(np.median(np.nanmax(distance, axis=1)))
        return low, high

    def first(self, count: int) -> LocatedRows:
        """The first `count` rows."""
        return LocatedRows(self.frame, self.row[:count], self.col[:count], self.value[:count])


Locate = Callable[[Floats, Floats, float], Floats]
"""Rows (n, cols), where the edge is expected (n,), its Gaussian width in pixels -> columns (n,).

A row that shows no edge gets NaN.
"""


def locate_rows(trimmed: EdgePixels, locate: Locate) -> LocatedRows:
    """Find the edge in every row that crosses it.

    Rows where the edge leaves the trimmed, or has an unusable pixel within three pixels of it,
    are left out.

    Parameters
    ----------
    trimmed : EdgePixels
    locate : callable
        The method's own way to place the edge in a row, see `Locate`.

    Raises
    ------
    SupportError
        If fewer than `MIN_ROWS` rows cross the edge.
    NoEdgeError
        If fewer than `MIN_ROWS` of those rows show an edge the method can place.
    PhaseError
        If the phases of the samples leave a gap over `MAX_PHASE_GAP_PX`.
    """
    frame = Frame.of(trimmed)
    row, expected, value = crossing_rows(trimmed, frame)
    col = locate(value, expected, trimmed.width_px)
    found = np.isfinite(col)
    if found.sum() < MIN_ROWS:
        raise NoEdgeError(
            f"an edge was placed in {int(found.sum())} of {row.size} rows, at least {MIN_ROWS} "
            "are needed: use a region with more contrast or less noise"
        )
    located = LocatedRows(frame, row[found], col[found], value[found])
    _require_phases(located)
    return located


def crossing_rows(trimmed: EdgePixels, frame: Frame) -> tuple[Floats, Floats, Floats]:
    """The rows of the turned image that cross the edge with usable pixels around it.

    Returns
    -------
    row : (n,) array
    expected : (n,) array
        Column of the line in that row.
    value : (n, cols) array

    Raises
    ------
    SupportError
        If there are fewer than `MIN_ROWS`.
    """
    image = frame.turn(trimmed.image)
    slope, intercept = frame.turned_line(trimmed.line)
    row = np.arange(image.shape[0], dtype=float)
    expected = intercept + slope * row
    crosses = _crosses(image, expected)
    if crosses.sum() < MIN_ROWS:
        raise SupportError(
            f"at least {MIN_ROWS} rows must cross the edge with {_REACH_PX} usable pixels on "
            f"each side, found {int(crosses.sum())} of {row.size}: use a longer or wider region"
        )
    return row[crosses], expected[crosses], image[crosses]


def _crosses(image: Floats, expected: Floats) -> NDArray[np.bool_]:
    """Which rows hold the edge with usable pixels around it, (rows,)."""
    centre = np.rint(expected).astype(int)
    columns = centre[:, None] + np.arange(-_REACH_PX, _REACH_PX + 1)
    inside = (columns >= 0) & (columns < image.shape[1])
    near = np.take_along_axis(image, np.clip(columns, 0, image.shape[1] - 1), axis=1)
    crosses: NDArray[np.bool_] = (inside & np.isfinite(near)).all(axis=1)
    return crosses


def _require_phases(rows: LocatedRows) -> None:
    line = rows.line()
    phase = np.sort(line.at(rows.row) % 1.0)
    gap = float(np.max(np.diff(np.concatenate((phase, phase[:1] + 1.0)))))
    if gap <= MAX_PHASE_GAP_PX:
        return
    angle_deg = math.degrees(math.atan(abs(line.slope)))
    found = (
        f"edge angle {angle_deg:.2f} deg over {rows.row.size} rows leaves {gap:.2f} px between "
        f"sample phases, at most {MAX_PHASE_GAP_PX} px is allowed"
    )
    if abs(line.slope) * line.rows < 1.0:
        enough = math.ceil(1.0 / max(abs(line.slope), 1e-3))
        raise PhaseError(f"{found}: use a region of {enough} rows or a more inclined edge")
    raise PhaseError(
        f"{found}: the slope repeats after a few rows (tan near 1, 1/2, 1/3 ...); "
        "use an edge of another angle or the method 'fermi'"
    )


def require_phases_for(order: int, rows: LocatedRows) -> None:
    """Refuse rows whose samples repeat at too few places for a polynomial of that order.

    In a window of 1 px the samples of all rows stand at their phases. Where those repeat after
    q rows (tan = p/q), a polynomial with q coefficients or more passes through q clumps of
    samples, and what it does between them follows the error of the line within each clump.

    Parameters
    ----------
    order : int
        Degree of the local polynomial.
    rows : LocatedRows

    Raises
    ------
    PhaseError
        If the distinct phases are not more than `order` + 1.
    """
    line = rows.line()
    phase = np.sort(line.at(rows.row) % 1.0)
    distinct, last = 1, phase[0]
    for place in phase[1:]:
        if place - last >= _DISTINCT_PX and phase[0] + 1.0 - place >= _DISTINCT_PX:
            distinct, last = distinct + 1, place
    if distinct > order + 1:
        return
    angle_deg = math.degrees(math.atan(abs(line.slope)))
    lower = " or a polynomial of order 2" if order > 2 and distinct > 3 else ""
    raise PhaseError(
        f"an angle of {angle_deg:.2f} deg over {rows.row.size} rows gives {distinct} distinct "
        f"sample phases, a local polynomial of order {order} needs {order + 2}: use another "
        f"angle, more rows{lower}"
    )
