"""Student-t scatter about a posterior, as a mixture of normal densities."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.special import gammaincinv

from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.curves.grid import Floats

__all__ = ["with_scatter"]

_EDGES: Final[Floats] = np.array([0.0, 0.002, 0.01, 0.03, 0.08, 0.2, 0.4, 0.7, 1.0])
"""Parts of the gamma distribution of precisions: fine where they are low, which makes the tails."""


def with_scatter(density: NormalMixture, scale: Floats, degrees: Floats) -> NormalMixture:
    """The density of a number that scatters about another one.

    Parameters
    ----------
    density : NormalMixture
        Of q parts; means and deviations may have a second axis, of places.
    scale, degrees : (q,) array
        Of the Student-t scatter of every part.
    """
    middle = 0.5 * (_EDGES[1:] + _EDGES[:-1])
    half = 0.5 * degrees[:, None]
    precision = gammaincinv(half, middle) / half
    own = scale[:, None] / np.sqrt(precision)
    own = own.reshape(own.shape + (1,) * (density.mean.ndim - 1))
    share = density.share[:, None] * np.diff(_EDGES)
    mean = np.broadcast_to(
        density.mean[:, None], np.broadcast_shapes(own.shape, density.mean[:, None].shape)
    )
    std = np.hypot(density.std[:, None], own)
    return NormalMixture(
        share.ravel(), mean.reshape(-1, *mean.shape[2:]), std.reshape(-1, *std.shape[2:])
    )
