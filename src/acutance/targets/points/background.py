"""The background under point sources: a plane that all share, and how far each lies off it.

Light in the wings of a PSF and a raised background look the same. Where the backgrounds of many
sources agree with one plane, they are tied to it as closely as they agree, and the wings are seen
against the background far from all sources; where they do not, every source keeps its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.points import tuned
from acutance.targets.points.first_fit import FirstFit
from acutance.targets.points.stamps import Stamps

__all__ = ["Background"]

_PLANE = 3


@dataclass(frozen=True, eq=False)
class Background:
    """What the backgrounds of the sources have in common.

    Parameters
    ----------
    columns : (n, c) array
        What the common plane's unknowns do to every pixel; c is 3, or 0 without a plane.
    anchors : (k, 3, c) array
        What they do to a source's own level and slopes.
    scale : (c,) array
        Prior standard deviations of the plane's unknowns, in image units.
    scatter : (3,) array
        Standard deviation of the sources' levels and slopes about the plane; infinite where
        every source stands alone.
    """

    columns: Floats
    anchors: Floats
    scale: Floats
    scatter: Floats
    pads: bool = False

    @classmethod
    def of(cls, stamps: Stamps, first: FirstFit) -> Background:
        """The background, from a first fit in which every source has its own."""
        sources = first.fluxes.size
        if sources < tuned.MIN_TIED_SOURCES:
            free = np.full(3, np.inf)
            nothing = np.empty((stamps.value.size, 0))
            return cls(nothing, np.empty((sources, 3, 0)), np.empty(0), free)
        middle = np.rint(first.places)
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
        noise = stamps.noise_of(first.residual)
        scatter = _scatter(stamps, first, anchors[:, 0], noise)
        levels = first.backgrounds[:, 0]
        scale = np.full(_PLANE, 10 * (float(np.abs(levels).max()) + noise) + 1e-9)
        return cls(columns, anchors, scale, scatter)

    def with_pads(self, image: Floats, contrast_std: float) -> Background:
        """The background with pads under the sources: their image for unit contrast, (n,)."""
        none = np.zeros((*self.anchors.shape[:2], 1))
        return replace(
            self,
            columns=np.hstack([self.columns, image[:, None]]),
            anchors=np.concatenate([self.anchors, none], axis=2),
            scale=np.append(self.scale, contrast_std),
            pads=True,
        )

    def light_of_pads(self, common: Floats) -> Floats | float:
        """What pads give every pixel, (n,), from the common unknowns; 0 without pads."""
        return np.asarray(self.columns[:, -1] * common[-1]) if self.pads else 0.0

    def tie(self, noise: float) -> Floats:
        """What ties flux, place, level and slopes of a source, for `SourceProblem`."""
        return np.concatenate([np.zeros(3), noise / self.scatter])

    def common(self, plane: Floats) -> Floats:
        """Levels and slopes of the plane at the sources, (k, 3)."""
        return np.asarray(self.anchors @ plane)

    def common_factor(self, factor: Floats) -> Floats:
        """Factor of the covariance of the plane's levels at the sources, (k, l)."""
        return np.asarray(self.anchors[:, 0] @ factor)


def _scatter(stamps: Stamps, first: FirstFit, plane: Floats, noise: float) -> Floats:
    """How much levels and slopes differ beyond what noise explains, never quite nothing."""
    sources = first.fluxes.size
    x, y = stamps.offsets(np.rint(first.places))
    columns = np.stack([np.ones(x.size), y, x], axis=1)
    formal = np.empty((sources, 3))
    for k, (begin, end) in enumerate(zip(stamps.starts[:-1], stamps.starts[1:], strict=True)):
        own = columns[begin:end]
        formal[k] = np.diagonal(np.linalg.pinv(own.T @ own)) * noise**2
    levels = first.backgrounds[:, 0]
    fitted = plane @ np.linalg.lstsq(plane, levels, rcond=None)[0]
    slopes = first.backgrounds[:, 1:] - np.median(first.backgrounds[:, 1:], axis=0)
    freedom = np.array([max(sources - _PLANE, 1), sources - 1, sources - 1])
    scatter = np.array([*((levels - fitted)[:, None] ** 2).sum(0), *(slopes**2).sum(0)]) / freedom
    expected = formal.mean(axis=0)
    doubt = 0.25 * expected * np.sqrt(2 / freedom)
    return np.asarray(np.sqrt(np.maximum(scatter - expected, doubt) + 1e-300))
