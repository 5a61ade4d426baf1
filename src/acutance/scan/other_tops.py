"""Tops of the likelihood that are nearly as high as the highest: their sensors count by it.

Of few edges two sensors may be as likely: one that is softer along a direction, under ideal objects
there, and a sharper one under soft objects. The normal approximation about one of them does not
know of the other. As the blurs that edges have in common (`acutance.scan.shared_blur`), the
differences between tops are a part of the sensor's posterior: their mean moves it, and their
scatter is a term of its deviations.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.stacked import unstacked
from acutance.scan.sensor_turns import SensorState
from acutance.scan.shared_blur import SharedBlur

__all__ = ["blur_of_tops"]


def blur_of_tops(
    best: SensorState, others: Sequence[SensorState], modes: Floats, freq_cpp: Floats
) -> SharedBlur:
    """By how much the blurs of the sensors of all tops differ from the best one's.

    Parameters
    ----------
    best : SensorState
    others : sequence of SensorState
        Their likelihoods are those of the same edges.
    modes : (b, k, q) array
        Change of the logarithm of the OTF by a unit of every blur.
    freq_cpp : (k,) array
    """
    blurs = np.array([_blur_apart(best.otf, one.otf, modes, freq_cpp) for one in (best, *others)])
    height = np.array([one.log_likelihood for one in (best, *others)])
    weight = np.exp(height - height.max())
    weight /= weight.sum()
    mean = weight @ blurs
    return SharedBlur(mean, np.sqrt(weight)[:, None] * (blurs - mean))


def _blur_apart(one: Floats, other: Floats, modes: Floats, freq_cpp: Floats) -> Floats:
    """Amounts (q,) of blurs that lead from one OTF along directions (b, 2 k) nearest to another."""
    below = freq_cpp <= NYQUIST_CPP
    modulus, wanted = (np.abs(unstacked(otf.T)).T[:, below] for otf in (one, other))
    slopes = modulus[:, :, None] * modes[:, below]
    off = (wanted - modulus).ravel()
    return np.asarray(np.linalg.lstsq(slopes.reshape(off.size, -1), off, rcond=1e-6)[0])
