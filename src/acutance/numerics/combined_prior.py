"""A prior of coefficients that are sums: what is regressed on, and what is reported, differ.

A model has k functions. Its prior is one of m >= k independent coefficients, among them whole
directions in the functions, such as families of sensors have. The normal equations of the functions
are those of the directions by two small products, so that directions cost no pass over the pixels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior, Prior, regress
from acutance.numerics.normal_equations import Normal

__all__ = ["CombinedPrior"]


@dataclass(frozen=True, eq=False)
class CombinedPrior:
    """Prior of k coefficients as sums of m others that are independent.

    Parameters
    ----------
    prior : Prior
        Of the independent coefficients.
    combination : (k, m) array
        The model's coefficients for every independent one.
    """

    prior: Prior
    combination: Floats

    @property
    def mean(self) -> Floats:
        """Prior mean of the model's coefficients, (k,)."""
        return np.asarray(self.combination @ self.prior.mean)

    def posterior(
        self,
        normal: Normal,
        variance: float,
        inflation: float = 1.0,
        *,
        noise_floor: float | None = None,
        earlier: Posterior | None = None,
    ) -> Posterior:
        """The model's coefficients as the data determine them.

        The first m columns of the factor are those at fixed amplitudes.

        Parameters
        ----------
        normal : Normal
            In the model's coefficients.
        variance, inflation
            As in `acutance.numerics.marginal_likelihood.regress`.
        noise_floor : float, optional
            The smallest noise the arithmetic allows for, instead of the prior's.
        earlier : Posterior, optional
            Solution of nearly the same problem: its amplitudes are the first guess.
        """
        prior = self.prior if noise_floor is None else replace(self.prior, noise_floor=noise_floor)
        found = regress(normal.combined(self.combination), prior, variance, inflation, earlier)
        return replace(
            found, beta=self.combination @ found.beta, factor=self.combination @ found.factor
        )

    def response(self, posterior: Posterior, noise: float) -> Floats:
        """Change of the model's coefficients with the normal equations' right side, (k, k).

        At fixed amplitudes: what these add is no answer to the residuals.
        """
        at_amplitudes = posterior.factor[:, : self.combination.shape[1]]
        return np.asarray(at_amplitudes @ at_amplitudes.T / noise)
