"""The sum of an edge and its mirror image: all that an even blur leaves of it is zero.

An even line spread function (LSF) makes an edge spread function (ESF) that is odd about its middle.
So of the normalised pixels v at the distance s from the middle, the sum

    S(s) = v(s) + v(-s) - 1,    s > 0

is zero whatever the even LSF, and shows what else there is: a level or a place that is off, ground
that is not even, an odd part of the LSF, or a characteristic that is not a straight line. The first
three have normal priors here; what remains is weighed by its log evidence.

Distances are in units of the full width at half maximum (FWHM), in which the priors are fixed
matrices over fixed bins.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.numerics.small_matrices import factorize, forward_substitution
from acutance.targets.straight.check_data import CheckData, regular
from acutance.targets.straight.check_loops import linear_at
from acutance.targets.straight.ground_steps import near_ground
from acutance.targets.straight.tuned import MISFIT, NEAR_GROUND_STEPS

__all__ = ["EVEN", "EVERY", "USUAL", "MirrorSum", "Weighed"]

_CELL: Final = 0.1
_CELLS: Final = (1,) * 10 + (2,) * 5 + (4,) * 5
"""Cells in every bin: the sum is smooth, and far from the edge smoother."""
_BINS: Final = len(_CELLS)
_BIN: Final[NDArray[np.intp]] = np.repeat(np.arange(_BINS + 1), [*_CELLS, 1])
"""The bin of every cell; the last one, of all that lies beyond, is not used."""
_EDGES: Final[Floats] = _CELL * np.cumsum([0, *_CELLS])
_CENTRES: Final[Floats] = np.asarray(0.5 * (_EDGES[1:] + _EDGES[:-1]))

_LEVEL_STD, _PLACE_STD_PX, _SLOPE_STD = 0.3, 0.3, 0.03
_GROUND_AMPLITUDES: Final[Floats] = np.exp([-8.0, -5.5, -4.0])
_GROUND_WEIGHTS: Final = (0.5, 0.35, 0.15)
"""Of the random walk of the ground on either side, per root of a width: mostly even."""
_ODD_PROCESSES: Final = ((1.2, 0.6), (0.7, 0.17))
"""Extent and smoothness of the odd part of an LSF, in widths."""
_ODD_STDS: Final = ((0.01, 0.02), (0.05, 0.08))
"""Their standard deviations, relative to the LSF's peak: of a weak odd part and of a strong one."""

EVEN: Final = len(_GROUND_WEIGHTS)
"""How many of the settings of the prior have an even LSF: the first ones."""
EVERY, USUAL = slice(None), slice(1, 2)
"""All settings; an even LSF beside ground as it often is."""


@dataclass(frozen=True, eq=False)
class Weighed:
    """How well the prior's settings explain a sum, and some curves beside them.

    Attributes
    ----------
    log_evidence : (j,) array
        Of every setting, its weight included: `EVEN` with an even LSF, then those with an odd part.
    pull, power : (j, k) arrays
        Product of every curve with the sum and with itself, at each setting: an amplitude of the
        curve has the likelihood of a normal variable of mean ``pull / power`` and variance
        ``1 / power``.
    """

    log_evidence: Floats
    pull: Floats
    power: Floats


@dataclass(frozen=True, eq=False)
class MirrorSum:
    """The sum of an edge and its mirror image in bins of their distance.

    Attributes
    ----------
    value, variance : (n,) arrays
        The sum, and the variance of its noise.
    half : (n,) array
        ESF of the even part of the LSF there, from one half to one: at -s it is 1 less that.
    lsf : (n,) array
        The even part of the LSF, 1/px.
    """

    value: Floats
    variance: Floats
    half: Floats
    lsf: Floats

    @classmethod
    def of(cls, data: CheckData, middle_px: float = 0.0) -> MirrorSum:
        """The sum of the pixels of an edge: that of the fitted curve, and of what it leaves.

        Parameters
        ----------
        data : CheckData
        middle_px : float, optional
            Where the edge is folded, from its 50 % point on.
        """
        response = data.fit.response
        information, left = _folded(
            data.fit.distance_px, data.weights, data.residual, data.near, middle_px,
            _CELL * data.fwhm_px,
        )  # fmt: skip
        first, step = regular(response.esf.distance_px)
        return cls(*_summed(
            response.esf.value, response.lsf.value, first, step, information, left, middle_px,
            data.fwhm_px,
        ))  # fmt: skip

    def weighed(self, curves: Floats, settings: slice = EVERY) -> Weighed:
        """Weigh the sum, and `curves` (k, n) that may be part of it, at some settings."""
        prior, log_weight = (one[settings] for one in _priors())
        rows = np.vstack([self.value, curves])
        log_density, pull, power = _weighed(prior, self.variance, self.lsf, rows)
        return Weighed(log_weight + log_density, pull, power)


@compiled
def _weighed(
    prior: Floats, variance: Floats, lsf: Floats, rows: Floats
) -> tuple[Floats, Floats, Floats]:
    """Of covariances S (j, n, n) the log density of the first row, and products of the others.

    ``S = prior + variance + place^2 lsf lsf^T``; of rows r the products are ``r_0 S^-1 r_k`` and
    ``r_k S^-1 r_k``, (j, k) each.
    """
    settings, n, curves = len(prior), len(variance), len(rows) - 1
    log_density = np.zeros(settings)
    pull, power = np.zeros((settings, curves)), np.zeros((settings, curves))
    for setting in range(settings):
        covariance, seen = np.empty((n, n)), np.empty((n, 1 + curves))
        for i in range(n):
            for j in range(n):
                covariance[i, j] = prior[setting, i, j] + _PLACE_STD_PX**2 * lsf[i] * lsf[j]
            covariance[i, i] += variance[i]
            for k in range(1 + curves):
                seen[i, k] = rows[k, i]
        factorize(covariance)
        forward_substitution(covariance, seen)
        for i in range(n):
            log_density[setting] -= np.log(covariance[i, i]) + 0.5 * seen[i, 0] ** 2
            for k in range(curves):
                pull[setting, k] += seen[i, 0] * seen[i, 1 + k]
                power[setting, k] += seen[i, 1 + k] ** 2
    return log_density, pull, power


@compiled
def _folded(
    s: Floats, weight: Floats, residual: Floats, near: NDArray[np.intp], middle_px: float,
    cell_px: float,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Weight of the near pixels in every bin of either side, and their mean residual, (2, n)."""
    total, left = np.full((2, _BINS), 1e-12), np.zeros((2, _BINS))
    for k in near:
        outwards = s[k] - middle_px
        own = _BIN[min(int(abs(outwards) / cell_px), _BIN.size - 1)]
        if own < _BINS:
            side = 1 if outwards > 0 else 0
            total[side, own] += weight[k]
            left[side, own] += weight[k] * residual[k]
    return total, left / total


@compiled
def _summed(
    esf: Floats, lsf: Floats, first: float, step: float, information: Floats, left: Floats,
    middle_px: float, width_px: float,
) -> tuple[Floats, Floats, Floats, Floats]:  # fmt: skip
    """The sum in every bin, the variance of its noise, and even parts of ESF and LSF, (n,) each.

    Of curves that both stand on the regular grid of `first` and `step`, and of what they leave of
    the pixels on either side, (2, n), with its inverse variance.
    """
    value, variance, half, even = np.empty((4, _BINS))
    for k in range(_BINS):
        before, behind = middle_px - width_px * _CENTRES[k], middle_px + width_px * _CENTRES[k]
        low, high = linear_at(esf, first, step, before), linear_at(esf, first, step, behind)
        value[k] = low + left[0, k] + high + left[1, k] - 1
        variance[k] = 1 / information[0, k] + 1 / information[1, k] + MISFIT**2
        half[k] = 0.5 * (1 + high - low)
        even[k] = 0.5 * (linear_at(lsf, first, step, before) + linear_at(lsf, first, step, behind))
    return value, variance, half, even


@cache
def _priors() -> tuple[Floats, Floats]:
    """Covariance of the sum at every setting of the prior, (j, n, n), and their log weights, (j,).

    Place and noise, which differ from edge to edge, come on top.
    """
    far = _CENTRES / _CENTRES[-1]
    levels = np.stack([np.full(_BINS, _LEVEL_STD), _SLOPE_STD * far, _SLOPE_STD * far**2], axis=1)
    even = levels @ levels.T
    scale = near_ground().scale[: NEAR_GROUND_STEPS.size]
    steps = ndtr(FWHM_OF_SIGMA * (_CENTRES[:, None] - NEAR_GROUND_STEPS)) * scale
    ground = 2 * steps @ steps.T
    found = [even + amplitude**2 * ground for amplitude in _GROUND_AMPLITUDES]
    for stds in _ODD_STDS:
        odd = [std**2 * _odd(*one) for std, one in zip(stds, _ODD_PROCESSES, strict=True)]
        found += [one + odd[0] + odd[1] for one in found[:EVEN]]
    weights = np.tile(_GROUND_WEIGHTS, 1 + len(_ODD_STDS))
    return np.array(found), np.log(weights)


def _odd(extent: float, smoothness: float) -> Floats:
    """Covariance of the sum behind an odd LSF, a smooth process of unit deviation, (n, n)."""
    u = np.linspace(0.0, _EDGES[-1], 200)
    apart, across = u[:, None] - u, u[:, None] + u
    process = np.exp(-0.5 * (apart / smoothness) ** 2) - np.exp(-0.5 * (across / smoothness) ** 2)
    fading = np.exp(-0.5 * (u / extent) ** 2)
    # The ESF of an odd LSF is even: its integral from there on, counted twice in the sum.
    integral = 2 * u[1] * (u > _CENTRES[:, None]) * fading
    return np.asarray(integral @ process @ integral.T)
