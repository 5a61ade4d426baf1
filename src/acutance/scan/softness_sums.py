"""Sums over the softness that every edge may have, edge by edge, compiled.

Of edge i the pixels say ``x^T A_i x - 2 c_i x`` (minus twice the log likelihood, up to a constant)
of a transfer function ``x_k = h_k exp(-2 pi^2 s^2 f_k^2)``, s being the softness of its object.
Softness is 0, or in the middle of one of equal cells.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined

__all__ = [
    "cell_chances",
    "likeliest_variances",
    "object_likelihoods",
    "softness_powers",
    "softness_terms",
    "weighted_by_bin",
]

_STEPS = 4
_LEAST_PX2, _MOST_PX2 = -0.2, 30.0
_LEAST = 1e-3
"""Information about a variance, 1 / px^4, of an edge that does not tell it."""


@inlined
def _fill_blur(blur: Floats, falls: Floats, first_px: float, width_px: float) -> None:
    """Transfer functions (m, t + 1) of an ideal object and of the middles of cells.

    Squares of equal steps have equal second differences: each cell's follow from the last one's.
    """
    for k in range(falls.size):
        now = np.exp(-falls[k] * first_px**2)
        ratio = np.exp(-falls[k] * (2 * first_px + width_px) * width_px)
        bend = np.exp(-2 * falls[k] * width_px**2)
        blur[k, 0] = 1.0
        for t in range(1, blur.shape[1]):
            blur[k, t] = now
            now *= ratio
            ratio *= bend


@inlined
def _fill_powers(power: Floats, row: Floats, quadratic: Floats, pull: Floats, blur: Floats) -> None:
    """``x^T A x - 2 c x`` of every column x of blur (m, t), (t,)."""
    for t in range(power.size):
        power[t] = 0.0
    for k in range(pull.size):
        for t in range(power.size):
            row[t] = quadratic[k, k] * blur[k, t] - 2 * pull[k]
        for other in range(k):
            twice = 2 * quadratic[k, other]
            for t in range(power.size):
                row[t] += twice * blur[other, t]
        for t in range(power.size):
            power[t] += row[t] * blur[k, t]


@compiled
def object_likelihoods(
    information: Floats, pull: Floats, seen: Floats, quadratic: Floats, own_pull: Floats
) -> None:
    """What edges say of the transfer functions of their objects, which are real.

    Parameters
    ----------
    information : (n, 2 k, 2 k) array
        About the transfer functions of the edges, real parts first.
    pull : (n, 2 k) array
        Its product with the likeliest.
    seen : (n, 2 k) array
        The sensor.
    quadratic, own_pull : (n, k, k), (n, k) array
        The same about the objects: results.
    """
    size = own_pull.shape[1]
    for i in range(len(seen)):
        here = seen[i]
        for k in range(size):
            own_pull[i, k] = here[k] * pull[i, k] + here[size + k] * pull[i, size + k]
            for other in range(size):
                real = here[k] * information[i, k, other]
                real += here[size + k] * information[i, size + k, other]
                imaginary = here[k] * information[i, k, size + other]
                imaginary += here[size + k] * information[i, size + k, size + other]
                quadratic[i, k, other] = real * here[other] + imaginary * here[size + other]


@compiled
def likeliest_variances(
    quadratic: Floats, pull: Floats, falls: Floats, tried_px2: Floats
) -> tuple[Floats, Floats]:
    """Likeliest variance of the softness of every object, and its standard deviation, (n,) each.

    The Gauss-Newton method from the best of what is tried first. A variance is below zero for an
    edge that is sharper than the sensor.

    Parameters
    ----------
    quadratic, pull : (n, k, k), (n, k) array
    falls : (k,) array
        Fall of the logarithm of the transfer function by the variance.
    tried_px2 : (c,) array
    """
    size, count = falls.size, len(pull)
    tried = np.exp(-falls.reshape(-1, 1) * tried_px2.reshape(1, -1))
    power, row = np.empty(tried_px2.size), np.empty(tried_px2.size)
    blur, slope = np.empty(size), np.empty(size)
    variances, stds = np.empty(count), np.empty(count)
    for i in range(count):
        _fill_powers(power, row, quadratic[i], pull[i], tried)
        variance = tried_px2[np.argmin(power)]
        information = _LEAST
        for _ in range(_STEPS):
            for k in range(size):
                blur[k] = np.exp(-falls[k] * variance)
                slope[k] = -falls[k] * blur[k]
            steepness, information = 0.0, 0.0
            for k in range(size):
                off, turned = -pull[i, k], 0.0
                for other in range(size):
                    off += quadratic[i, k, other] * blur[other]
                    turned += quadratic[i, k, other] * slope[other]
                steepness += slope[k] * off
                information += slope[k] * turned
            information = max(information, _LEAST)
            variance = min(max(variance - steepness / information, _LEAST_PX2), _MOST_PX2)
        variances[i], stds[i] = variance, 1 / np.sqrt(information)
    return variances, stds


@compiled
def softness_powers(
    quadratic: Floats, pull: Floats, falls: Floats, first_px: Floats, width_px: Floats, cells: int
) -> Floats:
    """``x^T A x - 2 c x`` of an ideal object and in the middle of every cell, (n, t + 1).

    Parameters
    ----------
    quadratic, pull : (n, k, k), (n, k) array
    falls : (k,) array
    first_px, width_px : (n,) array
        Middle of the first cell, and the width of each.
    cells : int
    """
    power, row = np.empty((len(pull), cells + 1)), np.empty(cells + 1)
    blur = np.empty((falls.size, cells + 1))
    for i in range(len(pull)):
        _fill_blur(blur, falls, first_px[i], width_px[i])
        _fill_powers(power[i], row, quadratic[i], pull[i], blur)
    return power


@compiled
def cell_chances(
    below: Floats, step_px: float, first_px: Floats, width_px: Floats, cells: int
) -> Floats:
    """Probability of every cell by every law of softness, (n, p, t).

    Parameters
    ----------
    below : (m, p) array
        Probability of less than 0, 1, 2, ... steps, by every law: it is linear between.
    step_px : float
    first_px, width_px : (n,) array
    cells : int
    """
    laws = below.shape[1]
    found = np.empty((first_px.size, laws, cells))
    last, here = np.empty(laws), np.empty(laws)
    for i in range(first_px.size):
        for border in range(cells + 1):
            place = (first_px[i] + (border - 0.5) * width_px[i]) / step_px
            at = min(int(place), len(below) - 2)
            part = min(place - at, 1.0)
            for law in range(laws):
                here[law] = below[at, law] + part * (below[at + 1, law] - below[at, law])
                if border > 0:
                    found[i, law, border - 1] = here[law] - last[law]
                last[law] = here[law]
    return found


@compiled
def softness_terms(
    quadratic: Floats,
    pull: Floats,
    falls: Floats,
    sensor: Floats,
    first_px: Floats,
    width_px: Floats,
    weight: Floats,
) -> tuple[Floats, Floats]:
    """Gradients of the log likelihood by the sensor for every softness, and expected information.

    Parameters
    ----------
    quadratic, pull : (n, m, m), (n, m) array
        About the sensor times the blur of each object.
    falls : (m,) array
    sensor : (n, m) array
    first_px, width_px : (n,) array
    weight : (n, t + 1) array
        Of every softness in the information.

    Returns
    -------
    slopes : (n, t + 1, m) array
    information : (n, m, m) array
    """
    size, count = falls.size, weight.shape[1]
    slopes = np.empty((len(pull), count, size))
    information = np.empty((len(pull), size, size))
    blur, row = np.empty((size, count)), np.empty(count)
    for i in range(len(pull)):
        _fill_blur(blur, falls, first_px[i], width_px[i])
        for k in range(size):
            for t in range(count):
                row[t] = pull[i, k]
            for other in range(size):
                one = quadratic[i, k, other] * sensor[i, other]
                for t in range(count):
                    row[t] -= one * blur[other, t]
            for t in range(count):
                slopes[i, t, k] = row[t] * blur[k, t]
            for other in range(k + 1):
                both = 0.0
                for t in range(count):
                    both += weight[i, t] * blur[k, t] * blur[other, t]
                information[i, k, other] = both * quadratic[i, k, other]
                information[i, other, k] = information[i, k, other]
    return slopes, information


@compiled
def weighted_by_bin(
    information: Floats,
    pull: Floats,
    gain: Floats,
    falls: Floats,
    first_px: Floats,
    width_px: Floats,
    weight: Floats,
    number: NDArray[np.intp],
    whole: Floats,
    projection: Floats,
) -> None:
    """Information about the sensor along every bin, its edges' objects being known.

    Parameters
    ----------
    information, pull : (n, 2 k, 2 k), (n, 2 k) array
        About the transfer functions of the edges.
    gain : (n, k) array
        What each sees, over the sensor along its bin.
    falls : (k,) array
    first_px, width_px : (n,) array
    weight : (n, t + 1) array
        Of every softness.
    number : (n,) int array
        Bin of each edge.
    whole, projection : (b, 2 k, 2 k), (b, 2 k) array
        Information, and its product with the likeliest sensor: results, zero at first.
    """
    size, count = falls.size, weight.shape[1]
    blur, both = np.empty((size, count)), np.empty((size, size))
    for i in range(len(pull)):
        _fill_blur(blur, falls, first_px[i], width_px[i])
        own, own_projection = whole[number[i]], projection[number[i]]
        for k in range(size):
            mean = 0.0
            for t in range(count):
                mean += weight[i, t] * blur[k, t]
            mean *= gain[i, k]
            own_projection[k] += mean * pull[i, k]
            own_projection[size + k] += mean * pull[i, size + k]
            for other in range(k + 1):
                square = 0.0
                for t in range(count):
                    square += weight[i, t] * blur[k, t] * blur[other, t]
                both[k, other] = square * gain[i, k] * gain[i, other]
                both[other, k] = both[k, other]
        for part in range(0, 2 * size, size):
            for k in range(size):
                for other in range(size):
                    own[part + k, other] += both[k, other] * information[i, part + k, other]
                    own[part + k, size + other] += (
                        both[k, other] * information[i, part + k, size + other]
                    )
