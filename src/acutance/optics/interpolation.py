"""Interpolation kernels: the weight of a pixel at a distance, and the mean transfer of phases."""

from __future__ import annotations

import math
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.errors import ModelError

__all__ = [
    "KERNEL_REACH_PX",
    "Interpolation",
    "cubic_convolution_weight",
    "interpolation_transfer",
    "interpolation_weight",
    "require_kernel",
    "spline_transfer",
]

Interpolation = Literal["nearest", "bilinear", "cubic", "spline", "lanczos"]

KERNEL_REACH_PX: Final[dict[str, float]] = {
    "nearest": 0.5, "bilinear": 1.0, "cubic": 2.0, "spline": 14.0, "lanczos": 3.0,
}  # fmt: skip
"""Distance beyond which an interpolation kernel is zero, in pixels; of a spline, below 1e-8."""

_LOBES: Final = 3
_POLE: Final = math.sqrt(3) - 2
"""By this the coefficients of a cubic spline through one pixel fall from pixel to pixel."""
_NEAR_ZERO_CPP: Final = 0.1
"""Below it the closed form of cubic convolution loses its digits."""
_LANCZOS_END_CPP: Final = 12.5
"""Beyond it less than 1e-6 passes Lanczos' kernel, and nothing here."""
_QUADRATURE: Final = {
    "cubic": np.polynomial.legendre.leggauss(16), "lanczos": np.polynomial.legendre.leggauss(40),
}  # fmt: skip
"""Nodes and weights over a pixel, by kernel: enough for the waves of its highest frequency."""


def require_kernel(of: str, kernel: str) -> None:
    """Refuse a kernel that is none of those above.

    Raises
    ------
    ModelError
        It names what was given, of which block or function.
    """
    # A list cannot be looked for among the names of a dict.
    if not isinstance(kernel, str) or kernel not in KERNEL_REACH_PX:
        raise ModelError(
            f"{of}: kernel is {kernel!r}, it has to be one of "
            + ", ".join(repr(name) for name in KERNEL_REACH_PX)
        )


def interpolation_weight(kernel: Interpolation, distance_px: ArrayLike, a: float = -0.5) -> Floats:
    """Weight an interpolation kernel gives to a pixel at a distance.

    Parameters
    ----------
    kernel : {"nearest", "bilinear", "cubic", "spline", "lanczos"}
        "cubic" is Keys' cubic convolution (IEEE Trans. ASSP 29, 1153, 1981), "spline" the cubic
        spline through all pixels (M. Unser, IEEE Signal Processing Magazine 16-6, 1999, 22),
        "lanczos" the sine over its argument in a window of three lobes, the weights of all pixels
        divided by their sum.
    distance_px : array
        Place of the pixel minus the interpolated place.
    a : float, optional
        Slope of the cubic kernel at distance 1: -0.5 (Keys, third order), -0.75 and -1 are in use.

    Returns
    -------
    array of the same shape
    """
    signed = np.asarray(distance_px, float)
    x = np.abs(signed)
    if kernel == "nearest":
        # Half way between two pixels the one on the left is taken, as `floor` would.
        return np.where((signed >= -0.5) & (signed < 0.5), 1.0, 0.0)
    if kernel == "bilinear":
        return np.asarray(np.maximum(1 - x, 0.0))
    if kernel == "spline":
        return _cardinal_spline(x)
    if kernel == "lanczos":
        apart = x - np.floor(x)
        whole = sum(_windowed_sine(apart + k) for k in range(-_LOBES, _LOBES))
        return np.asarray(_windowed_sine(x) / whole)
    return cubic_convolution_weight(x, a)


def cubic_convolution_weight(distance_px: Floats, a: Floats | float) -> Floats:
    """Weights of Keys' cubic convolution.

    Parameters
    ----------
    distance_px : (...) array
        Place of the pixel minus the interpolated place.
    a : (...) array or float
        Slope of the kernel at distance 1.
    """
    x = np.abs(distance_px)
    near = ((a + 2) * x - (a + 3)) * x**2 + 1
    far = a * (((x - 5) * x + 8) * x - 4)
    return np.where(x < 1, near, np.where(x < 2, far, 0.0))


def _windowed_sine(x: Floats) -> Floats:
    """The kernel of Lanczos before it is divided by the sum of all weights."""
    return np.where(np.abs(x) < _LOBES, np.sinc(x) * np.sinc(x / _LOBES), 0.0)


def _cardinal_spline(x: Floats) -> Floats:
    """The cubic spline that is 1 at one pixel and 0 at all others, at distances of 0 and more."""
    below = np.floor(x)
    parts = (
        math.sqrt(3) * _POLE ** np.abs(below + k) * _b_spline(np.abs(x - below - k))
        for k in range(-1, 3)
    )
    return np.where(x < KERNEL_REACH_PX["spline"], sum(parts), 0.0)


def _b_spline(x: Floats) -> Floats:
    """The cubic B-spline, at distances of 0 and more."""
    near = 2 / 3 - x**2 + 0.5 * x**3
    return np.where(x < 1, near, np.where(x < 2, (2 - x) ** 3 / 6, 0.0))


def interpolation_transfer(kernel: Interpolation, freq_cpp: Floats, a: float = -0.5) -> Floats:
    """Mean transfer of interpolation over all phases: the Fourier transform of the kernel.

    Parameters
    ----------
    kernel : {"nearest", "bilinear", "cubic", "spline", "lanczos"}
    freq_cpp : (...) array
        Cycles per pixel of the grid that is interpolated.
    a : float, optional
        Parameter of the cubic kernel.
    """
    if kernel == "nearest":
        return np.asarray(np.sinc(freq_cpp))
    if kernel == "bilinear":
        return np.asarray(np.sinc(freq_cpp) ** 2)
    if kernel == "spline":
        return spline_transfer(freq_cpp)
    if kernel == "lanczos":
        return _lanczos_transfer(freq_cpp)
    return _cubic_transfer(freq_cpp, a)


def spline_transfer(freq_cpp: Floats) -> Floats:
    """Mean transfer of interpolation with a cubic spline: ``sinc^4(f) / ((2 + cos 2 pi f) / 3)``.

    Close to 1 up to 0.3 and a half at Nyquist, as that of every good interpolation.
    """
    return np.asarray(3 * np.sinc(freq_cpp) ** 4 / (2 + np.cos(2 * math.pi * freq_cpp)))


def _cubic_transfer(f: Floats, a: float) -> Floats:
    """Of cubic convolution: closed form, quadrature near zero."""
    small = np.abs(f) < _NEAR_ZERO_CPP
    g = np.where(small, 1.0, f)
    keys = 3 * (np.sinc(g) ** 2 - np.sinc(2 * g))
    keys = keys + 2 * a * (3 * np.sinc(2 * g) ** 2 - 2 * np.sinc(2 * g) - np.sinc(4 * g))
    near_zero = _by_quadrature("cubic", np.where(small, f, 0.0), a)
    return np.where(small, near_zero, keys / (math.pi * g) ** 2)


def _lanczos_transfer(f: Floats) -> Floats:
    """Of Lanczos' kernel, which has no closed form."""
    found = np.zeros(np.shape(f))
    passes = np.abs(f) <= _LANCZOS_END_CPP
    found[passes] = _by_quadrature("lanczos", np.asarray(f)[passes])
    return found


def _by_quadrature(kernel: Interpolation, f: Floats, a: float = -0.5) -> Floats:
    """Of an even kernel that is smooth from pixel to pixel."""
    nodes, weights = _QUADRATURE[kernel]
    pixels = np.arange(KERNEL_REACH_PX[kernel])[:, None]
    x = (0.5 * (nodes + 1) + pixels).ravel()
    mass = np.tile(weights, pixels.size) * interpolation_weight(kernel, x, a)
    waves = 2 * math.pi * np.asarray(f)
    return np.asarray(sum(m * np.cos(p * waves) for m, p in zip(mass, x, strict=True)))
