"""Parcels of a landscape: fields, roofs, roads and ponds with borders of any direction."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr

from acutance.arguments import require_choice, require_whole
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line
from acutance.optics.block import require

__all__ = ["Border", "Parcel", "ParcelKind", "SideStrip", "StripKind"]

ParcelKind = Literal["field", "roof", "road", "disc"]
StripKind = Literal["rim", "gutter", "shadow"]

_WIDTH_SIGMA = 7.0
"""A soft border is 0 and 1 to 1e-12 beyond so many of its standard deviations."""


@dataclass(frozen=True)
class Border:
    """One side of a parcel: a straight line, or an arc of a circle, of finite length.

    Parameters
    ----------
    row, col : float
        Its middle in pixels; integers are pixel centres.
    normal_deg : float
        Direction of the normal at the middle, into the parcel, from the column axis towards the
        row axis.
    length_px : float
        Along the line or the arc.
    softness_px : float, optional
        Standard deviation of a Gaussian that blurs the border on the ground.
    curvature_per_px : float, optional
        One over the radius: above 0 when the centre lies inside the parcel, 0 for a line.
    """

    row: float
    col: float
    normal_deg: float
    length_px: float
    softness_px: float = 0.0
    curvature_per_px: float = 0.0

    def __post_init__(self) -> None:
        require(self, above=True, length_px=self.length_px)
        require(self, softness_px=self.softness_px)
        require(self, -1.0, 1.0, curvature_per_px=self.curvature_per_px)
        require(self, -math.inf, row=self.row, col=self.col, normal_deg=self.normal_deg)

    def along_and_across(self, rows: ArrayLike, cols: ArrayLike) -> tuple[Floats, Floats]:
        """Distances of places along the tangent at the middle, and from the border (inside > 0)."""
        line = Line(self.row, self.col, self.normal_deg)
        s, t = line.distances(rows, cols)
        k = self.curvature_per_px
        if k == 0:
            return t, s
        # R - |r - centre|, in a form that goes over into s when the radius grows beyond bounds.
        return t, (2 * s - k * (s**2 + t**2)) / (1 + np.hypot(k * s - 1, k * t))

    def distance(self, rows: ArrayLike, cols: ArrayLike) -> Floats:
        """Distance of places from the line or circle in pixels, positive inside the parcel."""
        if self.curvature_per_px == 0:
            return Line(self.row, self.col, self.normal_deg).normal_distance(rows, cols)
        return self.along_and_across(rows, cols)[1]

    def point(self, along_px: ArrayLike, inwards_px: float = 0.0) -> tuple[Floats, Floats]:
        """(rows, cols) at distances along the border from its middle, moved along the normal."""
        turn = np.asarray(along_px, float) * self.curvature_per_px
        # sin(x) / x and (1 - cos x) / x of the angle on the arc: finite on a line.
        t = np.asarray(along_px, float) * np.sinc(turn / math.pi)
        s = 0.5 * np.asarray(along_px, float) * turn * np.sinc(turn / (2 * math.pi)) ** 2
        s, t = s + inwards_px * np.cos(turn), t - inwards_px * np.sin(turn)
        x, y = unit_vector(self.normal_deg)
        return self.row + s * y + t * x, self.col + s * x - t * y

    def points(self, inwards_px: float = 0.0, step_px: float = 1.0) -> Floats:
        """Places along the border, about `step_px` apart, moved along the normal; (n, 2)."""
        half, count = 0.5 * self.length_px, math.ceil(self.length_px / step_px) + 1
        return np.column_stack(self.point(np.linspace(-half, half, count), inwards_px))

    def part(self, begin_px: float, end_px: float) -> Border:
        """What lies between two distances along the border from its middle."""
        middle = 0.5 * (begin_px + end_px)
        row, col = self.point(middle)
        normal = wrap_direction(self.normal_deg - math.degrees(middle * self.curvature_per_px))
        return replace(
            self, row=float(row), col=float(col), normal_deg=normal, length_px=end_px - begin_px
        )

    def moved(self, rows: float, cols: float) -> Border:
        """The same border elsewhere."""
        return replace(self, row=self.row + rows, col=self.col + cols)


@dataclass(frozen=True)
class SideStrip:
    """A narrow strip along one border of a parcel, of the length of that border.

    Parameters
    ----------
    border : int
        Which border it follows.
    kind : {"rim", "gutter", "shadow"}
    near_px, far_px : float
        Where it begins and ends, as distances from the border: above 0 inside the parcel.
    contrast : float
        What it adds to the level, in image units.
    softness_px : float, optional
        Standard deviation of a Gaussian that blurs its sides.
    """

    border: int
    kind: StripKind
    near_px: float
    far_px: float
    contrast: float
    softness_px: float = 0.0

    def __post_init__(self) -> None:
        require(self, softness_px=self.softness_px)
        require(self, -math.inf, near_px=self.near_px, far_px=self.far_px, contrast=self.contrast)
        require_choice(get_args(StripKind), kind=self.kind)
        require_whole(0, border=self.border)
        if not self.near_px < self.far_px:
            raise ModelError(
                f"a strip from {self.near_px:g} to {self.far_px:g} px has no width: the first "
                "distance has to be the lower one, both above 0 inside the parcel"
            )


@dataclass(frozen=True)
class Parcel:
    """Ground of one level, possibly sloping, inside straight and curved borders.

    What lies inside all borders belongs to it, so its corners point outwards: a polygon is
    convex, and one border that is a full circle makes a disc.

    Parameters
    ----------
    kind : {"field", "roof", "road", "disc"}
    row, col : float
        Its centre in pixels.
    borders : tuple of Border
    contrast : float
        Its level at the centre above the ground around it, in image units.
    slope_rows, slope_cols : float, optional
        By how much that changes from row to row and from column to column.
    strips : tuple of SideStrip, optional
    texture_std : float, optional
        Standard deviation of its texture in the image, in image units.
    """

    kind: ParcelKind
    row: float
    col: float
    borders: tuple[Border, ...]
    contrast: float
    slope_rows: float = 0.0
    slope_cols: float = 0.0
    strips: tuple[SideStrip, ...] = ()
    texture_std: float = 0.0

    def __post_init__(self) -> None:
        if not self.borders:
            raise ModelError("a parcel without borders has no end: give it one or more")
        count = len(self.borders)
        wrong = [one.border for one in self.strips if not 0 <= one.border < count]
        if wrong:
            raise ModelError(f"a strip follows border {wrong[0]}, the parcel has {count} of them")

    def moved(self, rows: float, cols: float) -> Parcel:
        """The same parcel elsewhere."""
        borders = tuple(one.moved(rows, cols) for one in self.borders)
        return replace(self, row=self.row + rows, col=self.col + cols, borders=borders)

    def contrast_at(self, rows: ArrayLike, cols: ArrayLike) -> Floats:
        """Level above the ground at places inside, without strips."""
        down, right = np.asarray(rows, float) - self.row, np.asarray(cols, float) - self.col
        return self.contrast + self.slope_rows * down + self.slope_cols * right

    def distance(self, rows: ArrayLike, cols: ArrayLike) -> Floats:
        """Distance from the nearest border, positive inside; exact but for the corners."""
        return np.asarray(
            np.minimum.reduce([one.distance(rows, cols) for one in self.borders], dtype=float)
        )

    @property
    def outer_px(self) -> float:
        """How far strips reach out of the parcel."""
        return max([0.0, *(-one.near_px for one in self.strips)])

    def outline(self, step_px: float = 1.0) -> Floats:
        """Points on all borders, about `step_px` apart, (n, 2) as (row, col)."""
        return np.concatenate([one.points(step_px=step_px) for one in self.borders])

    def drawn(self, rows: Floats, cols: Floats, blur_px: float) -> tuple[Floats, Floats]:
        """What the parcel adds to the ground, and its cover, both blurred by a Gaussian.

        Exact for straight borders but for the 3 `blur_px` around corners; of a curved border it
        is exact to the first order in its curvature.

        Parameters
        ----------
        rows, cols : arrays
            Places, broadcast against each other.
        blur_px : float
            Standard deviation of the blur, above 0.

        Returns
        -------
        level, cover : arrays
            In image units, and from 0 outside to 1 inside.
        """
        distances = [one.distance(rows, cols) for one in self.borders]
        covers = [
            _soft_step(distance, math.hypot(blur_px, one.softness_px), one.curvature_per_px)
            for distance, one in zip(distances, self.borders, strict=True)
        ]
        cover = np.asarray(np.multiply.reduce(covers))
        level = cover * self.contrast_at(rows, cols)
        for strip in self.strips:
            ends = [one for i, one in enumerate(covers) if i != strip.border]
            width = math.hypot(blur_px, strip.softness_px)
            bend = self.borders[strip.border].curvature_per_px
            first, last = (
                _soft_step(distances[strip.border] - at, width, bend)
                for at in (strip.near_px, strip.far_px)
            )
            level += strip.contrast * np.multiply.reduce([first - last, *ends])
        return level, cover


def _soft_step(distance: Floats, sigma_px: float, curvature_per_px: float) -> Floats:
    """A step from 0 to 1 at distance 0, blurred by a Gaussian."""
    # A round blur moves a curved border inwards by half its variance times the curvature.
    z = (distance - 0.5 * sigma_px**2 * curvature_per_px) / sigma_px
    step = np.asarray(z > 0, float)
    near = np.abs(z) < _WIDTH_SIGMA
    step[near] = ndtr(z[near])
    return step
