"""The truth of a landscape: every border that can be measured, and what lies beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from acutance.curves import HasResponse, Response
from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line, Orientation
from acutance.optics import Gaussian, Sensor
from acutance.simulate.landscape_layout import Waves
from acutance.simulate.noise import Noise
from acutance.simulate.parcel import Border, Parcel

__all__ = ["LOOK_PX", "Beside", "BesideKind", "LandscapeEdge", "edges_of"]

BesideKind = Literal["rim", "gutter", "shadow", "road", "neighbour", "opposite", "image border"]

LOOK_PX = 40.0
"""What lies farther from an edge is not listed."""

GUARD_PX = 4.0
"""Distance an edge keeps from the corners of its parcel."""

_CORNER_CLEAR_PX = 20.0
"""At a sharp corner the other side leans over the edge: it stays so far away from it."""

_MIN_LENGTH_PX = 12.0
"""Shorter borders are not listed."""


@dataclass(frozen=True)
class Beside:
    """Something that lies along an edge.

    Parameters
    ----------
    kind : str
        "rim", "gutter" or "shadow" along this border; "road" or "neighbour", another parcel;
        "opposite", another border of the same parcel; "image border".
    side : {"dark", "bright"}
        Of the edge.
    near_px, far_px : float
        Between which distances from the edge it lies; the second is at most 40.
    contrast_share : float
        What it adds to the level on its side, as a share of the edge's contrast.
    """

    kind: BesideKind
    side: Literal["dark", "bright"]
    near_px: float
    far_px: float
    contrast_share: float


@dataclass(frozen=True, eq=False)
class LandscapeEdge(HasResponse):
    """One border in a landscape, and all that is true of it.

    ``response``, and with it ``mtf_nyquist``, ``rer``, ``fwhm_px`` and the curves, are those of the
    image along the normal: the sensor's times the softness of the border. `sensor_response` is the
    sensor's alone.

    Parameters
    ----------
    name : str
    ground_line : Line
        The border on the ground: its middle, the direction there from dark to bright, and the
        length that is free of corners.
    curvature_per_px : float
        One over its radius, above 0 when the centre lies on the bright side; 0 for a line.
    softness_px : float
        Standard deviation of the border's own Gaussian blur.
    dark, bright : float
        Levels on either side of the middle, without what lies beside.
    texture_dark, texture_bright : float
        Standard deviation of the texture on either side, in image units.
    beside : tuple of Beside
        What lies within 40 px on either side, the nearest first.
    sensor : Sensor
        The one at this place.
    noise : Noise, optional
        Noise that was added to the image.
    """

    name: str
    ground_line: Line
    curvature_per_px: float
    softness_px: float
    dark: float
    bright: float
    texture_dark: float
    texture_bright: float
    beside: tuple[Beside, ...]
    sensor: Sensor
    noise: Noise | None = None

    @property
    def contrast(self) -> float:
        """Difference of the levels on either side."""
        return self.bright - self.dark

    @property
    def radius_px(self) -> float:
        """Radius of the border; infinite for a line."""
        return math.inf if self.curvature_per_px == 0 else 1 / abs(self.curvature_per_px)

    @property
    def length_px(self) -> float:
        """Length that is free of corners."""
        return self.ground_line.length_px

    @property
    def orientation(self) -> Orientation:
        """The image axis the MTF belongs to."""
        return self.ground_line.orientation

    @property
    def snr(self) -> float:
        """Contrast over the mean standard deviation of the noise on both sides, texture left out."""
        if self.noise is None:
            return math.inf
        std = float(np.mean(self.noise.std(np.array([self.dark, self.bright]))))
        return math.inf if std == 0 else self.contrast / std

    @property
    def clean_dark_px(self) -> float:
        """Distance on the dark side to the nearest thing beside the edge, at most 40."""
        return self._clean("dark")

    @property
    def clean_bright_px(self) -> float:
        """Distance on the bright side to the nearest thing beside the edge, at most 40."""
        return self._clean("bright")

    def _clean(self, side: str) -> float:
        return min([one.near_px for one in self.beside if one.side == side], default=LOOK_PX)

    def kind(self, half_width_px: float = 20.0) -> BesideKind | Literal["clean"]:
        """What disturbs the edge most within a half width: of the highest contrast; or "clean"."""
        within = [one for one in self.beside if one.near_px < half_width_px]
        if not within:
            return "clean"
        return max(within, key=lambda one: abs(one.contrast_share)).kind

    def ends(self) -> Floats:
        """Both ends of the border on the ground, (2, 2) as (row, col)."""
        half = 0.5 * self.length_px
        return np.column_stack(self._border.point(np.array([-half, half])))

    def region(self, half_width_px: float = 20.0, *, clean: bool = False) -> Floats:
        """A rectangle around the edge, (4, 2) as (row, col); it may reach beyond the image.

        Parameters
        ----------
        half_width_px : float, optional
            Distance from the edge to its borders on either side.
        clean : bool, optional
            Leave out what lies beside the edge: no wider than the clean ground on either side.
        """
        dark = min(half_width_px, self.clean_dark_px) if clean else half_width_px
        bright = min(half_width_px, self.clean_bright_px) if clean else half_width_px
        half = 0.5 * self.length_px
        straight = replace(self._border, curvature_per_px=0.0)
        corners = [(-half, -dark), (half, -dark), (half, bright), (-half, bright)]
        return np.array([straight.point(along, across) for along, across in corners])

    @property
    def line(self) -> Line:
        """Where the image passes half way between the levels: off for an asymmetric sensor."""
        profile = self.system.profile(self.ground_line.normal_deg)
        return self.ground_line.moved(profile.half_px, 0.0)

    @cached_property
    def system(self) -> Sensor:
        """The sensor at this place and the softness of the border, as one."""
        if self.softness_px == 0:
            return self.sensor
        return replace(self.sensor, blocks=[*self.sensor.blocks, Gaussian(self.softness_px)])

    @cached_property
    def response(self) -> Response:
        """True curves of the image along the normal: sensor times softness."""
        return self.system.response_along(self.ground_line.normal_deg)

    @cached_property
    def sensor_response(self) -> Response:
        """True curves of the sensor alone along the normal."""
        return self.sensor.response_along(self.ground_line.normal_deg)

    @property
    def _border(self) -> Border:
        """The border with its normal to the bright side."""
        at = self.ground_line
        return Border(
            at.row, at.col, at.normal_deg, at.length_px, self.softness_px, self.curvature_per_px
        )


@dataclass(frozen=True, eq=False)
class _Outlines:
    """Points on everything that can lie beside an edge: places, owners, kinds, contrasts."""

    places: Floats
    owner: NDArray[np.int_]
    border: NDArray[np.int_]
    kind: NDArray[np.str_]
    contrast: Floats
    tree: cKDTree


def edges_of(
    parcels: Sequence[Parcel],
    sensors: Sequence[Sensor],
    ground: Waves,
    ground_texture: float,
    shape: tuple[int, int],
    noise: Noise | None,
) -> tuple[LandscapeEdge, ...]:
    """The edges of all parcels but discs.

    Parameters
    ----------
    parcels : sequence of Parcel
    sensors : sequence of Sensor
        Of each parcel.
    ground : Waves
    ground_texture : float
        Standard deviation of the ground's texture in the image.
    shape : (rows, cols)
        Of the image.
    noise : Noise or None

    Returns
    -------
    tuple of LandscapeEdge
    """
    outlines = _outlines(parcels, shape)
    found = []
    for i, (parcel, sensor) in enumerate(zip(parcels, sensors, strict=True)):
        for j, border in enumerate(_usable_borders(parcel)):
            if border is None:
                continue
            found.append(
                _edge(f"{parcel.kind}-{i + 1}-{j + 1}", parcels, i, j, border, outlines, ground,
                      ground_texture, sensor, noise)
            )  # fmt: skip
    return tuple(found)


def _usable_borders(parcel: Parcel) -> list[Border | None]:
    """Each border without its ends, ``None`` where too little of it is left."""
    if parcel.kind == "disc":
        return [None]
    count = len(parcel.borders)
    found: list[Border | None] = []
    for i, border in enumerate(parcel.borders):
        half = 0.5 * border.length_px
        # Along the tangent of an inward normal, the next border comes first.
        begin = -half + _guard(border, parcel.borders[(i + 1) % count])
        end = half - _guard(border, parcel.borders[i - 1])
        found.append(border.part(begin, end) if end - begin >= _MIN_LENGTH_PX else None)
    return found


def _guard(border: Border, other: Border) -> float:
    """How much of a border to leave out at the corner with another one."""
    turn = abs(wrap_direction(other.normal_deg - border.normal_deg))
    inside_deg = 180.0 - turn
    if inside_deg >= 90.0:
        return GUARD_PX
    return GUARD_PX + _CORNER_CLEAR_PX / math.tan(math.radians(inside_deg))


def _edge(
    name: str,
    parcels: Sequence[Parcel],
    i: int,
    j: int,
    border: Border,
    outlines: _Outlines,
    ground: Waves,
    ground_texture: float,
    sensor: Sensor,
    noise: Noise | None,
) -> LandscapeEdge:
    parcel = parcels[i]
    step = float(parcel.contrast_at(border.row, border.col))
    outside = float(ground.at(border.row, border.col))
    rising = step > 0
    normal = border.normal_deg if rising else wrap_direction(border.normal_deg + 180.0)
    textures = (ground_texture, parcel.texture_std)
    return LandscapeEdge(
        name=name,
        ground_line=Line(border.row, border.col, normal, length_px=border.length_px),
        curvature_per_px=border.curvature_per_px if rising else 0.0 - border.curvature_per_px,
        softness_px=border.softness_px,
        dark=min(outside, outside + step),
        bright=max(outside, outside + step),
        texture_dark=textures[0 if rising else 1],
        texture_bright=textures[1 if rising else 0],
        beside=_beside(parcel, i, j, border, abs(step), rising, outlines),
        sensor=sensor,
        noise=noise,
    )


def _outlines(parcels: Sequence[Parcel], shape: tuple[int, int]) -> _Outlines:
    places, owners, borders, kinds, contrasts = [], [], [], [], []

    def add(points: Floats, owner: int, border: int, kind: str, contrast: float) -> None:
        places.append(points)
        owners.append(np.full(len(points), owner))
        borders.append(np.full(len(points), border))
        kinds.append(np.full(len(points), kind))
        contrasts.append(np.full(len(points), contrast))

    for i, parcel in enumerate(parcels):
        for j, border in enumerate(parcel.borders):
            along = np.linspace(-0.5, 0.5, math.ceil(border.length_px) + 1) * border.length_px
            other = "road" if parcel.kind == "road" else "neighbour"
            add(np.column_stack(border.point(along)), i, j, other, parcel.contrast)
            for strip in parcel.strips:
                if strip.border == j:
                    for at in (strip.near_px, strip.far_px):
                        sides = np.column_stack(border.point(along, at))
                        add(sides, i, j, strip.kind, strip.contrast)
    rows, cols = (np.arange(-0.5, size) for size in shape)
    for row in (-0.5, shape[0] - 0.5):
        add(np.column_stack([np.full(cols.size, row), cols]), -1, -1, "image border", 0.0)
    for col in (-0.5, shape[1] - 0.5):
        add(np.column_stack([rows, np.full(rows.size, col)]), -1, -1, "image border", 0.0)
    points = np.concatenate(places)
    return _Outlines(
        points,
        np.concatenate(owners),
        np.concatenate(borders),
        np.concatenate(kinds),
        np.concatenate(contrasts),
        cKDTree(points),
    )


def _beside(
    parcel: Parcel,
    i: int,
    j: int,
    border: Border,
    step: float,
    rising: bool,
    outlines: _Outlines,
) -> tuple[Beside, ...]:
    """Everything next to border `j` of parcel `i` within `LOOK_PX`, by distance."""
    near = outlines.tree.query_ball_point(
        (border.row, border.col), math.hypot(0.5 * border.length_px, LOOK_PX) + 2.0
    )
    index = np.array(sorted(near), int)
    along, across = border.along_and_across(*outlines.places[index].T)
    own = (outlines.owner[index] == i) & (outlines.border[index] == j)
    kept = (np.abs(along) <= 0.5 * border.length_px) & (np.abs(across) <= LOOK_PX) & ~own
    index, across = index[kept], across[kept]
    found = [
        Beside(
            strip.kind,
            "bright" if (strip.far_px > 0) == rising else "dark",
            *sorted((abs(strip.near_px), abs(strip.far_px))),
            strip.contrast / step,
        )
        for strip in parcel.strips
        if strip.border == j
    ]
    things = [
        (int(outlines.owner[k]), str(outlines.kind[k]), float(outlines.contrast[k])) for k in index
    ]
    for owner, kind, contrast in dict.fromkeys(things):
        of_it = (outlines.owner[index] == owner) & (outlines.kind[index] == kind)
        of_it &= outlines.contrast[index] == contrast
        own_parcel = owner == i and kind in ("road", "neighbour")
        for inside in (True, False):
            distances = np.abs(across[of_it & ((across > 0) == inside)])
            if distances.size == 0:
                continue
            found.append(
                Beside(
                    kind="opposite" if own_parcel else kind,  # type: ignore[arg-type]
                    side="bright" if inside == rising else "dark",
                    near_px=float(distances.min()),
                    far_px=LOOK_PX if own_parcel else float(distances.max()),
                    contrast_share=-1.0 if own_parcel else contrast / step,
                )
            )
    return tuple(sorted(found, key=lambda one: (one.near_px, one.kind)))
