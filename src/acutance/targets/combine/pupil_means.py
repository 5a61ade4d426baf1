"""Means of waves over what an aberrated pupil and itself, shifted, have in common.

The difference of the wavefronts at a place of the plane is a sum of terms that depend on the
distance from zero frequency alone, each with an amount of its own there. Two loops over the nodes
of the quadrature take the mean of ``exp(i D)`` and of its derivatives by the amounts, without
arrays of all places and nodes.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled

__all__ = ["mean_cosines", "mean_slopes", "mean_waves"]


@compiled
def mean_waves(
    ring: NDArray[np.intp], weights: Floats, odd: Floats, even: Floats, by_odd: Floats,
    by_even: Floats,
) -> NDArray[np.complex128]:  # fmt: skip
    """Means of ``cos(odd part) exp(i even part)``, (n,).

    Parameters
    ----------
    ring : (n,) int array
        Which distance from zero frequency each place has.
    weights : (r, m) array
        Of the nodes; what the discs have in common has a mirror image, at which odd terms have the
        other sign.
    odd, even : (3, r, m) and (2, r, m) array
        The terms.
    by_odd, by_even : (3, n) and (2, n) array
        Their amounts, in radians.
    """
    found = np.empty(ring.size, np.complex128)
    for i in range(ring.size):
        r = ring[i]
        real, imaginary = 0.0, 0.0
        for k in range(weights.shape[1]):
            angle = by_odd[0, i] * odd[0, r, k] + by_odd[1, i] * odd[1, r, k]
            angle += by_odd[2, i] * odd[2, r, k]
            turn = by_even[0, i] * even[0, r, k] + by_even[1, i] * even[1, r, k]
            part = weights[r, k] * math.cos(angle)
            real += part * math.cos(turn)
            imaginary += part * math.sin(turn)
        found[i] = complex(real, imaginary)
    return found


@compiled
def mean_slopes(
    ring: NDArray[np.intp], weights: Floats, odd: Floats, even: Floats, by_odd: Floats,
    by_even: Floats,
) -> NDArray[np.complex128]:  # fmt: skip
    """Derivatives of `mean_waves` by the amounts of the odd and of the even terms, (5, n)."""
    found = np.zeros((5, ring.size), np.complex128)
    for i in range(ring.size):
        r = ring[i]
        for k in range(weights.shape[1]):
            angle = by_odd[0, i] * odd[0, r, k] + by_odd[1, i] * odd[1, r, k]
            angle += by_odd[2, i] * odd[2, r, k]
            turn = by_even[0, i] * even[0, r, k] + by_even[1, i] * even[1, r, k]
            wave = weights[r, k] * complex(math.cos(turn), math.sin(turn))
            sine, cosine = -wave * math.sin(angle), 1j * wave * math.cos(angle)
            for j in range(3):
                found[j, i] += sine * odd[j, r, k]
            for j in range(2):
                found[3 + j, i] += cosine * even[j, r, k]
    return found


@compiled
def mean_cosines(
    ring: NDArray[np.intp], weights: Floats, terms: Floats, by: Floats
) -> NDArray[np.float64]:
    """Means of the cosine of two terms, and their derivatives by both amounts, (3, n).

    Parameters
    ----------
    ring, weights : array
        As of `mean_waves`.
    terms : (2, r, m) array
    by : (2, n) array
        Their amounts, in radians.
    """
    found = np.zeros((3, ring.size))
    for i in range(ring.size):
        r = ring[i]
        for k in range(weights.shape[1]):
            angle = by[0, i] * terms[0, r, k] + by[1, i] * terms[1, r, k]
            sine = weights[r, k] * math.sin(angle)
            found[0, i] += weights[r, k] * math.cos(angle)
            found[1, i] -= sine * terms[0, r, k]
            found[2, i] -= sine * terms[1, r, k]
    return found
