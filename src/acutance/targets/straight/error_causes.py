"""Common causes of error of the curves of one direction: one more of them, or the share of each.

The error of every curve is ``factor @ latent @ z``, with z standard normal and shared by the edge
spread function (ESF), the line spread function (LSF) and the transfer function. A cause is one
column of the factors, or part of the covariance of the latent variables.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np

from acutance.curves import Esf, Lsf, Mtf
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["FitCauses", "with_cause"]

Curve = TypeVar("Curve", Esf, Lsf, Mtf)


def with_cause(curve: Curve, error: Any) -> Curve:
    """A curve with one more cause: a column of its factor, and a latent variable.

    Parameters
    ----------
    curve : Esf, Lsf or Mtf
        With n places.
    error : (n,) array
        What one standard deviation of the cause adds to the curve.
    """
    factor: Any
    if isinstance(curve.factor, np.ndarray):
        factor = np.column_stack([curve.factor, error])
    else:
        factor = curve.factor.with_column(error)
    if curve.latent is None:
        return replace(curve, factor=factor)
    k, m = curve.latent.shape
    latent = np.zeros((k + 1, m + 1))
    latent[:k, :m], latent[k, m] = curve.latent, 1.0
    return replace(curve, factor=factor, latent=latent)


@dataclass(frozen=True, eq=False)
class FitCauses(ShortRepr):
    """The covariance of a linear model, separated by its causes.

    The unknowns stand in this order: the n of the LSF, then those held by a `group` each. The
    factor of their covariance is upper triangular, so its first n columns are what remains open
    when all others are known; each further one is what its unknown adds.

    Parameters
    ----------
    design : (c, n) array
        Columns of the curves' factors by the unknowns of the LSF.
    factor : (n, m + k) array
        Rows of the LSF of the factor of the covariance of all m unknowns; the last k columns are
        the share of the prior's amplitudes.
    information : (n, n) array
        What the pixels say of the unknowns of the LSF where all others are known.
    group : tuple of str
        Terms of the budget that the other m - n unknowns belong to.
    """

    design: Floats
    factor: Floats
    information: Floats
    group: tuple[str, ...]

    def variances(self, rows: Floats) -> dict[str, Floats]:
        """Variances that each cause gives to some numbers, (q,) by term; they add up.

        With all others known, the covariance of the unknowns is C = R R^T, and the pixels'
        information about them J. What the noise propagates into the posterior mean is C J C, as
        its derivative by the pixels is C times theirs; what the prior leaves undetermined is the
        rest: a prior as wide as the data are vague would leave nothing.

        Parameters
        ----------
        rows : (q, c) array
            What the columns of the curves' factors add to the numbers.
        """
        n = self.information.shape[0]
        m = n + len(self.group)
        caused = rows @ self.design @ self.factor
        squares = caused**2
        left_open = squares[:, :n].sum(axis=1)
        by_pixels = caused[:, :n] @ self.factor[:, :n].T
        noise = np.sum(by_pixels @ self.information * by_pixels, axis=1)
        # Of a density with several peaks the covariance may exceed what any of them allows.
        noise = np.minimum(noise, left_open)
        terms, belongs = _memberships(self.group)
        return {
            "pixel_noise": noise,
            "prior_shape": left_open - noise + squares[:, m:].sum(axis=1),
            **dict(zip(terms, (squares[:, n:m] @ belongs).T, strict=True)),
        }


@lru_cache
def _memberships(group: tuple[str, ...]) -> tuple[tuple[str, ...], Floats]:
    """The terms of some unknowns, and which unknown belongs to which, (unknowns, terms)."""
    terms = tuple(dict.fromkeys(group))
    return terms, np.array([[name == term for term in terms] for name in group], float)
