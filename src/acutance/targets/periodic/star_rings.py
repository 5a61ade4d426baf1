"""The pixels of a star, ring by ring."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import Flags, SiemensStar

__all__ = ["members_of", "ring_modulations", "rings_of"]

_RING_STEP_PX = 1.0


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
