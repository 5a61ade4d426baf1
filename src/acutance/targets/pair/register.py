"""Where the low image's content lies against the high one's, to a fraction of a low pixel."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft
from scipy.ndimage import uniform_filter

from acutance.curves.grid import Floats

__all__ = ["Registration", "register"]

_LOCAL_PX = 9
_BOUND_SIGMAS = 3.0
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Registration:
    """The best match of two images.

    Parameters
    ----------
    shift_px : (float, float)
        Displacement (rows, columns) of the low content.
    correlation : float
        Of the images without their local means, at that shift.
    inverted : bool
        Whether a match with opposite sign is the stronger one.
    at_limit : bool
        Whether it lies at the end of the range that was looked at, so that the best may be beyond.
    """

    shift_px: tuple[float, float]
    correlation: float
    inverted: bool
    at_limit: bool = False


def register(low: Floats, high: Floats, max_shift_px: int) -> Registration:
    """Match an image with another one of the same pixels, by the peak of their correlation.

    Parameters
    ----------
    low, high : (h, w) arrays
        NaN where unusable. `high` is the reference averaged over low pixels.
    max_shift_px : int
        The largest shift that is looked for.
    """
    a, b = _detail(low), _detail(high)
    power = math.sqrt(float(np.sum(a * a)) * float(np.sum(b * b)))
    if power == 0:
        return Registration((0.0, 0.0), 0.0, False)
    reach = min(max_shift_px, min(low.shape) // 2 - 1)
    shape = [fft.next_fast_len(size + reach) for size in low.shape]
    product = fft.rfft2(a, shape) * np.conj(fft.rfft2(b, shape))
    match = fft.irfft2(product, shape) / power
    order = np.arange(-reach, reach + 1)
    near = match[np.ix_(order, order)]
    i, j = (int(k) for k in np.unravel_index(int(np.argmax(near)), near.shape))
    shift = tuple(float(order[k]) + _vertex(line, k) for k, line in ((i, near[:, j]), (j, near[i])))
    return Registration(
        (shift[0], shift[1]), float(near[i, j]), bool(-near.min() > near.max()),
        reach > 0 and max(abs(int(order[i])), abs(int(order[j]))) == reach,
    )  # fmt: skip


def _detail(image: Floats) -> Floats:
    """An image less its local mean, outliers bounded, 0 where unusable."""
    usable = np.isfinite(image)
    filled = np.where(usable, image, 0.0)
    share = uniform_filter(usable.astype(float), _LOCAL_PX, mode="constant")
    mean = uniform_filter(filled, _LOCAL_PX, mode="constant") / np.maximum(share, 1e-9)
    detail = np.where(usable & (share > 0.3), image - mean, 0.0)
    # What rounding leaves of a uniform image is no structure.
    detail[np.abs(detail) < _ROUNDING * float(np.abs(filled).max())] = 0.0
    some = np.abs(detail[detail != 0])
    if some.size == 0:
        return detail
    bound = _BOUND_SIGMAS * max(1.4826 * float(np.median(some)), 0.2 * float(some.std()))
    return np.asarray(np.clip(detail, -bound, bound))


def _vertex(line: Floats, peak: int) -> float:
    """Place of a parabola's vertex through the peak and its neighbours."""
    if not 0 < peak < line.size - 1:
        return 0.0
    before, at, after = line[peak - 1 : peak + 2].tolist()
    bend = before - 2 * at + after
    return 0.0 if bend >= 0 else 0.5 * (before - after) / bend
