"""A wave ``a + b cos + c sin`` in every part of a star's rings, by least squares, all at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import Flags
from acutance.numerics.compiled import compiled

__all__ = ["PartWaves"]

_MIN_PIXELS = 9


@dataclass(frozen=True, eq=False)
class PartWaves:
    """Waves of parts that have enough pixels; of the others nothing is known.

    Attributes
    ----------
    sizes : (parts,) int array
        How many pixels every part has.
    has_enough : (parts,) bool array
    cosine, sine : (parts,) array
        Amplitudes; 0 where there are too few pixels.
    wave : (n,) array
        At every pixel, without the mean.
    rest : (parts,) array
        Sum of squares of what mean and wave leave.
    """

    sizes: NDArray[np.intp]
    has_enough: Flags
    cosine: Floats
    sine: Floats
    wave: Floats
    rest: Floats

    @classmethod
    def of(cls, part: NDArray[np.intp], turned: Floats, value: Floats, count: int) -> PartWaves:
        """The waves of pixels with a phase and a value in some parts.

        Parameters
        ----------
        part : (n,) int array
            Which part a pixel belongs to, below `count`.
        turned : (n,) array
            Phase of the wave at the pixel.
        value : (n,) array
        count : int
            Of parts.
        """
        sizes = np.bincount(part, minlength=count)
        enough = sizes >= _MIN_PIXELS
        cos, sin = np.cos(turned), np.sin(turned)
        c, s, cc, cs, *seen = _sums(part, cos, sin, value, count)
        gram = np.array([[sizes, c, s], [c, cc, cs], [s, cs, sizes - cc]])
        # Pixels of one phase alone have no wave.
        gram += 1e-9 * sizes * np.eye(3)[..., None]
        fit = np.zeros((3, count))
        solved = np.linalg.solve(gram[..., enough].T, np.array(seen)[:, enough].T[..., None])
        fit[:, enough] = solved[..., 0].T
        wave = fit[1, part] * cos + fit[2, part] * sin
        left = (value - fit[0, part] - wave) ** 2
        rest = np.asarray(np.bincount(part, left, minlength=count), float)
        return cls(sizes, enough, fit[1], fit[2], wave, rest)


@compiled
def _sums(part: NDArray[np.intp], cos: Floats, sin: Floats, value: Floats, count: int) -> Floats:
    """Sums over the pixels of every part, (7, count).

    Of cos, of sin, of two of their products, and of the value alone and with either.
    """
    found = np.zeros((7, count))
    for i in range(part.size):
        k, c, s = part[i], cos[i], sin[i]
        found[0, k] += c
        found[1, k] += s
        found[2, k] += c * c
        found[3, k] += c * s
        found[4, k] += value[i]
        found[5, k] += c * value[i]
        found[6, k] += s * value[i]
    return found
