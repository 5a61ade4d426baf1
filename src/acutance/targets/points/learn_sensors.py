"""Learn from optics what point spread functions there are: thousands of departures, in coordinates.

Departures of drawn sensors (`learn_psf`) are written in coordinates common to all families. They
are orthonormal axes of all that the directions of `psf_families` span, so pixels that are seen
through these directions are seen through the coordinates, too. `sensor_density` reads the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Final, NamedTuple, Self

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics import Detector, Gaussian, Sensor, draw_sensor
from acutance.targets.points.learn_psf import Departure, departure
from acutance.targets.points.psf_families import Parities, learned_families
from acutance.targets.points.psf_spline import GRIDS, parity_part
from acutance.targets.points.sensor_density import Basis

__all__ = [
    "DENSITY_COUNTS",
    "Departures",
    "density",
    "draw_departures",
    "with_more",
    "write_density",
]

DENSITY_COUNTS: Final = {
    "telescope": 1400,
    "halo": 500,
    "trail": 400,
    "smear": 400,
    "sharpened": 900,
    "restored": 1500,
    "resampled": 400,
    "plain": 300,
    "shifted": 800,
    "processed": 800,
    "scatter": 600,
    "footprint": 500,
    "peaked": 600,
    "deferred": 300,
}
"""Sensors of the density: more of families that vary in more ways. "plain" is a Gaussian blur and a
detector, nothing else; "footprint" the same with a detector that is no pixel: with gaps between
detectors, of staggered lines, or of a product that is finer than the sampling."""
_FOOTPRINT_PX: Final = (0.35, 2.0)
_FOOTPRINT_RATIO: Final = (0.6, 1 / 0.6)
_DEPENDENT: Final = 1e-6
"""Singular value over the largest below which directions are combinations of others."""


class Departures(NamedTuple):
    """Departures of sensors of one family, a row each.

    Attributes
    ----------
    even, across, along : (n, m) arrays
        Parts even across and along, odd across, and odd along with rows and columns exchanged: a
        quadrant of coefficients on the fine grid, then on the coarse one, then the tail; the root
        of the sum of squares is that of the light.
    log_widths : (n, 2) array
        Logarithms of the widths of the blur across and along, in pixels.
    """

    even: Floats
    across: Floats
    along: Floats
    log_widths: Floats

    @classmethod
    def of(cls, departures: Iterable[Departure]) -> Self:
        """From departures on whole grids."""
        every = list(departures)
        even, across, along = (
            np.array([_quadrants(one, parities) for one in every])
            for parities in ((1, 1), (-1, 1), (1, -1))
        )
        return cls(even, across, _turned(along), np.log([one.widths_px for one in every]))


def _quadrants(one: Departure, parities: Parities) -> Floats:
    parts = [parity_part(grid, *parities).ravel() for grid in (one.fine, one.coarse)]
    tail = one.tail * (parities == (1, 1))
    return np.asarray(np.append(np.concatenate(parts), tail) * _metric())


def _metric() -> Floats:
    """Root of the light squared that a coefficient of a quadrant stands for, with its images."""
    found = []
    for grid in GRIDS:
        images = np.full(2 * (grid.reach + 1,), 4.0)
        images[0] *= 0.5
        images[:, 0] *= 0.5
        found.append(grid.step * np.sqrt(images).ravel())
    return np.concatenate([*found, [1.0]])


def _turned(rows: Floats) -> Floats:
    """Rows of quadrants with their rows and columns exchanged."""
    found, first = [], 0
    for grid in GRIDS:
        side = grid.reach + 1
        own = rows[:, first : first + side**2].reshape(-1, side, side)
        found.append(own.transpose(0, 2, 1).reshape(len(rows), -1))
        first += side**2
    return np.hstack([*found, rows[:, first:]])


def draw_departures(counts: Mapping[str, int], seed: int) -> dict[str, Departures]:
    """Departures of so many sensors of every family, drawn at random."""
    found = {}
    for number, (family, count) in enumerate(counts.items()):
        rng = np.random.default_rng((seed, number))
        found[family] = Departures.of(departure(_drawn(family, rng)) for _ in range(count))
    return found


def _drawn(family: str, rng: np.random.Generator) -> Sensor:
    if family == "footprint":
        return _footprint(rng)
    if family != "plain":
        return draw_sensor(family, rng)
    return Sensor([Gaussian(rng.uniform(0.15, 1.1)), Detector(rng.uniform(0.85, 1.0))])


def _footprint(rng: np.random.Generator) -> Sensor:
    """A detector of another size than a pixel: half of them are square."""
    width_px = math.exp(rng.uniform(*np.log(_FOOTPRINT_PX)))
    is_square = rng.random() < 0.5
    height_px = width_px * (1.0 if is_square else math.exp(rng.uniform(*np.log(_FOOTPRINT_RATIO))))
    return Sensor([Gaussian(rng.uniform(0.15, 0.7)), Detector(width_px, height_px)])


def density(drawn: Mapping[str, Departures]) -> dict[str, Floats]:
    """The density of sensors: coordinates, and the sensors of every family in them.

    Returns
    -------
    dict of str to array
        "basis same", "basis opposite", "basis odd": as `sensor_density.Basis`; by family
        (n, a + b + 2 c + 2): coordinates, and the logarithms of the widths across and along.
    """
    even, odd = _directions()
    axes = Basis(*(_axes(one) for one in _by_symmetry(even, odd)))
    found: dict[str, Floats] = {
        f"basis {name}": np.asarray(np.linalg.lstsq(whole.T, own, rcond=1e-10)[0], float)
        for name, whole, own in zip(Basis._fields, (even, even, odd), axes, strict=True)
    }
    for family, one in drawn.items():
        found[family] = _coordinates(one, axes)
    return found


def with_more(kept: Mapping[str, Floats], drawn: Mapping[str, Departures]) -> dict[str, Floats]:
    """A density with more sensors, in the coordinates it has.

    Parameters
    ----------
    kept : dict of str to array
        As `density` gives it.
    drawn : dict of str to Departures
        Of families that it has, or of new ones.
    """
    even, odd = _directions()
    axes = Basis(*(
        whole.T @ kept[f"basis {name}"]
        for name, whole in zip(Basis._fields, (even, even, odd), strict=True)
    ))  # fmt: skip
    found = dict(kept)
    for family, one in drawn.items():
        more = _coordinates(one, axes)
        found[family] = np.vstack([found[family], more]) if family in found else more
    return found


def _directions() -> tuple[Floats, Floats]:
    """The directions of all families, (n, m): even ones, and those odd across."""
    even, odd, _ = (
        np.column_stack([*(q.reshape(len(q), -1) for q in group.quadrants), group.tail]) * _metric()
        for group in learned_families().groups
    )
    return even, odd


def _coordinates(drawn: Departures, axes: Basis) -> Floats:
    """Coordinates of departures along axes, (n, a + b + 2 c), and the logarithms of the widths."""
    same, opposite, across = (
        np.asarray(part @ own)
        for part, own in zip(_by_symmetry(drawn.even, drawn.across), axes, strict=True)
    )
    return np.hstack([same, opposite, across, drawn.along @ axes.odd, drawn.log_widths])


def _by_symmetry(even: Floats, odd: Floats) -> Basis:
    """Even departures (n, m) in parts that a turn by 90 degrees keeps, and turns; the odd ones."""
    turned = _turned(even)
    return Basis(0.5 * (even + turned), 0.5 * (even - turned), odd)


def _axes(directions: Floats) -> Floats:
    """Orthonormal axes of what directions (r, m) span, (m, k): all of it.

    What coordinates lack, pixels at 200 times the noise see, and take for another sensor.
    """
    size, axes = np.linalg.svd(directions, full_matrices=False)[1:]
    return np.asarray(axes[size > _DEPENDENT * size[0]].T)


def write_density(path: Path, found: Mapping[str, Floats]) -> None:
    """Keep the density of sensors in a file that `sensor_density` reads."""
    kept = {
        name: rows.astype("<f4" if name.startswith("basis ") else "<f2")
        for name, rows in found.items()
    }
    np.savez_compressed(path, allow_pickle=False, **kept)
