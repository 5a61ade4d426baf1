"""Tapers of a line spread function before its Fourier transform."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["hamming_window", "tukey_window"]


def tukey_window(distance: Floats, half_width: Floats | float, alpha: float) -> Floats:
    """Tapered cosine, 1 in the middle and 0 from `half_width` on.

    Parameters
    ----------
    distance : array
        From the window's centre, any shape, in the unit of `half_width`.
    half_width : float or array that broadcasts with `distance`
    alpha : float
        Share of the window that is tapered, 0 < alpha <= 1; 1 is the Hann window.
    """
    outward = np.clip(np.abs(distance) / half_width, 0.0, 1.0)
    taper = np.clip((outward - (1.0 - alpha)) / alpha, 0.0, 1.0)
    return np.asarray(0.5 * (1.0 + np.cos(np.pi * taper)))


def hamming_window(distance: Floats, half_width: float) -> Floats:
    """Raised cosine 0.54 + 0.46 cos, 0.08 at `half_width` and beyond it."""
    outward = np.clip(np.abs(distance) / half_width, 0.0, 1.0)
    return np.asarray(0.54 + 0.46 * np.cos(np.pi * outward))
