"""How point spread functions of the families of sensors depart from a Gaussian through a pixel.

The principal directions that `learn_psf` found, as functions: in the plane, and its transform. They
are sums of splines (`psf_spline`) in units of the width of the first fit, and of a tail.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.points.psf_spline import GRIDS, Parity, add_spline_sum, add_splines, whole
from acutance.targets.points.tuned import FAMILY_LOG_AMPLITUDES

__all__ = ["PARITIES", "Families", "Parities", "entry_name", "learned_families"]

Complexes = NDArray[np.complex128]
Parities = tuple[Parity, Parity]
PARITIES: Final[tuple[Parities, ...]] = ((1, 1), (-1, 1))
"""Across and along. Directions even across and odd along are transposes of the second kind. What is
odd both ways is a twentieth of what is even where there is any (interpolation at one phase)."""
_ROUNDING: Final = 1e-13


class _Waves(NamedTuple):
    """Waves of every parity on either grid, (n, reach + 1) each, at frequencies per width."""

    across: dict[Parity, list[Floats]]
    along: dict[Parity, list[Floats]]

    @classmethod
    def at(cls, f: Floats, g: Floats) -> _Waves:
        """At frequencies (f, g), (n,)."""
        parities: tuple[Parity, Parity] = (1, -1)
        return cls(
            *({p: [grid.waves(one, p) for grid in GRIDS] for p in parities} for one in (f, g))
        )


@dataclass(frozen=True, eq=False)
class _Group:
    """Directions of one parity: quadrants of coefficients a grid, and tails."""

    across: Parity
    along: Parity
    quadrants: tuple[Floats, ...]
    tail: Floats

    def transform(self, waves: _Waves) -> Complexes:
        """Transform at frequencies, without the tail, (n, r)."""
        return self._transform(waves, self.quadrants)

    def transform_sum(self, waves: _Waves, weights: Floats) -> Complexes:
        """``transform(waves) @ weights``, (n,)."""
        mixed = [np.tensordot(weights, one, 1)[None] for one in self.quadrants]
        return self._transform(waves, mixed)[:, 0]

    def _transform(self, waves: _Waves, quadrants: Sequence[Floats]) -> Complexes:
        pairs = zip(waves.across[self.across], waves.along[self.along], quadrants, strict=True)
        return np.asarray(sum(_sums(*pair) for pair in pairs) * self._turn)

    @property
    def _turn(self) -> complex:
        """What functions of odd parity are turned by."""
        return (-1j) ** ((self.across < 0) + (self.along < 0))


@dataclass(frozen=True, eq=False)
class Families:
    """The directions of all families.

    Parameters
    ----------
    groups : tuple
        Directions by parity.
    block : (r,) int array
        Number of the family of every direction.
    """

    groups: tuple[_Group, ...]
    block: NDArray[np.intp]

    @cached_property
    def tail(self) -> Floats:
        """Share of every direction in the tail, (r,)."""
        return np.concatenate([one.tail for one in self.groups])

    @cached_property
    def coefficients(self) -> tuple[Floats, ...]:
        """Coefficients on either whole grid, (size * size, r)."""
        found = []
        for number, grid in enumerate(GRIDS):
            every = [whole(one.quadrants[number], one.across, one.along) for one in self.groups]
            found.append(np.concatenate(every).reshape(-1, grid.size**2).T.copy())
        return tuple(found)

    def add(
        self, found: Floats, pixel: NDArray[np.intp], light: Floats, u: Floats, v: Floats
    ) -> None:
        """Add the light of all directions, without tails, to the first columns of a matrix.

        At places (u, v) in widths, per square width, times `light`, each to the row of its pixel.
        """
        for grid, coefficients in zip(GRIDS, self.coefficients, strict=True):
            add_splines(found, pixel, light, u, v, grid.step, coefficients)

    def sums(self, u: Floats, v: Floats, weights: Floats) -> Floats:
        """All directions times weights, (r,), and the derivatives by u and v, (3, n)."""
        found = np.zeros((3, u.size))
        for grid, coefficients in zip(GRIDS, self.coefficients, strict=True):
            mixed = (coefficients @ weights).reshape(grid.size, grid.size)
            add_spline_sum(found, u, v, grid.step, mixed)
        return found

    def transform(self, f: Floats, g: Floats) -> Complexes:
        """Transform of every direction without its tail at frequencies per width, (n, r)."""
        waves = _Waves.at(f, g)
        return np.hstack([one.transform(waves) for one in self.groups])

    def transform_sum(self, f: Floats, g: Floats, weights: Floats) -> Complexes:
        """``transform(f, g) @ weights``, (n,)."""
        ends = np.cumsum([one.tail.size for one in self.groups])[:-1]
        found, waves = np.zeros(f.size, complex), _Waves.at(f, g)
        for group, own in zip(self.groups, np.split(weights, ends), strict=True):
            found += group.transform_sum(waves, own)
        return found


def _sums(across: Floats, along: Floats, quadrant: Floats) -> Floats:
    """Sums over quadrants (r, k, k) of waves across and along, (n, k) each, (n, r)."""
    if _is_constant(along):
        # On an axis the waves along it are all there is to multiply.
        return np.asarray(across @ (along[0] @ quadrant).T)
    if _is_constant(across):
        return np.asarray(along @ (quadrant @ across[0]).T)
    rows = along @ quadrant.transpose(1, 0, 2).reshape(along.shape[1], -1)
    rows = rows.reshape(len(rows), len(quadrant), -1)
    return np.asarray(np.einsum("nrk,nk->nr", rows, across))


def _is_constant(waves: Floats) -> bool:
    """Whether waves, (n, k), are the same at all frequencies, but for rounding."""
    return float(np.ptp(waves, axis=0).max(initial=0.0)) < _ROUNDING


def entry_name(family: str, across: Parity, along: Parity) -> str:
    """Name of a family's directions of given parities in the file of what was learned."""
    return f"{family} {across:+d}{along:+d}"


@cache
def learned_families() -> Families:
    """The families as they were learned."""
    path = files("acutance.targets.points").joinpath("psf_families.npz")
    groups: list[_Group] = []
    block: list[NDArray[np.intp]] = []
    with path.open("rb") as file, np.load(file, allow_pickle=False) as learned:
        for parities in PARITIES:
            rows = [learned[entry_name(family, *parities)] for family in FAMILY_LOG_AMPLITUDES]
            own = _groups_of(np.vstack(rows), *parities)
            groups += own
            block += len(own) * [np.repeat(np.arange(len(rows)), [len(one) for one in rows])]
    return Families(tuple(groups), np.concatenate(block))


def _groups_of(directions: Floats, across: Parity, along: Parity) -> list[_Group]:
    """Directions of given parities, (r, m), and their transposes if these have others."""
    if not len(directions):
        return []
    ends = np.cumsum([(grid.reach + 1) ** 2 for grid in GRIDS])
    *flat, tail = np.split(directions.astype(float), ends, axis=1)
    quadrants = tuple(
        one.reshape(-1, grid.reach + 1, grid.reach + 1)
        for one, grid in zip(flat, GRIDS, strict=True)
    )
    found = [_Group(across, along, quadrants, tail[:, 0])]
    if across != along:
        turned = tuple(one.transpose(0, 2, 1) for one in quadrants)
        found.append(_Group(along, across, turned, tail[:, 0]))
    return found
