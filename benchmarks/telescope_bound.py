"""How well a population of telescopes can be measured at all: the Bayesian bound of an edge.

Who knows the population that a sensor was drawn from cannot do better, in the root mean square
over it, than the mean of the posterior. It is found by importance sampling: many telescopes of the
population are drawn, and each counts by the likelihood of the edge's pixels behind it. The edge's
direction is known; its two levels and its place are not: they enter the image linearly (the place
about the true one, which it misses by a hundredth of a pixel) and are integrated out.

Nobody knows the population of telescopes that a sensor was drawn from. The same of all families of
`acutance.optics` is the bound of who knows no more than that it is one of these.

The optical transfer functions (OTF) of all drawn sensors lie close to a space of a few dozen
dimensions. Products of its edge spread functions over the pixels are formed once an image, and a
likelihood is a quadratic form of few coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from acutance import optics
from acutance.curves.grid import Floats
from acutance.optics.population import UNEVEN_FAMILIES
from acutance.simulate import Truth
from acutance.targets.straight.tuned import FAMILY_WEIGHTS

HIGHEST_CPP, STEP_CPP = 2.4, 1 / 256
"""No aperture passes more; the step makes images repeat after 256 px."""
FAMILIES = {
    name: FAMILY_WEIGHTS.get(name, 1.0) for name in optics.FAMILIES if name not in UNEVEN_FAMILIES
}
"""How often each is drawn, as the estimator expects them; uneven ones have no real OTF."""
ANGLE_DEG = (5.0, 20.0)
_FREQ_CPP = np.arange(round(HIGHEST_CPP / STEP_CPP) + 1) * STEP_CPP
_NEGLIGIBLE = 1e-5
"""Directions of OTFs below this share of the largest are left out."""


def draw_aperture(rng: np.random.Generator) -> optics.Block:
    """An aperture of .9 to 1.6 c/px, obscured by .2 to .4, up to .3 waves out of focus."""
    cutoff_cpp, obscuration = rng.uniform(0.9, 1.6), rng.uniform(0.2, 0.4)
    return optics.Defocus(rng.uniform(0.0, 0.3), cutoff_cpp, obscuration)


def draw_blur(rng: np.random.Generator) -> list[optics.Block]:
    """Jitter of .05 to .35 px, smear up to 1 px both ways, diffusion of charge, and a pixel."""
    return [
        optics.Gaussian(rng.uniform(0.05, 0.35)),
        optics.Smear(rng.uniform(0.0, 1.0), "across"),
        optics.Smear(rng.uniform(0.0, 1.0), "along"),
        optics.ChargeDiffusion(rng.uniform(0.1, 0.5), 1.0),
        optics.Detector(),
    ]


def _some_direction(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Frequencies along a random direction."""
    angle = np.deg2rad(rng.uniform(*ANGLE_DEG))
    return _FREQ_CPP * np.cos(angle), _FREQ_CPP * np.sin(angle)


class Posterior(NamedTuple):
    """What pixels and population say of the MTF at Nyquist.

    Attributes
    ----------
    mean, std : float
    effective : float
        Effective number of drawn sensors.
    """

    mean: float
    std: float
    effective: float


@dataclass(frozen=True, eq=False)
class Population:
    """Sensors drawn at random, each seen along a random direction.

    Attributes
    ----------
    otf : (F, r) array
        The directions of OTFs at the frequencies k STEP_CPP, k = 0 to F - 1.
    share : (K, r) array
        Of every sensor in these directions.
    nyquist : (K,) array
        MTF of every sensor at .5 c/px.
    """

    otf: Floats
    share: Floats
    nyquist: Floats

    @classmethod
    def drawn(cls, apertures: int, blurs: int, rng: np.random.Generator) -> Population:
        """Telescopes of some apertures, each with some blurs of its own."""
        drawn = []
        for _ in range(apertures):
            aperture = draw_aperture(rng).otf(_FREQ_CPP, np.zeros_like(_FREQ_CPP)).real
            for _ in range(blurs):
                place = _some_direction(rng)
                factors = [np.real(block.otf(*place)) for block in draw_blur(rng)]
                drawn.append(aperture * np.prod(factors, axis=0))
        return cls._of(np.array(drawn))

    @classmethod
    def of_families(cls, count: int, rng: np.random.Generator) -> Population:
        """Sensors of all families, as often as the estimator expects them (`FAMILIES`)."""
        often = np.array(list(FAMILIES.values())) / sum(FAMILIES.values())
        names = rng.choice(list(FAMILIES), count, p=often)
        sensors = (optics.draw_sensor(name, rng) for name in names)
        return cls._of(np.array([np.real(one.otf(*_some_direction(rng))) for one in sensors]))

    @classmethod
    def _of(cls, otf: Floats) -> Population:
        power, axes = np.linalg.eigh(otf.T @ otf)
        kept = axes[:, power > _NEGLIGIBLE**2 * power[-1]]
        nyquist = np.abs(otf[:, round(0.5 / STEP_CPP)])
        return cls(kept, otf @ kept, nyquist)

    def posterior(self, image: Floats, truth: Truth, noise: float) -> Posterior:
        """The posterior of the MTF at Nyquist, from the pixels of an edge.

        Parameters
        ----------
        image : (rows, cols) array
        truth : Truth
            Its line is known, its levels are not.
        noise : float
            Standard deviation of the noise.
        """
        distance_px = truth.line.normal_distance(*np.indices(image.shape)).ravel()
        log_likelihood = self._log_likelihood(distance_px, image.ravel() / noise)
        weight = np.exp(log_likelihood - log_likelihood.max())
        weight /= weight.sum()
        mean = float(weight @ self.nyquist)
        variance = float(weight @ (self.nyquist - mean) ** 2)
        return Posterior(mean, np.sqrt(variance), 1 / float(weight @ weight))

    def _log_likelihood(self, distance_px: Floats, value: Floats) -> Floats:
        """Of every sensor, (K,), for pixels of unit noise; levels and place integrated out."""
        esf, lsf = self._images(distance_px)
        level = np.ones_like(value)
        middle = value - value.mean()
        # Products of the regressors 1, E (ESF less one half) and L (LSF), and with the pixels.
        share, count = self.share, float(value.size)
        products = np.empty((len(share), 3, 3))
        products[:, 0, 0] = count
        products[:, 0, 1] = products[:, 1, 0] = share @ (level @ esf)
        products[:, 0, 2] = products[:, 2, 0] = share @ (level @ lsf)
        for row, col, one, other in ((1, 1, esf, esf), (1, 2, esf, lsf), (2, 2, lsf, lsf)):
            quadratic = np.sum((share @ (one.T @ other)) * share, axis=1)
            products[:, row, col] = products[:, col, row] = quadratic
        with_pixels = np.stack(
            [np.zeros(len(share)), share @ (middle @ esf), share @ (middle @ lsf)], axis=1
        )
        fitted = np.linalg.solve(products, with_pixels[:, :, None])[:, :, 0]
        explained = np.sum(fitted * with_pixels, axis=1)
        return 0.5 * (explained - np.linalg.slogdet(products)[1])

    def _images(self, distance_px: Floats) -> tuple[Floats, Floats]:
        """ESF less one half, and LSF, of every direction of OTFs at the pixels, (n, r) each."""
        weight = np.where(_FREQ_CPP == 0, 0.5, 1.0) * STEP_CPP
        cycles = distance_px[:, None] * _FREQ_CPP
        esf = (2 * distance_px[:, None] * np.sinc(2 * cycles) * weight) @ self.otf
        lsf = (2 * np.cos(2 * np.pi * cycles) * weight) @ self.otf
        return esf, lsf
