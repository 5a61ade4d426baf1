"""The pixels of a star, ring by ring."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import Flags, SiemensStar
from acutance.numerics.shape_error import ShapeError

__all__ = ["members_of", "ring_modulations", "rings_of", "shape_error"]

_RING_STEP_PX = 1.0
_CHANCE = 1.5
"""Deviations by which the residuals' spokes have to exceed what noise makes."""
_ALONG_AXES = 2.0
"""Error along rows and columns, over its root mean square in all directions: filters act there."""
_NEAR_CPP = 0.07
_TURNS = np.arange(0, 18, 2)
"""Even angular orders: transfer has the same modulus in opposite directions."""
_MIN_PIXELS = 34
_MIN_SINGULAR = 0.1


def rings_of(
    smooth: Floats, usable: Flags, row: float, col: float, first: float, last: float
) -> list[tuple[float, Floats, Floats]]:
    """Rings of pixels: radius, direction and value of every pixel in them."""
    rows, cols = np.nonzero(usable)
    radius = np.hypot(rows - row, cols - col)
    angle = np.arctan2(rows - row, cols - col)
    value = smooth[usable]
    ring = np.floor((radius - first) / _RING_STEP_PX).astype(np.intp)
    order = np.argsort(ring, kind="stable")
    ring, radius, angle, value = ring[order], radius[order], angle[order], value[order]
    found = []
    for number in range(max(int((last - first) / _RING_STEP_PX), 0)):
        start, stop = np.searchsorted(ring, [number, number + 1]).tolist()
        here = slice(start, stop)
        if stop - start >= 12:
            found.append((float(np.mean(radius[here])), angle[here], value[here]))
    return found


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
    value = image[rows, cols]
    kept = star.holds(angle, 2.0 / np.maximum(radius, 1.0))
    found = []
    for low in np.arange(inner_px, outer_px - 0.5, 1.0):
        here = kept & (radius >= low) & (radius < low + 1)
        if np.count_nonzero(here) < 12:
            continue
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
    rows, cols = np.nonzero(np.isfinite(residual))
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    phase, value = star.cycles * angle + star.alpha_rad, residual[rows, cols]
    found, excess, freedom = [], 0.0, 0
    for low in np.arange(inner_px, outer_px - 0.5, 1.0):
        here = (radius >= low) & (radius < low + 1)
        if np.count_nonzero(here) < _MIN_PIXELS:
            continue
        waves = np.multiply.outer(angle[here], _TURNS[1:])
        around = np.hstack([np.ones((len(waves), 1)), np.cos(waves), np.sin(waves)])
        design = np.cos(phase[here])[:, None] * around
        left, size, right = np.linalg.svd(design, full_matrices=False)
        kept = size > _MIN_SINGULAR * size[0]
        seen = (left.T @ value[here])[kept]
        excess, freedom = excess + float(seen @ seen) / noise**2 - seen.size, freedom + seen.size
        spokes = right[kept].T @ (seen / size[kept])
        chance = noise**2 * np.sum((right[kept] / size[kept, None]) ** 2, axis=0)
        power = np.where(np.arange(spokes.size) == 0, 1.0, 0.5) @ (spokes**2 - chance)
        found.append((star.cycles / (2 * math.pi * float(np.mean(radius[here]))), power))
    if not found or excess < _CHANCE * math.sqrt(2 * freedom):
        return None
    freq, power = np.array(found).T
    places = np.arange(0.0, freq.max() + _NEAR_CPP, _NEAR_CPP)
    near = np.exp(-0.5 * ((places[:, None] - freq) / _NEAR_CPP) ** 2) + np.finfo(float).tiny
    error = _ALONG_AXES * np.sqrt(np.maximum(near @ power / near.sum(axis=1), 0.0)) / level
    error[0] = 0.0
    return ShapeError(places, error)
