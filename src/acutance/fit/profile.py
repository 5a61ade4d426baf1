"""What lies on the ground along the normal of a straight target: one step, or several."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.fit.blur import Blur

__all__ = ["EDGE", "Profile", "pulse_profile"]


@dataclass(frozen=True)
class Profile:
    """Steps of the ground's brightness along the normal.

    With R the response to a unit step, a pixel at normal distance s sees

        dark + height * sum_k share_k R(s - position_k)

    Parameters
    ----------
    positions_px : tuple of float
        Where the steps are; the first at 0.
    shares : tuple of float
        Their heights, relative to the first: 1 for it, negative for a step down.
    """

    positions_px: tuple[float, ...]
    shares: tuple[float, ...]

    def distances(self, s: Floats) -> list[Floats]:
        """Normal distance from every step, (n,) each."""
        return [s - position if position else s for position in self.positions_px]

    def response(self, blur: Blur, s: Floats) -> tuple[Floats, Floats]:
        """What a plain blur makes of the profile, and its derivative by s, (n,) each."""
        value, slope = blur.esf_and_lsf(s)
        for position, share in zip(self.positions_px[1:], self.shares[1:], strict=True):
            esf, lsf = blur.esf_and_lsf(s - position)
            value, slope = value + share * esf, slope + share * lsf
        return value, slope

    def sides(self, blur: Blur, s: Floats) -> tuple[tuple[Floats, Floats], ...]:
        """The two outermost plateaus: how much of a pixel sees each, and how far out it lies."""
        last = s - self.positions_px[-1]
        return (1 - blur.esf(s), -s), (blur.esf(last), last)

    def outside(self, s: Floats) -> Floats:
        """Distance from the profile's nearest end, negative within it."""
        return np.maximum(-s, s - self.positions_px[-1])


EDGE: Final = Profile((0.0,), (1.0,))


def pulse_profile(width_px: float, fall: float = 1.0) -> Profile:
    """A step up and one down after `width_px`; `fall` is the second's height over the first's."""
    return Profile((0.0, width_px), (1.0, -fall))
