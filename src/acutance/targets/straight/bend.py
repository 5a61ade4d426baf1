"""A first fit of a gently curved target: the line is bent until its parts lie on it."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.noise import median, robust_scale
from acutance.targets.straight.first_fit import FirstFit, fit_first

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
    s = fit.line.normal_distance(row, col)
    near = fit.profile.near(s, _NEAR_WIDTHS * fit.blur.width_px)
    s, t = s[near], fit.line.tangent_distance(row, col)[near]
    response, slope = fit.profile.response(fit.profile.seen(fit.blur, s))
    residual = (value[near] - fit.dark) / fit.height - response
    first, extent = float(t.min(initial=0.0)), float(np.ptp(t)) if t.size else 0.0
    parts = int(extent / _PART_PX)
    if parts < _MIN_PARTS:
        return 0.0, np.inf, 1.0
    power, offset = _part_offsets(t - first, slope, residual, extent / parts, parts)
    known = (power > 0.3 * median(power)) & (np.abs(offset) < _MAX_OFFSET_PX)
    if np.count_nonzero(known) < _MIN_PARTS:
        return 0.0, np.inf, 1.0
    half_px, offset = 0.5 * extent, offset[known]
    place = (first + (known.nonzero()[0] + 0.5) * (extent / parts)) / half_px
    shapes = np.stack([np.ones(place.size), place, 0.5 * place * place])
    inverse = np.linalg.solve(shapes @ shapes.T, shapes)
    left = offset - (inverse @ offset) @ shapes
    bow = inverse[2] / half_px**2
    return float(bow @ offset), max(robust_scale(left), 1e-6) * math.sqrt(bow @ bow), half_px


@compiled
def _part_offsets(
    t: Floats, slope: Floats, residual: Floats, part_px: float, parts: int
) -> tuple[Floats, Floats]:
    """Power of the slope in every part of a target, and the part's offset by least squares.

    `t` begins at the first part's end.
    """
    power, product = np.zeros(parts), np.zeros(parts)
    for k in range(t.size):
        part = min(int(t[k] / part_px), parts - 1)
        power[part] += slope[k] * slope[k]
        product[part] -= slope[k] * residual[k]
    return power, product / np.maximum(power, 1e-9)
