"""The result of the joint fit of point sources: their common PSF, and every source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior
from acutance.numerics.noise import Correlation
from acutance.targets.points import tuned
from acutance.targets.points.pads import Pads
from acutance.targets.points.pixels_alone import PixelsAlone
from acutance.targets.points.psf import PsfModel
from acutance.targets.points.stamps import Stamps

__all__ = ["PointsFit"]


@dataclass(frozen=True, eq=False)
class PointsFit:
    """Sources and their common PSF.

    Parameters
    ----------
    stamps : Stamps
        The pixels used.
    model : PsfModel
        The PSF with its covariance.
    places, places_std : (k, 2) arrays
        Sources as (row, col).
    fluxes, fluxes_std : (k,) arrays
        Light of each, summed over all pixels of the plane.
    backgrounds : (k, 3) array
        Background at the pixel nearest to a source, and its slopes down and to the right per px.
    backgrounds_std : (k,) array
        Standard deviation of the background.
    light, fitted : (n,) arrays
        What its own source, and the model as a whole, gives every pixel.
    noise : float
        Standard deviation of the background's noise.
    gain : float
        Variance of the noise per unit of light, 0 where the noise does not grow with it.
    correlation : Correlation
        Of the noise between neighbouring pixels.
    pads : Pads, optional
        Pads under the sources, where the pixels ask for them.
    families : mapping of str to float
        Probability of every family of sensors, and that it is another sensor.
    posterior : Posterior, optional
        The solution by the normal prior, of which the first unknowns are those of the PSF.
    doubt : (m, j) array, optional
        Further errors of its unknowns, that the prior has no part in.
    """

    stamps: Stamps
    model: PsfModel
    places: Floats
    places_std: Floats
    fluxes: Floats
    fluxes_std: Floats
    backgrounds: Floats
    backgrounds_std: Floats
    light: Floats
    fitted: Floats
    noise: float
    gain: float
    correlation: Correlation
    pads: Pads | None = None
    families: Mapping[str, float] = field(default_factory=dict)
    posterior: Posterior | None = None
    doubt: Floats | None = None

    @cached_property
    def pixels_alone(self) -> PixelsAlone | None:
        """What the pixels say of the PSF, the prior apart."""
        if self.posterior is None or self.doubt is None:
            return None
        return PixelsAlone.of(self.posterior, self.model.weights.size, self.doubt)

    @property
    def residual(self) -> Floats:
        """What the model leaves of every pixel, (n,)."""
        return self.stamps.value - self.fitted

    @property
    def pixel_noise(self) -> Floats:
        """Standard deviation of every pixel's noise, (n,)."""
        return np.sqrt(self.noise**2 + self.gain * np.maximum(self.light, 0.0))

    @property
    def standard_residual(self) -> Floats:
        """Residuals over noise and what the model may miss of the light, (n,)."""
        return self.residual / np.hypot(self.pixel_noise, tuned.MODEL_ERROR * self.light)

    @property
    def peaks(self) -> Floats:
        """What each source would add to a pixel right under it, (k,)."""
        origin = np.zeros(1)
        return self.fluxes * float(self.model.psf(origin, origin)[0])
