"""Objects of a landscape drawn at random: a field, roof, road or disc, and what lies beside it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_direction
from acutance.simulate.landscape_options import LandscapeOptions, Range
from acutance.simulate.parcel import Border, Parcel, ParcelKind, SideStrip

__all__ = ["draw_object", "polygon"]

Beside = Literal["clean", "rim", "gutter", "shadow", "road", "neighbour"]

_SKEW_DEG = 7.0
"""The sides of a field are turned at random by up to so much."""

_MIN_SIDE_PX = 24.0
"""Nothing is laid beside sides shorter than this."""

_DARKEST = 0.2
"""Share of the ground's level that dark objects keep."""


def draw_object(options: LandscapeOptions, rng: np.random.Generator) -> tuple[Parcel, ...]:
    """One object about the point (0, 0): its main parcel first, then roads and neighbours.

    Parameters
    ----------
    options : LandscapeOptions
    rng : numpy.random.Generator

    Returns
    -------
    tuple of Parcel
    """
    kinds: tuple[ParcelKind, ...] = ("roof", "road", "disc", "field")
    shares = (options.roofs, options.roads, options.discs)
    kind = kinds[rng.choice(4, p=[*shares, max(0.0, 1 - sum(shares))])]
    main = _with_ground(_shape(kind, options, rng), options, rng)
    if kind in ("road", "disc"):
        return (main,)
    return _with_sides(main, options, rng)


def polygon(
    kind: ParcelKind, normals_deg: Floats, distances_px: Floats, contrast: float
) -> Parcel | None:
    """The polygon inside lines at distances from (0, 0).

    Parameters
    ----------
    kind : {"field", "roof", "road", "disc"}
    normals_deg : (n,) array
        Outward directions of the lines, rising.
    distances_px : (n,) array
    contrast : float

    Returns
    -------
    Parcel or None
        ``None`` where a line does not touch the polygon of the others.
    """
    x, y = unit_vector(np.asarray(normals_deg, float))
    corners = []
    for i in range(len(normals_deg)):
        j = (i + 1) % len(normals_deg)
        lines = np.array([[x[i], y[i]], [x[j], y[j]]])
        corners.append(np.linalg.solve(lines, [distances_px[i], distances_px[j]]))
    borders = []
    for i, normal in enumerate(normals_deg):
        begin, end = corners[i - 1], corners[i]
        length = float((end - begin) @ (-y[i], x[i]))
        if length <= 1.0:
            return None
        col, row = 0.5 * (begin + end)
        inwards = wrap_direction(float(normal) + 180.0)
        borders.append(Border(float(row), float(col), inwards, length))
    return Parcel(kind, 0.0, 0.0, tuple(borders), contrast)


def _rectangle(
    kind: ParcelKind, turn_deg: float, width_px: float, height_px: float, contrast: float
) -> Parcel:
    """A rectangle about (0, 0): its width along the direction `turn_deg`."""
    normals = np.array([turn_deg, turn_deg + 90.0, turn_deg + 180.0, turn_deg + 270.0])
    found = polygon(kind, normals, 0.5 * np.array([width_px, height_px] * 2), contrast)
    # Every rectangle has its four sides.
    assert found is not None
    return found


def _shape(kind: ParcelKind, options: LandscapeOptions, rng: np.random.Generator) -> Parcel:
    """The main parcel, of contrast 1."""
    turn = rng.uniform(-180.0, 180.0)
    if kind == "disc":
        radius = rng.uniform(*options.disc_radius_px)
        x, y = unit_vector(turn)
        around = Border(
            -radius * y, -radius * x, turn, 2 * math.pi * radius, 0.0, min(1.0, 1 / radius)
        )
        return Parcel(kind, 0.0, 0.0, (around,), 1.0)
    if kind == "roof":
        width, height = rng.uniform(*options.roof_px, 2)
        return _rectangle(kind, turn, width, height, 1.0)
    if kind == "road":
        width, length = rng.uniform(*options.road_width_px), rng.uniform(*options.road_length_px)
        return _rectangle(kind, turn, width, length, 1.0)
    return _field(turn, options, rng)


def _field(turn_deg: float, options: LandscapeOptions, rng: np.random.Generator) -> Parcel:
    """Four to six sides, some of them soft, some of them arcs."""
    found = None
    while found is None:
        sides = int(rng.choice([4, 5, 6], p=[0.8, 0.1, 0.1]))
        skew = rng.uniform(-_SKEW_DEG, _SKEW_DEG, sides)
        normals = turn_deg + 360.0 / sides * np.arange(sides) + skew
        distances = 0.5 * rng.uniform(*options.field_px, sides)
        if sides == 4:
            distances = np.tile(distances[:2], 2)
        found = polygon("field", normals, distances, 1.0)
    borders = []
    for one in found.borders:
        soft = rng.uniform(*options.softness_px) if rng.random() < options.soft else 0.0
        lowest, highest = options.soft_normal_deg
        # Drawn all the same: a seed gives the same objects whatever directions are soft.
        if (one.normal_deg - lowest) % 180 > highest - lowest:
            soft = 0.0
        bend = 0.0
        if rng.random() < options.curved:
            radius = math.exp(rng.uniform(*np.log(options.radius_px)))
            bend = float(rng.choice([-1, 1])) / radius
        # The arc goes through both corners.
        row, col = one.point(0.0, -0.125 * bend * one.length_px**2)
        borders.append(
            replace(one, row=float(row), col=float(col), softness_px=soft, curvature_per_px=bend)
        )
    return replace(found, borders=tuple(borders))


def _with_ground(parcel: Parcel, options: LandscapeOptions, rng: np.random.Generator) -> Parcel:
    """The parcel with contrast, slope and texture."""
    low, high = options.contrast
    deepest = (1 - _DARKEST) * options.ground
    if rng.random() < options.dark and low < deepest:
        contrast = -rng.uniform(low, min(high, deepest))
    else:
        contrast = rng.uniform(low, high)
    return _on_the_ground(parcel, contrast, options, rng)


def _on_the_ground(
    parcel: Parcel, contrast: float, options: LandscapeOptions, rng: np.random.Generator
) -> Parcel:
    x, y = unit_vector(rng.uniform(0.0, 360.0))
    slope = abs(contrast) * rng.uniform(0.0, options.slope_per_px)
    return replace(
        parcel,
        contrast=contrast,
        slope_rows=slope * y,
        slope_cols=slope * x,
        texture_std=abs(contrast) * rng.uniform(*options.texture),
    )


def _with_sides(
    main: Parcel, options: LandscapeOptions, rng: np.random.Generator
) -> tuple[Parcel, ...]:
    """A field or roof with what lies beside each of its borders."""
    kinds: tuple[Beside, ...] = ("rim", "gutter", "shadow", "road", "neighbour", "clean")
    shares = [
        options.rims,
        options.gutters,
        options.shadows,
        options.side_roads,
        options.neighbours,
    ]
    chances = [*shares, max(0.0, 1 - sum(shares))]
    strips, others = [], []
    for i, border in enumerate(main.borders):
        kind = kinds[rng.choice(6, p=chances)]
        if border.length_px < _MIN_SIDE_PX:
            continue
        if kind == "rim" or kind == "gutter":
            strips.append(_line(i, kind, main.contrast, options, rng))
        elif kind == "shadow":
            depth = abs(main.contrast) * rng.uniform(*options.shadow_contrast)
            width = rng.uniform(*options.shadow_width_px)
            strips.append(SideStrip(i, "shadow", -width, 0.0, -depth, border.softness_px))
        elif kind == "road" or kind == "neighbour":
            others.append(_beyond(border, kind, main.contrast, options, rng))
    return (replace(main, strips=tuple(strips)), *others)


def _line(
    border: int,
    kind: Literal["rim", "gutter"],
    contrast: float,
    options: LandscapeOptions,
    rng: np.random.Generator,
) -> SideStrip:
    """A rim or gutter on either side; half of them touch the border."""
    strength = abs(contrast) * rng.uniform(*options.line_contrast)
    sign = -1.0 if kind == "gutter" or rng.random() < 0.5 else 1.0
    begin = 0.0 if rng.random() < 0.5 else rng.uniform(*options.line_distance_px)
    end = begin + rng.uniform(*options.line_width_px)
    near, far = (begin, end) if rng.random() < 0.5 else (-end, -begin)
    return SideStrip(border, kind, near, far, sign * strength)


def _beyond(
    border: Border,
    kind: Literal["road", "neighbour"],
    contrast: float,
    options: LandscapeOptions,
    rng: np.random.Generator,
) -> Parcel:
    """A road or another field outside of a border, turned a little against it."""
    drawn: Range
    shape: ParcelKind
    if kind == "road":
        shape, drawn = "road", options.side_road_contrast
        width = rng.uniform(*options.road_width_px)
    else:
        shape, drawn = "field", options.neighbour_contrast
        width = rng.uniform(*options.roof_px)
    strength = float(rng.choice([-1, 1])) * abs(contrast) * rng.uniform(*drawn)
    strength = max(strength, -(1 - _DARKEST) * options.ground)
    tilt = rng.uniform(-options.tilt_deg, options.tilt_deg)
    # The end that comes nearest keeps the gap, on a hollow arc too.
    nearer = 0.5 * border.length_px * math.sin(math.radians(abs(tilt)))
    nearer += max(0.0, -border.curvature_per_px) * border.length_px**2 / 8
    away = -(rng.uniform(*options.gap_px) + nearer + 0.5 * width)
    flat = replace(border, curvature_per_px=0.0)
    row, col = flat.point(0.0, away)
    made = _rectangle(shape, border.normal_deg + tilt, width, border.length_px, 1.0)
    return _on_the_ground(made.moved(float(row), float(col)), strength, options, rng)
