"""Loops over the pixels of a region around a straight target.

Arrays of the region's shape hold each pixel's value, its distance from the target's line along the
normal, s, and its distance along the line, t. Pixels that must not be used are NaN.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.line import Line
from acutance.numerics.compiled import compiled
from acutance.targets.straight.step_profile import blurred_profile

__all__ = [
    "best_rows",
    "bounded_residual",
    "line_distances",
    "local_mean",
    "pixels_along",
    "reach_before_structure",
    "reach_of_rows",
    "values_beside",
]


_WIDER = (1.0, 1.5, 2.0, 3.0, 4.0)
"""Widths of plateaus that are tried, in units of the smallest one needed."""
_SHORTEST_RUN = 5
"""Fewer rows in a row, amid others that are not clear, are so by chance."""


def line_distances(shape: tuple[int, ...], line: Line) -> tuple[Floats, Floats]:
    """Distance of every pixel from a line, along its normal and along it, (rows, cols) each."""
    row, col = np.arange(float(shape[0]))[:, None], np.arange(float(shape[1]))
    return line.distances(row, col)


@compiled
def pixels_along(
    image: Floats, s: Floats, t: Floats, start_px: float, stop_px: float, reach_px: float
) -> Floats:
    """Row, column, value and s of the pixels near a stretch of the line, (4, n)."""
    near = (np.abs(s) < reach_px) & (t > start_px) & (t < stop_px) & np.isfinite(image)
    found, n = np.empty((4, np.count_nonzero(near))), 0
    for row in range(image.shape[0]):
        for col in range(image.shape[1]):
            if near[row, col]:
                found[0, n], found[1, n] = row, col
                found[2, n], found[3, n] = image[row, col], s[row, col]
                n += 1
    return found


@compiled
def bounded_residual(
    image: Floats, s: Floats, dark: float, height: float, steps: Floats, sigma: float,
    aperture: float,
) -> Floats:  # fmt: skip
    """What a blurred profile leaves of the pixels, in units of its height, within -1 .. 1.

    One bad pixel is an outlier, and no structure of the plateaus.

    Parameters
    ----------
    image, s : (rows, cols) arrays
    dark, height : float
    steps : (2, n) array
        Positions and shares of the profile's steps.
    sigma, aperture : float
        The blur, pixels.
    """
    model = blurred_profile(s.reshape(-1), steps, sigma, aperture)[0].reshape(image.shape)
    found = np.empty(image.shape)
    for row in range(image.shape[0]):
        for col in range(image.shape[1]):
            residual = (image[row, col] - dark) / height - model[row, col]
            residual = 1.0 if residual > 1.0 else residual
            found[row, col] = -1.0 if residual < -1.0 else residual
    return found


@compiled
def local_mean(image: Floats) -> Floats:
    """Mean of the usable ones of the 3 x 3 pixels around every usable pixel, (rows, cols)."""
    rows, cols = image.shape
    total, known = np.zeros((rows + 2, cols + 2)), np.zeros((rows + 2, cols + 2))
    for row in range(rows):
        for col in range(cols):
            usable = np.isfinite(image[row, col])
            known[row + 1, col + 1] = 1.0 if usable else 0.0
            total[row + 1, col + 1] = image[row, col] if usable else 0.0
    total, known = _sums_of_three(total), _sums_of_three(known)
    mean = np.empty((rows, cols))
    for row in range(rows):
        for col in range(cols):
            own = total[row, col] / known[row, col]
            mean[row, col] = own if np.isfinite(image[row, col]) else np.nan
    return mean


@compiled
def _sums_of_three(padded: Floats) -> Floats:
    """Sums over 3 x 3 places, (rows - 2, cols - 2)."""
    rows, cols = padded.shape[0] - 2, padded.shape[1] - 2
    total = np.empty((rows, cols))
    for row in range(rows):
        for col in range(cols):
            above = padded[row, col] + padded[row, col + 1] + padded[row, col + 2]
            level = padded[row + 1, col] + padded[row + 1, col + 1] + padded[row + 1, col + 2]
            below = padded[row + 2, col] + padded[row + 2, col + 1] + padded[row + 2, col + 2]
            total[row, col] = above + level + below
    return total


@compiled
def values_beside(
    values: Floats, s: Floats, t: Floats, last_step_px: float, near_px: float, far_px: float,
    half_length_px: float,
) -> Floats:  # fmt: skip
    """Values of the usable pixels within two distances from a target's ends, (n,)."""
    found, n = np.empty(values.size), 0
    for row in range(values.shape[0]):
        for col in range(values.shape[1]):
            outside = max(-s[row, col], s[row, col] - last_step_px)
            if (
                near_px < outside < far_px
                and abs(t[row, col]) < half_length_px
                and np.isfinite(values[row, col])
            ):
                found[n] = values[row, col]
                n += 1
    return found[:n].copy()


@compiled
def reach_of_rows(
    mean: Floats, s: Floats, t: Floats, last_step_px: float, far_px: float,
    tolerance: float, near_px: float, near_tolerance: float,
) -> tuple[int, Floats, Floats, bool]:  # fmt: skip
    """How far the pixels and the uniform plateaus of every row reach, on both sides of a target.

    Parameters
    ----------
    mean : (rows, cols) array
        Local mean of what a fit leaves; NaN of pixels that must not be used.
    s, t : (rows, cols) arrays
    last_step_px : float
        Distance of the target's last step from its first.
    far_px : float
        Pixels further out do not count.
    tolerance, near_tolerance : float
        A pixel is structure if its mean exceeds the first; up to `near_px` from the target's ends
        the second.
    near_px : float

    Returns
    -------
    first : int
        Where the first row begins along the line. Rows are one pixel long.
    last : (2, n) array
        How far out the last pixel of every row lies, on the dark and on the bright side.
    stop : (2, n) array
        A pixel less than its first structure, infinite without any; within the target a structure
        pixel spoils its row on both sides.
    any_structure : bool
    """
    usable = np.isfinite(mean)
    low, high = np.inf, -np.inf
    for row in range(mean.shape[0]):
        for col in range(mean.shape[1]):
            if usable[row, col]:
                low, high = min(low, t[row, col]), max(high, t[row, col])
    first = math.floor(low)
    count = int(high - first) + 1
    last, stop = np.zeros((2, count)), np.full((2, count), np.inf)
    any_structure = False
    for row in range(mean.shape[0]):
        for col in range(mean.shape[1]):
            if not usable[row, col]:
                continue
            place = int(t[row, col] - first)
            dark, bright = -s[row, col], s[row, col] - last_step_px
            outside = max(dark, bright)
            if 0 < outside < far_px:
                side = 0 if dark > 0 else 1
                last[side, place] = max(last[side, place], outside)
            if abs(mean[row, col]) > (near_tolerance if outside < near_px else tolerance):
                any_structure = True
                if dark > -0.5 - last_step_px:
                    stop[0, place] = min(stop[0, place], max(dark - 1.0, 0.0))
                if bright > -0.5 - last_step_px:
                    stop[1, place] = min(stop[1, place], max(bright - 1.0, 0.0))
    return first, last, stop, any_structure


@compiled
def reach_before_structure(stop: Floats, width_px: float, need: float) -> Floats:
    """How far the rows are clear of structure at known distances, (2, rows).

    A row ends before the first structure of its own or of the rows next to it. Structure is blurred
    too: where the reach exceeds what is needed, it ends a width of the blur before the structure of
    any row that near.
    """
    reach = np.empty(stop.shape)
    wide = math.ceil(width_px)
    for side in range(stop.shape[0]):
        for row in range(stop.shape[1]):
            close, wary = np.inf, np.inf
            for other in range(max(row - wide, 0), min(row + wide + 1, stop.shape[1])):
                wary = min(wary, stop[side, other] - width_px)
                if abs(other - row) <= 1:
                    close = min(close, stop[side, other])
            reach[side, row] = max(wary, min(close, need))
    return reach


@compiled
def best_rows(reach: Floats, need: float) -> NDArray[np.bool_]:
    """Which rows to use, (rows,): many, with plateaus of at least `need` pixels.

    Structure that ends at the border of a field interrupts it: rows beyond are of the same target.
    A wider plateau leaves fewer rows; twice the need is worth a third of them.
    """
    best, found = 0.0, np.zeros(reach.size, np.bool_)
    for wider in _WIDER:
        chosen, start = np.zeros(reach.size, np.bool_), 0
        for stop in range(reach.size + 1):
            if stop < reach.size and reach[stop] >= need * wider:
                continue
            if stop - start >= _SHORTEST_RUN:
                chosen[start:stop] = True
            start = stop + 1
        worth = np.count_nonzero(chosen) * (1 - 0.5**wider)
        if worth > best:
            best, found = worth, chosen
    return found
