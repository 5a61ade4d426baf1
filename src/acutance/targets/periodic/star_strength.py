"""How much of the rings about a place some number of spokes explains.

Two hundred numbers are tried, each in all parts of a dozen rings: the parts are fitted together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import Flags
from acutance.targets.periodic.part_waves import PartWaves
from acutance.targets.periodic.star_rings import MIN_RING_PIXELS, RING_STEP_PX, sector_of

__all__ = ["PixelsAbout"]

_RINGS = 12
"""So many rings are looked at, or up to twice as many, from the inside out."""


@dataclass(frozen=True, eq=False)
class PixelsAbout:
    """Pixels about a place, the nearest first.

    Attributes
    ----------
    radius, angle, value : (n,) arrays
    """

    radius: Floats
    angle: Floats
    value: Floats

    @classmethod
    def of(cls, image: Floats, usable: Flags, row: float, col: float) -> PixelsAbout:
        """The usable pixels of an image."""
        rows, cols = np.nonzero(usable)
        radius = np.hypot(rows - row, cols - col)
        order = np.argsort(radius, kind="stable")
        angle = np.arctan2(rows - row, cols - col)
        return cls(radius[order], angle[order], image[usable][order])

    def strength(self, cycles: int, first: float, last: float, parts: int) -> float:
        """Share of the rings' variance that some cycles explain, by least squares.

        Parameters
        ----------
        cycles : int
            In a full turn.
        first, last : float
            Radii of the innermost and the outermost ring, px.
        parts : int
            A ring is fitted in so many parts, each by itself.
        """
        ends = np.searchsorted(
            np.floor((self.radius - first) / RING_STEP_PX),
            np.arange(max(int((last - first) / RING_STEP_PX), 0) + 1),
        )
        sizes = np.diff(ends)
        rings = np.flatnonzero(sizes >= MIN_RING_PIXELS)
        rings = rings[:: max(rings.size // _RINGS, 1)]
        if rings.size == 0:
            return 0.0
        sizes = sizes[rings]
        kept = np.concatenate([np.arange(ends[k], ends[k + 1]) for k in rings.tolist()])
        ring = np.repeat(np.arange(rings.size), sizes)
        angle, value = self.angle[kept], self.value[kept]
        value = value - (np.bincount(ring, value) / sizes)[ring]
        power = float(np.sum(np.bincount(ring, value**2) / sizes))
        part = ring * parts + sector_of(angle, parts)
        explained = _explained(part, cycles * angle, value, rings.size * parts)
        return min(float(np.sum(explained / np.repeat(sizes, parts))) / max(power, 1e-300), 1.0)


def _explained(part: NDArray[np.intp], turned: Floats, value: Floats, count: int) -> Floats:
    """Sum of squares of every part's wave, less what noise makes; 0 of parts of few pixels."""
    waves = PartWaves.of(part, turned, value, count)
    sizes = np.maximum(waves.sizes, 1)
    total = np.bincount(part, waves.wave, minlength=count)
    squares = np.bincount(part, waves.wave**2, minlength=count)
    found = squares - total**2 / sizes - waves.rest * 2 / sizes
    return np.where(waves.has_enough, np.maximum(found, 0.0), 0.0)
