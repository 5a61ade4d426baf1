"""The scene along the normal of a straight target: one step, or several."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.gaussian_pixel import GaussianPixel, blurred_step

__all__ = ["EDGE", "Profile", "Sides", "blurred_profile", "pulse_profile"]

Sides = tuple[tuple[Floats, Floats], ...]
"""Of either plateau, its share in every pixel, and the pixel's distance outwards."""


@dataclass(frozen=True)
class Profile:
    """Steps of the scene's brightness along the normal.

    With R the response to a unit step, the edge spread function (ESF), whose derivative is the line
    spread function (LSF), a pixel at normal distance s has the value

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

    @property
    def is_edge(self) -> bool:
        """Whether there is one step; a pulse has two or more."""
        return len(self.shares) == 1

    def distances(self, s: Floats) -> list[Floats]:
        """Normal distance from every step, (n,) each."""
        return [s - position if position else s for position in self.positions_px]

    def seen(self, blur: GaussianPixel, s: Floats) -> list[tuple[Floats, Floats]]:
        """ESF and LSF of a Gaussian through a pixel at the distances from every step, (n,) each."""
        return [blur.esf_and_lsf(distance) for distance in self.distances(s)]

    def response(self, seen: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
        """The blurred profile and its derivative by s, (n,) each."""
        value, slope = seen[0]
        for share, (esf, lsf) in zip(self.shares[1:], seen[1:], strict=True):
            value, slope = value + share * esf, slope + share * lsf
        return value, slope

    @property
    def steps(self) -> Floats:
        """Positions and shares of the steps, (2, steps): for compiled loops."""
        return np.array((self.positions_px, self.shares))

    def mean(self, blur: GaussianPixel, s: Floats) -> Floats:
        """The profile, blurred by a Gaussian through a pixel, (n,)."""
        return self.response(self.seen(blur, s))[0]

    def sides(self, seen: list[tuple[Floats, Floats]], s: Floats) -> Sides:
        """The two outermost plateaus: their share in a pixel, its distance outwards."""
        last = self.positions_px[-1]
        return (1 - seen[0][0], -s), (seen[-1][0], s - last if last else s)

    def near(self, s: Floats, reach_px: float) -> NDArray[np.bool_]:
        """Which pixels lie nearer than `reach_px` to a step."""
        first, *others = (np.abs(distance) < reach_px for distance in self.distances(s))
        for close in others:
            first |= close
        return first

    def outside(self, s: Floats) -> Floats:
        """Distance from the profile's nearest end, negative within it."""
        return np.maximum(-s, s - self.positions_px[-1])


@compiled
def blurred_profile(s: Floats, steps: Floats, sigma: float, aperture: float) -> Floats:
    """A profile blurred by a Gaussian through a pixel and its slope, (2, n), for compiled loops."""
    found = np.zeros((2, s.size))
    for step in range(steps.shape[1]):
        position, share = steps[0, step], steps[1, step]
        for k in range(s.size):
            esf, lsf, _, _ = blurred_step(s[k] - position, sigma, aperture)
            found[0, k] += share * esf
            found[1, k] += share * lsf
    return found


EDGE: Final = Profile((0.0,), (1.0,))


def pulse_profile(width_px: float, height_ratio: float = 1.0) -> Profile:
    """A step up and one down after `width_px`; `height_ratio`: the second over the first."""
    return Profile((0.0, float(width_px)), (1.0, -float(height_ratio)))
