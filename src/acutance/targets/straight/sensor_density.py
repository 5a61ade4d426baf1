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
from functools import cache, cached_property
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.pivoted_root import least_squares, pivoted_root
from acutance.targets.straight.kernel_sums import (
    LANES,
    forward_substitution,
    kernel_moments,
    kernel_weights,
)
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
_SIZES = len(KERNEL_SCALES)
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

    @cached_property
    def second_moment(self) -> Floats:
        """Covariance of all sensors about none, family by family, (q, q)."""
        found = np.zeros((self.basis.shape[1],) * 2)
        for family in self.families:
            mean = family.coordinates.mean(axis=0)
            found += family.covariance + np.outer(mean, mean)
        return found

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
        kernels = _Kernels.of(
            np.concatenate([self.kernel_covariances, other[None]]), combinations, values
        )
        return _mixture(self.group_names, self._seen_groups(kernels, width_px), kernels)

    @cached_property
    def group_names(self) -> tuple[str, ...]:
        """Family of every group of kernels, the one about none at the end."""
        return (*np.repeat([family.name for family in self.families], _SIZES).tolist(), "other")

    @cached_property
    def kernel_covariances(self) -> Floats:
        """Of the kernels of every group but the last, (g - 1, q, q)."""
        return np.array([
            scale**2 * family.covariance for family in self.families for scale in KERNEL_SCALES
        ])  # fmt: skip

    @cached_property
    def spread(self) -> Floats:
        """Second moment of the coordinates of all sensors, (q, q)."""
        return np.asarray(self._centres.T @ self._centres / len(self._centres))

    @cached_property
    def _centres(self) -> Floats:
        return np.concatenate([family.coordinates for family in self.families])

    @cached_property
    def _filled_centres(self) -> Floats:
        count, q = self._centres.shape
        return np.hstack([self._centres, np.zeros((count, -q % LANES))])

    @cached_property
    def _log_width(self) -> Floats:
        return np.concatenate([family.log_width for family in self.families])

    @cached_property
    def _log_share(self) -> Floats:
        """Logarithm of the weight of every sensor among all, (n,)."""
        return np.concatenate([
            np.full(family.log_width.size, math.log(weight / family.log_width.size))
            for family in self.families
            for weight in (FAMILY_WEIGHTS.get(family.name, 1.0),)
        ])  # fmt: skip

    def _about(self, width_px: float) -> tuple[NDArray[np.intp], Floats]:
        """Sensors of about that blur: first and last of every group, and all log weights."""
        away = (self._log_width - math.log(width_px)) / KERNEL_LOG_WIDTH
        start, members, ends = 0, [], np.array([-_REACH, _REACH])
        for family in self.families:
            own = away[start : start + family.log_width.size]
            members += [start + own.searchsorted(ends)] * _SIZES
            start += own.size
        return np.array(members, np.intp), self._log_share - 0.5 * away**2

    def _seen_groups(self, kernels: _Kernels, width_px: float) -> _Groups:
        """Weight, mean and spread of the centres of every group, the one about none at the end."""
        members, log_before = self._about(width_px)
        last = kernels.told[-1]
        other = math.log(OTHER_WEIGHT) + float(kernels.log_density[-1] - 0.5 * (last @ last))
        log_weight, largest = kernel_weights(
            self._filled_centres, log_before, members, kernels.axes[:-1], kernels.told[:-1],
            kernels.log_density[:-1], other,
        )  # fmt: skip
        weight, mean, spread = kernel_moments(self._centres, members, log_weight, largest)
        none = np.zeros_like(mean[:1])
        return _Groups(
            np.append(weight, math.exp(other - largest)),
            np.concatenate([mean, none]),
            np.concatenate([spread, np.zeros_like(spread[:1])]),
        )


def _told(information: Floats, projection: Floats, spread: Floats) -> tuple[Floats, Floats]:
    """Independent combinations (q, r) of the coordinates that pixels tell, and their values.

    Those told best are first, in coordinates whose covariance `spread` is one.
    """
    lower = np.linalg.cholesky(spread)
    root = pivoted_root(lower.T @ information @ lower, _UNTOLD)
    return np.linalg.solve(lower.T, root), least_squares(root, lower.T @ projection)


class _Kernels(NamedTuple):
    """What the pixels say of the kernels of g groups.

    Attributes
    ----------
    covariance : (g, q, q) array
        Of a kernel before.
    root : (g, q, r) array
        ``root @ root.T`` is what the pixels take from it.
    axes : (g, r, q) array
        Independent combinations of the coordinates, of unit variance under a kernel.
    told : (g, r) array
        What the pixels say of them.
    log_density : (g,) array
        Logarithm of the density of a kernel that is where the pixels say.
    """

    covariance: Floats
    root: Floats
    axes: Floats
    told: Floats
    log_density: Floats

    @classmethod
    def of(cls, covariance: Floats, combinations: Floats, values: Floats) -> _Kernels:
        """From the covariances, the combinations (q, r) that pixels tell, and their values."""
        count, (q, r) = len(covariance), combinations.shape
        half = covariance @ combinations
        lower = np.asarray(np.linalg.cholesky(np.eye(r) + combinations.T @ half), float)
        right = np.empty((2, count, r, q))
        right[0], right[1] = half.transpose(0, 2, 1), combinations.T
        root, axes = (forward_substitution(lower, one) for one in right)
        told = forward_substitution(lower, np.tile(values[:, None], (count, 1, 1)))[..., 0]
        log_density = -np.log(np.diagonal(lower, axis1=1, axis2=2)).sum(axis=1)
        return cls(covariance, root.transpose(0, 2, 1), axes, told, log_density)


class _Groups(NamedTuple):
    """Weight (g,), and mean (g, q) and spread (g, q, q) of the centres, of groups of kernels."""

    weight: Floats
    centre: Floats
    spread: Floats


def _mixture(names: Sequence[str], groups: _Groups, kernels: _Kernels) -> SensorsSeen:
    """Mean and covariance of all kernels together: their own, and how their means differ."""
    some = np.flatnonzero(groups.weight)
    weight, centre, spread = (part[some] for part in groups)
    covariance, root, axes, told, _ = (part[some] for part in kernels)
    share = weight / weight.sum()
    left = np.eye(centre.shape[1]) - root @ axes
    means = (left @ centre[..., None] + root @ told[..., None])[..., 0]
    own = covariance - root @ root.transpose(0, 2, 1) + left @ spread @ left.transpose(0, 2, 1)
    mean = share @ means
    away = means - mean
    found: dict[str, float] = {}
    for group, one in zip(some.tolist(), share.tolist(), strict=True):
        found[names[group]] = found.get(names[group], 0.0) + one
    whole = np.tensordot(share, own, 1) + (away * share[:, None]).T @ away
    return SensorsSeen(mean, whole, found)


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
