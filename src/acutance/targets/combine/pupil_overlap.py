"""What an obscured pupil and itself, shifted, have in common: OTFs of aberrations are its means.

Two discs of radius one about -s and s have a lens in common; each obscuration, of radius e, hides a
lens of it, and what both hide counts once. Every lens is two segments of a circle.
"""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["overlap_nodes"]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Over a segment, either way: with aberrations of .1 waves the OTF is right to .0002."""


def overlap_nodes(shift: Floats, obscuration: float) -> tuple[Floats, Floats, Floats]:
    """Nodes of a quadrature over one half of it, x along the shift and y across.

    The other half is its mirror image, at -x. The nodes are symmetric in y.

    Parameters
    ----------
    shift : (n,) array
        Half the distance of the centres, 0 to 1: in radii of the pupil.
    obscuration : float
        Radius, 0 to below 1.

    Returns
    -------
    x, y, weights : (n, m) array
        Weights sum to one; where nothing is in common they are 0.
    """
    middle = np.zeros_like(shift)
    # Where the rim of an obscuration crosses that of the other disc.
    crossing = (1 - obscuration**2) / (4 * np.maximum(shift, 1e-12))
    segments = [
        _segment(shift, 1.0, middle),
        _segment(shift, obscuration, middle),
        _segment(shift, obscuration, -crossing),
        _segment(shift, 1.0, crossing),
    ]
    x, y, area = (np.concatenate(parts, axis=1) for parts in zip(*segments, strict=True))
    # What is seen by both discs, or hidden twice, less what either hides.
    area[:, area.shape[1] // 2 :] *= -1
    return x, y, area / np.maximum(area.sum(axis=1, keepdims=True), 1e-300)


def _segment(shift: Floats, radius: float, begin: Floats) -> tuple[Floats, Floats, Floats]:
    """Nodes and their area of what lies beyond x = begin in a disc about -shift, (n, m) each."""
    # By the angle on the rim: its chords have no infinite slope.
    end = np.arccos(np.clip((begin + shift) / max(radius, 1e-12), -1.0, 1.0))[:, None]
    angle = 0.5 * end * (_NODES + 1)
    chord = radius * np.sin(angle)
    x = np.repeat(radius * np.cos(angle) - shift[:, None], _NODES.size, axis=1)
    y = (chord[..., None] * _NODES).reshape(shift.size, -1)
    area = (end * _WEIGHTS * chord**2)[..., None] * _WEIGHTS
    return x, y, area.reshape(shift.size, -1)
