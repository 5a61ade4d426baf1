"""Regions of an image: boxes of whole pixels, and polygons in pixel coordinates.

An integer coordinate is a pixel CENTRE: pixel (3, 5) covers 2.5..3.5 rows and 4.5..5.5 columns.
"""

from __future__ import annotations

import operator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import require_all, require_kind, require_numbers, require_shape
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError, RegionError

__all__ = ["Box", "Region"]

_STRIP_PIXELS = 1_000_000
"""Pixels tested at once, so that the outline of a whole scene fits into memory."""


@dataclass(frozen=True)
class Box:
    """A window of whole pixels.

    Parameters
    ----------
    row, col : int
        The first row and the first column. They may lie outside the image until it is read.
    height, width : int
        How many rows and columns; at least 1.

    Raises
    ------
    RegionError
        If a number is not an integer, or the box holds no pixel.
    """

    row: int
    col: int
    height: int
    width: int

    def __post_init__(self) -> None:
        for name in ("row", "col", "height", "width"):
            value = getattr(self, name)
            try:
                # Arithmetic on floats gives whole numbers, too: 20.0.
                is_whole = isinstance(value, float) and value.is_integer()
                object.__setattr__(self, name, int(value) if is_whole else operator.index(value))
            except TypeError:
                raise RegionError(
                    f"{name} of a pixel box must be a whole number, not {value!r}"
                ) from None
        if self.height < 1 or self.width < 1:
            raise RegionError(
                f"a box of {self.height} x {self.width} pixels is empty: "
                "height and width must be at least 1"
            )

    @classmethod
    def whole(cls, shape: tuple[int, int]) -> Box:
        """The box of a whole image of `shape` (rows, columns).

        Raises
        ------
        RegionError
            If it is no pair of whole numbers, 1 or more.
        """
        return cls(0, 0, *_two(shape))

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width)."""
        return self.height, self.width

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns as slices, to cut an array of the whole image."""
        return slice(self.row, self.row + self.height), slice(self.col, self.col + self.width)

    def as_tuple(self) -> tuple[int, int, int, int]:
        """(row, col, height, width)."""
        return self.row, self.col, self.height, self.width

    def intersection(self, other: Box) -> Box | None:
        """The pixels both boxes hold; ``None`` when they share none.

        Raises
        ------
        OptionError
            If the other is no box.
        """
        require_kind(Box, other=other)
        row, col = max(self.row, other.row), max(self.col, other.col)
        height = min(self.row + self.height, other.row + other.height) - row
        width = min(self.col + self.width, other.col + other.width) - col
        return Box(row, col, height, width) if height > 0 and width > 0 else None

    def grown(self, margin_px: int) -> Box:
        """The box with `margin_px` more pixels on every side (fewer when negative).

        Raises
        ------
        OptionError, RegionError
            If the margin is no whole number, or nothing is left.
        """
        require_numbers(margin_px=margin_px)
        return Box(
            self.row - margin_px,
            self.col - margin_px,
            self.height + 2 * margin_px,
            self.width + 2 * margin_px,
        )

    def require_inside(self, shape: tuple[int, int]) -> None:
        """Check that an image of `shape` (rows, columns) holds every pixel of the box.

        Raises
        ------
        RegionError
            If it does not; the message has the part of the box that the image holds.
        """
        shared = self.intersection(Box.whole(shape))
        if shared == self:
            return
        region = f"the region row {self.row}, col {self.col}, {self.height} x {self.width} pixels"
        if shared is None:
            raise RegionError(
                f"{region} lies outside the image of {shape[0]} rows x {shape[1]} columns: "
                "choose a region inside it"
            )
        raise RegionError(
            f"{region} reaches beyond the image of {shape[0]} rows x {shape[1]} columns: "
            f"the part inside is {','.join(map(str, shared.as_tuple()))} (row,col,height,width)"
        )


@dataclass(frozen=True, eq=False)
class Region(ShortRepr):
    """A polygon in pixel coordinates, with or without holes.

    A pixel belongs to the region when its centre lies inside. Of a centre exactly on the outline
    the low sides (top, left) count as inside and the high sides do not, so that two polygons
    that share a side never share a pixel.

    Parameters
    ----------
    vertices : (n, 2) array
        Corners as (row, col); a repeated last corner is dropped. At least 3.
    holes : tuple of (k, 2) arrays, optional
        Outlines of what is left out, in the same coordinates.
    margin_px : float, optional
        Pixels no farther than this from the outline, or from that of a hole, belong to it, too.
    name : str, optional
        What it is called, as a file of regions names it.

    Raises
    ------
    RegionError
        If an outline has fewer than three corners, no area, a coordinate that is not finite, or
        four corners whose sides cross: two triangles instead of the figure that is meant; or if the
        margin is no number from 0 on.
    """

    vertices: Floats
    holes: tuple[Floats, ...] = ()
    margin_px: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        require_kind(str, name=self.name)
        require_numbers(margin_px=self.margin_px)
        if not 0.0 <= self.margin_px < np.inf:
            raise RegionError(f"the margin of a region is {self.margin_px:g} px: give 0 or more")
        object.__setattr__(self, "vertices", _outline(self.vertices))
        holes = require_all(object, "holes", self.holes)
        object.__setattr__(self, "holes", tuple(_outline(hole) for hole in holes))

    @classmethod
    def from_box(cls, box: Box) -> Region:
        """The outline of the pixels of a box, half a pixel outside their centres.

        Raises
        ------
        OptionError
            If it is no box.
        """
        require_kind(Box, box=box)
        top, left = box.row - 0.5, box.col - 0.5
        bottom, right = top + box.height, left + box.width
        return cls(np.array([[top, left], [top, right], [bottom, right], [bottom, left]]))

    def box(self, shape: tuple[int, int]) -> Box:
        """The box of pixels around the region, as far as the image has them.

        Parameters
        ----------
        shape : (rows, columns)
            Of the whole image. What lies outside is cut off.

        Raises
        ------
        RegionError
            If the region holds no pixel centre of the image, or the shape is none.
        """
        shape = _two(shape)
        low = self.vertices.min(axis=0) - self.margin_px
        high = self.vertices.max(axis=0) + self.margin_px
        extent = (
            f"it covers rows {low[0]:.1f} to {high[0]:.1f}, columns {low[1]:.1f} to {high[1]:.1f} "
            f"of an image of {shape[0]} rows x {shape[1]} columns"
        )
        first = np.maximum(np.ceil(low), 0)
        size = np.minimum(np.ceil(high), shape) - first
        if (low > np.array(shape) - 0.5).any() or (high < -0.5).any():
            raise RegionError(f"the region lies outside the image: {extent}; choose one inside it")
        if (size < 1).any() or not self._holds_a_centre(box := Box(*map(int, (*first, *size)))):
            raise RegionError(
                f"the region holds no pixel centre of the image: {extent}; "
                "draw it larger or move it inside"
            )
        return box

    def _holds_a_centre(self, box: Box) -> bool:
        """Whether any pixel of a box is inside, in strips so that a scene fits."""
        strip_rows = max(1, _STRIP_PIXELS // box.width)
        return any(
            self.mask(
                Box(row, box.col, min(strip_rows, box.row + box.height - row), box.width)
            ).any()
            for row in range(box.row, box.row + box.height, strip_rows)
        )

    def mask(self, box: Box) -> NDArray[np.bool_]:
        """Which pixels of a box have their centre inside the region.

        Parameters
        ----------
        box : Box
            May reach beyond the region on any side.

        Returns
        -------
        (height, width) bool array

        Raises
        ------
        OptionError
            If it is no box.
        """
        require_kind(Box, box=box)
        inside = _inside(self.vertices, box)
        for hole in self.holes:
            inside &= ~_inside(hole, box)
        if self.margin_px > 0:
            for outline in (self.vertices, *self.holes):
                inside |= _near(outline, self.margin_px, box)
        return inside


def _two(shape: Any) -> tuple[int, int]:
    """Rows and columns of an image."""
    try:
        return require_shape(shape)
    except OptionError as error:
        raise RegionError(str(error)) from None


def _outline(vertices: ArrayLike) -> Floats:
    """A read-only copy of an outline, open, checked."""
    try:
        corners = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        raise RegionError(
            f"an outline is an array of (row, col) pairs, not {vertices!r:.80}: give numbers"
        ) from None
    if corners.ndim != 2 or corners.shape[1] != 2:
        raise RegionError(
            f"an outline is an array of (row, col) pairs, shape (n, 2), not {corners.shape}"
        )
    if not np.isfinite(corners).all():
        raise RegionError("an outline has a coordinate that is not a finite number: draw it again")
    if len(corners) > 1 and np.array_equal(corners[0], corners[-1]):
        corners = corners[:-1]
    if len(corners) < 3:
        raise RegionError(f"an outline of {len(corners)} corners has no inside: give 3 or more")
    if np.linalg.matrix_rank(corners[1:] - corners[0]) < 2:
        raise RegionError(
            "the corners of an outline lie on one line, so it has no inside: draw it again"
        )
    if len(corners) == 4 and (_cross(*corners) or _cross(*np.roll(corners, -1, axis=0))):
        listed = ", ".join(f"({row:g}, {col:g})" for row, col in corners)
        raise RegionError(
            f"two sides of the outline {listed} (row, col) cross: give its corners in the order "
            "in which one walks around it"
        )
    corners.setflags(write=False)
    return corners


def _cross(a: Floats, b: Floats, c: Floats, d: Floats) -> bool:
    """Whether the side from a to b crosses that from c to d."""
    return _turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0


def _turn(a: Floats, b: Floats, c: Floats) -> float:
    """Twice the area of a triangle, negative where it is walked around the other way."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _inside(outline: Floats, box: Box) -> NDArray[np.bool_]:
    """Even-odd rule at the pixel centres of a box, row by row.

    A side crosses a row of centres at one column; every centre to the right of it changes its
    mind once. Counting the crossings left of each centre costs sides x rows + rows x columns;
    only the parity counts, so a byte that overflows does no harm.
    """
    start, stop = outline, np.roll(outline, -1, axis=0)
    rows = np.arange(box.row, box.row + box.height, dtype=np.float64)[:, np.newaxis]
    crossed = (start[:, 0] <= rows) != (stop[:, 0] <= rows)
    at_row, side = np.nonzero(crossed)
    done = (rows[at_row, 0] - start[side, 0]) / (stop[side, 0] - start[side, 0])
    column = start[side, 1] + done * (stop[side, 1] - start[side, 1])
    first = np.clip(np.ceil(column) - box.col, 0, box.width).astype(np.intp)
    crossings = np.zeros((box.height, box.width + 1), dtype=np.uint8)
    np.add.at(crossings, (at_row, first), 1)
    inside: NDArray[np.bool_] = np.cumsum(crossings[:, :-1], axis=1, dtype=np.uint8) % 2 == 1
    return inside


def _near(outline: Floats, margin_px: float, box: Box) -> NDArray[np.bool_]:
    """Which pixels of a box have their centre within a margin of an outline, row by row.

    What lies within the margin of one side is convex: in every row it is one run of columns, whose
    ends belong to the points of the side that a tangent at the margin touches there.
    """
    start, step = outline, np.roll(outline, -1, axis=0) - outline
    low, high = np.minimum(start, start + step)[:, 0], np.maximum(start, start + step)[:, 0]
    rows = np.arange(box.row, box.row + box.height, dtype=np.float64)[:, np.newaxis]
    at_row, side = np.nonzero((low - margin_px <= rows) & (rows < high + margin_px))
    (down, right), away = step[side].T, rows[at_row, 0] - start[side, 0]
    reach = margin_px * np.abs(right) / np.maximum(np.hypot(down, right), 1e-300)
    ends = []
    for sense in (-1.0, 1.0):
        towards = np.sign(sense * right * down)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            share = np.clip((away + towards * reach) / down, 0.0, 1.0)
        share = np.where(down == 0.0, sense * right > 0.0, share)
        half = np.sqrt(np.maximum(margin_px**2 - (away - share * down) ** 2, 0.0))
        ends.append(start[side, 1] + share * right + sense * half)
    first, stop = (np.clip(np.ceil(one) - box.col, 0, box.width).astype(np.intp) for one in ends)
    runs = np.zeros((box.height, box.width + 1), dtype=np.int16)
    np.add.at(runs, (at_row, first), 1)
    np.add.at(runs, (at_row, stop), -1)
    near: NDArray[np.bool_] = np.cumsum(runs[:, :-1], axis=1, dtype=np.int16) > 0
    return near
