"""The noise of a target's two levels: what its ratio shows of the image's characteristic.

A characteristic of slope g multiplies noise by g, so that a curve changes ln of the ratio of the
variances by 2 ln(g bright / g dark) for noise that was there before it. Of a pulse the second level
is that of its pixels near the peak, which may be below that of a wide one. In values that are
proportional to light the brighter side has as much noise, or more by no more than photons make, or
anything where the noise is the texture of the ground.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.noise import variance_between
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.tuned import MIN_SIDE_PIXELS, NOISE_FLOOR

__all__ = ["SideNoise"]

_MAX_LOG_RATIO: Final = 3.0
_MORE_THAN_PHOTONS: Final = 0.3
_WHITE, _PHOTONS = 0.6, 0.4
"""Of a sensor's noise on the two sides: equal, or growing with the light."""
_TEXTURE_SNR: Final = 60.0
"""Contrast over noise at which the noise is as likely the ground's, of any ratio; its odds fall
with the fourth power: 97 % at 26, as of paint on grass, 11 % at 100. They grow with the square of
the noise's power along the normal over that of white noise."""
_NOISE_BEFORE: Final = 0.85
"""Share of curves that the noise goes through; else it is added behind, as by compression."""
_TEXTURE_STD: Final = 2.5
_NOISE_STD: Final = 0.05
_TAKEN: Final = 1.8
"""Variance of the logarithm of a pulse over that by chance: the fit takes some of the noise of its
few pixels, and leaves some of the image."""
_DARK, _PEAK = 0.05, 0.75
"""A pulse's background, and its peak, as shares of its height."""


@dataclass(frozen=True)
class SideNoise:
    """The noise of the bright side over that of the dark one.

    Parameters
    ----------
    log_variance, std : float
        Logarithm of the ratio of the variances, and its standard deviation.
    widest : float
        The largest such logarithm that photons make.
    texture : float
        Probability that the noise is the ground's.
    dark, bright : float
        Where the two levels lie between those of the target.
    """

    log_variance: float
    std: float
    widest: float
    texture: float
    dark: float = 0.0
    bright: float = 1.0

    @classmethod
    def of(cls, data: CheckData) -> SideNoise | None:
        """The noise of an edge's plateaus; none where there is none, or few pixels."""
        sides = [int(np.count_nonzero(side)) for side in data.plateaus]
        return cls._between(data, data.variances, sides, (0.0, 1.0))

    @classmethod
    def of_pulse(cls, data: CheckData, sign: float) -> SideNoise | None:
        """The noise of a pulse's background and peak; `sign` is -1 of a dark pulse, whose values
        are negated."""
        residual, fitted = data.residual, data.fitted
        parts = ((-math.inf, _DARK), (_PEAK, math.inf))
        inside = [(low < fitted) & (fitted < high) for low, high in parts]
        counts = [int(np.count_nonzero(one)) for one in inside]
        if min(counts) < MIN_SIDE_PIXELS:
            return None
        variances = tuple(variance_between(residual, fitted, *part) for part in parts)
        levels = (0.0, float(np.mean(fitted[inside[1]])))
        if sign < 0:
            variances, counts, levels = variances[::-1], counts[::-1], levels[::-1]
        return cls._between(data, variances, counts, levels, taken=_TAKEN)

    @classmethod
    def _between(
        cls,
        data: CheckData,
        variances: tuple[float, ...],
        counts: list[int],
        levels: tuple[float, ...],
        taken: float = 1.0,
    ) -> SideNoise | None:
        """Of the darker and the brighter level: variances, pixels, places between the target's."""
        if min(variances) <= NOISE_FLOOR**2 or min(counts) < MIN_SIDE_PIXELS:
            return None
        chance = taken * data.across.pixels_as_one * (2 / counts[0] + 2 / counts[1])
        low, high = data.fit.dark, data.fit.bright
        if levels[0] > levels[1]:
            low, high = -high, -low
        photons = math.log(high / low) if 0 < low < high else _MAX_LOG_RATIO
        # Noise of a sensor hardly correlates, that of a resampled product a little.
        odds = (_TEXTURE_SNR * data.noise) ** 4 * data.inflation**2
        return cls(
            math.log(variances[1] / variances[0]), math.hypot(_NOISE_STD, math.sqrt(chance)),
            photons + _MORE_THAN_PHOTONS, odds / (1 + odds), *levels,
        )  # fmt: skip

    @property
    def curvature(self) -> float:
        """The c of ``v = u + c u (1 - u)`` through which equal noise is as unequal."""
        return -math.tanh(0.25 * self.log_variance)

    @property
    def max_gain(self) -> float:
        """Log likelihood of the characteristic that suits this noise best, over that of none."""
        best, without = (self._density(log_ratio) for log_ratio in (0.0, self.log_variance))
        return max(math.log(_NOISE_BEFORE * best / without + 1 - _NOISE_BEFORE), 0.0)

    def likelihood(self, slope: Floats) -> Floats:
        """Likelihood of characteristics of a slope, bright over dark, over that of none."""
        through = _densities(
            self.log_variance - 2 * np.log(slope), self.std, self.widest, self.texture
        )
        without = self._density(self.log_variance)
        return _NOISE_BEFORE / without * through + (1 - _NOISE_BEFORE)

    def _density(self, log_ratio: float) -> float:
        return _density(log_ratio, self.std, self.widest, self.texture)


@compiled
def _density(log_ratio: float, std: float, widest: float, texture: float) -> float:
    """Density of the logarithm of bright over dark variance, for linear values."""
    below = _share_below(log_ratio / std) - _share_below((log_ratio - widest) / std)
    sensor = _WHITE * _normal(log_ratio, std) + _PHOTONS * below / widest
    ground = _normal(log_ratio, math.hypot(_TEXTURE_STD, std))
    return (1 - texture) * sensor + texture * ground


@compiled
def _densities(log_ratio: Floats, std: float, widest: float, texture: float) -> Floats:
    """The same of many logarithms, (k, m)."""
    found = np.empty(log_ratio.shape)
    for k in range(log_ratio.shape[0]):
        for m in range(log_ratio.shape[1]):
            found[k, m] = _density(log_ratio[k, m], std, widest, texture)
    return found


@inlined
def _share_below(z: float) -> float:
    """Share of the standard normal distribution below z."""
    return 0.5 * math.erfc(-z * math.sqrt(0.5))


@inlined
def _normal(x: float, std: float) -> float:
    return math.exp(-0.5 * (x / std) ** 2) / (std * math.sqrt(2 * math.pi))
