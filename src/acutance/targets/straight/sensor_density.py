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
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.pivoted_root import least_squares, pivoted_root
from acutance.numerics.small_matrices import lower_inverse
from acutance.targets.straight.kernel_sums import (
    LANES,
    kernel_moments,
    kernel_weights,
    mixture,
    seen_kernels,
)
from acutance.targets.straight.tuned import (
    FAMILY_WEIGHTS,
    KERNEL_FLOOR,
    KERNEL_SCALES,
    OTHER_WEIGHT,
)

__all__ = ["SensorFamily", "Sensors", "SensorsSeen", "drawn_sensors"]

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
    weight : (n,) array
        How often every one is expected; the sum is one.
    covariance : (q, q) array
        Of the coordinates.
    """

    name: str
    coordinates: Floats
    log_width: Floats
    weight: Floats
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
        """Sum over the families of the covariance of their sensors about none, (q, q)."""
        found = np.zeros((self.basis.shape[1],) * 2)
        for family in self.families:
            mean = family.weight @ family.coordinates
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
        covariance = np.concatenate([self.covariances, other[None]])
        part, power = self._groups
        lower, root, axes, told, log_density = seen_kernels(
            covariance, part, power, combinations, values
        )
        log_middle = math.log(width_px)
        none = math.log(OTHER_WEIGHT) + float(log_density[-1] - 0.5 * (told[-1] @ told[-1]))
        counts, kept, log_weight, largest = kernel_weights(
            self._columns, self._log_share, self._log_width, log_middle, self._ends,
            lower[:-1], axes[:-1], told[:-1], log_density[:-1], none,
        )  # fmt: skip
        # The last group is about none: its centre, and their spread, are zero.
        weight, centre, spread = kernel_moments(
            self._columns, len(other), counts, kept, log_weight, largest
        )
        weight[-1] = math.exp(none - largest)
        share = weight / weight.sum()
        mean, whole = mixture(share, centre, spread, covariance, part, power, root, axes, told)
        families: dict[str, float] = {}
        for name, one in zip(self.group_names, share.tolist(), strict=True):
            if one > 0:
                families[name] = families.get(name, 0.0) + one
        return SensorsSeen(mean, whole, families)

    @cached_property
    def group_names(self) -> tuple[str, ...]:
        """Family of every group of kernels, the one about none at the end."""
        return (*np.repeat([family.name for family in self.families], _SIZES).tolist(), "other")

    @cached_property
    def covariances(self) -> Floats:
        """Of every family, (f, q, q)."""
        return np.array([family.covariance for family in self.families])

    @cached_property
    def _groups(self) -> tuple[NDArray[np.intp], Floats]:
        """Covariance of the kernels of every group: which one, and by what factor."""
        count = len(self.families)
        part = np.append(np.repeat(np.arange(count), _SIZES), count)
        return part, np.append(np.tile(np.square(KERNEL_SCALES), count), 1.0)

    @cached_property
    def spread(self) -> Floats:
        """Second moment of the coordinates of all sensors, (q, q)."""
        return np.asarray(self._centres.T @ self._centres / len(self._centres))

    @cached_property
    def _centres(self) -> Floats:
        return np.concatenate([family.coordinates for family in self.families])

    @cached_property
    def _columns(self) -> NDArray[np.float32]:
        """The coordinates, (p, n), filled up with zeros: the file has no more digits than these."""
        count, q = self._centres.shape
        filling = np.zeros((-q % LANES, count), np.float32)
        return np.vstack([self._centres.T.astype(np.float32), filling])

    @cached_property
    def _log_width(self) -> Floats:
        return np.concatenate([family.log_width for family in self.families])

    @cached_property
    def _log_share(self) -> Floats:
        """Logarithm of the weight of every sensor among all, (n,)."""
        return np.concatenate([
            np.log(FAMILY_WEIGHTS.get(family.name, 1.0) * family.weight) for family in self.families
        ])  # fmt: skip

    @cached_property
    def _ends(self) -> NDArray[np.intp]:
        """First sensor of every family among all, and the one after the last, (f + 1,)."""
        return np.cumsum([0, *(family.log_width.size for family in self.families)])


def _told(information: Floats, projection: Floats, spread: Floats) -> tuple[Floats, Floats]:
    """Independent combinations (q, r) of the coordinates that pixels tell, and their values.

    Those told best are first, in coordinates whose covariance `spread` is one; the last are zeros
    that fill up a multiple of `LANES`.
    """
    lower = np.asarray(np.linalg.cholesky(spread), float)
    root = pivoted_root(lower.T @ information @ lower, _UNTOLD)
    q, r = root.shape
    combinations, values = np.zeros((q, r + -r % LANES)), np.zeros(r + -r % LANES)
    np.matmul(lower_inverse(lower).T, root, out=combinations[:, :r])
    values[:r] = least_squares(root, lower.T @ projection)
    return combinations, values


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
    log_width, odd = rows[:, -1], np.flatnonzero(parity < 0)
    uneven = np.linalg.norm(rows[:, odd], axis=1) > KERNEL_FLOOR
    places = np.repeat(np.arange(len(rows)), 1 + uneven)
    mirrored = np.append(False, places[1:] == places[:-1])
    coordinates = rows[places, :-1]
    coordinates[:, odd] *= (uneven[places] * np.where(mirrored, -1.0, 1.0))[:, None]
    weight = 1.0 / (1 + uneven[places]) / len(rows)
    about = coordinates - weight @ coordinates
    covariance = (weight[:, None] * about).T @ about + KERNEL_FLOOR**2 * np.eye(parity.size)
    return SensorFamily(name, coordinates, log_width[places], weight, covariance)
