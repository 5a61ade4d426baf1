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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.straight.kernel_sums import kernel_moments, kernel_weights
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
_UNTOLD = 1e-2
"""Information of combinations that pixels do not tell, whose prior variance is one."""


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
        combinations, values = _told(information, projection, self.spread + other)
        # Kernels of every family and size, and the one about none.
        covariance = np.concatenate([self.kernel_covariances, other[None]])
        half = covariance @ combinations
        lower = np.linalg.cholesky(np.eye(values.size) + combinations.T @ half)
        whitening = np.linalg.inv(lower)
        axes, told = whitening @ combinations.T, whitening @ values
        log_density = np.log(np.diagonal(whitening, axis1=1, axis2=2)).sum(axis=1)
        last = math.log(OTHER_WEIGHT) + float(log_density[-1]) - 0.5 * float(told[-1] @ told[-1])
        largest, weighed = last, []
        for k, name, centres, log_weight in self._kernels(width_px):
            found, largest = kernel_weights(
                centres, log_weight + log_density[k], axes[k], told[k], largest
            )
            weighed.append((k, name, centres, found))
        moments = [
            (k, name, *kernel_moments(centres, found, largest))
            for k, name, centres, found in weighed
        ]
        q = other.shape[0]
        moments.append((-1, "other", math.exp(last - largest), np.zeros(q), np.zeros((q, q))))
        half = half @ whitening.transpose(0, 2, 1)
        parts = [
            _Part.of(name, weight, centre, spread, covariance[k], half[k], axes[k], told[k])
            for k, name, weight, centre, spread in moments
            if weight > 0
        ]
        return _mixture(parts)

    @cached_property
    def kernel_covariances(self) -> Floats:
        """Of the kernels of every family, and of every size of them, (k, q, q)."""
        return np.array([
            scale**2 * family.covariance for family in self.families for scale in KERNEL_SCALES
        ])  # fmt: skip

    @cached_property
    def spread(self) -> Floats:
        """Second moment of the coordinates of all sensors, (q, q)."""
        every = np.concatenate([family.coordinates for family in self.families])
        return np.asarray(every.T @ every / len(every))

    def _kernels(self, width_px: float) -> Iterator[tuple[int, str, Floats, Floats]]:
        """Number, family, centres and log weights of the kernels of one covariance."""
        number = 0
        for family in self.families:
            centres, log_weight = family.about(width_px)
            for _ in KERNEL_SCALES:
                yield number, family.name, centres, log_weight
                number += 1


def _told(information: Floats, projection: Floats, spread: Floats) -> tuple[Floats, Floats]:
    """Independent combinations (q, r) of the coordinates that pixels tell, and their values.

    Those told best are first. In coordinates whose covariance `spread` is one the information is
    diagonal.
    """
    lower = np.linalg.cholesky(spread)
    size, axes = np.linalg.eigh(lower.T @ information @ lower)
    told = np.flatnonzero(size > _UNTOLD)[::-1]
    scale = np.sqrt(size[told])
    values = (axes[:, told] / scale).T @ (lower.T @ projection)
    return np.linalg.solve(lower.T, axes[:, told] * scale), values


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of the mixture: kernels of one covariance, after the pixels were seen.

    Attributes
    ----------
    name : str
        The family.
    weight : float
    mean : (q,) array
    covariance : (q, q) array
        Of the kernels, and of their centres about the mean.
    """

    name: str
    weight: float
    mean: Floats
    covariance: Floats

    @classmethod
    def of(
        cls,
        name: str,
        weight: float,
        centre: Floats,
        spread: Floats,
        covariance: Floats,
        half: Floats,
        axes: Floats,
        told: Floats,
    ) -> _Part:
        """From the kernels before, their centres' mean and spread, and what the pixels say."""
        kept = np.eye(centre.size) - half @ axes
        return cls(
            name, weight, kept @ centre + half @ told,
            covariance - half @ half.T + kept @ spread @ kept.T,
        )  # fmt: skip


def _mixture(parts: Sequence[_Part]) -> SensorsSeen:
    """Mean and covariance of all parts together: their own, and how their means differ."""
    weight = np.array([part.weight for part in parts])
    weight /= weight.sum()
    means = np.array([part.mean for part in parts])
    mean = weight @ means
    away = means - mean
    covariance = (away * weight[:, None]).T @ away
    found: dict[str, float] = {}
    for part, share in zip(parts, weight.tolist(), strict=True):
        covariance += share * part.covariance
        found[part.name] = found.get(part.name, 0.0) + share
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
