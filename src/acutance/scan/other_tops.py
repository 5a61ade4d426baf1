"""Tops of the likelihood that are nearly as high as the highest: their sensors count by it.

Of few edges two sensors may be as likely: one that is softer along a direction, under ideal objects
there, and a sharper one under soft objects. The normal approximation about one of them does not
know of the other. Each has the evidence of its edges and of the forms that go through it (MacKay,
Information Theory, Inference, and Learning Algorithms, 2003, chapter 28). As the blurs that edges
have in common (`acutance.scan.shared_blur`), the differences between tops are a part of the
sensor's posterior: their mean moves it, and their scatter is a term of its deviations.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.stacked import unstacked
from acutance.scan.information import observed_information
from acutance.scan.population import fit_shares
from acutance.scan.sensor_turns import SensorState, otf_samples
from acutance.scan.shared_blur import SharedBlur
from acutance.targets.combine.fit import combine_curves

__all__ = ["blur_of_tops", "log_evidence"]


def log_evidence(top: SensorState, normal_deg: Floats) -> float:
    """Logarithm of the evidence of a top, but for a constant of the edges.

    Parameters
    ----------
    top : SensorState
    normal_deg : (b,) array
        Mean direction of every bin.
    """
    member = fit_shares(top.along, top.otf, top.share)
    information = observed_information(top.along, top.otf, member)
    samples = otf_samples(normal_deg, top.along.freq_cpp, top.otf.ravel(), information)
    forms = combine_curves([samples], forms=top.forms, near=top.near).forms
    return member.log_posterior - 0.5 * forms[0].score - math.log(forms[0].weight)


def blur_of_tops(
    best: Floats, others: Sequence[Floats], log_evidences: Floats, modes: Floats, freq_cpp: Floats
) -> SharedBlur:
    """By how much the blurs of the sensors of all tops differ from the best one's.

    Parameters
    ----------
    best : (b, 2 k) array
        OTF along directions, real parts first.
    others : sequence of (b, 2 k) arrays
    log_evidences : (1 + n,) array
        Of the best and of the n others.
    modes : (b, k, q) array
        Change of the logarithm of the OTF by a unit of every blur.
    freq_cpp : (k,) array
    """
    blurs = np.array([_blur_apart(best, one, modes, freq_cpp) for one in (best, *others)])
    weight = np.exp(log_evidences - log_evidences.max())
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
