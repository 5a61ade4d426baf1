"""Rounding to the steps of an image's numbers, where the noise is too small to smooth it.

Rounding shifts the mean of pixels whose true value is v, in steps, by a sawtooth of v that noise of
standard deviation sigma (in steps) smooths:

    e(v) = sum_k (-1)^k sin(2 pi k v) exp(-2 pi^2 k^2 sigma^2) / (pi k)

From .5 steps of noise on it vanishes. Below, it is equal for all pixels of a plateau and moves its
level by up to half a step, while in the steep part it changes from pixel to pixel and is noise of
variance 1/12. So it is made part of the model: on either plateau waves of the value itself, of
unknown phase, with the amplitudes of the sawtooth; and slow waves of the distance where the wings
come within a step of the plateau, and rounding hides them.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.noise import smallest_step
from acutance.targets.straight.tuned import MAX_FINE_STEP

__all__ = ["NO_ROUNDING", "Rounding", "level_step", "rounding_of"]

_MAX_NOISE_STEPS: Final = 0.5
_HARMONICS: Final = np.arange(1, 4)
_NEAR_STEPS: Final = 6
_FEW: Final = 512
_WAVES: Final = np.arange(1, 4)
_WING_STEPS: Final = 0.3
_AMPLITUDE: Final = 1.5
"""Standard deviations of the modes over those of the sawtooth: its values are spread evenly, not
normally, and its wings are not those of the fit (2400 edges, noise .05 to .3 steps: at 1 the
intervals of MTF(.25) hold 80 % at .1 steps and 93 % at .2, at 1.5 75 to 88 and 94 to 98 %)."""


class Rounding(NamedTuple):
    """The rounding of some pixels.

    Attributes
    ----------
    modes : (k, n) array
        Waves of the pixels' values, about 1 at their largest.
    std : (k,) array
        Standard deviation of their amplitudes, in image units.
    floor : float
        Standard deviation that rounding adds to noise, in image units.
    """

    modes: Floats
    std: Floats
    floor: float


NO_ROUNDING: Final = Rounding(np.empty((0, 0)), np.empty(0), 0.0)


def level_step(value: Floats, level: float) -> float:
    """The step of numbers that are not evenly spaced, (n,), next to a level."""
    values = np.unique(value)
    if values.size < 2:
        return 0.0
    at = int(np.searchsorted(values, level))
    near = values[max(at - _NEAR_STEPS, 0) : at + _NEAR_STEPS]
    return float(np.min(np.diff(near))) if near.size > 1 else 0.0


def rounding_of(
    value: Floats,
    fitted: Floats,
    outside: Floats,
    groups: list[NDArray[np.bool_]],
    height: float,
    variances: Floats,
) -> Rounding:
    """The rounding of the pixels of a target.

    Parameters
    ----------
    value, fitted : (n,) arrays
        The pixels, and a fit to them.
    outside : (n,) array
        Their distance outwards from the target's nearest step.
    groups : list of (n,) bool arrays
        Pixels of each plateau with the half of the transition next to it.
    height : float
        Contrast of the target.
    variances : (len(groups),) array
        Variance of the pixels on each plateau, rounding included.
    """
    # Of finer numbers a few hundred are enough to find two that differ by less.
    few = smallest_step(value[:: max(value.size // _FEW, 1)])
    if few < max(MAX_FINE_STEP * height, math.sqrt(float(np.min(variances))) / _MAX_NOISE_STEPS):
        return NO_ROUNDING
    modes, std, floor = [], [], 0.0
    for group, variance in zip(groups, variances, strict=True):
        level = float(np.median(value[group])) if group.any() else 0.0
        step = level_step(value, level)
        if not (step > MAX_FINE_STEP * height and variance < (_MAX_NOISE_STEPS * step) ** 2):
            continue
        noise = max(variance / step**2 - 1 / 12, 0.0)
        amplitude = np.exp(-2 * (math.pi * _HARMONICS) ** 2 * noise) / (math.pi * _HARMONICS)
        phase = np.multiply.outer(_HARMONICS, (fitted - level) * (2 * math.pi / step))
        modes += [np.cos(phase) * group, np.sin(phase) * group]
        std += [amplitude * (step / math.sqrt(2))] * 2
        flat = group & (np.abs(fitted - level) < step)
        if flat.any():
            modes.append(_slow_waves(outside, flat))
            std.append(_WING_STEPS * step * amplitude[0] * math.pi / _WAVES)
        floor = max(floor, step / math.sqrt(12))
    if not modes:
        return NO_ROUNDING
    return Rounding(np.vstack(modes), _AMPLITUDE * np.concatenate(std), floor)


def _slow_waves(outside: Floats, flat: NDArray[np.bool_]) -> Floats:
    """Waves over the distance of the pixels that rounding makes equal to their plateau."""
    place = np.zeros(outside.size)
    first, last = float(outside[flat].min()), float(outside[flat].max())
    place[flat] = (outside[flat] - first) / max(last - first, 1e-9)
    return np.asarray(np.cos(np.multiply.outer(math.pi * _WAVES, np.sqrt(place))) * flat)
