"""A point spread function given as samples on a fine grid, as a numerical model makes it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_floats, require_numbers, require_whole
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.optics.block import Block, Transfer, require
from acutance.optics.detector import Detector
from acutance.optics.motion import Smear
from acutance.optics.sensor import Sensor, require_sensor

__all__ = ["RasterPsf", "numerical_psf"]

PERIOD_PX = 32
"""Period of the transform the samples are made by; far wider than any trim."""


@dataclass(frozen=True, eq=False)
class RasterPsf:
    """Samples of a point spread function: a block whose OTF is the sum over them.

    The OTF repeats every ``1 / step_px`` cycles per pixel. A target drawn in squares of the same
    step adds ``Detector(step_px)``, which ends the repetition: ``Sensor([psf,
    Detector(psf.step_px)])`` is a whole system, for `Sensor.profile` and everything after it.

    Parameters
    ----------
    samples : (n, m) array
        Light at each sample, (row, column); the sum is 1.
    step_px : float
        Distance of two samples in pixels. The samples lie evenly about the origin, on whole
        multiples of the step where n (m) is odd and half way between where it is even.

    Raises
    ------
    OptionError
        If the samples are no numbers.
    ModelError
        If they are no matrix, or one is not finite; if the step is not above 0.
    """

    samples: Floats
    step_px: float

    def __post_init__(self) -> None:
        samples = require_floats("RasterPsf: samples", self.samples)
        if samples.ndim != 2 or samples.size == 0 or not np.isfinite(samples).all():
            raise ModelError(
                f"RasterPsf: samples of shape {samples.shape}: give rows and columns of finite "
                "numbers, whose sum is 1"
            )
        object.__setattr__(self, "samples", samples)
        require(self, above=True, step_px=self.step_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        u, v = np.asarray(u, float), np.asarray(v, float)
        rows, cols = (self._places(size) for size in self.samples.shape)
        if v.size * u.size == np.broadcast(u, v).size:
            # A grid of frequencies, or a single one: two matrix products.
            down = np.exp(-2j * math.pi * np.multiply.outer(v.ravel(), rows))
            right = np.exp(-2j * math.pi * np.multiply.outer(cols, u.ravel()))
            product = down @ self.samples @ right
            # Either frequency may be the one that runs along the first axis.
            return np.asarray(product[_numbered(v), _numbered(u)])
        u, v = np.broadcast_arrays(u, v)
        down = np.exp(-2j * math.pi * np.multiply.outer(v.ravel(), rows))
        right = np.exp(-2j * math.pi * np.multiply.outer(u.ravel(), cols))
        return np.asarray(np.einsum("ij,ij->i", down @ self.samples, right).reshape(u.shape))

    def _places(self, size: int) -> Floats:
        return np.asarray((np.arange(size) - 0.5 * (size - 1)) * self.step_px, np.float64)


def _numbered(array: Floats) -> NDArray[np.intp]:
    """The number of each element, in the shape of the array."""
    return np.arange(array.size).reshape(array.shape)


def numerical_psf(sensor: Sensor, *, subpixels: int = 20, trim_px: float = 5.0) -> RasterPsf:
    """The net PSF of a sensor as a numerical model on a fine grid has it.

    As in the SDSU generic sensor model (2005, 3.1): 20 samples to a pixel, rectangles as rows
    of equal samples (a detector of 1 px is 20, a smear of 0.25 px is 5), everything convolved,
    trimmed to a square of 5 px and normalised. Its MTF differs from the analytic one of the
    blocks: that is the point of it.

    Parameters
    ----------
    sensor : Sensor
        `Detector` and `Smear` become rows of samples, rounded to whole ones; the other blocks
        enter by their optical transfer function (OTF) at the frequencies of the grid.
    subpixels : int, optional
        Samples per pixel, 2 to 100.
    trim_px : float, optional
        Width of the square that is kept, in pixels, 1 to 16.

    Returns
    -------
    RasterPsf

    Raises
    ------
    OptionError
        If there is no sensor, or a number is none.
    ModelError
        If the grid is too coarse or the trim too wide or narrow.
    """
    require_sensor(sensor)
    require_whole(1, subpixels=subpixels)
    require_numbers(trim_px=trim_px)
    if not (2 <= subpixels <= 100 and 1 <= trim_px <= 16):
        raise ModelError(
            f"a numerical PSF of {subpixels} samples per pixel trimmed to {trim_px:g} px was "
            "requested: 2 to 100 samples and 1 to 16 px are possible"
        )
    step = 1 / subpixels
    size = PERIOD_PX * subpixels
    u: Floats = np.asarray(np.fft.rfftfreq(size, step), np.float64)
    v: Floats = np.asarray(np.fft.fftfreq(size, step)[:, None], np.float64)
    product: Transfer = np.ones((size, size // 2 + 1), complex)
    odd = [0, 0]
    for block in sensor.blocks:
        counts = _counts(block, subpixels)
        if counts is None:
            product = product * block.otf(u, v)
            continue
        product = (
            product * _row_of_samples(counts[0], v * step) * _row_of_samples(counts[1], u * step)
        )
        odd = [parity ^ (count - 1) % 2 for parity, count in zip(odd, counts, strict=True)]
    # An even number of equal samples is centred between two: half a step, in either axis.
    half = np.exp(1j * math.pi * step * (odd[0] * v + odd[1] * u))
    plane = np.fft.fftshift(np.fft.irfft2(product * half, (size, size)))
    kept = round(trim_px * subpixels)
    sizes = [kept + (kept + 1 + parity) % 2 for parity in odd]
    starts = [size // 2 - n // 2 for n in sizes]
    window = tuple(slice(start, start + n) for start, n in zip(starts, sizes, strict=True))
    samples = plane[window]
    return RasterPsf(np.ascontiguousarray(samples / samples.sum()), step)


def _counts(block: Block, subpixels: int) -> tuple[int, int] | None:
    """Numbers of equal samples (down, right) a rectangle is drawn with; None for other blocks."""
    if isinstance(block, Detector):
        height = block.width_px if block.height_px is None else block.height_px
        return max(1, round(height * subpixels)), max(1, round(block.width_px * subpixels))
    if isinstance(block, Smear):
        count = max(1, round(block.length_px * subpixels))
        return (count, 1) if block.axis == "along" else (1, count)
    return None


def _row_of_samples(count: int, cycles: Floats) -> Floats:
    """Transform of `count` equal samples about their middle, at cycles per sample."""
    offset = np.arange(count) - 0.5 * (count - 1)
    return np.asarray(sum(np.cos(2 * math.pi * k * cycles) for k in offset) / count)
