"""Placing the edge in each row: cubic inflection, Fermi functions, centroid of the derivative.

Every function takes rows (n, cols) that rise to the right, the column where the edge of each
row is expected (n,) and the Gaussian width of the edge in pixels, and returns columns (n,),
NaN where a row shows no edge.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.straight.published.windows import tukey_window

__all__ = [
    "centroid_locations",
    "cubic_locations",
    "fermi_locations",
    "fermi_sum_locations",
]

_SEARCH_PX = 2.0
_FERMI_POINTS = 7
_FERMI_SUM_POINTS = 13
_TERM_OFFSETS = np.array([0.0, -4.0, 4.0])
_FERMI_STEPS = 40
_MAX_DAMPING = 1e6
_NARROWEST_PX, _WIDEST_PX = 0.05, 5.0


def _largest_rise(value: Floats, expected: Floats) -> NDArray[np.int64]:
    """Left pixel of the neighbours with the largest difference, near the expected edge."""
    rise = np.diff(value, axis=1)
    middle = np.arange(rise.shape[1]) + 0.5
    near = np.abs(middle - expected[:, None]) <= _SEARCH_PX
    return np.asarray(np.argmax(np.where(near & np.isfinite(rise), rise, -np.inf), axis=1))


def _cut(value: Floats, first: NDArray[np.int64], count: int) -> Floats:
    """`count` pixels of every row from column `first`; NaN beyond the image."""
    columns = first[:, None] + np.arange(count)
    inside = (columns >= 0) & (columns < value.shape[1])
    cut = np.take_along_axis(value, np.clip(columns, 0, value.shape[1] - 1), axis=1)
    return np.where(inside, cut, np.nan)


def cubic_locations(value: Floats, expected: Floats, width_px: float) -> Floats:
    """Inflection of the cubic through the 4 pixels around the largest difference.

    KOMPSAT-3 draft (2014), steps 5a-5c. The second derivative of that cubic at its two inner
    pixels equals their second differences, so the inflection has a closed form. A row whose
    inflection lies outside the four pixels shows no edge.
    """
    first = _largest_rise(value, expected) - 1
    y0, y1, y2, y3 = _cut(value, first, 4).T
    bend_left, bend_right = y0 - 2 * y1 + y2, y1 - 2 * y2 + y3
    change = bend_left - bend_right
    with np.errstate(divide="ignore", invalid="ignore"):
        place = 1.0 + bend_left / change
    return np.where((change > 0) & (place >= 0) & (place <= 3), first + place, np.nan)


def fermi_locations(value: Floats, expected: Floats, width_px: float) -> Floats:
    """Centre b of the Fermi function fitted to the 7 pixels nearest the largest difference.

    Generic sensor modeling (2005), section 2.3.2, with the equation as it must read:
    f(x) = a / (exp((x - b) / c) + 1) + d. The printed one has the 1 inside the exponent and
    grows without bound. A row whose centre leaves its seven pixels shows no edge.
    """
    return _fermi_centres(value, expected, width_px, _FERMI_POINTS, terms=1)


def fermi_sum_locations(value: Floats, expected: Floats, width_px: float) -> Floats:
    """Symmetry point b of a sum of three Fermi functions fitted to 13 pixels.

    QuickBird report (2005), section 3.3.1: for products with MTF compensation, whose edges under-
    and overshoot by different amounts, "a summation of Fermi functions". It prints neither their
    number nor the pixels; here one function about b has two of its own width c, of either sign,
    4 c before and behind it.
    """
    return _fermi_centres(value, expected, width_px, _FERMI_SUM_POINTS, terms=3)


def _fermi_centres(
    value: Floats, expected: Floats, width_px: float, count: int, terms: int
) -> Floats:
    """Centres of Fermi functions fitted to `count` pixels about the largest difference."""
    left = _largest_rise(value, expected)
    rise = np.nan_to_num(_cut(np.diff(value, axis=1), left - 1, 3), nan=-np.inf)
    centre = left + (rise[:, 2] >= rise[:, 0])
    points = _cut(value, centre - count // 2, count)
    usable = np.isfinite(points).all(axis=1)
    place = np.full(left.size, np.nan)
    place[usable] = centre[usable] + _fit_fermi_rows(points[usable], width_px, terms)
    return np.where(np.abs(place - centre) <= _FERMI_POINTS // 2, place, np.nan)


def _fit_fermi_rows(points: Floats, width_px: float, terms: int) -> Floats:
    """Centre of rising Fermi functions in every row of `points`, from the middle pixel.

    All rows are fitted together by Levenberg-Marquardt steps.
    """
    x = np.arange(points.shape[1]) - points.shape[1] // 2
    low, height = points.min(axis=1), np.ptp(points, axis=1)
    # In shares of its height every row is the same problem in any unit and on any level.
    points = (points - low[:, None]) / np.where(height > 0, height, 1.0)[:, None]
    unknown = np.zeros((low.size, 3 + terms))
    unknown[:, 1] = np.log(np.clip(0.55 * width_px, 0.1, 2.0))
    unknown[:, 3] = height > 0
    damping = np.full(low.size, 1e-3)
    cost = np.sum((points - _fermi_rows(x, unknown)[0]) ** 2, axis=1)
    settled = np.zeros(low.size, dtype=bool)
    for _ in range(_FERMI_STEPS):
        model, jacobian = _fermi_rows(x, unknown)
        normal = np.einsum("npi,npj->nij", jacobian, jacobian)
        gradient = np.einsum("npi,np->ni", jacobian, points - model)
        scale = np.einsum("nii->ni", normal)
        scale = np.maximum(scale, 1e-12 * scale.max(axis=1, keepdims=True))
        damped = normal + (damping[:, None] * scale)[:, :, None] * np.eye(3 + terms)
        trial = unknown + np.linalg.solve(damped, gradient[:, :, None])[:, :, 0]
        trial[:, 1] = np.clip(trial[:, 1], np.log(_NARROWEST_PX), np.log(_WIDEST_PX))
        trial_cost = np.sum((points - _fermi_rows(x, trial)[0]) ** 2, axis=1)
        better = trial_cost < cost
        settled |= better & (cost - trial_cost <= 1e-10 * cost)
        unknown = np.where(better[:, None], trial, unknown)
        damping = np.clip(np.where(better, damping / 5, damping * 5), 1e-12, 1e12)
        cost = np.minimum(cost, trial_cost)
        settled |= (cost <= 1e-20) | (damping > _MAX_DAMPING)
        if settled.all():
            break
    return np.asarray(unknown[:, 0])


def _fermi_rows(x: Floats, unknown: Floats) -> tuple[Floats, Floats]:
    """Values (n, p) and Jacobian (n, p, k) of Fermi functions (b, log c, d, a of every term)."""
    b, log_c, d = (unknown[:, i, None] for i in range(3))
    height = unknown[:, None, 3:]
    u = (x - b) / np.exp(log_c)
    rise = 0.5 * (1.0 + np.tanh((u[:, :, None] - _TERM_OFFSETS[: height.shape[2]]) / 2))
    steep = np.sum(height * rise * (1.0 - rise), axis=2)
    common = np.stack((-steep / np.exp(log_c), -steep * u, np.ones_like(u)), axis=2)
    return np.sum(height * rise, axis=2) + d, np.concatenate((common, rise), axis=2)


def centroid_locations(value: Floats, expected: Floats, width_px: float) -> Floats:
    """Centroid of the windowed derivative, in two passes (ISO 12233 e-SFR).

    The window of the second pass is centred on the line through the first one's centroids. As
    in the standard's reference program the Tukey window stands on a floor of 5 %.
    """
    rise = np.nan_to_num(np.diff(value, axis=1), nan=0.0)
    middle = np.arange(rise.shape[1]) + 0.5
    row = np.arange(value.shape[0], dtype=float)
    centre = expected
    for _ in range(2):
        farther = np.maximum(centre, value.shape[1] - 1 - centre)[:, None]
        window = 0.95 * tukey_window(middle - centre[:, None], farther, 1.0) + 0.05
        weighted = rise * window
        total = weighted.sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            place = np.where(total > 0, weighted @ middle / total, np.nan)
        place = np.where((place >= 0) & (place <= value.shape[1] - 1), place, np.nan)
        found = np.isfinite(place)
        if found.sum() < 2:
            return place
        # The correction of the first line is a straight line as well, and small.
        correction = np.polyfit(row[found], (place - expected)[found], 1)
        centre = expected + np.polyval(correction, row)
    return place
