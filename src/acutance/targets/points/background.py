"""The ground under point sources: a plane that all share, and how far each departs from it.

Light in the wings of a PSF and a raised background look alike. Where the backgrounds of many
sources agree with one plane, they are tied to it as closely as they agree, and the wings are seen
against the ground far from all sources; where they do not, every source keeps its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.noise import robust_scale
from acutance.targets.points.first_fit import BlurredPoints
from acutance.targets.points.stamps import Stamps

__all__ = ["Ground", "ground_levels"]

_LEAST_SOURCES = 6
_PLANE = 3


@dataclass(frozen=True, eq=False)
class Ground:
    """How the backgrounds of the sources hang together.

    Parameters
    ----------
    columns : (n, c) array
        What the common plane's unknowns do to every pixel; c is 3, or 0 without a plane.
    anchors : (k, 3, c) array
        What they do to a source's own level and slopes.
    scale : (c,) array
        Prior standard deviations of the plane's unknowns, in image units.
    spread : (3,) array
        Standard deviation of the sources' levels and slopes about the plane; infinite where
        every source stands alone.
    """

    columns: Floats
    anchors: Floats
    scale: Floats
    spread: Floats

    @classmethod
    def of(cls, stamps: Stamps, start: BlurredPoints) -> Ground:
        """The ground as a first fit with free backgrounds shows it."""
        sources = start.fluxes.size
        if sources < _LEAST_SOURCES:
            free = np.full(3, np.inf)
            nothing = np.empty((stamps.value.size, 0))
            return cls(nothing, np.empty((sources, 3, 0)), np.empty(0), free)
        middle = np.rint(start.places)
        origin = middle.mean(axis=0)
        reach = max(float(np.ptp(middle, axis=0).max()), 1.0)
        away = (middle - origin) / reach
        anchors = np.zeros((sources, 3, _PLANE))
        anchors[:, 0, 0] = 1.0
        anchors[:, 0, 1:] = away
        anchors[:, 1, 1] = anchors[:, 2, 2] = 1 / reach
        columns = np.stack(
            [
                np.ones(stamps.value.size),
                (stamps.row - origin[0]) / reach,
                (stamps.col - origin[1]) / reach,
            ],
            axis=1,
        )
        noise = robust_scale(start.residual)
        spread = _spread(stamps, start, anchors[:, 0], noise)
        levels = start.grounds[:, 0]
        scale = np.full(_PLANE, 10 * (float(np.abs(levels).max()) + noise) + 1e-9)
        return cls(columns, anchors, scale, spread)

    def tie(self, noise: float) -> Floats:
        """What ties flux, place, level and slopes of a source, for `eliminate`."""
        return np.concatenate([np.zeros(3), noise / self.spread])

    def common(self, plane: Floats) -> Floats:
        """Levels and slopes of the plane at the sources, (k, 3)."""
        return np.asarray(self.anchors @ plane)

    def common_factor(self, factor: Floats) -> Floats:
        """Factor of the covariance of the plane's levels at the sources, (k, l)."""
        return np.asarray(self.anchors[:, 0] @ factor)


def ground_levels(stamps: Stamps, places: Floats, grounds: Floats) -> Floats:
    """The ground under every pixel by its own source's level and slopes, (n,)."""
    x, y = stamps.offsets(np.rint(places))
    level, down, right = grounds[stamps.owner].T
    return np.asarray(level + down * y + right * x)


def _spread(stamps: Stamps, start: BlurredPoints, plane: Floats, noise: float) -> Floats:
    """How much levels and slopes differ beyond what noise explains, never quite nothing."""
    sources = start.fluxes.size
    x, y = stamps.offsets(np.rint(start.places))
    columns = np.stack([np.ones(x.size), y, x], axis=1)
    formal = np.empty((sources, 3))
    for k, (first, last) in enumerate(zip(stamps.starts[:-1], stamps.starts[1:], strict=True)):
        own = columns[first:last]
        formal[k] = np.diagonal(np.linalg.pinv(own.T @ own)) * noise**2
    levels = start.grounds[:, 0]
    fitted = plane @ np.linalg.lstsq(plane, levels, rcond=None)[0]
    slopes = start.grounds[:, 1:] - np.median(start.grounds[:, 1:], axis=0)
    freedom = np.array([max(sources - _PLANE, 1), sources - 1, sources - 1])
    scatter = np.array([*((levels - fitted)[:, None] ** 2).sum(0), *(slopes**2).sum(0)]) / freedom
    expected = formal.mean(axis=0)
    doubt = 0.25 * expected * np.sqrt(2 / freedom)
    return np.asarray(np.sqrt(np.maximum(scatter - expected, doubt) + 1e-300))
