"""What the pixels of a straight target say of its transfer function (OTF), the prior apart.

The likelihood is the posterior over a prior that is broad. Over a narrow one it would be a small
difference of large numbers: a sharpened sensor lies many of its deviations away in directions that
it hardly leaves open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.small_matrices import lower_inverse, lower_square
from acutance.targets.otf_likelihood import OtfLikelihood
from acutance.targets.straight.lsf import LsfModel

__all__ = ["PixelsAlone"]


@dataclass(frozen=True, eq=False)
class PixelsAlone(ShortRepr):
    """The equations of a linear model of the line spread function (LSF), in n unknowns.

    All other unknowns of the fit are integrated out.

    Attributes
    ----------
    blur : GaussianPixel
        The first fit, which the unknowns correct.
    level : float
        Height of its step, in image units.
    columns : (c, n) array
        Spline and tail of the LSF by the unknowns.
    information : (n, n) array
        Inverse covariance of the unknowns by the pixels alone.
    projection : (n,) array
        The same times the values they have by the pixels alone.
    prior_mean : (n,) array
    prior : (n, n) array
        Covariance of a prior, broad in the LSF.
    """

    blur: GaussianPixel
    level: float
    columns: Floats
    information: Floats
    projection: Floats
    prior_mean: Floats
    prior: Floats

    def likelihood(self, freq_cpp: Floats, gain: Floats) -> OtfLikelihood:
        """The likelihood of the OTF.

        Parameters
        ----------
        freq_cpp : (n,) array
            Above zero.
        gain : (n,) array
            By how much the OTF of the sensor exceeds that of the image.
        """
        prior_root = np.asarray(np.linalg.cholesky(self.prior), float)
        known = lower_square(lower_inverse(prior_root))
        lower = np.asarray(np.linalg.cholesky(self.information + known), float)
        root = lower_inverse(lower).T
        unknowns = root @ (root.T @ (self.projection + known @ self.prior_mean))
        own, latent = self.columns @ unknowns, self.columns @ root
        model = LsfModel(self.blur, self.level, own[:-1], float(own[-1]), latent)
        spectrum, rows = model.spectrum(np.concatenate([[0.0], freq_cpp]))
        raised = np.concatenate([[1.0], gain])
        rows = raised[:, None] * rows
        return OtfLikelihood.of_posterior(
            raised * spectrum,
            rows @ (own - self.columns @ self.prior_mean),
            rows @ latent,
            rows @ (self.columns @ prior_root),
        )
