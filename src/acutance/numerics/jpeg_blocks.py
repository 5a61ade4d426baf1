"""Blocks of 8 x 8 pixels whose cosine transform was rounded: what JPEG leaves of an image.

JPEG rounds the cosine transform of every block of 8 x 8 pixels (G. K. Wallace, Communications of
the ACM 34(4), 30, 1991, DOI 10.1145/103085.103089), and most of its 63 coefficients besides the
mean become zero, the fine detail first. Cut at the right place, the blocks of the image still have
those zeros, but for the rounding of pixels; cut one pixel beside, each mixes two of them and has
none. Where the blocks begin a crop does not tell, so all 64 places of their lattice are tried.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined
from acutance.numerics.pixel_steps import smallest_neighbour_step, value_range

__all__ = ["jpeg_blocks"]

_BLOCK: Final = 8
_DETAILS: Final = 63
"""Coefficients of a block besides its mean."""
_ACTIVE_STEPS: Final = 4.0
"""Blocks of less detail, in steps of the image's numbers, are flat at every place."""
_PRIOR_BLOCKS: Final = 5.0
"""Blocks of the usual share of details, of which each place has so many more: a few active blocks
differ by chance. With it 4 of 49 000 tiles of 24 to 96 px of images without JPEG exceed a ratio of
1.25, and nearly all of a JPEG of 8 bits."""
_MAX_STEPS: Final = 65536
"""Numbers finer than those of 16 bits were not written by JPEG."""
_HALF: Final = math.sqrt(0.125)
_WAVE: Final = tuple(0.5 * math.cos(k * math.pi / 16) for k in range(8))


def jpeg_blocks(pixels: Floats) -> float:
    """How many times rarer details are in blocks cut at one place than at the next best.

    A detail is a coefficient of a block's cosine transform beyond the rounding of pixels. In
    images that were not compressed the ratio is 1.0 to 1.2 by chance; also where no block has any.

    Parameters
    ----------
    pixels : (rows, cols) array
        NaN where a pixel is not to be used.
    """
    if min(pixels.shape) < 2 * _BLOCK:
        return 1.0
    step = smallest_neighbour_step(pixels)
    if not step * _MAX_STEPS > value_range(pixels):
        return 1.0
    details, blocks = _details_by_place(pixels, step, _ACTIVE_STEPS * step)
    if not details.sum() > 0:
        return 1.0
    usual = _PRIOR_BLOCKS * details.sum() / blocks.sum()
    share = (details + usual) / (blocks + _PRIOR_BLOCKS)
    return _next_smallest(share, *divmod(int(share.argmin()), _BLOCK)) / float(share.min())


@compiled
def _details_by_place(pixels: Floats, step: float, active: float) -> tuple[Floats, Floats]:
    """Details of the blocks that begin at every row and column, modulo 8, and how many these are.

    Both (8, 8). Blocks with an unknown pixel do not count, nor flat ones.
    """
    rows, cols = pixels.shape[0], pixels.shape[1] - _BLOCK + 1
    across = np.empty((_BLOCK, rows, cols))
    for i in range(rows):
        row = pixels[i]
        for j in range(cols):
            found = _cosines(
                row[j], row[j + 1], row[j + 2], row[j + 3],
                row[j + 4], row[j + 5], row[j + 6], row[j + 7],
            )  # fmt: skip
            for u in range(_BLOCK):
                across[u, i, j] = found[u]
    details, blocks = np.zeros((_BLOCK, _BLOCK)), np.zeros((_BLOCK, _BLOCK))
    count, largest, mean = np.empty(cols), np.empty(cols), np.empty(cols)
    for i in range(rows - _BLOCK + 1):
        count[:] = 0.0
        largest[:] = 0.0
        for u in range(_BLOCK):
            own = across[u]
            for j in range(cols):
                c0, c1, c2, c3, c4, c5, c6, c7 = _cosines(
                    own[i, j], own[i + 1, j], own[i + 2, j], own[i + 3, j],
                    own[i + 4, j], own[i + 5, j], own[i + 6, j], own[i + 7, j],
                )  # fmt: skip
                if u == 0:
                    mean[j] = c0
                    c0 = 0.0
                count[j] += (
                    _beyond(c0, step) + _beyond(c1, step) + _beyond(c2, step) + _beyond(c3, step)
                    + _beyond(c4, step) + _beyond(c5, step) + _beyond(c6, step) + _beyond(c7, step)
                )  # fmt: skip
                largest[j] = max(
                    largest[j],
                    max(max(abs(c0), abs(c1)), max(abs(c2), abs(c3))),
                    max(max(abs(c4), abs(c5)), max(abs(c6), abs(c7))),
                )
        for j in range(cols):
            if np.isfinite(mean[j]) and largest[j] > active:
                details[i % _BLOCK, j % _BLOCK] += count[j] / _DETAILS
                blocks[i % _BLOCK, j % _BLOCK] += 1
    return details, blocks


@compiled
def _next_smallest(share: Floats, row: int, col: int) -> float:
    """The smallest share of other rows and columns: those of one of both keep some of the zeros."""
    smallest = np.inf
    for i in range(_BLOCK):
        for j in range(_BLOCK):
            if i != row and j != col:
                smallest = min(smallest, share[i, j])
    return smallest


@inlined
def _beyond(coefficient: float, step: float) -> float:
    return 1.0 if abs(coefficient) >= step else 0.0


@inlined
def _cosines(
    a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """The orthonormal cosine transform of eight numbers, by their sums and differences."""
    s0, s1, s2, s3 = a + h, b + g, c + f, d + e
    d0, d1, d2, d3 = a - h, b - g, c - f, d - e
    p, q, m, n = s0 + s3, s1 + s2, s0 - s3, s1 - s2
    return (
        _HALF * (p + q),
        _WAVE[1] * d0 + _WAVE[3] * d1 + _WAVE[5] * d2 + _WAVE[7] * d3,
        _WAVE[2] * m + _WAVE[6] * n,
        _WAVE[3] * d0 - _WAVE[7] * d1 - _WAVE[1] * d2 - _WAVE[5] * d3,
        _HALF * (p - q),
        _WAVE[5] * d0 - _WAVE[1] * d1 + _WAVE[7] * d2 + _WAVE[3] * d3,
        _WAVE[6] * m - _WAVE[2] * n,
        _WAVE[7] * d0 - _WAVE[5] * d1 + _WAVE[3] * d2 - _WAVE[1] * d3,
    )
