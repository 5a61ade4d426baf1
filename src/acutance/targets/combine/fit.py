"""One parametric optical transfer function (OTF) of many measurements: least squares."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.combine.correction import Correction
from acutance.targets.combine.curves import ChiSquare, OtfSamples, WhitenedCurves
from acutance.targets.combine.form_fit import FIRST_STEPS, FormFit, Start, fit_forms, likely_starts
from acutance.targets.combine.forms_on_plane import FormsOnPlane
from acutance.targets.combine.lit_curves import LitCurves
from acutance.targets.combine.sensor_forms import FORMS, SensorForm
from acutance.targets.combine.weighted_forms import CombinedOtf, WeightedForm

__all__ = ["CombinedFit", "FormFit", "combine_curves"]

Complexes = NDArray[np.complex128]

_MIN_WEIGHT = 0.01
_MIN_SINGULAR = 0.1
_MAX_CORRECTED = 3
_HOPELESS = 60.0
"""Of scores above the least, after the first steps: no form beyond it gets any weight (of 390 forms
fitted to the edges of scenes, those that did were within 12; after 22 steps they were not)."""
_SHARES = (0.0, 0.01, 0.03, 0.1, 0.3)
"""Standard deviations tried for the correction of a form, shares of the logarithm of the OTF."""


@dataclass(frozen=True, eq=False)
class CombinedFit:
    """All forms fitted to all curves, and whether they agree.

    Parameters
    ----------
    data : WhitenedCurves
    forms : tuple of FormFit
        The one of largest weight first.
    plain_form : FormFit
        The best form without a correction.
    simplest : FormFit
        The one of fewest terms.
    near : tuple of FormFit
        Where the forms of curves that hardly differ begin: those in the mean, and of every one the
        form in any direction.
    """

    data: WhitenedCurves
    forms: tuple[FormFit, ...]
    plain_form: FormFit
    simplest: FormFit
    near: tuple[FormFit, ...]

    @cached_property
    def otf(self) -> CombinedOtf:
        """The mean over forms, widened as far as the curves disagree."""
        return replace(self.unwidened, birge_ratio=self.total.birge_ratio)

    @cached_property
    def unwidened(self) -> CombinedOtf:
        """The mean over forms, as of curves that agree."""
        names = [field.name for field in fields(WeightedForm)]
        light = [WeightedForm(*(getattr(one, name) for name in names)) for one in self.forms]
        return CombinedOtf(tuple(light), 1.0)

    @property
    def total(self) -> ChiSquare:
        """Chi-square of all curves together about the mean over forms, in what sensors differ by.

        By width, smear, halo and trail: whether the curves agree.
        """
        return self._agreement[0]

    @property
    def members(self) -> tuple[ChiSquare, ...]:
        """The same of each curve."""
        return self._agreement[1]

    @cached_property
    def _agreement(self) -> tuple[ChiSquare, tuple[ChiSquare, ...]]:
        return _chi_squares(self.data, self.forms, _shapes(self.data, self.simplest))

    @cached_property
    def plain(self) -> ChiSquare:
        """Of all curves about the best plain form: whether a plain sensor explains them."""
        return _chi_squares(self.data, [self.plain_form])[0]


def combine_curves(
    curves: Sequence[OtfSamples],
    *,
    detector_px: tuple[float, float] = (1.0, 1.0),
    forms: Sequence[tuple[str, ...]] = FORMS,
    near: Sequence[WeightedForm] = (),
) -> CombinedFit:
    """Fit every form to all curves, with corrections of several sizes, and average.

    Each is weighted by its marginal likelihood, parameters and correction integrated out, so that a
    smear, a halo or a correction enters as far as the curves show it; where the curves do not
    separate two forms, the difference between them is part of the uncertainty (MacKay, Information
    Theory, Inference, and Learning Algorithms, 2003, chapter 28).

    Parameters
    ----------
    curves : sequence of OtfSamples
    detector_px : (float, float), optional
        Width of the detector across and along.
    forms : sequence of tuples of str, optional
        Terms of the forms that are tried.
    near : sequence of WeightedForm, optional
        Of curves that hardly differed, the largest weight first: where a form begins, too.
        Forms with defocus and a kernel have several optima.
    """
    data = WhitenedCurves([one.centred() for one in curves])
    plain = _settled(data, [(SensorForm(terms, detector_px), None) for terms in forms], near)
    first = min(plain, key=lambda one: one.score)
    correction = Correction(first.form, tuple(first.parameters.tolist()))
    aligned = [pair for one in _weighted(plain) for pair in one.form.aligned(one.parameters)]
    fits = [*plain, *_settled(data, aligned, near)]
    ways = LitCurves(data, first.otf_on(data.plane)).of(correction.directions_on(data.plane).T).T
    last = sorted(fits, key=lambda one: one.score)[:_MAX_CORRECTED]
    for share in _SHARES[1:]:
        # A larger correction moves the form on from where a smaller one left it.
        before, last = last, fit_forms(data, [one.start for one in last], share, share * ways)
        fits += last
        # Scores have one least: what no correction of some size explains, no larger one does.
        last = [
            one
            for one, smaller in zip(last, before, strict=True)
            if one.score <= smaller.score - 2 * math.log(_MIN_WEIGHT)
        ]
        if not last:
            break
    weighted = _weighted([replace(one, correction=correction) for one in fits])
    simplest = min(plain, key=lambda one: len(one.form.terms))
    kept = {one.form.oblique_terms for one in weighted}
    origins = [one for one in plain if one.form.terms in kept]
    return CombinedFit(data, weighted, first, simplest, (*weighted, *origins))


def _settled(
    data: WhitenedCurves,
    forms: Sequence[tuple[SensorForm, Floats | None]],
    near: Sequence[WeightedForm],
) -> list[FormFit]:
    """Forms without a correction, from known places, or else from guesses; hopeless ones are left
    after the first steps."""
    if not forms:
        return []
    nowhere = np.zeros((data.values.size, 0))
    starts: dict[SensorForm, list[Floats]] = {form: [] for form, _ in forms}
    for one in near:
        # The first one counts: it has the largest weight.
        if one.form in starts and not starts[one.form]:
            starts[one.form].append(one.parameters)
    unknown = [form for form, start in forms if start is None]
    guesses = dict(zip(unknown, likely_starts(data, unknown), strict=True))
    for form, start in forms:
        starts[form] += guesses[form] if start is None else [start]
    fits = fit_forms(data, _pairs(starts), 0.0, nowhere, FIRST_STEPS)
    least = min(one.score for one in fits)
    hopeful = [one.start for one in fits if one.score < least + _HOPELESS]
    again = {one.form: one for one in fit_forms(data, hopeful, 0.0, nowhere)}
    return [again.get(one.form, one) for one in fits]


def _pairs(starts: Mapping[SensorForm, Sequence[Floats]]) -> list[Start]:
    return [(form, p) for form, own in starts.items() for p in own]


def _weighted(fits: Sequence[FormFit]) -> tuple[FormFit, ...]:
    """Fits with their share in the mean, the largest first; negligible ones are left out."""
    best = min(one.score for one in fits)
    odds = {id(one): math.exp(-0.5 * (one.score - best)) for one in fits}
    kept = sorted((one for one in fits if odds[id(one)] > _MIN_WEIGHT), key=lambda one: one.score)
    whole = sum(odds[id(one)] for one in kept)
    return tuple(replace(one, weight=odds[id(one)] / whole) for one in kept)


def _chi_squares(
    data: WhitenedCurves, forms: Sequence[FormFit], shapes: Complexes | None = None
) -> tuple[ChiSquare, tuple[ChiSquare, ...]]:
    """Chi-square of all curves and of each, with the mean and the variance they should have.

    Whitened errors e of covariance S leave the residuals ``M e``, M taking out what the
    parameters follow; a sum of their squares over a curve has the mean ``tr(P M S M)`` and the
    variance ``2 tr((P M S M)^2)``, P choosing the curve, and of each curve the `shapes` (n, k)
    that are judged: a prior makes errors in other directions smaller than their deviations. What
    forms miss of a curve that is a mean over others is beside S.
    """
    best = forms[0]
    near = LitCurves(data, FormsOnPlane(forms, data.plane).mean)
    residual = near.residual
    slopes = near.of(best.slopes_on(data.plane).T).T
    inverse = np.linalg.inv(slopes.T @ slopes + np.diag(best.prior_std**-2.0))
    left = near.apart(np.eye(residual.size)) - slopes @ inverse @ slopes.T
    covariance = left @ data.covariance @ left.T + data.missed
    axes = [np.eye(residual.size)[:, part] for part in data.parts]
    if shapes is not None:
        ways = near.of(shapes.T).T
        axes = [own @ _span(ways[part]) for own, part in zip(axes, data.parts, strict=True)]
    members = tuple(_chi_square(own.T @ residual, own.T @ covariance @ own) for own in axes)
    whole = np.concatenate(axes, axis=1)
    return _chi_square(whole.T @ residual, whole.T @ covariance @ whole), members


def _span(ways: Floats) -> Floats:
    """Orthonormal axes of the directions some vectors span, the faint ones left out, (n, k)."""
    # A curve exactly across does not depend on a smear along.
    length = np.linalg.norm(ways, axis=0)
    if not length.any():  # A curve whose pixels tell nothing.
        return np.zeros((len(ways), 0))
    seen = length > 1e-9 * length.max()
    left, size, _ = np.linalg.svd(ways[:, seen] / length[seen], full_matrices=False)
    return np.asarray(left[:, size > _MIN_SINGULAR * size[0]])


def _shapes(data: WhitenedCurves, simplest: FormFit) -> Complexes:
    """How OTFs of sensors differ: in width, smear, halo and trail, (n, k).

    About the Gaussian of the simplest form: that of another may be half a sensor, as behind an
    unsharp mask.
    """
    form = SensorForm(("gaussian", "smear", "halo", "trail"), simplest.form.detector_px)
    at = form.mean.copy()
    found = simplest.form.numbers(simplest.parameters)
    if "sigma_across_px" in found:
        at[:2] = math.log(found["sigma_across_px"]), math.log(found["sigma_along_px"])
        at[2] = math.atanh(found.get("correlation", 0.0))
    at[3:5] = 0.5
    return form.slopes_on(at, data.plane)


def _chi_square(residual: Floats, covariance: Floats) -> ChiSquare:
    return ChiSquare(
        float(residual @ residual), float(np.trace(covariance)), 2 * float(np.sum(covariance**2))
    )
