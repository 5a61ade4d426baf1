"""What ground processing does to the transfer: resampling and sharpening."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.optics.block import Block, Transfer, has_otf, require
from acutance.optics.interpolation import (
    KERNEL_REACH_PX,
    Interpolation,
    interpolation_transfer,
    interpolation_weight,
    require_kernel,
)

__all__ = ["Resampling", "Rescaled", "Sharpening", "Shift"]


@dataclass(frozen=True)
class Resampling:
    """Interpolation onto a grid whose phase against the pixels varies evenly over the image.

    The optical transfer function (OTF) is the Fourier transform of the interpolation kernel in both
    axes, which is the average of the transfers over all phases. For one constant phase use `Shift`.

    Parameters
    ----------
    kernel : {"nearest", "bilinear", "cubic", "spline", "lanczos"}, optional
    a : float, optional
        Parameter of the cubic kernel; see `acutance.optics.interpolation`.
    """

    kernel: Interpolation = "cubic"
    a: float = -0.5

    def __post_init__(self) -> None:
        require_kernel(type(self).__name__, self.kernel)
        require(self, -4.0, 0.0, a=self.a)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        across, along = (interpolation_transfer(self.kernel, np.asarray(f), self.a) for f in (u, v))
        return np.asarray(across * along)


@dataclass(frozen=True)
class Shift:
    """Interpolation at one constant sub-pixel shift: a short filter, so an exact OTF.

    A pixel of the new image shows the place `row_px`, `col_px` further on in the old one. Its
    value is a weighted sum of old pixels, whose transfer (referred to the shifted place) is
    ``sum_k w(k - shift) exp(2 pi i u (k - shift))``; real at half a pixel, complex elsewhere.

    Parameters
    ----------
    row_px, col_px : float
        Shift in pixels; only its fraction of a pixel matters.
    kernel : {"nearest", "bilinear", "cubic", "spline", "lanczos"}, optional
    a : float, optional
        Parameter of the cubic kernel; see `acutance.optics.interpolation`.
    """

    row_px: float = 0.0
    col_px: float = 0.0
    kernel: Interpolation = "cubic"
    a: float = -0.5

    def __post_init__(self) -> None:
        require_kernel(type(self).__name__, self.kernel)
        require(self, -4.0, 0.0, a=self.a)
        require(self, -1e6, 1e6, row_px=self.row_px, col_px=self.col_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        across = self._transform(np.asarray(u), self.col_px)
        return np.asarray(across * self._transform(np.asarray(v), self.row_px))

    def _transform(self, f: Floats, shift_px: float) -> Transfer:
        reach = max(math.ceil(KERNEL_REACH_PX[self.kernel]), 2)
        offset = np.arange(-reach, reach + 2) - (shift_px - math.floor(shift_px))
        weight = interpolation_weight(self.kernel, offset, self.a)
        # What a spline has beyond its reach is missing.
        weight = weight / weight.sum()
        # The offsets are a pixel apart: a polynomial in what a pixel turns the phase by.
        turn = np.exp(2j * math.pi * f)
        values = np.zeros_like(turn)
        for one in weight[::-1]:
            values = values * turn + one
        return np.asarray(values * np.exp(2j * math.pi * offset[0] * f))


@dataclass(frozen=True)
class Sharpening:
    """A convolution of the image with a small kernel, as MTF compensation applies it.

    The OTF is the finite sum ``sum k[i, j] exp(-2 pi i (v i + u j)) / sum k``, with i and j
    counted from the kernel's centre: a sum of cosines for a symmetric kernel.

    Parameters
    ----------
    kernel : tuple of tuples of float
        Rows of the kernel; both sides odd, the sum not zero. Any nested sequence is accepted.
    """

    kernel: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        try:
            taps = np.atleast_2d(np.asarray(self.kernel, float))
        except (TypeError, ValueError):
            raise ModelError(
                f"Sharpening: the kernel is {self.kernel!r}, it has to be rows of equally many "
                "numbers"
            ) from None
        if taps.ndim != 2 or taps.shape[0] % 2 == 0 or taps.shape[1] % 2 == 0:
            raise ModelError(
                f"Sharpening: the kernel has shape {taps.shape}, both sides have to be odd"
            )
        if not abs(taps.sum()) > 1e-6 * np.abs(taps).sum():
            raise ModelError(
                "Sharpening: the kernel sums to zero, so it has no gain to "
                "normalise by: give a kernel with a positive sum"
            )
        object.__setattr__(self, "kernel", tuple(tuple(row) for row in taps.tolist()))

    @classmethod
    def both_axes(cls, strength: float) -> Sharpening:
        """The kernel (-strength, 1 + 2 strength, -strength) applied to rows and to columns."""
        taps = np.array([-strength, 1 + 2 * strength, -strength])
        return cls(tuple(tuple(row) for row in np.outer(taps, taps).tolist()))

    @property
    def noise_gain(self) -> float:
        """Growth of the standard deviation of white noise: ``sqrt(sum k^2) / |sum k|``."""
        taps = np.asarray(self.kernel)
        return float(np.sqrt(np.sum(taps**2)) / abs(taps.sum()))

    def otf(self, u: Floats, v: Floats) -> Transfer:
        taps = np.asarray(self.kernel) / np.sum(self.kernel)
        symmetric = bool(np.array_equal(taps, taps[::-1, ::-1]))
        down, right = (np.arange(size) - size // 2 for size in taps.shape)
        by_column = np.exp(-2j * math.pi * np.multiply.outer(v, down)) @ taps
        total: Transfer = np.zeros(np.broadcast_shapes(np.shape(u), np.shape(v)), complex)
        for j, place in enumerate(right.tolist()):
            total = total + by_column[..., j] * np.exp(-2j * math.pi * place * np.asarray(u))
        return np.array(total.real) if symmetric else total


@dataclass(frozen=True)
class Rescaled:
    """A system seen in pixels of another size.

    Parameters
    ----------
    system : Block
        A block, or a whole `Sensor`, in its own pixels.
    scale : float
        Size of the new pixels in old ones, above 0.
    """

    system: Block
    scale: float

    def __post_init__(self) -> None:
        if not has_otf(self.system):
            raise ModelError(
                f"Rescaled: system is {self.system!r:.80}, which has no OTF: give a block such as "
                "Gaussian(0.4), or a Sensor"
            )
        require(self, above=True, scale=self.scale)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        return self.system.otf(np.asarray(u) / self.scale, np.asarray(v) / self.scale)
