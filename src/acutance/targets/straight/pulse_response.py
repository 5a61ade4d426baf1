"""The width of the pulse response function at half of its maximum, from a fitted LSF and width.

The pulse response function (PRF) is the image of a pulse of height 1 between plateaus of 0:
``P(s) = E(s) - E(s - w)`` with the edge spread function (ESF) E, 0 at the rising side, and the
pulse's width w. It is linear in the ESF, so its covariance is that of the ESF at two distances
(Helder, Choi, "Generic sensor modeling using pulse method", 2005, 2.3).
"""

from __future__ import annotations

import math

import numpy as np

from acutance.curves import Esf, Estimate, Response
from acutance.curves.grid import Floats, crossing

__all__ = ["prf_fwhm"]


def prf_fwhm(response: Response, width_px: float, width_factor: Floats) -> Estimate:
    """Full width of the pulse response function at half of its maximum, in pixels.

    Parameters
    ----------
    response : Response
        Of the sensor, along the normal.
    width_px : float
        Width of the pulse.
    width_factor : (m,) array
        Factor of the width's variance in the latent variables of the curves: in a fit of
        both, a pulse that is too wide comes with a line spread function (LSF) that is too narrow.

    Returns
    -------
    Estimate
        ``nan`` where the response does not fall to half on both sides.
    """
    esf, lsf, w = response.esf, response.lsf, width_px
    grid = esf.distance_px
    step = float(grid[1] - grid[0])
    distance = np.arange(float(grid[0]), float(grid[-1]) + w + 0.5 * step, step)
    value = _steps(esf, distance) - _steps(esf, distance - w)
    peak = int(np.argmax(value))
    top, level = float(distance[peak]), 0.5 * float(value[peak])
    rise, fall = (crossing(distance, value, level, top, way) for way in (-1, 1))
    if math.isnan(rise) or math.isnan(fall):
        return Estimate(math.nan, math.nan)

    def steepness(s: float) -> float:
        return float(np.interp(s, lsf.distance_px, lsf.value, 0.0, 0.0))

    def gradient(s: float) -> Floats:
        row = _gradient(esf, s) - _gradient(esf, s - w)
        row[: width_factor.size] += steepness(s - w) * width_factor
        return row

    half = 0.5 * gradient(top)
    moves = [(half - gradient(s)) / (steepness(s) - steepness(s - w)) for s in (rise, fall)]
    return Estimate(fall - rise, float(np.linalg.norm(moves[1] - moves[0])))


def _steps(esf: Esf, distance_px: Floats) -> Floats:
    return np.asarray(np.interp(distance_px, esf.distance_px, esf.value, 0.0, 1.0))


def _gradient(esf: Esf, distance_px: float) -> Floats:
    """The row of the ESF's covariance factor; nothing is uncertain beyond its grid."""
    grid = esf.distance_px
    inside = bool(grid[0] <= distance_px <= grid[-1])
    row = esf.gradient(min(max(distance_px, float(grid[0])), float(grid[-1])))
    return row if inside else np.zeros_like(row)
