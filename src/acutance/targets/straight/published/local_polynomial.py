"""Modified Savitzky-Golay: local polynomials of unevenly spaced samples, on a regular grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.errors import SupportError

__all__ = ["modified_savitzky_golay", "window_gain"]

_STEP_PX = 0.05
_WINDOW_STEPS = 20
_RIDGE = 1e-9


def modified_savitzky_golay(
    distance_px: Floats, value: Floats, weight: Floats, grid_px: Floats, order: int
) -> Floats:
    """Local polynomials of unevenly spaced samples, evaluated at the centre of a 1 px window.

    Parameters
    ----------
    distance_px, value, weight : (n,) arrays
        Samples in any order; weight 0 leaves one out.
    grid_px : (m,) array
        Centres of the windows, 0.05 px apart.
    order : int
        Degree of the polynomial.

    Returns
    -------
    (m,) array
        A window with fewer distinct samples than the polynomial has coefficients gets the
        flattest polynomial through them.

    Raises
    ------
    SupportError
        If a window holds no sample at all.
    """
    size = grid_px.size
    position = (distance_px - grid_px[0]) / _STEP_PX
    first = np.ceil(position - _WINDOW_STEPS / 2).astype(int)
    window = first[:, None] + np.arange(_WINDOW_STEPS)
    offset = (position[:, None] - window) * (2.0 / _WINDOW_STEPS)
    inside = (window >= 0) & (window < size)
    window, offset = window[inside], offset[inside]
    share = np.broadcast_to(weight[:, None], inside.shape)[inside]
    target = np.broadcast_to(value[:, None], inside.shape)[inside]
    if np.bincount(window, share, minlength=size).min() <= 0:
        raise SupportError("a 1 px window of the profile holds no sample: use a larger region")
    basis = np.polynomial.legendre.legvander(offset, order).T
    terms = order + 1
    normal = np.empty((size, terms, terms))
    moment = np.empty((size, terms, 1))
    for i in range(terms):
        weighted = share * basis[i]
        moment[:, i, 0] = np.bincount(window, weighted * target, minlength=size)
        for j in range(i, terms):
            normal[:, i, j] = np.bincount(window, weighted * basis[j], minlength=size)
            normal[:, j, i] = normal[:, i, j]
    normal += (_RIDGE * normal[:, :1, :1]) * np.diag([0.0] + [1.0] * order)
    coefficient = np.linalg.solve(normal, moment)[:, :, 0]
    return np.asarray(coefficient @ np.polynomial.legendre.legvander(np.zeros(1), order)[0])


def window_gain(freq_cpp: ArrayLike, order: int) -> Floats:
    """What the local polynomial of a 1 px window leaves of a wave: its gain at the centre.

    The least-squares polynomial over u in [-1, 1] has the kernel ``sum_l (2l + 1)/2 P_l(0)
    P_l(u)``, and the Fourier transform of a Legendre polynomial is a spherical Bessel function:
    ``sum over even l <= order of (2l + 1) P_l(0) (-1)^(l/2) j_l(pi f)``. Samples are taken to
    fill the window evenly.

    Parameters
    ----------
    freq_cpp : array
        Cycles per pixel on the axis of the profile.
    order : int
        Degree of the polynomial.

    Returns
    -------
    array of the same shape
        .98016 at Nyquist for order 2, .99958 for order 4.
    """
    from scipy.special import eval_legendre, spherical_jn

    angle = np.pi * np.asarray(freq_cpp, dtype=float)
    gain = np.zeros_like(angle)
    for degree in range(0, order + 1, 2):
        sign = -1.0 if degree % 4 else 1.0
        share = (2 * degree + 1) * eval_legendre(degree, 0.0) * sign
        gain += share * spherical_jn(degree, angle)
    return np.asarray(gain)
