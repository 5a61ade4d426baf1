"""The pixels of a star, ring by ring."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import Flags, SiemensStar
from acutance.numerics.shape_error import ShapeError
from acutance.targets.periodic.tuned import STAR_FINEST_CPP

__all__ = [
    "MIN_RING_PIXELS",
    "RING_STEP_PX",
    "first_radius",
    "members_of",
    "ring_modulations",
    "rings_of",
    "sector_of",
    "shape_error",
]

RING_STEP_PX = 1.0
MIN_RING_PIXELS = 12
_MIN_INNER_PX = 1.5
_CHANCE = 1.5
"""Deviations by which the residuals' spokes have to exceed what noise makes."""
_ALONG_AXES = 2.0
"""Error along rows and columns, over its root mean square in all directions: filters act there."""
_NEAR_CPP = 0.07
_TURNS = np.arange(2, 18, 2)
"""Even angular orders: transfer has the same modulus in opposite directions."""
_MIN_PIXELS = 34
_MIN_SINGULAR = 0.1


def first_radius(star: SiemensStar, inner_px: float | None) -> float:
    """Where a star begins to be used: inside, its spokes are too fine, or stated to end."""
    return max(star.radius_at(STAR_FINEST_CPP), inner_px or 0.0, _MIN_INNER_PX)


def rings_of(
    smooth: Floats, usable: Flags, row: float, col: float, first: float, last: float
) -> list[tuple[float, Floats, Floats]]:
    """Rings of pixels: radius, direction and value of every pixel in them."""
    rows, cols = np.nonzero(usable)
    radius = np.hypot(rows - row, cols - col)
    angle = np.arctan2(rows - row, cols - col)
    value = smooth[usable]
    ring = np.floor((radius - first) / RING_STEP_PX).astype(np.intp)
    order = np.argsort(ring, kind="stable")
    ring, radius, angle, value = ring[order], radius[order], angle[order], value[order]
    found = []
    for number in range(max(int((last - first) / RING_STEP_PX), 0)):
        start, stop = np.searchsorted(ring, [number, number + 1]).tolist()
        here = slice(start, stop)
        if stop - start >= MIN_RING_PIXELS:
            found.append((float(np.mean(radius[here])), angle[here], value[here]))
    return found


def sector_of(angle: Floats, count: int) -> NDArray[np.intp]:
    """Which of some equal parts of a turn, from -pi on, each direction (n,) lies in."""
    turns = (angle + math.pi) / (2 * math.pi)
    return np.asarray((turns * count).astype(np.intp) % count)


def members_of(sector: NDArray[np.intp], among: Flags, count: int) -> list[NDArray[np.intp]]:
    """Which pixels belong to each of some parts, counting only those `among`."""
    return [np.flatnonzero((sector == number) & among) for number in range(count)]


def ring_modulations(
    image: Floats, star: SiemensStar, inner_px: float, outer_px: float
) -> tuple[Floats, Floats, Floats]:
    """The plain reading: a + b cos + c sin of the spokes in every ring, by least squares.

    Returns
    -------
    freq_cpp, modulation, std : (n,) arrays
        Frequency of the ring, amplitude of the wave in image units, and its standard deviation.
    """
    rows, cols = np.nonzero(np.isfinite(image))
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    kept = star.holds(angle, 2.0 / np.maximum(radius, 1.0))
    radius, angle, value, found = radius[kept], angle[kept], image[rows, cols][kept], []
    for here in _members(radius, inner_px, outer_px, MIN_RING_PIXELS):
        phase = star.cycles * angle[here] + star.alpha_rad
        design = np.stack([np.ones(phase.size), np.cos(phase), np.sin(phase)], axis=1)
        fit, *_ = np.linalg.lstsq(design, value[here], rcond=None)
        rest = value[here] - design @ fit
        noise = float(rest @ rest) / max(phase.size - 3, 1)
        variance = noise * float(np.linalg.pinv(design.T @ design)[1, 1])
        mean_radius = float(np.mean(radius[here]))
        found.append((star.cycles / (2 * math.pi * mean_radius), fit[1], math.sqrt(variance)))
    table = np.array(found, float).reshape(-1, 3)
    return table[:, 0], table[:, 1], table[:, 2]


def shape_error(
    residual: Floats,
    star: SiemensStar,
    noise: float,
    level: float,
    inner_px: float,
    outer_px: float,
) -> ShapeError | None:
    """What the residuals of a star show of a shape that the fit did not follow, or nothing.

    A transfer that is wrong at the frequency of a ring leaves the ring's spokes there, in one
    direction more than in others: filters act along rows and columns.

    Parameters
    ----------
    residual : (rows, cols) array
        NaN where no pixel was used.
    star : SiemensStar
    noise : float
        Standard deviation of the pixels' noise.
    level : float
        Amplitude of the spokes before the sensor.
    inner_px, outer_px : float
    """
    rings = _residual_rings(residual, star, inner_px, outer_px)
    if not rings:
        return None
    freq = np.array([star.freq_cpp(radius) for radius, _, _ in rings])
    found = [_spoke_power(value / noise, angle, star) for _, angle, value in rings]
    power, excess, freedom = (np.array(column) for column in zip(*found, strict=True))
    if np.sum(excess) < _CHANCE * math.sqrt(2 * np.sum(freedom)):
        return None
    places = np.arange(0.0, freq.max() + _NEAR_CPP, _NEAR_CPP)
    near = np.exp(-0.5 * ((places[:, None] - freq) / _NEAR_CPP) ** 2) + np.finfo(float).tiny
    mean_power = np.maximum(near @ power / near.sum(axis=1), 0.0)
    std = _ALONG_AXES * noise / level * np.sqrt(mean_power)
    std[0] = 0.0
    return ShapeError(places, std)


def _residual_rings(
    residual: Floats, star: SiemensStar, inner_px: float, outer_px: float
) -> list[tuple[float, Floats, Floats]]:
    """Radius, directions and residuals of every ring that has enough pixels."""
    rows, cols = np.nonzero(np.isfinite(residual))
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    value = residual[rows, cols]
    return [
        (float(np.mean(radius[here])), angle[here], value[here])
        for here in _members(radius, inner_px, outer_px, _MIN_PIXELS)
    ]


def _members(
    radius: Floats, inner_px: float, outer_px: float, least: int
) -> list[NDArray[np.intp]]:
    """Which pixels belong to every ring of a pixel that has at least so many."""
    order = np.argsort(radius)
    starts: Floats = np.asarray(np.arange(inner_px, outer_px - 0.5, 1.0))
    first, end = np.searchsorted(radius[order], [starts, starts + 1])
    rings = zip(first.tolist(), end.tolist(), strict=True)
    return [np.sort(order[one:other]) for one, other in rings if other - one >= least]


def _spoke_power(standard: Floats, angle: Floats, star: SiemensStar) -> tuple[float, float, int]:
    """Mean power of the spokes in a ring's standardised residuals, noise taken off.

    Also chi-square of the spokes less its expectation, and that. What pixels of a fan hardly show
    of some directions is taken to be as much as in the others: of the noise in them nothing else
    would be left.
    """
    turns = np.multiply.outer(angle, _TURNS)
    around = np.hstack([np.ones((angle.size, 1)), np.cos(turns), np.sin(turns)])
    spokes = np.cos(star.cycles * angle + star.alpha_rad)
    left, size, _ = np.linalg.svd(spokes[:, None] * around, full_matrices=False)
    kept = size > _MIN_SINGULAR * size[0]
    seen = (left.T @ standard)[kept]
    excess = float(seen @ seen) - seen.size
    # Mean squares of one, and of sines and cosines, over directions.
    whole = 1.0 + 0.5 * (around.shape[1] - 1)
    return whole * excess / float(size[kept] @ size[kept]), excess, seen.size
