"""What point spread functions there are: a density over thousands of sensors drawn at random.

Departures of a PSF from a Gaussian through a pixel (`learn_psf`) are written in coordinates, each a
combination of the directions of `psf_families`. Every drawn sensor is the centre of normal
kernels, of the covariance that sensors like it have among themselves: families are halved along
their longest axis until few are left in a part (a k-d tree along principal axes; J. L. Bentley,
Communications of the ACM 18, 1975), so small departures have small kernels and large ones large
kernels (B. W. Silverman, Density Estimation, 1986, section 5.3).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.kernel_mixture import Kernels
from acutance.targets.points.tuned import (
    FAMILY_WEIGHTS,
    KERNEL_FLOOR,
    KERNEL_FLOOR_SHARE,
    KERNEL_LOG_RATIO,
    KERNEL_LOG_WIDTH,
    KERNEL_SCALES,
    LIKE_SENSORS,
)

__all__ = ["Basis", "Sensors", "drawn_sensors", "sensors_of"]

_REACH: Final = 3.0
"""Sensors whose blur differs by more standard deviations have no part."""
_AXES: Final = 24
"""Principal axes of a part's covariance that its kernels have; elsewhere they have the floor. Of 57
restored sensors not drawn, linear in their coordinates, at SNR 200 the FWHM lies with 12 in 86 of
100 intervals, with 24 in 94."""
_NOTHING: Final = 1e-4
"""Coordinates below which a sensor is its own mirror image, or its own transpose."""


class Basis(NamedTuple):
    """Coordinates as combinations of the families' directions, by symmetry.

    Attributes
    ----------
    same, opposite : (r, a), (r, b) arrays
        Of directions even across and along: what stays the same when rows and columns are
        exchanged, and what changes its sign.
    odd : (s, c) array
        Of directions odd across and even along; their transposes have coordinates of their own.
    """

    same: Floats
    opposite: Floats
    odd: Floats

    @property
    def directions(self) -> Floats:
        """What coordinates (a + b + c + c) are of all directions, (r + s + s, a + b + 2 c)."""
        even = np.hstack([self.same, self.opposite])
        (r, p), (s, c) = even.shape, self.odd.shape
        whole = np.zeros((r + 2 * s, p + 2 * c))
        whole[:r, :p] = even
        whole[r : r + s, p : p + c] = whole[r + s :, p + c :] = self.odd
        return whole


@dataclass(frozen=True, eq=False)
class Sensors:
    """The density of sensors.

    Attributes
    ----------
    directions : (r, q) array
        What unit coordinates are of the directions of the families.
    kernels : Kernels
        About the coordinates of every sensor's departure, weighted as often as such a sensor is
        expected; a part are sensors of one family that are like each other, its name the family's.
    log_width : (n,) array
        Logarithm of the mean width of its blur in pixels.
    log_ratio : (n,) array
        Logarithm of the ratio of the widths across and along.
    """

    directions: Floats
    kernels: Kernels
    log_width: Floats
    log_ratio: Floats

    def about(self, widths_px: tuple[float, float]) -> Kernels:
        """Kernels of the sensors of about those widths, if there are any."""
        width = (self.log_width - 0.5 * math.log(widths_px[0] * widths_px[1])) / KERNEL_LOG_WIDTH
        ratio = (self.log_ratio - math.log(widths_px[0] / widths_px[1])) / KERNEL_LOG_RATIO
        away = width**2 + ratio**2
        weighted = self.kernels._replace(log_weight=self.kernels.log_weight - 0.5 * away)
        return weighted.some(away < _REACH**2)


@cache
def drawn_sensors() -> Sensors:
    """The sensors of the file that benchmarks/learn_psf.py --density writes."""
    path = files("acutance.targets.points").joinpath("psf_sensors.npz")
    with path.open("rb") as file, np.load(file, allow_pickle=False) as kept:
        found = {name: kept[name].astype(float) for name in kept.files}
    basis = Basis(*(found.pop(f"basis {name}") for name in Basis._fields))
    return sensors_of(basis, found)


def sensors_of(basis: Basis, drawn: Mapping[str, Floats]) -> Sensors:
    """The density of drawn sensors.

    Parameters
    ----------
    basis : Basis
        Of a + b + c coordinates.
    drawn : mapping of str to (n, a + b + 2 c + 2) arrays
        Coordinates of the sensors of every family, and the logarithms of their widths.
    """
    found = {family: list(_parts(family, rows, basis)) for family, rows in drawn.items()}
    parts = [part for own in found.values() for part in own]
    kernels = Kernels(
        np.concatenate([part.centres for part in parts]),
        np.concatenate([part.log_weight for part in parts]),
        np.repeat(np.arange(len(parts)), [len(part.centres) for part in parts]),
        np.stack([part.factor for part in parts]),
        np.array([part.floor for part in parts]),
        np.repeat(list(found), [len(own) for own in found.values()]),
        KERNEL_SCALES,
    )
    log_width = np.concatenate([part.log_width for part in parts])
    log_ratio = np.concatenate([part.log_ratio for part in parts])
    return Sensors(basis.directions, kernels, log_width, log_ratio)


class _Part(NamedTuple):
    """Sensors of one family that are like each other, as `Sensors` and its kernels have them."""

    centres: Floats
    log_width: Floats
    log_ratio: Floats
    log_weight: Floats
    factor: Floats
    floor: float


def _parts(family: str, rows: Floats, basis: Basis) -> Iterator[_Part]:
    """From the coordinates of every sensor, (n, a + b + 2 c), and the logarithms of its widths."""
    centres, log_widths, log_weight = _images(rows[:, :-2], rows[:, -2:], basis)
    log_width = log_widths.mean(axis=1)
    log_ratio = log_widths[:, 0] - log_widths[:, 1]
    log_weight += math.log(FAMILY_WEIGHTS.get(family, 1.0) / len(rows))
    places = np.column_stack([centres, KERNEL_LOG_WIDTH * log_width])
    for part in _halved(places, np.arange(len(places))):
        about = centres[part] - centres[part].mean(axis=0)
        power, axes = np.linalg.eigh(about.T @ about / part.size)
        factor = axes[:, -_AXES:] * np.sqrt(np.maximum(power[-_AXES:], 0.0))
        size = float(np.sqrt(np.mean(np.sum(centres[part] ** 2, axis=1))))
        floor = max(KERNEL_FLOOR, KERNEL_FLOOR_SHARE * size)
        yield _Part(
            centres[part], log_width[part], log_ratio[part], log_weight[part], factor, floor
        )


def _images(coordinates: Floats, log_widths: Floats, basis: Basis) -> tuple[Floats, Floats, Floats]:
    """All sensors as they are, mirrored and turned, each of these once.

    Returns
    -------
    (m, q) array
        Coordinates.
    (m, 2) array
        Logarithms of the widths.
    (m,) array
        Logarithm of the share of the sensor that an image is.
    """
    a, b, c = (part.shape[1] for part in basis)
    same, opposite, across, along = np.split(coordinates, [a, a + b, a + b + c], axis=1)
    by_row, by_col = (np.linalg.norm(odd, axis=1) > _NOTHING for odd in (along, across))
    turns = by_row | by_col | (np.linalg.norm(opposite, axis=1) > _NOTHING)
    always = np.ones_like(turns)
    images, counts = [], []
    for x, mirrored in ((1, always), (-1, by_col)):
        for y, upside_down in ((1, always), (-1, by_row)):
            images += [
                (np.hstack([same, opposite, x * across, y * along]), log_widths),
                (np.hstack([same, -opposite, y * along, x * across]), log_widths[:, ::-1]),
            ]
            counts += [mirrored & upside_down, mirrored & upside_down & turns]
    share = -np.log(np.sum(counts, axis=0))
    return (
        np.concatenate([one[kept] for (one, _), kept in zip(images, counts, strict=True)]),
        np.concatenate([one[kept] for (_, one), kept in zip(images, counts, strict=True)]),
        np.concatenate([share[kept] for kept in counts]),
    )


def _halved(places: Floats, members: NDArray[np.intp]) -> Iterator[NDArray[np.intp]]:
    """Parts of at most `LIKE_SENSORS` members, whose order is kept, halved along longest axes."""
    if members.size <= LIKE_SENSORS:
        yield members
        return
    about = places[members] - places[members].mean(axis=0)
    along = about @ np.linalg.eigh(about.T @ about)[1][:, -1]
    upper = along > np.median(along)
    if not upper.any():
        yield members
        return
    yield from _halved(places, members[~upper])
    yield from _halved(places, members[upper])
