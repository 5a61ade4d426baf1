"""Pads: the mounts that mirrors stand on, brighter or darker than the ground around them.

The light of a pad has the same place as that of its source and nearly its width, so the two are
told apart by little: the pad ends at its borders, the wings of a PSF do not. Whether pads of one
common size and level are part of the model is decided by the marginal likelihood; where they are,
what is not known of their level enters the deviations of the PSF.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.numerics.marginal_likelihood import Posterior, Prior
from acutance.targets.points.amplitudes import likelier_posterior, posterior_log_evidence
from acutance.targets.points.per_source import SourceProblem
from acutance.targets.points.stamps import Stamps

__all__ = ["Pads", "log_evidence_of_pads", "pads_image"]


@dataclass(frozen=True, eq=False)
class Pads(ShortRepr):
    """Square pads under all sources.

    Parameters
    ----------
    side_px : float
        Their side; the likeliest one of some.
    contrast : Estimate
        Their level above the ground around, in image units.
    """

    side_px: float
    contrast: Estimate

    @classmethod
    def of(cls, side_px: float, posterior: Posterior) -> Pads:
        """Pads whose contrast is the last of a posterior's unknowns."""
        std = float(np.sqrt(posterior.factor[-1] @ posterior.factor[-1]))
        return cls(side_px, Estimate(float(posterior.beta[-1]), std))

    def to_dict(self) -> dict[str, Any]:
        """Side and contrast, for JSON."""
        return {"side_px": self.side_px, "contrast": self.contrast.to_dict()}


def pads_image(stamps: Stamps, places: Floats, blur: GaussianPixel2d, side_px: float) -> Floats:
    """What pads of unit contrast under all sources give every pixel, (n,).

    They are seen through the blur, its ellipse taken as upright.
    """
    x, y = stamps.all_offsets(places)
    own = _profile(x, side_px, math.sqrt(blur.xx)) * _profile(y, side_px, math.sqrt(blur.yy))
    return stamps.summed(np.ones(places.shape[0]), own)


def _profile(distance: Floats, side_px: float, sigma_px: float) -> Floats:
    """A strip of unit height across, seen through a pixel and a Gaussian."""
    blur = GaussianPixel(sigma_px)
    return blur.esf(distance + 0.5 * side_px) - blur.esf(distance - 0.5 * side_px)


def log_evidence_of_pads(
    problem: SourceProblem,
    images: Sequence[Floats],
    contrast_std: float,
    weight: Floats,
    prior: Prior,
    found: Posterior,
    inflation: float,
) -> Floats:
    """How much likelier the pixels are with pads than without, as logarithms.

    Parameters
    ----------
    problem : SourceProblem
        That of the fit without pads.
    images : sequence of (n,) arrays
        As `pads_image` gives them for some sides.
    contrast_std : float
        Prior standard deviation of the contrast, in image units.
    weight : (n,) array
        Inverse variances of the pixels, 1 on the background.
    prior, found, inflation
        Prior, solution and correlation of the noise of the fit without pads.
    """
    more = replace(
        prior,
        block=np.append(prior.block, -1.0),
        scale=np.append(prior.scale, contrast_std),
        mean=np.append(prior.mean, 0.0),
    )
    without = posterior_log_evidence(problem.eliminated(weight).normal, prior, found, inflation)
    gains = []
    for image in images:
        wider = replace(problem, shared=np.hstack([problem.shared, image[:, None]]))
        normal = wider.eliminated(weight).normal
        tried = likelier_posterior(normal, more, found.variance, inflation, None)
        gains.append(posterior_log_evidence(normal, more, tried, inflation) - without)
    return np.array(gains)
