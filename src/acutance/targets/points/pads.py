"""Pads: the mounts that mirrors stand on, brighter or darker than the ground around them.

The light of a pad has the same place as that of its source and nearly its width, so the two are
told apart by little: the pad ends at its borders, the wings of a PSF do not. Whether pads of one
common size and level are part of the model is decided by the marginal likelihood; where they are,
what is not known of their level enters the deviations of the PSF. Where it leaves them open, the
PSF is that of both models, each with its probability.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.gaussian_pixel_2d import GaussianPixel2d
from acutance.numerics.kernel_mixture import Further
from acutance.numerics.marginal_likelihood import Posterior, regress
from acutance.numerics.normal_equations import Normal
from acutance.targets.points import tuned
from acutance.targets.points.among_sensors import AmongSensors, Equations, among_sensors
from acutance.targets.points.per_source import Blocks, SourceProblem
from acutance.targets.points.psf_prior import PsfDirections
from acutance.targets.points.stamps import Stamps

__all__ = ["Pads", "PadsFound", "find_pads", "pads_image"]

_DOUBT: Final = 0.5
"""How much more log evidence a fit with pads may find than was foreseen: of 53 images of eleven
families, with pads and without, more than .05 in two, whose pads gain 9 and were foreseen to gain
7; .1 where nothing is gained."""


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


class PadsFound(NamedTuple):
    """Pads of the likeliest side, beside the fit without them.

    Attributes
    ----------
    side_px : float
    share : float
        Probability of pads, 0 to 1.
    posterior : Posterior
        With pads: their contrast is the last unknown.
    """

    side_px: float
    share: float
    posterior: Posterior

    @property
    def likely(self) -> bool:
        """Whether pads are likelier than none."""
        return self.share > 0.5

    @property
    def sure(self) -> bool:
        """Whether pads belong to the model."""
        return self.share > tuned.SURE_OF_PADS

    def averaged(self, without: Posterior) -> Posterior:
        """The posterior where pads are open: of both models, each with its probability."""
        away = self.posterior.beta[:-1] - without.beta
        doubt = math.sqrt(self.share * (1 - self.share))
        factor = [
            math.sqrt(1 - self.share) * without.factor,
            math.sqrt(self.share) * self.posterior.factor[:-1],
            doubt * away[:, None],
        ]
        return replace(without, beta=without.beta + self.share * away, factor=np.hstack(factor))

    def doubt(self, without: Posterior) -> Floats:
        """What pads would change of all unknowns, times the root of their probability, (m, 1)."""
        return math.sqrt(self.share) * (self.posterior.beta[:-1] - without.beta)[:, None]


def find_pads(
    problem: SourceProblem,
    blocks: Blocks,
    images: Sequence[Floats],
    contrast_std: float,
    weight: Floats,
    without: AmongSensors,
    directions: PsfDirections,
) -> PadsFound | None:
    """The pads that make the pixels likelier, if there are any.

    A square of `tuned.NO_PAD_PX` is hardly a pad: what it explains, a PSF that the prior does not
    foresee explains as well. Pads have to be likelier than that, too.

    Parameters
    ----------
    problem, blocks : SourceProblem, Blocks
        Those of the fit without pads.
    images : sequence of (n,) arrays
        As `pads_image` gives them for `tuned.NO_PAD_PX`, then for every one of
        `tuned.PAD_SIDES_PX`.
    contrast_std : float
        Prior standard deviation of the contrast, in image units.
    weight : (n,) array
        Inverse variances of the pixels, 1 on the background.
    without : AmongSensors
        The fit without pads.
    directions : PsfDirections
        What its first unknowns are.
    """
    pads = replace(problem, shared=np.column_stack(images)).eliminated(weight)
    between = blocks.shared.T @ pads.shared
    foreseen = _foreseen_gains(without, between, pads.normal, contrast_std)
    if foreseen[1:].max() < tuned.PAD_OPEN_LOG_EVIDENCE - _DOUBT:
        return None
    alone, prior, inflation, found = without.equations
    more = replace(
        prior,
        block=np.append(prior.block, -1.0),
        scale=np.append(prior.scale, contrast_std),
        mean=np.append(prior.mean, 0.0),
    )
    kernels = without.kernels

    def beneath(number: int) -> AmongSensors:
        """The fit with pads of one image under the sources."""
        normal = _bordered(alone, between[:, number], pads.normal, number)
        likeliest = regress(normal, more, found.variance, inflation, found)
        equations = Equations(normal, more, inflation, likeliest)
        return among_sensors(equations, directions, kernels)

    tried = [beneath(number) for number in range(1, len(images))]
    gains = [_as_pads(one) - without.log_evidence for one in tried]
    best = int(np.argmax(gains))
    if gains[best] < tuned.PAD_OPEN_LOG_EVIDENCE:
        return None
    gain = gains[best] - max(0.0, beneath(0).log_evidence - without.log_evidence)
    if gain < tuned.PAD_OPEN_LOG_EVIDENCE:
        return None
    share = 1 / (1 + math.exp(min(tuned.PAD_LOG_EVIDENCE - gain, 700.0)))
    return PadsFound(tuned.PAD_SIDES_PX[best], share, tried[best].posterior)


def _foreseen_gains(
    without: AmongSensors, between: Floats, pads: Normal, contrast_std: float
) -> Floats:
    """About what every image gains, `_as_pads`, without solving anything anew, (j,).

    Exact for the noise and the prior amplitudes of the fit without pads: with pads both differ by
    little.
    """
    model, noise = without.model, without.equations.noise
    scaled = between * (contrast_std / noise)
    projection = pads.projection * (contrast_std / noise)
    information = np.diagonal(pads.gram) * (contrast_std**2 / noise)
    likeliest = without.equations.likeliest
    alone = Further(scaled, projection, information)
    precision = alone.precision(_squares(likeliest.factor[:, : likeliest.beta.size].T @ scaled))
    gain = alone.gain(likeliest.beta @ scaled, precision)
    of_others = math.log(max(without.other, 1e-300)) + gain
    if without.mixture is None:
        return of_others
    further = Further(
        model.columns.T @ scaled,
        projection - model.start @ scaled,
        information - _squares(model.others.T @ scaled),
    )
    kernels = without.mixture.seen.kernels
    counted = ~np.isin(kernels.name, tuned.COMPENSATED)[kernels.part]
    counted &= without.likely
    weight = without.mixture.log_weight_with(further, np.flatnonzero(counted))
    of_sensors = np.logaddexp.reduce(weight, axis=(1, 2)) + model.log_evidence
    return np.asarray(np.logaddexp(of_others, of_sensors - without.log_evidence))


def _squares(columns: Floats) -> Floats:
    """Sum of the squares of every column, (j,) of (m, j)."""
    return np.asarray(np.einsum("ij,ij->j", columns, columns))


def _as_pads(among: AmongSensors) -> float:
    """Log evidence of pads under a sensor whose PSF is not compensated.

    The lobes of one that is pass for pads of any level: these are not told from none.
    """
    compensated = sum(among.share.get(family, 0.0) for family in tuned.COMPENSATED)
    return among.log_evidence + math.log(max(1 - compensated, 1e-300))


def _bordered(alone: Normal, between: Floats, pads: Normal, number: int) -> Normal:
    """The normal equations with the contrast of the pads of one image as the last unknown."""
    gram = np.block([[alone.gram, between[:, None]], [between, pads.gram[number, number]]])
    projection = np.append(alone.projection, pads.projection[number])
    return Normal(gram, projection, alone.data, alone.count)
