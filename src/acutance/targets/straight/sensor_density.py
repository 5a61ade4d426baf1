"""What sensors there are: a density over thousands drawn at random (`acutance.optics.FAMILIES`).

Departures of line spread functions (LSF) from a Gaussian through a pixel (`learn_lsf`) are written
in a few coordinates c. Within a family f they have a kernel density,

    p(c) = sum_k N(c; c_k, h^2 S_f) / n,

S_f being the family's covariance and c_k its sensors, those of about the same blur. What pixels
say of c is normal: of independent combinations ``K^T c`` the values y, each with an error of one
(K K^T is their information about c). So the posterior is a mixture of normal distributions in
closed form. Kernel k, of covariance ``S = h^2 S_f``, is left with

    weight       N(y; K^T c_k, V),    V = 1 + K^T S K,
    mean         c_k + G (y - K^T c_k),    G = S K V^-1,
    covariance   S - G K^T S

(B. W. Silverman, Density Estimation, 1986, section 4.2, for kernels of a sample's own covariance;
C. M. Bishop, Pattern Recognition and Machine Learning, 2006, section 2.3.3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.straight.tuned import (
    FAMILY_WEIGHTS,
    KERNEL_FLOOR,
    KERNEL_LOG_WIDTH,
    KERNEL_SCALES,
    OTHER_WEIGHT,
)

__all__ = ["SensorFamily", "Sensors", "SensorsSeen", "drawn_sensors"]

_REACH = 3.0
"""Sensors whose blur differs by more, in units of `KERNEL_LOG_WIDTH`, have no part."""
_NEGLIGIBLE = -9.0
"""Logarithm of the weight relative to the largest, below which a kernel is left out."""
_UNTOLD = 1e-2
"""Information of combinations that pixels do not tell: coordinates are below one."""


@dataclass(frozen=True, eq=False)
class SensorFamily:
    """Sensors of one family.

    Attributes
    ----------
    name : str
    coordinates : (n, q) array
        Of every sensor's departure; a unit is the light of the whole LSF.
    log_width : (n,) array
        Logarithm of the width of its blur in pixels, ascending.
    covariance : (q, q) array
        Of the coordinates.
    """

    name: str
    coordinates: Floats
    log_width: Floats
    covariance: Floats

    def about(self, width_px: float) -> tuple[Floats, Floats]:
        """Sensors of about that blur, (m, q), and the logarithm of their weight, (m,)."""
        centre, reach = math.log(width_px), _REACH * KERNEL_LOG_WIDTH
        first, last = np.searchsorted(self.log_width, (centre - reach, centre + reach))
        away = (self.log_width[first:last] - centre) / KERNEL_LOG_WIDTH
        weight = math.log(FAMILY_WEIGHTS.get(self.name, 1.0) / self.log_width.size)
        return self.coordinates[first:last], weight - 0.5 * away**2


@dataclass(frozen=True, eq=False)
class SensorsSeen:
    """What pixels and the density of sensors together say of a departure.

    Attributes
    ----------
    mean : (q,) array
    covariance : (q, q) array
    share : dict of str to float
        Probability of every family, and that it is another sensor.
    """

    mean: Floats
    covariance: Floats
    share: dict[str, float]


@dataclass(frozen=True, eq=False)
class Sensors:
    """The density of sensors.

    Attributes
    ----------
    basis : (SIZE + 1, q) array
        Departures of unit coordinates, orthonormal: coefficients of the spline, and the tail.
    families : tuple of SensorFamily
    """

    basis: Floats
    families: tuple[SensorFamily, ...]

    def seen(
        self, information: Floats, projection: Floats, width_px: float, other: Floats
    ) -> SensorsSeen:
        """The posterior of the coordinates.

        Parameters
        ----------
        information : (q, q) array
            Inverse covariance of what the pixels say.
        projection : (q,) array
            The same times its mean.
        width_px : float
            Width of the blur.
        other : (q, q) array
            Covariance of the coordinates of sensors like none that was drawn, about none.
        """
        combinations, values = _told(information, projection)
        kernels = []
        for family in self.families:
            centres, log_weight = family.about(width_px)
            off = values - centres @ combinations
            for scale in KERNEL_SCALES:
                covariance = scale**2 * family.covariance
                kernels.append(
                    _Kernels.of(family.name, centres, log_weight, off, covariance, combinations)
                )
        nothing, weight = np.zeros((1, other.shape[0])), np.log([OTHER_WEIGHT])
        kernels.append(_Kernels.of("other", nothing, weight, values[None], other, combinations))
        return _mixture(kernels)


def _told(information: Floats, projection: Floats) -> tuple[Floats, Floats]:
    """Independent combinations (q, r) of the coordinates that pixels tell, and their values."""
    size, axes = np.linalg.eigh(information)
    told = size > _UNTOLD
    combinations = axes[:, told] * np.sqrt(size[told])
    return combinations, (combinations / size[told]).T @ projection


@dataclass(frozen=True, eq=False)
class _Kernels:
    """Kernels of one family and one covariance, after the pixels were seen.

    Attributes
    ----------
    name : str
        The family.
    centres : (n, q) array
    off : (n, r) array
        What the pixels say, minus what the centres do.
    log_weight : (n,) array
    gain : (q, r) array
    covariance : (q, q) array
    """

    name: str
    centres: Floats
    off: Floats
    log_weight: Floats
    gain: Floats
    covariance: Floats

    @classmethod
    def of(
        cls,
        name: str,
        centres: Floats,
        log_weight: Floats,
        off: Floats,
        covariance: Floats,
        combinations: Floats,
    ) -> _Kernels:
        """From kernels before, what the pixels say minus what they do, and the combinations."""
        common = covariance @ combinations
        lower = np.linalg.cholesky(np.eye(off.shape[1]) + combinations.T @ common)
        whitening = np.linalg.inv(lower)
        standard = off @ whitening.T
        weight = log_weight - 0.5 * np.einsum("ij,ij->i", standard, standard)
        weight += float(np.log(np.diagonal(whitening)).sum())
        half = common @ whitening.T
        return cls(name, centres, off, weight, half @ whitening, covariance - half @ half.T)

    def weighted(self, largest: float) -> tuple[Floats, Floats]:
        """Weights (m,) relative to the largest, and means (m, q), of those that matter."""
        kept = self.log_weight > largest + _NEGLIGIBLE
        means = self.centres[kept] + self.off[kept] @ self.gain.T
        return np.exp(self.log_weight[kept] - largest), means


def _mixture(kernels: Sequence[_Kernels]) -> SensorsSeen:
    """Mean and covariance of all kernels together: their own, and how their means differ."""
    largest = max(float(one.log_weight.max(initial=-math.inf)) for one in kernels)
    kept = [one.weighted(largest) for one in kernels]
    shares = np.array([float(weight.sum()) for weight, _ in kept])
    whole = float(shares.sum())
    weight = np.concatenate([weight for weight, _ in kept]) / whole
    means = np.concatenate([means for _, means in kept])
    mean = weight @ means
    away = means - mean
    covariance = (away * weight[:, None]).T @ away
    found: dict[str, float] = {}
    for one, share in zip(kernels, (shares / whole).tolist(), strict=True):
        covariance += share * one.covariance
        found[one.name] = found.get(one.name, 0.0) + share
    return SensorsSeen(mean, covariance, found)


@cache
def drawn_sensors() -> Sensors:
    """The sensors of the file that benchmarks/learn_lsf.py writes."""
    path = files("acutance.targets.straight").joinpath("sensors.npz")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as kept:
        basis = kept["basis"].astype(float)
        names = [name for name in kept.files if name != "basis"]
        families = tuple(_family(name, kept[name].astype(float), _parity(basis)) for name in names)
    return Sensors(basis, families)


def _parity(basis: Floats) -> Floats:
    """1 for even directions, -1 for odd ones, (q,)."""
    spline = basis[:-1]
    return np.asarray(np.sign(np.sum(spline * spline[::-1], axis=0) + basis[-1] ** 2))


def _family(name: str, rows: Floats, parity: Floats) -> SensorFamily:
    """From coordinates of every sensor, (n, q), and the logarithm of its width in the last column.

    Edges are seen from either side, so mirror images of sensors that are not even count as often.
    """
    coordinates, log_width = rows[:, :-1], rows[:, -1]
    odd = coordinates[:, parity < 0]
    if float(np.sqrt(np.mean(np.sum(odd**2, axis=1)))) > KERNEL_FLOOR:
        coordinates = np.repeat(coordinates, 2, axis=0)
        coordinates[1::2] *= parity
        log_width = np.repeat(log_width, 2)
    else:
        coordinates = np.where(parity < 0, 0.0, coordinates)
    about = coordinates - coordinates.mean(axis=0)
    covariance = about.T @ about / len(about) + KERNEL_FLOOR**2 * np.eye(parity.size)
    return SensorFamily(name, coordinates, log_width, covariance)
