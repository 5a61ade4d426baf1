"""Whether the values of bars and stars are proportional to light: the curvature of their image.

With u the fitted image between dark (0) and bright (1), values that lie on a curve are

    v = u + c u (1 - u)

to second order. Of a sine of k cycles and modulation m the bend is ``(1 - m^2 cos^2) / 4``: a wave
of 2 k cycles, and a mean that changes with the modulation. No transfer makes either of a sine or of
a square wave, so the residuals show c, once what the fit has taken of it is left out.
"""

from __future__ import annotations

from typing import Final

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.periodic.otf_regression import Regression
from acutance.targets.periodic.residual_share import left_of

__all__ = ["DEPARTURE", "find_curvature"]

DEPARTURE: Final = 0.25
"""Largest distance of the curve from a straight line, for a curvature of 1."""


def find_curvature(
    fitted: Regression, pattern: Floats, contrast: float, weight: Floats, inflation: float
) -> Estimate:
    """The curvature c that the residuals of a pattern show.

    Parameters
    ----------
    fitted : Regression
    pattern : (n,) array
        The fitted image above its dark level (of dark bars, above the background), image units.
    contrast : float
        From dark to bright; of dark bars from the background to them, which is negative.
    weight : (n,) array
        Of the pixels.
    inflation : float
        Factor on the noise variance for correlated noise.

    Returns
    -------
    Estimate
        With an infinite deviation where the fit follows the bend.
    """
    shape = pattern / contrast
    bend = contrast * shape * (1 - shape)
    return left_of(fitted, bend[None, :], weight, inflation)[0]
