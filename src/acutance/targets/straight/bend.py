"""A first fit of a gently curved target: the line is bent until its parts lie on it."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.noise import median, robust_scale
from acutance.numerics.small_matrices import orthonormal_rows
from acutance.targets.straight.first_fit import FirstFit, fit_first
from acutance.targets.straight.step_profile import blurred_profile

__all__ = ["bent"]

_PART_PX = 5.0
_MIN_PARTS = 5
_MAX_PASSES = 4
_SIGNIFICANT = 5.0
_MIN_SAGITTA_PX = 0.02
_MAX_OFFSET_PX = 1.5
_NEAR_WIDTHS = 1.5


def bent(
    row: Floats, col: Floats, value: Floats, fit: FirstFit, *, fit_width: bool = False
) -> FirstFit:
    """The first fit on a line with the curvature that the target has; unchanged where it has none.

    Parameters
    ----------
    row, col, value : (n,) arrays
        The pixels of the fit.
    fit : FirstFit
        On a straight line.
    fit_width : bool, optional
        Whether a pulse's width is unknown.

    Raises
    ------
    NoEdgeError
        If no step survives the fit.
    """
    for _ in range(_MAX_PASSES):
        curvature, std, half_px = _curvature(row, col, value, fit)
        if abs(curvature) < max(_SIGNIFICANT * std, 2 * _MIN_SAGITTA_PX / half_px**2):
            break
        fit = fit_first(
            row, col, value, fit.line.bent(curvature), dark=fit.dark, bright=fit.dark + fit.height,
            sigma_px=fit.blur.sigma_px, profile=fit.profile, fit_width=fit_width,
        )  # fmt: skip
    return fit


def _curvature(
    row: Floats, col: Floats, value: Floats, fit: FirstFit
) -> tuple[float, float, float]:
    """Curvature that the offsets of the parts of a target show, its std, and half their length.

    The pixels of a part that lies an offset d towards the bright side are darker by d times the
    slope of the image.
    """
    first, part_px, power, offset = _part_offsets(
        *fit.line.distances(row, col), (value - fit.dark) / fit.height, fit.profile.steps,
        fit.blur.sigma_px, fit.blur.aperture_px, _NEAR_WIDTHS * fit.blur.width_px,
    )  # fmt: skip
    if power.size < _MIN_PARTS:
        return 0.0, np.inf, 1.0
    known = (power > 0.3 * median(power)) & (np.abs(offset) < _MAX_OFFSET_PX)
    if np.count_nonzero(known) < _MIN_PARTS:
        return 0.0, np.inf, 1.0
    half_px = 0.5 * part_px * power.size
    place = np.asarray((first + (known.nonzero()[0] + 0.5) * part_px) / half_px, float)
    bow, bow_std, left = _bow(place, offset[known])
    std = max(robust_scale(left), 1e-6) * bow_std
    return bow / half_px**2, std / half_px**2, half_px


@compiled
def _bow(place: Floats, offset: Floats) -> tuple[float, float, Floats]:
    """Curvature of a parabola through offsets (n,) at some places, its standard deviation for
    offsets with errors of one, and what the parabola leaves of them."""
    shapes = np.ones((3, place.size))
    for k in range(place.size):
        shapes[1, k], shapes[2, k] = place[k], 0.5 * place[k] * place[k]
    # The last one is what only a bow follows.
    free = orthonormal_rows(shapes)
    std = 1 / (free[2] @ shapes[2])
    return std * (free[2] @ offset), std, offset - (free @ offset) @ free


@compiled
def _part_offsets(
    s: Floats, t: Floats, value: Floats, steps: Floats, sigma: float, aperture: float,
    reach_px: float,
) -> tuple[float, float, Floats, Floats]:  # fmt: skip
    """Offsets of the parts of a target by least squares, from the pixels near its steps.

    Returns
    -------
    first, part_px : float
        Where the first part begins along the line, and how long the parts are.
    power, offset : (parts,) arrays
        Squared slopes of each part, and its offset.
    """
    near = np.abs(s) < reach_px
    for k in range(1, steps.shape[1]):
        near |= np.abs(s - steps[0, k]) < reach_px
    s, t, value = s[near], t[near], value[near]
    first, last = np.inf, -np.inf
    for k in range(t.size):
        first, last = min(first, t[k]), max(last, t[k])
    parts = int(max(last - first, 0.0) / _PART_PX)
    power, product = np.zeros(parts), np.zeros(parts)
    if parts == 0:
        return 0.0, 0.0, power, product
    part_px = (last - first) / parts
    response, slope = blurred_profile(s, steps, sigma, aperture)
    for k in range(s.size):
        part = min(int((t[k] - first) / part_px), parts - 1)
        power[part] += slope[k] * slope[k]
        product[part] -= slope[k] * (value[k] - response[k])
    return first, part_px, power, product / np.maximum(power, 1e-9)
