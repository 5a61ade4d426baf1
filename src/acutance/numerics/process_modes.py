"""Gaussian processes of finite extent and smoothness: priors of corrections.

A process has the covariance ``exp(-(x^2 + x'^2) / 2 L^2) exp(-(x - x')^2 / 2 l^2)``: its functions
extend over L about the origin and vary over l. On places of a grid its modes are those of a matrix
(`covariance_modes`); in closed form they are Hermite functions whose variances fall by a constant
factor from order to order (`mehler`: Mehler's formula; Rasmussen and Williams, Gaussian Processes
for Machine Learning, 2006, 4.3.1).
"""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["covariance_modes", "mehler"]


def covariance_modes(
    places: Floats, extent: float, smoothness: float, negligible: float
) -> tuple[Floats, Floats]:
    """Variances and shapes of a process's modes at some places.

    Parameters
    ----------
    places : (n,) array
    extent, smoothness : float
        L and l, in the unit of the places.
    negligible : float
        Modes with a variance below this share of the largest are left out.

    Returns
    -------
    variance : (r,) array
        Ascending.
    shape : (n, r) array
        Orthonormal columns; times the roots of the variances, their squares sum to the covariance.
    """
    envelope = np.exp(-0.5 * (places / extent) ** 2)
    apart = (places[:, None] - places) / smoothness
    variance, shape = np.linalg.eigh(np.exp(-0.5 * apart**2) * envelope[:, None] * envelope)
    kept = variance > negligible * variance[-1]
    return variance[kept], np.asarray(shape[:, kept])


def mehler(extent: float, smoothness: float) -> tuple[float, float]:
    """Ratio of the variances of one order and the one before, and scale of the Hermite functions.

    Parameters
    ----------
    extent, smoothness : float
        L and l; the scale has their unit.
    """
    q = 1 + (smoothness / extent) ** 2
    ratio = q - math.sqrt(q * q - 1)
    return ratio, smoothness * math.sqrt(2 * ratio / (1 - ratio**2))
