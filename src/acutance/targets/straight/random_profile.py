"""The mean of noise along a straight target: a random profile, integrated out of the equations.

With A the columns of a target's unknowns and P those of a spline along its normal, whose random
coefficients have the covariance C, the noise of the pixels is white noise of weights W and P C P^T.
Generalised least squares needs their sums alone (the matrix inversion lemma):

    A^T V^-1 A = A^T W A - A^T W P (C^-1 + P^T W P)^-1 P^T W A

With the banded factor L of P^T W P = L L^T the inverse is L^-T (1 - (1 + L^T C L)^-1) L^-1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

from acutance.curves.grid import Floats
from acutance.numerics.banded_matrices import (
    banded_back_substitution,
    banded_factor,
    banded_substitution,
    between_banded_factors,
)
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.coloured_noise import ColouredNoise
from acutance.targets.straight.linear_model import Linear, NoiseModel
from acutance.targets.straight.spline import CELL, CELLS, combine, cubic_weights
from acutance.targets.straight.spline_equations import (
    Stencil,
    products_of_splines,
    products_with_spline,
)

__all__ = ["RandomProfile", "random_profile"]


@dataclass(frozen=True, eq=False)
class RandomProfile:
    """A random profile across a straight target, in a spline over all its pixels.

    Attributes
    ----------
    stencil : pair of (n,) int and (4, n) arrays
        Each pixel's place in the spline.
    own : (k, k) array
        Weighted sums over the pixels of the products of the spline's columns.
    beside : (k, m) array
        Of its columns with those of the equations' unknowns.
    projection : (k,) array
        Of its columns with the pixels' values.
    covariance : (k, k) array
        Of its coefficients, in units of the noise of unit weight.
    """

    stencil: Stencil
    own: Floats
    beside: Floats
    projection: Floats
    covariance: Floats

    def integrated_out(self, normal: Normal, disturbing: Floats) -> Normal:
        """The equations of pixels without what the profile explains.

        Parameters
        ----------
        normal : Normal
            Of the coefficients of the edge spread function (ESF), and q further unknowns.
        disturbing : (q,) array
            Variance of the noise that disturbs those, where that of unit weight is 1.
        """
        explained = self._explained(np.column_stack([self.beside, self.projection]))
        left = _without(normal, explained[:-1, :-1], explained[:-1, -1])
        # What varies along the target: as much of each regressor is noise, at random.
        last = slice(-disturbing.size, None)
        own = np.maximum(normal.gram.diagonal()[last], 1e-300)
        random = np.diag(np.maximum(disturbing - 1, 0.0) / own)
        rows = left.gram[last]
        followed = _gain(rows[:, last], random) @ rows
        return _without(left, rows.T @ followed, followed.T @ left.projection[last])

    def followed(self, rows: Floats) -> Floats:
        """Mean of some rows (k, n) along the target, cell by cell of the spline, at the pixels."""
        cell = self.stencil[0]
        count = np.maximum(np.bincount(cell), 1)
        return np.asarray(np.stack([np.bincount(cell, row) / count for row in rows])[:, cell])

    def likeliest(self, coefficients: Floats) -> Floats:
        """The profile at the pixels under given coefficients of ESF and regressors, (n,)."""
        left = self.projection - self.beside @ coefficients
        known = banded_substitution(self._factor, left[:, None])[:, 0]
        unknown = solve_triangular(self._certainty.T, self._unknown(known), check_finite=False)
        return combine(*self.stencil, banded_back_substitution(self._factor, known - unknown))

    def _explained(self, columns: Floats) -> Floats:
        """What the profile explains of the products of all weighted sums (k, m), (m, m)."""
        known = banded_substitution(self._factor, columns)
        unknown = self._unknown(known)
        return np.asarray(known.T @ known - unknown.T @ unknown)

    def _unknown(self, known: Floats) -> Floats:
        """What the prior leaves open of columns that pixels alone explain, in its own units."""
        return np.asarray(
            solve_triangular(self._certainty, known, lower=True, check_finite=False), float
        )

    @cached_property
    def _factor(self) -> Floats:
        """Bands of the factor of `own`."""
        return banded_factor(self.own)

    @cached_property
    def _certainty(self) -> Floats:
        """Lower factor of ``1 + L^T C L``."""
        prior = between_banded_factors(self._factor, self.covariance)
        return np.asarray(np.linalg.cholesky(prior + np.eye(len(prior))), float)


def random_profile(
    linear: Linear,
    noise: NoiseModel,
    coloured: ColouredNoise,
    weight: Floats,
    columns: Sequence[Floats],
) -> RandomProfile:
    """What noise adds to the profile across a target, where that of unit weight is 1.

    Parameters
    ----------
    linear : Linear
    noise : NoiseModel
        Of both sides.
    coloured : ColouredNoise
        Spectra of either.
    weight : (n,) array
        Of the pixels.
    columns : sequence of (q, n) arrays
        The regressors.
    """
    first_fit, s = linear.first_fit, linear.s
    cell_px, first_px = CELL * first_fit.blur.width_px, float(s.min())
    position = (s - first_px) / cell_px
    cells, stencil = int(position.max()) + 1, cubic_weights(position)
    weighted = (stencil[0], stencil[1] * weight)
    own = products_of_splines(*weighted, *stencil, (cells, cells))
    esf = [products_of_splines(*weighted, *one, (cells, CELLS)) for one in linear.stencils]
    rows = np.concatenate([linear.first_residual[None], *columns])
    others = products_with_spline(weighted, rows, cells)
    reach_px = min(-first_px, float(s.max()))
    length_px = max(np.count_nonzero(np.abs(s) < reach_px) / (2 * reach_px), 1.0)
    share = first_fit.profile.mean(first_fit.blur, first_px + cell_px * np.arange(-1.0, cells + 2))
    return RandomProfile(
        stencil, own, np.hstack([np.sum(esf, axis=0), others[:, 1:]]), others[:, 0],
        coloured.profile_covariance(noise.sides, share, cell_px, length_px),
    )  # fmt: skip


def _without(normal: Normal, gram: Floats, projection: Floats) -> Normal:
    """Equations without what is explained of their sums."""
    return replace(normal, gram=normal.gram - gram, projection=normal.projection - projection)


def _gain(seen: Floats, covariance: Floats) -> Floats:
    """Covariance of random coefficients as pixels leave it that tell so much of them."""
    gain = np.linalg.solve(np.eye(len(seen)) + covariance @ seen, covariance)
    return np.asarray(0.5 * (gain + gain.T))
