"""A wave ``a + b cos + c sin`` in every part of a star's rings, by least squares, all at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.geometry.star_geometry import Flags

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

        def sums(values: Floats) -> Floats:
            return np.asarray(np.bincount(part, values, minlength=count))

        gram = np.empty((3, 3, count))
        gram[0, 0], gram[0, 1], gram[0, 2] = sizes, sums(cos), sums(sin)
        gram[1, 1], gram[1, 2] = sums(cos * cos), sums(cos * sin)
        gram[2, 2] = sizes - gram[1, 1]
        gram[1, 0], gram[2, 0], gram[2, 1] = gram[0, 1], gram[0, 2], gram[1, 2]
        # Pixels of one phase alone have no wave.
        gram += 1e-9 * sizes * np.eye(3)[..., None]
        seen = np.array([sums(value), sums(cos * value), sums(sin * value)])
        fit = np.zeros((3, count))
        solved = np.linalg.solve(gram[..., enough].T, seen[:, enough].T[..., None])
        fit[:, enough] = solved[..., 0].T
        wave = fit[1, part] * cos + fit[2, part] * sin
        return cls(sizes, enough, fit[1], fit[2], wave, sums((value - fit[0, part] - wave) ** 2))
