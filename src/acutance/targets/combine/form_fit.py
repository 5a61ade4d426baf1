"""One form of a sensor fitted to all curves: the parameters of largest posterior density."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import leastsq

from acutance.curves.grid import Floats
from acutance.targets.combine.correction import Correction
from acutance.targets.combine.curves import WhitenedCurves
from acutance.targets.combine.lit_curves import LitCurves
from acutance.targets.combine.sensor_forms import SensorForm, product
from acutance.targets.combine.weighted_forms import WeightedForm

__all__ = ["FIRST_STEPS", "FormFit", "fit_form", "likely_starts"]

FIRST_STEPS, _MAX_STEPS = 30, 60
_STARTS_TRIED = 2
_SETTLED = 1e-6
"""Change of a form's misfit, a share of it, that is none: with more the turns of a scene cycle."""
_FLAT = 1e-8
"""Cosine between the residual and what any parameter changes: no step leads further."""

_STARTS: Mapping[str, Sequence[tuple[float, float]]] = {
    "smear": ((0.9, 0.15), (0.15, 0.9), (0.7, 0.7), (0.7, -0.7)),
    "upright smear": ((0.0, -1.5), (-1.5, 0.0), (-0.4, -0.4)),
    "trail": ((0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3)),
    "phase": ((0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7)),
}


@dataclass(frozen=True, eq=False)
class FormFit(WeightedForm):
    """One form, with a correction of a given size, fitted to all curves.

    Parameters
    ----------
    score : float
        Minus twice the log evidence of the form, by Laplace's approximation.
    """

    score: float

    @property
    def prior_std(self) -> Floats:
        """Prior standard deviations of parameters and weights, (p + m,)."""
        return np.concatenate([self.form.std, np.full(self.weights.size, self.share)])


def fit_form(
    data: WhitenedCurves,
    form: SensorForm,
    starts: Sequence[Floats],
    share: float,
    ways: Floats,
    steps: int = _MAX_STEPS,
) -> FormFit:
    """The parameters of largest posterior density, the correction integrated out.

    Parameters
    ----------
    data : WhitenedCurves
    form : SensorForm
    starts : sequence of (p,) arrays
        Where the fit begins, in turn; the best end counts.
    share : float
        Standard deviation of the correction, of the logarithm of the OTF.
    ways : (n, m) array
        What a deviation of every direction of the correction changes in whitened values.
    steps : int, optional
        Most evaluations of a fit.
    """
    std, misfit = form.std, _Misfit(data, form, ways)
    cost, p = min((misfit.least(first, steps) for first in starts), key=lambda one: one[0])
    off, _ = misfit.parts(p)
    by_p = misfit.slopes_of_curves(p)
    design = np.concatenate([by_p, ways], axis=1)
    normal = design.T @ design
    normal += np.diag(np.concatenate([std**-2.0, np.ones(ways.shape[1])]))
    inverse = np.linalg.inv(normal)
    moved = design @ inverse
    # The directions' weights are counted in units of the share.
    scale = np.concatenate([np.ones(p.size), np.full(ways.shape[1], share)])
    amounts = np.linalg.solve(normal[p.size :, p.size :], ways.T @ off)
    # Laplace: the posterior of parameters and directions is narrower than their prior.
    whole = np.concatenate([std, np.ones(ways.shape[1])])
    narrowed = np.linalg.slogdet(whole[:, None] * normal * whole)[1]
    score = cost + float(narrowed)
    nothing = Correction(form, tuple(p.tolist()))
    covariance = scale[:, None] * (inverse + moved.T @ data.shared @ moved) * scale
    root = np.asarray(np.linalg.cholesky(0.5 * (covariance + covariance.T)))
    return FormFit(form, share, nothing, p, share * amounts, root, 1.0, score=score)


class _Misfit:
    """How far a form is from all curves, and from the prior of its parameters."""

    def __init__(self, data: WhitenedCurves, form: SensorForm, ways: Floats) -> None:
        self.data, self.form = data, form
        # (1 + ways ways^T)^(-1/2), by the singular values of ways.
        self.left, singular, _ = np.linalg.svd(ways, full_matrices=False)
        self.damping = 1 / np.sqrt(1 + singular**2) - 1
        self.mean, self.std = form.mean, form.std
        self.last = np.full(self.mean.size, np.nan)
        self.last_factors: list[NDArray[Any]] = []
        self.last_curves: LitCurves

    def least(self, start: Floats, steps: int) -> tuple[float, Floats]:
        """The least sum of squares of the residual, and where it is, by Levenberg and Marquardt.

        `scipy.optimize.least_squares` takes the same steps, in a tenth more of the time.
        """
        found, _, info, *_ = leastsq(
            self.residual, start, Dfun=self.slopes, full_output=True,
            ftol=_SETTLED, xtol=_SETTLED, gtol=_FLAT, maxfev=steps,
        )  # fmt: skip
        left = info["fvec"]
        return float(left @ left), np.asarray(found)

    def curves(self, p: Floats) -> LitCurves:
        """All curves about the OTF; slopes are asked for where the residual was."""
        if not np.array_equal(p, self.last):
            self.last, self.last_factors = p.copy(), self.form.factors_on(p, self.data.plane)
            self.last_curves = LitCurves(self.data, product(self.last_factors))
        return self.last_curves

    def parts(self, p: Floats) -> tuple[Floats, Floats]:
        """Of the curves, and of the parameters from their prior, in standard deviations."""
        return self.curves(p).residual, (p - self.mean) / self.std

    def residual(self, p: Floats) -> Floats:
        """All in one, the correction integrated out."""
        off, from_prior = self.parts(p)
        return np.concatenate([self._damped(off), from_prior])

    def slopes_of_curves(self, p: Floats) -> Floats:
        """Derivatives of the whitened OTF by the parameters, (n, p)."""
        near = self.curves(p)
        return near.of(self.form.slopes_on(p, self.data.plane, self.last_factors))

    def slopes(self, p: Floats) -> Floats:
        """Derivatives of the residual."""
        return np.concatenate([-self._damped(self.slopes_of_curves(p)), np.diag(1 / self.std)])

    def _damped(self, values: Floats) -> Floats:
        if not self.damping.size:
            return values
        return np.asarray(values + (self.left * self.damping) @ (self.left.T @ values))


def likely_starts(data: WhitenedCurves, form: SensorForm) -> list[Floats]:
    """The first guesses of the parameters that fit best."""
    misfit = _Misfit(data, form, np.zeros((data.values.size, 0)))
    best_first = sorted(_starts(form), key=lambda p: float(np.sum(misfit.residual(p) ** 2)))
    return best_first[:_STARTS_TRIED]


def _starts(form: SensorForm) -> list[Floats]:
    """First guesses: a smear or trail of 0 is stationary, and both have directions."""
    found = [form.mean]
    for name, ways in _STARTS.items():
        if name in form.terms:
            at = SensorForm(form.terms[: form.terms.index(name)]).mean.size
            found = [_with(start, at, way) for start in found for way in ways]
    return found


def _with(start: Floats, at: int, way: tuple[float, float]) -> Floats:
    moved = start.copy()
    moved[at : at + 2] = way
    return moved
