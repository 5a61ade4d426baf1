"""Learn from optics how line spread functions (LSF) depart from a Gaussian through a pixel.

Sensors of families (`acutance.optics.FAMILIES`) are drawn at random. Each is fitted as the
first fit of an edge would be, and what is left of its LSF, in the spline of `lsf_prior` and the
tail, is its departure. The principal directions of a family's departures, each with the root of
its mean square, are the family's part of the normal prior (`lsf_prior`); the departures themselves,
in coordinates common to all families, are the density of sensors (`sensor_density`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from acutance.curves.grid import Floats
from acutance.geometry.line import Line
from acutance.numerics.lorentz_tail import tail_lsf
from acutance.optics import Detector, Gaussian, Sensor, draw_sensor
from acutance.targets.straight.first_fit import fit_first
from acutance.targets.straight.spline import CENTRES, quasi_interpolant
from acutance.targets.straight.tuned import FAMILY_LOG_AMPLITUDES, TAIL_WIDTH

__all__ = [
    "DENSITY_COUNTS",
    "Departure",
    "departure",
    "draw_density",
    "learn",
    "principal_directions",
    "with_more",
    "write",
    "write_density",
]

DENSITY_COUNTS = {
    "telescope": 2000,
    "halo": 1000,
    "trail": 700,
    "smear": 500,
    "sharpened": 1600,
    "restored": 2000,
    "resampled": 1000,
    "plain": 400,
    "shifted": 1000,
    "processed": 1400,
    "scatter": 1200,
    "aberrated": 500,
    "peaked": 800,
    "deferred": 350,
}
"""Sensors of the density: more of families that vary in more ways. "plain" is a Gaussian blur and a
detector, nothing else."""
_COORDINATES = 48
"""In the median .0001 of the light lies outside of these, of one processed sensor in fifty .0014;
what thousand edges of a scene share must be less than what they tell: with 44 a product that was
compensated and interpolated was .04 low at Nyquist."""

_SMALLEST = 1e-3
_REACH_PX, _STEP_PX = 9.0, 0.1
_NOISE = 0.01
"""Noise, relative to the height, at which the first fit weighs its expectations."""
_NEGLIGIBLE = {"telescope": 1e-3}
_NEGLIGIBLE_ELSEWHERE = 5e-3
"""Share of the mean square of a family's first direction below which directions are left out:
about what an edge of 100 px at SNR 100 can tell."""


@dataclass(frozen=True, eq=False)
class Departure:
    """What a Gaussian through a pixel leaves of a sensor's LSF.

    Attributes
    ----------
    coefficients : (SIZE + 1,) array
        Of the LSF's spline, in which place, level and width of the Gaussian have no part, and the
        share of light in the 1/s^2 tail.
    width_px : float
        Width of the Gaussian through its pixel.
    """

    coefficients: Floats
    width_px: float


def departure(sensor: Sensor, normal_deg: float = 0.0) -> Departure:
    """What a Gaussian through a pixel leaves of a sensor's LSF.

    Parameters
    ----------
    sensor : Sensor
    normal_deg : float, optional
        Direction of the edge's normal.
    """
    profile = sensor.profile(normal_deg)
    s = np.arange(-_REACH_PX, _REACH_PX + _STEP_PX, _STEP_PX)
    along = np.zeros(s.size)
    fit = fit_first(
        along, s, profile.esf(s + profile.half_px), Line(row=0.0, col=0.0, normal_deg=0.0),
        dark=0.0, bright=1.0, noise=_NOISE,
    )  # fmt: skip
    width, places = fit.blur.width_px, CENTRES * fit.blur.width_px
    # The profile's own tail is tail / (pi s^2), ours tail TAIL_WIDTH / (pi u^2) per width.
    tail = profile.tail / (width * TAIL_WIDTH)
    seen = width * profile.lsf(places + profile.half_px + fit.line.col)
    seen -= tail * tail_lsf(CENTRES, TAIL_WIDTH)
    lsf, by_place, by_sigma, _ = fit.blur.lsf_slopes(places)
    free = np.linalg.qr(quasi_interpolant(np.stack([lsf, by_place, by_sigma], axis=1)))[0]
    left = quasi_interpolant(seen - width * fit.height * lsf)
    return Departure(np.append(left - free @ (free.T @ left), tail), width)


def principal_directions(departures: Floats, negligible: float) -> Floats:
    """Directions in which departures vary about none, and about as often mirrored as not.

    Parameters
    ----------
    departures : (n, SIZE + 1) array
    negligible : float
        Directions of a smaller share of the first one's mean square are left out.

    Returns
    -------
    (SIZE + 1, r) array
        Columns times their standard normal variables give a random departure.
    """
    both = np.concatenate([departures, _mirrored(departures)])
    power, axes = np.linalg.eigh(both.T @ both / len(both))
    kept = power > negligible * power[-1]
    return np.asarray(axes[:, kept] * np.sqrt(power[kept]))


def _mirrored(departures: Floats) -> Floats:
    mirrored = departures.copy()
    mirrored[..., :-1] = departures[..., -2::-1]
    return mirrored


def learn(
    sensors_per_family: int, seed: int, families: Iterable[str] = FAMILY_LOG_AMPLITUDES
) -> dict[str, Floats]:
    """The directions of every family, (SIZE + 1, r) each."""
    found = {}
    for number, family in enumerate(families):
        rng = np.random.default_rng((seed, number))
        drawn = [
            departure(draw_sensor(family, rng)).coefficients for _ in range(sensors_per_family)
        ]
        negligible = _NEGLIGIBLE.get(family, _NEGLIGIBLE_ELSEWHERE)
        found[family] = principal_directions(np.array(drawn), negligible)
    return found


def write(path: Path, directions: dict[str, Floats]) -> None:
    """Keep the directions of all families in a file that `lsf_prior` reads."""
    np.savez(path, allow_pickle=False, **{name: d.astype("<f4") for name, d in directions.items()})


def draw_density(counts: Mapping[str, int], seed: int) -> dict[str, Floats]:
    """The density of sensors: a basis of departures, and the sensors of every family in it.

    Returns
    -------
    dict of str to array
        "basis", (SIZE + 1, q); by family (n, q + 1): coordinates, and the logarithm of the width
        by which they are ordered. Directions of the basis are even or odd.
    """
    drawn, widths = {}, {}
    for number, (family, count) in enumerate(counts.items()):
        drawn[family], widths[family] = _departures(family, count, (seed, number))
    # Small departures are as interesting as large ones.
    even = [
        rows / max(float(np.linalg.norm(rows, axis=1).mean()), _SMALLEST) for rows in drawn.values()
    ]
    both = np.concatenate([*even, *map(_mirrored, even)])
    basis = np.linalg.svd(both, full_matrices=False)[2][:_COORDINATES].T
    columns = {name: np.column_stack([rows @ basis, widths[name]]) for name, rows in drawn.items()}
    return {"basis": basis, **columns}


def with_more(kept: Mapping[str, Floats], family: str, count: int, seed: int) -> dict[str, Floats]:
    """A density with a family that it has not, or another draw of one, in the basis it has.

    Parameters
    ----------
    kept : dict of str to array
        As `draw_density` gives it.
    family : str
    count, seed : int
    """
    rows, widths = _departures(family, count, (seed,))
    return {**kept, family: np.column_stack([rows @ kept["basis"], widths])}


def _departures(family: str, count: int, seed: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Coefficients of so many sensors, (n, SIZE + 1), and the logarithms of their widths, (n,),
    ascending."""
    rng = np.random.default_rng(seed)
    found = [departure(_drawn(family, rng)) for _ in range(count)]
    found.sort(key=lambda one: one.width_px)
    return np.array([one.coefficients for one in found]), np.log([one.width_px for one in found])


def _drawn(family: str, rng: np.random.Generator) -> Sensor:
    if family != "plain":
        return draw_sensor(family, rng)
    return Sensor([Gaussian(rng.uniform(0.05, 1.1)), Detector(rng.uniform(0.85, 1.0))])


def write_density(path: Path, density: dict[str, Floats]) -> None:
    """Keep the density of sensors in a file that `sensor_density` reads."""
    halves = {name: rows.astype("<f2") for name, rows in density.items() if name != "basis"}
    basis = density["basis"].astype("<f4")
    np.savez_compressed(path, allow_pickle=False, basis=basis, **halves)
