"""A survey of a landscape: which borders can be measured, and what lies beside each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line
from acutance.optics.sensor import Sensor
from acutance.simulate.landscape_edges import LOOK_PX, Beside, BesideKind, EdgeSide, LandscapeEdge
from acutance.simulate.landscape_layout import Waves
from acutance.simulate.noise import Noise
from acutance.simulate.parcel import Border, Parcel

__all__ = ["edges_of"]

GUARD_PX = 4.0
"""Distance an edge keeps from the corners of its parcel."""

_CORNER_CLEAR_PX = 20.0
"""At a sharp corner the other side leans over the edge: it stays so far away from it."""

_MIN_LENGTH_PX = 12.0
"""Shorter borders are not listed."""

_PAST_ENDS_PX = 2.0
"""What lies past the ends of an edge by no more than this is beside it too: its blur is."""


@dataclass(frozen=True)
class _Thing:
    """What can lie beside an edge: a parcel, a strip along a border of it, the image's border."""

    owner: int
    kind: BesideKind
    contrast: float
    strip_of: int | None = None


@dataclass(frozen=True, eq=False)
class _Outlines:
    """Points on the outlines of all things, about 1 px apart.

    Parameters
    ----------
    things : tuple of _Thing
    places : (n, 2) array
        Rows and columns.
    thing, owner, border : (n,) arrays of int
        What each point belongs to, of which parcel, and along which border of that.
    tree : cKDTree
        Of the places.
    """

    things: tuple[_Thing, ...]
    places: Floats
    thing: NDArray[np.int_]
    owner: NDArray[np.int_]
    border: NDArray[np.int_]
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
        for j, border in _usable_borders(parcel):
            step = float(parcel.contrast_at(border.row, border.col))
            outside = float(ground.at(border.row, border.col))
            inside: EdgeSide = "bright" if step > 0 else "dark"
            beside = [*_own_strips(parcel, j, step, inside)]
            beside += _others(parcels, i, j, border, step, inside, outlines)
            line, curvature = _from_dark_to_bright(border, inside)
            textures = sorted([(outside, ground_texture), (outside + step, parcel.texture_std)])
            found.append(
                LandscapeEdge(
                    name=f"{parcel.kind}-{i + 1}-{j + 1}",
                    ground_line=line,
                    curvature_per_px=curvature,
                    softness_px=border.softness_px,
                    dark=textures[0][0],
                    bright=textures[1][0],
                    texture_dark=textures[0][1],
                    texture_bright=textures[1][1],
                    beside=tuple(sorted(beside, key=lambda one: (one.near_px, one.kind))),
                    sensor=sensor,
                    noise=noise,
                )
            )
    return tuple(found)


def _usable_borders(parcel: Parcel) -> Iterator[tuple[int, Border]]:
    """Borders without the ends at the corners, with their numbers, where enough is left."""
    if parcel.kind == "disc":
        return
    count = len(parcel.borders)
    for j, border in enumerate(parcel.borders):
        half = 0.5 * border.length_px
        # Along the tangent of an inward normal, the next border comes first.
        following, last = (j + 1) % count, (j - 1) % count
        begin = -half + _guard(parcel.borders[following], border) + _inner_px(parcel, following)
        end = half - _guard(border, parcel.borders[last]) - _inner_px(parcel, last)
        if end - begin >= _MIN_LENGTH_PX:
            yield j, border.part(begin, end)


def _guard(one: Border, before: Border) -> float:
    """How much of either border to leave out at the corner where one ends and another begins."""
    turn = wrap_direction(_end_normal_deg(one, 0.5) - _end_normal_deg(before, -0.5))
    inside_deg = 180.0 - abs(turn)
    if inside_deg >= 90.0:
        return GUARD_PX
    return GUARD_PX + _CORNER_CLEAR_PX / math.tan(math.radians(inside_deg))


def _inner_px(parcel: Parcel, j: int) -> float:
    """How far strips along border `j` reach into the parcel: they cross its other borders."""
    return max([0.0, *(one.far_px for one in parcel.strips if one.border == j)])


def _end_normal_deg(border: Border, share: float) -> float:
    """Direction of the normal at one end: at a share of the length from the middle."""
    turn = share * border.length_px * border.curvature_per_px
    return border.normal_deg - math.degrees(turn)


def _from_dark_to_bright(border: Border, inside: EdgeSide) -> tuple[Line, float]:
    """The line of a border with its normal to the bright side, and the curvature seen so."""
    if inside == "bright":
        normal, curvature = border.normal_deg, border.curvature_per_px
    else:
        normal, curvature = border.normal_deg + 180.0, 0.0 - border.curvature_per_px
    at = Line(border.row, border.col, wrap_direction(normal), length_px=border.length_px)
    return at, curvature


def _outlines(parcels: Sequence[Parcel], shape: tuple[int, int]) -> _Outlines:
    things: list[_Thing] = []
    parts: list[tuple[Floats, int, int]] = []
    for i, parcel in enumerate(parcels):
        kind: BesideKind = "road" if parcel.kind == "road" else "neighbour"
        things.append(_Thing(i, kind, parcel.contrast))
        parts += [(one.points(), len(things) - 1, j) for j, one in enumerate(parcel.borders)]
        for strip in parcel.strips:
            things.append(_Thing(i, strip.kind, strip.contrast, strip.border))
            along = parcel.borders[strip.border]
            sides = [along.points(at) for at in (strip.near_px, strip.far_px)]
            parts.append((np.concatenate(sides), len(things) - 1, strip.border))
    things.append(_Thing(-1, "image border", 0.0))
    parts.append((_image_border(shape), len(things) - 1, -1))
    places = np.concatenate([points for points, _, _ in parts])
    sizes = [len(points) for points, _, _ in parts]
    thing, border = (np.repeat([part[k] for part in parts], sizes) for k in (1, 2))
    owner = np.array([one.owner for one in things])[thing]
    return _Outlines(tuple(things), places, thing, owner, border, cKDTree(places))


def _image_border(shape: tuple[int, int]) -> Floats:
    rows, cols = (np.arange(-0.5, size) for size in shape)
    sides = [np.column_stack([np.full(cols.size, row), cols]) for row in (rows[0], rows[-1])]
    sides += [np.column_stack([rows, np.full(rows.size, col)]) for col in (cols[0], cols[-1])]
    return np.concatenate(sides)


def _own_strips(parcel: Parcel, j: int, step: float, inside: EdgeSide) -> Iterator[Beside]:
    """Rims, gutters and shadows along border `j` itself."""
    for strip in parcel.strips:
        if strip.border == j:
            side = inside if strip.far_px > 0 else _other(inside)
            near, far = sorted((abs(strip.near_px), abs(strip.far_px)))
            yield Beside(strip.kind, side, near, far, strip.contrast / abs(step))


def _other(side: EdgeSide) -> EdgeSide:
    return "dark" if side == "bright" else "bright"


def _others(
    parcels: Sequence[Parcel],
    i: int,
    j: int,
    border: Border,
    step: float,
    inside: EdgeSide,
    outlines: _Outlines,
) -> Iterator[Beside]:
    """Everything else within `LOOK_PX` of border `j` of parcel `i`, along its whole length."""
    half = 0.5 * border.length_px
    near = outlines.tree.query_ball_point((border.row, border.col), math.hypot(half, LOOK_PX) + 2)
    index = np.array(sorted(near), int)
    along, across = border.along_and_across(*outlines.places[index].T)
    own = (outlines.owner[index] == i) & (outlines.border[index] == j)
    kept = (np.abs(along) <= half + _PAST_ENDS_PX) & (np.abs(across) <= LOOK_PX) & ~own
    thing, across = outlines.thing[index[kept]], across[kept]
    for k in np.unique(thing):
        one = outlines.things[k]
        opposite = one.owner == i and one.strip_of is None
        for within in (True, False):
            distances = np.abs(across[(thing == k) & ((across > 0) == within)])
            if distances.size == 0:
                continue
            wide = opposite or (
                one.kind in ("road", "neighbour")
                and _reaches_out(parcels[one.owner], border, LOOK_PX if within else -LOOK_PX)
            )
            yield Beside(
                kind="opposite" if opposite else one.kind,
                side=inside if within else _other(inside),
                near_px=float(distances.min()),
                far_px=LOOK_PX if wide else float(distances.max()),
                contrast_share=math.copysign(1.0, -step) if opposite else one.contrast / abs(step),
            )


def _reaches_out(parcel: Parcel, border: Border, inwards_px: float) -> bool:
    """Whether a parcel goes on at this distance from a border."""
    half = 0.5 * border.length_px
    probes = border.point(np.linspace(-half, half, 9), inwards_px)
    return bool(np.max(parcel.distance(*probes)) > 0)
