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


@dataclass(frozen=True, eq=False)
class PixelsAlone(ShortRepr):
    """A normal posterior of the PSF and the prior that it has, by the directions of the PSF.

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
        """From the solution for all unknowns, of which the first are those of the PSF."""
        own = posterior.factor[:size, : posterior.beta.size]
        return cls(posterior.beta[:size], own, posterior.prior_std[:size], errors[:size])

    def likelihood(self, model: PsfModel, u_cpp: Floats, v_cpp: Floats) -> OtfLikelihood:
        """The likelihood of the OTF about the reported one.

        Parameters
        ----------
        model : PsfModel
            The reported PSF.
        u_cpp, v_cpp : (n,) arrays
            Frequencies of the OTF.
        """
        rows = replace(model, latent=np.eye(self.mean.size)).factor(u_cpp, v_cpp)
        found = OtfLikelihood.of_posterior(
            rows @ self.mean, rows @ self.factor, rows * self.prior_std
        )
        about = found.about(rows @ (model.weights - self.mean))
        return about.with_errors(rows @ self.errors)
