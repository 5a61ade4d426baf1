"""Forms of a sensor fitted to all curves: the parameters of largest posterior density.

All forms, from all of their starts, are fitted side by side (`acutance.targets.combine.
form_products`, `acutance.numerics.levenberg_marquardt`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from acutance.curves.grid import Floats
from acutance.numerics.levenberg_marquardt import Expansion, least_squares
from acutance.targets.combine.correction import Correction
from acutance.targets.combine.curves import WhitenedCurves
from acutance.targets.combine.form_products import FormProducts
from acutance.targets.combine.lit_curves import LitCurves
from acutance.targets.combine.sensor_forms import SensorForm
from acutance.targets.combine.weighted_forms import WeightedForm

__all__ = ["FIRST_STEPS", "FormFit", "Start", "fit_forms", "likely_starts"]

Places = NDArray[np.intp]
Start = tuple[SensorForm, Floats]
"""A form, and the parameters (p,) where its fit begins."""

FIRST_STEPS, _MAX_STEPS = 30, 60
_STARTS_TRIED = 2
_SETTLED = 1e-6
"""Change of a form's misfit, a share of it, that is none: with more the turns of a scene cycle."""
_FLAT = 1e-8
"""Cosine between the residual and what any parameter changes: no step leads further."""

_STARTS: Mapping[str, tuple[int, Sequence[tuple[float, ...]]]] = {
    "smear": (0, ((0.9, 0.15), (0.15, 0.9), (0.7, 0.7), (0.7, -0.7))),
    "upright smear": (0, ((0.0, -1.5), (-1.5, 0.0), (-0.4, -0.4))),
    "trail": (0, ((0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3))),
    "phase": (0, ((0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7))),
    "astigmatism": (2, ((0.03, 0.1, 0.0), (0.03, -0.1, 0.0), (0.03, 0.0, 0.1), (0.03, 0.0, -0.1))),
    "aberrated": (2, ((0.03,),)),
}
"""Of terms that are stationary at their mean, or have several optima: the first of some parameters,
and guesses of them."""


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

    @property
    def start(self) -> Start:
        """Where another fit of the form may begin."""
        return self.form, self.parameters


def fit_forms(
    data: WhitenedCurves,
    starts: Sequence[Start],
    share: float,
    ways: Floats,
    steps: int = _MAX_STEPS,
) -> list[FormFit]:
    """The parameters of largest posterior density of every form, the correction integrated out.

    Parameters
    ----------
    data : WhitenedCurves
    starts : sequence of Start
        Where the fits begin, those of a form in turn: of several of one form the best end counts.
    share : float
        Standard deviation of the correction, of the logarithm of the OTF.
    ways : (n, m) array
        What a deviation of every direction of the correction changes in whitened values.
    steps : int, optional
        Most evaluations of a fit.
    """
    misfits = _Misfits(data, [form for form, _ in starts], ways)
    ends, costs = least_squares(
        misfits, misfits.padded([p for _, p in starts]), misfits.products.std,
        most=steps, settled=_SETTLED, flat=_FLAT,
    )  # fmt: skip
    places = groupby(range(len(starts)), key=lambda i: starts[i][0])
    best = np.array([min(own, key=costs.__getitem__) for _, own in places], np.intp)
    return misfits.fits(ends[best], costs[best], best, share)


class _Misfits:
    """How far forms are from all curves, and from the prior of their parameters."""

    def __init__(self, data: WhitenedCurves, forms: Sequence[SensorForm], ways: Floats) -> None:
        self.data, self.forms, self.ways = data, forms, ways
        self.products = FormProducts(tuple(one.terms for one in forms), forms[0].detector_px)
        # (1 + ways ways^T)^(-1/2), by the singular values of ways.
        self.left, singular, _ = np.linalg.svd(ways, full_matrices=False)
        self.damping = 1 / np.sqrt(1 + singular**2) - 1
        self.near: _NearForms
        self._some: dict[bytes, FormProducts] = {}

    def padded(self, parameters: Sequence[Floats]) -> Floats:
        """Parameters of every form, (f, p); 0 where it has fewer."""
        found = np.zeros_like(self.products.mean)
        for own, p in zip(found, parameters, strict=True):
            own[: p.size] = p
        return found

    def some(self, which: Places) -> FormProducts:
        """Some of the sensors: most steps ask for those of the step before."""
        name = which.tobytes()
        if name not in self._some:
            self._some[name] = self.products.some(which)
        return self._some[name]

    def costs(self, x: Floats, which: Places) -> Floats:
        """Sums of squares of the residuals, the correction integrated out, and from the prior."""
        # A trial step may lead anywhere.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            self.near = _NearForms(self, x, which)
            return self.near.costs

    def expansions(self, x: Floats, which: Places) -> Expansion:
        """How they change with the parameters, of some of those whose costs were asked last."""
        near = self.near.some(np.searchsorted(self.near.which, which))
        slopes, std = self.damped(near.slopes), near.products.std
        gram = slopes @ slopes.transpose(0, 2, 1)
        np.einsum("bii->bi", gram)[:] += std**-2.0
        fall = slopes @ self.damped(near.curves.residual)[..., None]
        return Expansion(gram, near.from_prior / std - fall[..., 0])

    def damped(self, values: Floats) -> Floats:
        """Whitened values (..., size), the correction integrated out."""
        if not self.damping.size:
            return values
        return np.asarray(values + (values @ self.left) @ (self.left * self.damping).T)

    def fits(self, x: Floats, costs: Floats, which: Places, share: float) -> list[FormFit]:
        """Forms `which`, one a form, at the parameters where the costs are least."""
        near = _NearForms(self, x, which)
        return [
            self._fit(
                self.forms[i], x[k], float(costs[k]), near.slopes[k].T, near.curves.residual[k],
                share,
            )
            for k, i in enumerate(which.tolist())
        ]  # fmt: skip

    def _fit(
        self, form: SensorForm, x: Floats, cost: float, by_p: Floats, off: Floats, share: float
    ) -> FormFit:
        std, ways = form.std, self.ways
        p = x[: std.size].copy()
        design = np.concatenate([by_p[:, : p.size], ways], axis=1)
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
        score = cost + float(narrowed) - 2 * self._log_twins(form, p, inverse)
        nothing = Correction(form, tuple(p.tolist()))
        covariance = scale[:, None] * (inverse + self.data.shared_of(moved)) * scale
        root = np.asarray(np.linalg.cholesky(0.5 * (covariance + covariance.T)))
        return FormFit(form, share, nothing, p, share * amounts, root, 1.0, score=score)

    @staticmethod
    def _log_twins(form: SensorForm, p: Floats, covariance: Floats) -> float:
        """Logarithm of how many optima there are like this one, signs changed.

        Those that overlap with it count in part: half of each lies on its own side of zero.
        """
        found = 0.0
        for at in form.signed:
            far = math.sqrt(p[at] @ np.linalg.solve(covariance[np.ix_(at, at)], p[at]))
            found += math.log(2) + float(log_ndtr(far))
        return found


@dataclass(frozen=True, eq=False)
class _NearForms:
    """Some forms at some parameters.

    Attributes
    ----------
    misfits : _Misfits
    x : (b, p) array
    which : (b,) int array
    """

    misfits: _Misfits
    x: Floats
    which: Places

    @cached_property
    def products(self) -> FormProducts:
        return self.misfits.some(self.which)

    @cached_property
    def factors(self) -> NDArray[np.complex128]:
        return self.products.factors(self.x, self.misfits.data.plane)

    @cached_property
    def curves(self) -> LitCurves:
        """All curves about the OTF of each, (b, n)."""
        return LitCurves(self.misfits.data, self.factors.prod(axis=0))

    @cached_property
    def from_prior(self) -> Floats:
        """Parameters, (b, p), in prior standard deviations from the mean."""
        return np.asarray((self.x - self.products.mean) / self.products.std)

    @cached_property
    def costs(self) -> Floats:
        residual = self.misfits.damped(self.curves.residual)
        return np.asarray(np.sum(residual**2, axis=1) + np.sum(self.from_prior**2, axis=1))

    @cached_property
    def slopes(self) -> Floats:
        """Derivatives of the whitened OTFs by the parameters, (b, p, size); 0 where a form has
        fewer."""
        slopes = self.products.own_slopes(self.x, self.misfits.data.plane, self.factors)
        found = np.zeros((*self.x.shape, self.misfits.data.values.size))
        self.curves.put(slopes, self.products.places, found)
        return found

    def some(self, kept: Places) -> _NearForms:
        """Those at places (k,) among them; what is known of them is not worked out again."""
        if kept.size == self.which.size:
            return self
        found = _NearForms(self.misfits, self.x[kept], self.which[kept])
        vars(found).update(factors=self.factors[:, kept], curves=self.curves.some(kept))
        return found


def likely_starts(data: WhitenedCurves, forms: Sequence[SensorForm]) -> list[list[Floats]]:
    """Of every form the first guesses of the parameters that fit best."""
    if not forms:
        return []
    guesses = [_starts(form) for form in forms]
    owners = [form for form, own in zip(forms, guesses, strict=True) for _ in own]
    misfits = _Misfits(data, owners, np.zeros((data.values.size, 0)))
    x = misfits.padded([p for own in guesses for p in own])
    costs = iter(misfits.costs(x, np.arange(len(x))).tolist())
    found = []
    for own in guesses:
        order = np.argsort([next(costs) for _ in own], kind="stable")
        found.append([own[i] for i in order[:_STARTS_TRIED].tolist()])
    return found


def _starts(form: SensorForm) -> list[Floats]:
    """First guesses of the parameters of a form."""
    found = [form.mean]
    for name, begin in form.begins.items():
        if name in _STARTS:
            first, ways = _STARTS[name]
            found = [_with(start, begin + first, way) for start in found for way in ways]
    return found


def _with(start: Floats, at: int, way: tuple[float, ...]) -> Floats:
    moved = start.copy()
    moved[at : at + len(way)] = way
    return moved
