"""The General Image Quality Equation (GIQE), versions 3, 4 and 5.

NIIRS, the National Imagery Interpretability Rating Scale, of an image of given ground sampling
distance (GSD), relative edge response (RER), overshoot, noise gain and SNR. Version 4:
Leachtenauer et al., Applied Optics 36, 8322 (1997), doi:10.1364/AO.36.008322. The factor of noise
gain over SNR is 0.344; several programs have 0.334.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from acutance.curves.short_repr import ShortRepr

__all__ = ["EQUATION_STD", "JUMP_RER", "GiqeInputs", "giqe", "giqe4_jump"]

_INCH_M = 0.0254
JUMP_RER = 0.9
"""Version 4 has other coefficients from this RER on."""
EQUATION_STD = 0.3
"""Standard error of ratings about version 4 (Leachtenauer et al. 1997), in NIIRS. None was
published that we know of for versions 3 and 5: the same is taken."""


@dataclass(frozen=True)
class GiqeInputs(ShortRepr):
    """What the equations are made of.

    Parameters
    ----------
    gsd_m : float
        Geometric mean of the two ground sampling distances, normal to the line of sight, metres.
    rer_across, rer_along : float
    snr : float
        Before sharpening.
    elevation_deg : float
        Of the line of sight over the horizon: 90 at nadir.
    giqe_h : float
        Edge height overshoot H, geometric mean of both directions.
    noise_gain : float
    """

    gsd_m: float
    rer_across: float
    rer_along: float
    snr: float
    elevation_deg: float = 90.0
    giqe_h: float = 1.0
    noise_gain: float = 1.0

    @property
    def rer_mean(self) -> float:
        """Geometric mean of both directions: of versions 3 and 4."""
        return math.sqrt(self.rer_across * self.rer_along)

    @property
    def rer_weighted(self) -> float:
        """The smaller one counts twice: of version 5."""
        low, high = sorted((self.rer_across, self.rer_along))
        return math.cbrt(high * low**2)

    @property
    def gsd_ground_in(self) -> float:
        """GSD on the ground, which one direction is stretched over, in inches."""
        return self.gsd_m / _INCH_M / math.sqrt(self._sine)

    @property
    def gsd_weighted_in(self) -> float:
        """GSD between that normal to the line of sight and that on the ground, in inches."""
        return self.gsd_m / _INCH_M / float(self._sine**0.25)

    @property
    def _sine(self) -> float:
        return math.sin(math.radians(self.elevation_deg))


def giqe(inputs: GiqeInputs, version: int) -> float:
    """NIIRS by one of the versions.

    Parameters
    ----------
    inputs : GiqeInputs
    version : {3, 4, 5}
        Version 5 is of images that were not sharpened: it has neither overshoot nor noise gain.
    """
    return {3: _giqe3, 4: _giqe4, 5: _giqe5}[version](inputs)


def giqe4_jump(inputs: GiqeInputs) -> float:
    """By how much version 4 jumps at its RER of 0.9, at these GSDs."""
    log_gsd = math.log10(inputs.gsd_ground_in)
    return (-3.32 + 3.16) * log_gsd + (1.559 - 2.817) * math.log10(JUMP_RER)


def _giqe3(own: GiqeInputs) -> float:
    sharpness = 3.32 * math.log10(own.rer_mean / own.gsd_ground_in)
    return 11.81 + sharpness - 1.48 * own.giqe_h - own.noise_gain / own.snr


def _giqe4(own: GiqeInputs) -> float:
    by_gsd, by_rer = (3.32, 1.559) if own.rer_mean >= JUMP_RER else (3.16, 2.817)
    return (
        10.251
        - by_gsd * math.log10(own.gsd_ground_in)
        + by_rer * math.log10(own.rer_mean)
        - 0.656 * own.giqe_h
        - 0.344 * own.noise_gain / own.snr
    )


def _giqe5(own: GiqeInputs) -> float:
    log_rer = math.log10(own.rer_weighted)
    return (
        9.57
        - 3.32 * math.log10(own.gsd_weighted_in)
        + 3.32 * (1 - math.exp(-1.9 / own.snr)) * log_rer
        - 2.0 * log_rer**4
        - 1.8 / own.snr
    )
