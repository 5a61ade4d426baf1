"""What the pixels of point sources say of the sensor's transfer function (OTF), the prior apart."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.marginal_likelihood import Posterior
from acutance.targets.otf_likelihood import OtfLikelihood
from acutance.targets.points.psf import PsfModel

__all__ = ["PixelsAlone"]


_WIDER, _OPEN = 10.0, 0.05
"""The prior divided out: in units of that of the fit, and at least, as a share of the light.
A posterior over a narrow one would be a small difference of large numbers."""
_NO_LIGHT = 1.0
"""Prior standard deviation of the light of a spectrum that is scaled to it."""


@dataclass(frozen=True, eq=False)
class PixelsAlone(ShortRepr):
    """A normal posterior of the PSF over a wide prior, by the directions of the PSF.

    Attributes
    ----------
    mean : (m,) array
        Of the posterior; that of the prior is zero.
    factor : (m, k) array
        Factor of its covariance.
    prior_std : (m,) array
        Standard deviations of the prior.
    errors : (m, j) array
        Further errors that the prior has no part in.
    """

    mean: Floats
    factor: Floats
    prior_std: Floats
    errors: Floats

    @classmethod
    def of(cls, posterior: Posterior, size: int, errors: Floats) -> PixelsAlone:
        """From the solution for all unknowns, of which the first are those of the PSF.

        In units of the fit's prior, the inverse of its covariance loses that prior and gets the
        wide one.
        """
        std = posterior.prior_std[:size]
        wide = np.maximum(_WIDER * std, _OPEN)
        whitened = posterior.factor[:size, : posterior.beta.size] / std[:, None]
        precision = np.linalg.inv(whitened @ whitened.T)
        power, axes = np.linalg.eigh(precision - np.diag(1 - (std / wide) ** 2))
        root = axes / np.sqrt(np.maximum(power, float(np.min(std / wide)) ** 2))
        mean = root @ (root.T @ (precision @ (posterior.beta[:size] / std)))
        return cls(std * mean, std[:, None] * root, wide, errors[:size])

    def likelihood(self, model: PsfModel, u_cpp: Floats, v_cpp: Floats) -> OtfLikelihood:
        """The likelihood of the OTF.

        The light of every source is an unknown of the fit, and the spectrum is scaled to it.

        Parameters
        ----------
        model : PsfModel
            The reported PSF.
        u_cpp, v_cpp : (n,) arrays
            Frequencies of the OTF.
        """
        rows = replace(model, latent=np.eye(self.mean.size)).factor(u_cpp, v_cpp)
        otf = model.otf(u_cpp, v_cpp) + rows @ (self.mean - model.weights)
        scaled = np.zeros((1, self.mean.size))
        prior = np.vstack([scaled, rows * self.prior_std])
        light = np.zeros((len(prior), 1))
        light[0] = _NO_LIGHT
        found = OtfLikelihood.of_posterior(
            np.concatenate([[1.0], otf]),
            np.concatenate([[0.0], rows @ self.mean]),
            np.vstack([np.zeros((1, self.factor.shape[1])), rows @ self.factor]),
            np.hstack([prior, light]),
        )
        return found.with_errors(rows @ self.errors)
