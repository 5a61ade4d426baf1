"""Ways in which the blur of a sensor may change, and how much of each the edges of a scene show.

A change of the logarithm of the optical transfer function (OTF) is a sum of modes: an added
Gaussian blur, the same in all directions, across more than along, or oblique; and a loss in the
middle of the band, as of defocus. With them the sensor's blur is told from that of all objects
together (the ridge along which expectation and maximisation creeps; C. Liu, D. B. Rubin, Y. N. Wu,
Biometrika 85, 1998, 755), and followed over the field of view (`acutance.scan.field_fit`).
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.information import mode_information
from acutance.scan.population import fit_shares

__all__ = [
    "ALL_AROUND",
    "BLUR_MODES",
    "COMMON_MODES",
    "LONGEST_PX2",
    "OBLIQUE",
    "ModesFit",
    "blur_modes",
    "changed",
    "edge_modes",
    "fit_modes",
    "quartic_modes",
]

BLUR_MODES: Final = ("all around", "across more than along", "oblique", "middle of the band")
"""Units are the variance of a Gaussian blur, px^2; of the last, of one of the same effect at
a quarter of a cycle per pixel."""
ALL_AROUND: Final = 0
"""The mode that a softness of all objects has."""
OBLIQUE: Final = 2
"""The mode that changes nothing across and along."""
COMMON_MODES: Final = 3
"""The blurs: what a sensor and all of its objects have in common is none of shape."""
_MAX_STEPS: Final = 12
_DAMPINGS: Final = (0.0, 0.03, 0.3, 3.0, 30.0)
"""Added to all curvatures in turn, in units of the largest, until a step leads upwards."""
LONGEST_PX2: Final = 0.05
"""Longest step of blurs."""
_TINY: Final = 1e-30
_SETTLED: Final = 0.05
"""Rise of the log likelihood, expected of a step, that is none."""


class ModesFit(NamedTuple):
    """The likeliest change of a sensor.

    Attributes
    ----------
    amount : (q,) array
    share : (g, p) array
        Of the parts of the population.
    information : (q, q) array
        Of the edges alone, about the amounts, what the objects are not being known.
    log_posterior : float
    """

    amount: Floats
    share: Floats
    information: Floats
    log_posterior: float


def blur_modes(u_cpp: Floats, v_cpp: Floats) -> Floats:
    """Change of the logarithm of the OTF by a unit of every mode, (..., 4).

    Parameters
    ----------
    u_cpp, v_cpp : (...) arrays
        Frequencies across and along.
    """
    square = u_cpp**2 + v_cpp**2
    middle = np.sin(np.pi * np.sqrt(square) / NYQUIST_CPP) ** 2 / 16
    middle = np.where(square < NYQUIST_CPP**2, middle, 0.0)
    parts = [square, u_cpp**2 - v_cpp**2, 2 * u_cpp * v_cpp, middle]
    return np.asarray(-2 * np.pi**2 * np.stack(parts, axis=-1))


def edge_modes(normal_deg: Floats, freq_cpp: Floats) -> Floats:
    """The modes along directions, (n, k, 4)."""
    angle = np.radians(normal_deg)[:, None]
    return blur_modes(freq_cpp * np.cos(angle), freq_cpp * np.sin(angle))


def quartic_modes(normal_deg: Floats, freq_cpp: Floats) -> Floats:
    """Modes of fourth order along directions, (n, k, 5): what is left of blurs beyond the second.

    The first three are those of `BLUR_MODES`, steeper, the others turn four times all around: the
    five span the homogeneous polynomials of fourth order in both frequencies.
    """
    fourth = (freq_cpp / NYQUIST_CPP) ** 2
    turned = 4 * np.radians(normal_deg)[:, None]
    steeper = edge_modes(normal_deg, freq_cpp)[:, :, :COMMON_MODES] * fourth[:, None]
    size = -2 * np.pi**2 * freq_cpp**2 * fourth
    four_fold = np.stack([size * np.cos(turned), size * np.sin(turned)], axis=-1)
    return np.concatenate([steeper, four_fold], axis=2)


def changed(otf: Floats, log_gain: Floats) -> Floats:
    """OTFs (n, 2 k), real parts first, times the exponential of (n, k)."""
    gain = np.exp(log_gain)
    return np.asarray(otf * np.hstack([gain, gain]))


def fit_modes(
    edges: EdgeLikelihoods,
    otf: Floats,
    share: Floats,
    modes: Floats,
    *,
    start: Floats | None = None,
    mean: Floats | float = 0.0,
    std: Floats | float = np.inf,
    longest: float = LONGEST_PX2,
) -> ModesFit:
    """How much of every mode makes the edges likeliest.

    Newton's method; what the edges are is integrated out, and the shares of the parts follow every
    step: else it would creep where a blur of the sensor may be one of the objects.

    Parameters
    ----------
    edges : EdgeLikelihoods
    otf : (b, 2 k) array
        The sensor along the bins.
    share : (g, p) array
        First guess.
    modes : (n, k, q) array
        Change of the logarithm of the OTF that every edge sees.
    start : (q,) array, optional
        First guess of the amounts.
    mean, std : (q,) array or float, optional
        Of the prior of the amounts.
    longest : float, optional
        Longest step of the amounts.
    """
    amount = np.zeros(modes.shape[2]) if start is None else start
    precision = np.broadcast_to(np.asarray(std) ** -2.0, amount.shape)
    seen = edges.turned(np.exp(modes @ amount))
    member = fit_shares(seen, otf, share)
    reached = member.log_posterior - 0.5 * float(precision @ (amount - mean) ** 2)
    for _ in range(_MAX_STEPS):
        pull, information = mode_information(member, modes)
        upwards = pull - precision * (amount - mean)
        steps = _steps(information + np.diag(precision), upwards, longest)
        is_last = 0.5 * float(upwards @ steps[0]) < _SETTLED
        for step in steps:
            moved = amount + step
            seen = edges.turned(np.exp(modes @ moved))
            tried = fit_shares(seen, otf, member.share)
            value = tried.log_posterior - 0.5 * float(precision @ (moved - mean) ** 2)
            if value > reached:
                break
        else:
            break
        amount, member, reached = moved, tried, value
        if is_last:
            break
    _, information = mode_information(member, modes)
    return ModesFit(amount, member.share, information, reached)


def _steps(information: Floats, pull: Floats, longest: float) -> list[Floats]:
    """Newton's step, upwards whatever the curvature, and shorter ones nearer to the gradient."""
    size, axes = np.linalg.eigh(information)
    size = np.maximum(np.abs(size), longest**-2.0)
    damped = (axes @ ((axes.T @ pull) / (size + share * size.max())) for share in _DAMPINGS)
    return [one * min(1.0, longest / max(float(np.linalg.norm(one)), _TINY)) for one in damped]
