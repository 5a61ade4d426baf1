"""One parametric 2-D OTF through the curves of many measurements, by generalised least squares."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.geometry.angles import wrap_axis
from acutance.targets.combine.correction import Departure
from acutance.targets.combine.curves import ChiSquare, PlaneCurve, WhitenedCurves
from acutance.targets.combine.sensor_forms import FORMS, SensorForm

__all__ = ["CombinedFit", "FormFit", "combine_curves"]

Complexes = NDArray[np.complex128]

_LARGEST_STD_DEG = 30.0
_LEAST_WEIGHT = 0.01
_FAINT = 0.1
_SHARES = (0.0, 0.01, 0.03, 0.1, 0.3)
"""Standard deviations tried for the departure from a form, shares of the logarithm of the OTF."""

_MOST_DEPARTED = 3
_STARTS_TRIED = 2
_SMEAR_STARTS = ((0.9, 0.15), (0.15, 0.9), (0.7, 0.7), (0.7, -0.7))
_TRAIL_STARTS = ((0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3))


@dataclass(frozen=True, eq=False)
class FormFit:
    """One form, with a departure of a given size, fitted to all curves.

    Parameters
    ----------
    form : SensorForm
    share : float
        Standard deviation of the departure from the form, a share of the logarithm of the OTF.
    departure : Departure
    parameters : (p,) array
    weights : (m,) array
        Of the departure's directions.
    inverse : (p + m, p + m) array
        Covariance of both if the errors of different curves were independent.
    root : (p + m, p + m) array
        Factor of their covariance, before it is widened.
    score : float
        Minus twice the logarithm of the form's evidence, by Laplace's approximation.
    weight : float
        Share in the mean over forms, ``exp(-score / 2)`` normalised.
    """

    form: SensorForm
    share: float
    departure: Departure
    parameters: Floats
    weights: Floats
    inverse: Floats
    root: Floats
    score: float
    weight: float

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), exactly 1 at zero frequency."""
        plain = self.form.otf(self.parameters, u_cpp, v_cpp)
        if self.weights.size == 0:
            return plain
        return np.asarray(plain + self.departure.directions(u_cpp, v_cpp) @ self.weights)

    def slopes(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Derivatives of the OTF by parameters and weights, (n, p + m)."""
        own = self.form.slopes(self.parameters, u_cpp, v_cpp)
        if self.weights.size == 0:
            return own
        return np.concatenate([own, self.departure.directions(u_cpp, v_cpp)], axis=1)

    def numbers(self, widened: float = 1.0) -> dict[str, Estimate]:
        """Parameters by name; a direction of what is round or short has no value."""
        centre = self.form.numbers(self.parameters)
        step = 1e-5
        rows = {name: np.zeros(self.parameters.size) for name in centre}
        for i, move in enumerate(step * np.eye(self.parameters.size)):
            above = self.form.numbers(self.parameters + move)
            below = self.form.numbers(self.parameters - move)
            for name, row in rows.items():
                change = above[name] - below[name]
                if name.endswith("_deg"):
                    change = wrap_axis(change)
                row[i] = change / (2 * step)
        root = self.root[: self.parameters.size]
        found = {
            name: Estimate(value, widened * float(np.linalg.norm(rows[name] @ root)))
            for name, value in centre.items()
        }
        for name, number in found.items():
            if name.endswith("_deg") and not number.std < _LARGEST_STD_DEG:
                found[name] = Estimate(math.nan, math.nan)
        return found


@dataclass(frozen=True, eq=False)
class CombinedFit:
    """The 2-D OTF of all curves, an `acutance.curves.OtfModel`: a mean over forms.

    Parameters
    ----------
    curves : tuple of PlaneCurve
    forms : tuple of FormFit
        The one of largest weight first.
    total : ChiSquare
        Of all curves together about the mean over forms, in what sensors differ by (width,
        smear, halo, trail): whether the curves agree.
    members : tuple of ChiSquare
        Of each curve.
    plain : ChiSquare
        Of all curves about the best form without a departure: whether a plain sensor holds them.
    """

    curves: tuple[PlaneCurve, ...]
    forms: tuple[FormFit, ...]
    total: ChiSquare
    members: tuple[ChiSquare, ...]
    plain: ChiSquare

    @property
    def best(self) -> FormFit:
        """The form with the largest weight."""
        return self.forms[0]

    @property
    def departure(self) -> float:
        """Mean standard deviation of the departure, a share of the logarithm of the OTF."""
        return sum(one.weight * one.share for one in self.forms)

    @property
    def birge_ratio(self) -> float:
        """What every standard deviation was widened by."""
        return self.total.birge_ratio

    @property
    def numbers(self) -> dict[str, Estimate]:
        """Parameters of the best form."""
        return self.best.numbers(self.birge_ratio)

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        sigma = min(one.form.least_sigma_px(one.parameters) for one in self.forms)
        return float(np.clip(0.8 / max(sigma, 1e-3), 3.0, 6.0))

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Mean OTF over the forms, (n,), exactly 1 at zero frequency."""
        return _mean_otf(self.forms, u_cpp, v_cpp)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k): that of each form, and how the forms differ."""
        mean = self.otf(u_cpp, v_cpp)
        parts = []
        for one in self.forms:
            off = one.otf(u_cpp, v_cpp) - mean
            own = np.concatenate([one.slopes(u_cpp, v_cpp) @ one.root, off[:, None]], axis=1)
            parts.append(math.sqrt(one.weight) * own)
        found = self.birge_ratio * np.concatenate(parts, axis=1)
        found[(u_cpp == 0) & (v_cpp == 0)] = 0.0
        return np.asarray(found)


def combine_curves(
    curves: Sequence[PlaneCurve],
    *,
    detector_px: tuple[float, float] = (1.0, 1.0),
    forms: Sequence[tuple[str, ...]] = FORMS,
) -> CombinedFit:
    """Fit every form to all curves, with departures of several sizes, and average.

    Each is weighted by its evidence, parameters and departure integrated out, so that a smear, a
    halo or a departure enters as far as the curves show it; where they cannot tell forms apart,
    the difference between them is part of the uncertainty (MacKay, Information Theory, Inference,
    and Learning Algorithms, 2003, chapter 28).

    Parameters
    ----------
    curves : sequence of PlaneCurve
    detector_px : (float, float), optional
        Width of the detector across and along.
    forms : sequence of tuples of str, optional
        Terms of the forms that are tried.
    """
    data = WhitenedCurves([one.centred() for one in curves])
    nowhere = np.zeros((data.values.size, 0))
    plain = [_fit_form(data, SensorForm(terms, detector_px), None, 0.0, nowhere) for terms in forms]
    first = min(plain, key=lambda one: one.score)
    departure = Departure(first.form, tuple(first.parameters.tolist()))
    ways = data.of(departure.directions(data.u_cpp, data.v_cpp))
    likely = sorted(plain, key=lambda one: one.score)[:_MOST_DEPARTED]
    fits = plain + [
        _fit_form(data, start.form, start, share, share * ways)
        for share in _SHARES[1:]
        for start in likely
    ]
    weighted = _weighted([replace(one, departure=departure) for one in fits])
    simplest = min(plain, key=lambda one: len(one.form.terms))
    total, members = _chi_squares(data, weighted, _shapes(data, simplest))
    return CombinedFit(tuple(data.curves), weighted, total, members, _chi_squares(data, [first])[0])


def _weighted(fits: Sequence[FormFit]) -> tuple[FormFit, ...]:
    """Fits with their share in the mean, the largest first; what hardly counts is left out."""
    best = min(one.score for one in fits)
    odds = {id(one): math.exp(-0.5 * (one.score - best)) for one in fits}
    kept = sorted((one for one in fits if odds[id(one)] > _LEAST_WEIGHT), key=lambda one: one.score)
    whole = sum(odds[id(one)] for one in kept)
    return tuple(replace(one, weight=odds[id(one)] / whole) for one in kept)


def _mean_otf(forms: Sequence[FormFit], u: Floats, v: Floats) -> Complexes:
    return np.asarray(sum(one.weight * one.otf(u, v) for one in forms))


def _fit_form(
    data: WhitenedCurves, form: SensorForm, start: FormFit | None, share: float, ways: Floats
) -> FormFit:
    """The parameters of largest posterior density, the departure integrated out."""
    mean, spread = form.mean, form.spread
    # (1 + ways ways^T)^(-1/2), by the singular values of ways.
    left, singular, _ = np.linalg.svd(ways, full_matrices=False)
    damping = 1 / np.sqrt(1 + singular**2) - 1

    def damped(values: Floats) -> Floats:
        return np.asarray(values + (left * damping) @ (left.T @ values))

    def residual(p: Floats) -> Floats:
        off = data.values - data.of(form.otf(p, data.u_cpp, data.v_cpp))
        return np.concatenate([damped(off), (p - mean) / spread])

    def slopes(p: Floats) -> Floats:
        by_p = data.of(form.slopes(p, data.u_cpp, data.v_cpp))
        return np.concatenate([-damped(by_p), np.diag(1 / spread)])

    found = min(
        (
            least_squares(
                residual, first, jac=slopes, method="lm", xtol=1e-6, ftol=1e-6, max_nfev=60
            )
            for first in ([start.parameters] if start is not None else _likely(form, residual))
        ),
        key=lambda one: float(one.cost),
    )
    p = np.asarray(found.x)
    off = data.values - data.of(form.otf(p, data.u_cpp, data.v_cpp))
    by_p = data.of(form.slopes(p, data.u_cpp, data.v_cpp))
    design = np.concatenate([by_p, ways], axis=1)
    normal = design.T @ design
    normal += np.diag(np.concatenate([spread**-2.0, np.ones(ways.shape[1])]))
    inverse = np.linalg.inv(normal)
    moved = design @ inverse
    value, vector = np.linalg.eigh(inverse + moved.T @ data.shared @ moved)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    # The directions' weights are counted in units of the share.
    scale = np.concatenate([np.ones(p.size), np.full(ways.shape[1], share)])
    amounts = np.linalg.solve(normal[p.size :, p.size :], ways.T @ off)
    # Laplace: what the priors of parameters and directions lose by being narrowed.
    whole = np.concatenate([spread, np.ones(ways.shape[1])])
    narrowed = np.linalg.slogdet(whole[:, None] * normal * whole)[1]
    score = 2 * float(found.cost) + float(narrowed)
    nothing = Departure(form, tuple(p.tolist()))
    return FormFit(
        form, share, nothing, p, share * amounts, scale[:, None] * inverse * scale,
        scale[:, None] * root, score, 1.0,
    )  # fmt: skip


def _likely(form: SensorForm, residual: Callable[[Floats], Floats]) -> list[Floats]:
    """The starts that fit best."""
    return sorted(_starts(form), key=lambda p: float(np.sum(residual(p) ** 2)))[:_STARTS_TRIED]


def _starts(form: SensorForm) -> list[Floats]:
    """Where to begin: none of a smear or a trail is stationary, and they have directions."""
    found = [form.mean]
    for name, ways in (("smear", _SMEAR_STARTS), ("trail", _TRAIL_STARTS)):
        if name in form.terms:
            at = SensorForm(form.terms[: form.terms.index(name)]).mean.size
            found = [_with(start, at, way) for start in found for way in ways]
    return found


def _with(start: Floats, at: int, way: tuple[float, float]) -> Floats:
    moved = start.copy()
    moved[at : at + 2] = way
    return moved


def _chi_squares(
    data: WhitenedCurves, forms: Sequence[FormFit], ways: Floats | None = None
) -> tuple[ChiSquare, tuple[ChiSquare, ...]]:
    """Chi-square of all curves and of each, with the mean and the variance they should have.

    Whitened errors e of covariance S leave the residuals ``M e``, M taking out what the
    parameters follow; a sum of their squares over a curve has the mean ``tr(P M S M)`` and the
    variance ``2 tr((P M S M)^2)``, P choosing the curve, and of each curve the `ways` (n, k) that
    are looked at: a prior makes errors in other directions smaller than their deviations.
    """
    best = forms[0]
    slopes = data.of(best.slopes(data.u_cpp, data.v_cpp))
    residual = data.values - data.of(_mean_otf(forms, data.u_cpp, data.v_cpp))
    left = np.eye(residual.size) - slopes @ best.inverse @ slopes.T
    covariance = left @ data.covariance @ left.T
    axes = [np.eye(residual.size)[:, part] for part in data.parts]
    if ways is not None:
        axes = [own @ _span(ways[part]) for own, part in zip(axes, data.parts, strict=True)]
    members = tuple(_chi_square(own.T @ residual, own.T @ covariance @ own) for own in axes)
    whole = np.concatenate(axes, axis=1)
    return _chi_square(whole.T @ residual, whole.T @ covariance @ whole), members


def _span(ways: Floats) -> Floats:
    """Orthonormal axes of the directions some vectors span, the faint ones left out, (n, k)."""
    # A curve exactly across sees nothing of a smear along.
    length = np.linalg.norm(ways, axis=0)
    seen = length > 1e-9 * length.max()
    left, size, _ = np.linalg.svd(ways[:, seen] / length[seen], full_matrices=False)
    return np.asarray(left[:, size > _FAINT * size[0]])


def _shapes(data: WhitenedCurves, simplest: FormFit) -> Floats:
    """How curves of sensors differ: in width, smear, halo and trail, (n, k).

    About the Gaussian of the simplest form: that of another may be half a sensor, as behind an
    unsharp mask.
    """
    form = SensorForm(("gaussian", "smear", "halo", "trail"), simplest.form.detector_px)
    at = form.mean.copy()
    at[:3] = simplest.parameters[:3]
    at[3:5] = 0.5
    return data.of(form.slopes(at, data.u_cpp, data.v_cpp))


def _chi_square(residual: Floats, covariance: Floats) -> ChiSquare:
    return ChiSquare(
        float(residual @ residual), float(np.trace(covariance)), 2 * float(np.sum(covariance**2))
    )
