"""Learn from optics how point spread functions (PSF) depart from a Gaussian through a pixel.

Sensors of families (`acutance.optics.FAMILIES`; `tuned` says which) are drawn at random. The PSF of
each is fitted as the first fit of sources would be, and what is left of it, in the splines of
`psf_spline` and the tail, is its departure. Sensors are as often turned by 90 degrees and mirrored
as not, so departures of different parities have nothing to do with one another: the principal
directions of each, with the root of their mean square, are the family's part of the normal prior
(`psf_prior`). The departures themselves are the density of sensors (`learn_sensors`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates

from acutance.curves.grid import Floats
from acutance.numerics.lorentz_tail import tail_otf, tail_psf
from acutance.optics import Sensor, draw_sensor
from acutance.targets.points.first_fit import FirstFit, fit_first_gaussian
from acutance.targets.points.psf_families import PARITIES, Parities, entry_name
from acutance.targets.points.psf_prior import PsfDirections
from acutance.targets.points.psf_spline import (
    COARSE,
    FINE,
    GRIDS,
    Parity,
    SplineGrid,
    coarse_share,
    parity_part,
)
from acutance.targets.points.stamps import Stamps
from acutance.targets.points.tuned import FAMILY_LOG_AMPLITUDES

__all__ = [
    "Departure",
    "departure",
    "directions_of",
    "learn",
    "principal_directions",
    "sampled_psf",
    "write",
]

_STEP_PX: Final = 1 / 6
_SAMPLES: Final = 384
_RADIUS_PX: Final = 13.0
"""Of the pixels that the first fit sees: as `PointsOptions.radius_px` has it."""
_PHASES: Final = np.mod(np.outer(np.arange(13), (1, 5)) / 13 + 0.5, 1.0) - 0.5
"""Where in a pixel the sources of the first fit are: a lattice that a turn by 90 degrees keeps, of
which the blur is within .004 px² that of 20 mirrors."""
_APART_PX: Final = 100.0
_NEGLIGIBLE: Final = {"telescope": 3e-5, "restored": 3e-5, "shifted": 3e-3, "processed": 3e-3}
_NEGLIGIBLE_ELSEWHERE: Final = 3e-4
"""Share of the mean square of a family's first direction below which directions are left out. What
is even of shifted and processed sensors telescopes and restored ones have as well: with the 17 more
directions of a share of 3e-4 they are measured hardly better, at a fifth more of work."""
_SYMMETRIES: Final = [
    (parities, turned)
    for parities in PARITIES
    for turned in ((1, -1) if parities[0] == parities[1] else (0,))
]
"""Parities, and the sign under exchange of rows and columns where these are the same."""
_EXTREME: Final = 2.0
"""Size over a family's median beyond which departures are scaled down."""


class Departure(NamedTuple):
    """What a Gaussian through a pixel leaves of a PSF, per square width and light of the Gaussian.

    Flux, place and shape of the Gaussian have no part in it. Its blur and its light are those that
    the joint fit finds in pixels: coordinates of drawn and of measured sensors are the same.

    Attributes
    ----------
    fine, coarse : (size, size) arrays
        Coefficients on the two grids.
    tail : float
        Share of light in the tail.
    widths_px : (float, float)
        Widths of the Gaussian through its pixel, across and along.
    """

    fine: Floats
    coarse: Floats
    tail: float
    widths_px: tuple[float, float]


def sampled_psf(sensor: Sensor) -> Floats:
    """The PSF at steps of a sixth of a pixel over 64 px, its origin at the middle sample."""
    freq_cpp = np.fft.fftfreq(_SAMPLES, _STEP_PX)
    otf = np.broadcast_to(sensor.otf(freq_cpp, freq_cpp[:, None]), (_SAMPLES, _SAMPLES))
    # What falls like 1 / r^3 would be folded back: it is added behind the transform.
    tail = sensor.profile(0.0).tail
    otf = otf - tail * tail_otf(np.hypot(freq_cpp, freq_cpp[:, None]), 1.0)
    psf = np.fft.fftshift(np.fft.ifft2(otf).real) / _STEP_PX**2
    places_px = (np.arange(_SAMPLES) - _SAMPLES // 2) * _STEP_PX
    return np.asarray(psf + tail * tail_psf(np.hypot(places_px, places_px[:, None]), 1.0))


def _first_fit(psf: Floats) -> FirstFit:
    """The first fit of sources without noise, at phases all over a pixel.

    Sources have a flux, a place and a background each: of an undersampled PSF they take up what
    differs from phase to phase, so the blur is another one than of all its samples together.
    """
    reach = np.arange(-math.ceil(_RADIUS_PX), math.ceil(_RADIUS_PX) + 1.0)
    row, col = np.meshgrid(reach, reach, indexing="ij")
    away = row - _PHASES[:, 0, None, None], col - _PHASES[:, 1, None, None]
    owner, *pixel = np.nonzero(np.hypot(*away) <= _RADIUS_PX)
    row, col = row[tuple(pixel)], col[tuple(pixel)]
    light = _light_at(psf, row - _PHASES[owner, 0], col - _PHASES[owner, 1])
    apart = _APART_PX * np.arange(len(_PHASES))
    nobody = np.zeros(0, np.intp)
    stamps = Stamps(row, col + apart[owner], light, owner, nobody, nobody)
    truth = _PHASES + apart[:, None] * np.array([0.0, 1.0])
    found = fit_first_gaussian(stamps, np.rint(truth))
    return replace(found, places=found.places - truth)


def _light_at(psf: Floats, row: Floats, col: Floats) -> Floats:
    """A sampled PSF at distances from the source in pixels."""
    samples = np.stack([row, col]) / _STEP_PX + _SAMPLES // 2
    return np.asarray(map_coordinates(psf, samples, order=3, mode="grid-wrap"))


def departure(sensor: Sensor) -> Departure:
    """What a Gaussian through a pixel leaves of a sensor's PSF."""
    psf = sampled_psf(sensor)
    fit = _first_fit(psf)
    row, col = fit.places.mean(axis=0)
    wide, high = fit.blur.widths_px
    half_width_px = math.sqrt(wide * high)
    tail = sensor.profile(0.0).tail / half_width_px

    def light_at(x: Floats, y: Floats) -> Floats:
        return _light_at(psf, y + row, x + col)

    def seen(grid: SplineGrid) -> tuple[Floats, Floats]:
        """The PSF without its tail, (n, n), and the blur with what it is free in, (n, n, 6)."""
        x, y = np.meshgrid(grid.centres * wide, grid.centres * high)
        light = light_at(x, y)
        blur = np.stack(fit.blur.slopes(x.ravel(), y.ravel())[:6], axis=1)
        return light - tail * tail_psf(np.hypot(x, y), half_width_px), blur.reshape(*x.shape, 6)

    near, blur_near = seen(FINE)
    shares = np.linalg.lstsq(blur_near.reshape(-1, 6), near.ravel(), rcond=None)[0]
    far, blur_far = seen(COARSE)
    u, v = np.meshgrid(COARSE.centres, COARSE.centres)
    coarse = COARSE.coefficients((far - blur_far @ shares) * coarse_share(np.hypot(u, v)))
    u, v = np.meshgrid(FINE.centres, FINE.centres)
    rest = near - blur_near @ shares
    rest -= (COARSE.rows(u.ravel(), v.ravel()) @ coarse.ravel()).reshape(rest.shape)
    # The joint fit counts as light of the Gaussian what least squares finds of it in the whole.
    flux = PsfDirections(fit.blur).light_of_blur(light_at)
    scale = wide * high / flux
    return Departure(scale * FINE.coefficients(rest), scale * coarse, tail / flux, (wide, high))


def principal_directions(departures: Floats) -> tuple[Floats, Floats]:
    """Directions in which departures, (n, m), vary about none, and their mean squares.

    Returns
    -------
    power : (n,) array
        Mean squares, ascending.
    directions : (n, m) array
        Rows times their standard normal variables give a random departure.
    """
    power, axes = np.linalg.eigh(departures @ departures.T / len(departures))
    return power, np.asarray(axes.T @ departures / math.sqrt(len(departures)))


def directions_of(departures: Sequence[Departure], negligible: float) -> dict[Parities, Floats]:
    """The principal directions of a family's departures by parity.

    Sensors turned by 90 degrees and mirrored ones count as well. Directions are left out whose mean
    square is below a `negligible` share of the largest.

    Returns
    -------
    dict of (r, m) arrays
        A quadrant of coefficients on the fine grid, then on the coarse one, then the tail.
    """
    grids = [np.array([one[number] for one in departures]) for number in range(len(GRIDS))]
    tails = np.array([one.tail for one in departures])
    # A spline of the coarse grid stands for more light than one of the fine grid.
    counts = [*((grid.reach + 1) ** 2 for grid in GRIDS), 1]
    steps = np.repeat([*(grid.step for grid in GRIDS), 1.0], counts)

    def part(across: Parity, along: Parity, turned: int) -> Floats:
        """What is even or odd under both mirrors, and when turned, (n, m)."""
        own = [parity_part(one, across, along) for one in grids]
        if turned:
            own = [0.5 * (one + turned * one.transpose(0, 2, 1)) for one in own]
        else:
            # Half of the sensors trail along: theirs are the transposes.
            own = [math.sqrt(0.5) * one for one in own]
        tail = tails * (across == along == turned == 1)
        every = np.column_stack([*(one.reshape(tails.size, -1) for one in own), tail])
        return np.asarray(every * steps)

    parts = {(*parities, turned): part(*parities, turned) for parities, turned in _SYMMETRIES}
    size = np.sqrt(sum(np.sum(one**2, axis=1) for one in parts.values()))
    # Few extreme sensors would determine all directions.
    weight = np.minimum(1.0, _EXTREME * np.median(size) / size)[:, None]
    found = {key: principal_directions(weight * one) for key, one in parts.items()}
    least = negligible * max(power[-1] for power, _ in found.values())
    kept = {key: rows[power > least] / steps for key, (power, rows) in found.items()}
    return {
        parities: np.concatenate([rows for key, rows in kept.items() if key[:2] == parities])
        for parities in PARITIES
    }


def learn(
    sensors_per_family: int, seed: int, families: Iterable[str] = FAMILY_LOG_AMPLITUDES
) -> dict[str, Floats]:
    """The directions of every family and parity, (r, m) each, by the names in the file."""
    learned: dict[str, Floats] = {}
    for number, family in enumerate(families):
        rng = np.random.default_rng((seed, number))
        drawn = [departure(draw_sensor(family, rng)) for _ in range(sensors_per_family)]
        found = directions_of(drawn, _NEGLIGIBLE.get(family, _NEGLIGIBLE_ELSEWHERE))
        learned |= {entry_name(family, *parities): rows for parities, rows in found.items()}
    return learned


def write(path: Path, learned: dict[str, Floats]) -> None:
    """Keep the directions in a file that `psf_families` reads."""
    small = {name: rows.astype("<f2") for name, rows in learned.items()}
    np.savez_compressed(path, allow_pickle=False, **small)
