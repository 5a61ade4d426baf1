"""A field of the night sky: few stars among many galaxies, and what is no light at all."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from acutance.arguments import require_finite, require_optional, require_rng
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.optics.block import require, require_range
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.galaxy import Galaxy
from acutance.simulate.limits import require_shape
from acutance.simulate.noise import Noise
from acutance.simulate.points import PointsTruth, peak_per_flux
from acutance.simulate.scene import Point, render_patches, stamp

__all__ = ["SkyField", "SkyTruth", "sky"]

_STEPS_A_PIXEL: Final = 40
_STEP_PX: Final = 32
_SMALLEST_PX, _LARGEST_PX = 96, 256
_MAX_OBJECTS: Final = 20000
_REACHES: Final = 6.0
"""Half-light radii of a galaxy that are rendered on either side beyond a star's window."""


@dataclass(frozen=True)
class SkyField:
    """What a field of the sky holds.

    Parameters
    ----------
    stars, galaxies, doubles, cosmic_rays, hot_pixels : int
        How many of each; a double is two stars 0.8 to 3 px apart.
    snr : (float, float)
        Peak of stars over the noise, log-uniform in this range; the flux of galaxies is that of
        stars of the same range.
    half_light_px : (float, float)
        Half-light radii of galaxies, log-uniform in this range.
    bulges : float
        Share of the galaxies with a de Vaucouleurs profile; the others are exponential discs.

    Raises
    ------
    ModelError, OptionError
        If a number makes no sense, or a range does not rise.
    """

    stars: int = 30
    galaxies: int = 300
    doubles: int = 5
    cosmic_rays: int = 25
    hot_pixels: int = 8
    snr: tuple[float, float] = (15.0, 600.0)
    half_light_px: tuple[float, float] = (0.6, 6.0)
    bulges: float = 0.3

    def __post_init__(self) -> None:
        require(
            self, 0, _MAX_OBJECTS, stars=self.stars, galaxies=self.galaxies, doubles=self.doubles,
            cosmic_rays=self.cosmic_rays, hot_pixels=self.hot_pixels,
        )  # fmt: skip
        require(self, 0.0, 1.0, bulges=self.bulges)
        require_range(self, above=True, snr=self.snr, half_light_px=self.half_light_px)


@dataclass(frozen=True, eq=False)
class SkyTruth(ShortRepr):
    """The truth of a simulated field.

    Parameters
    ----------
    points : PointsTruth
        The single stars: places, fluxes and the true curves.
    galaxies : tuple of Galaxy
    doubles : (n, 2) array
        Places (row, col) of the stars of doubles, two after each other.
    cosmic_rays, hot_pixels : (n, 2) arrays
        Where a track begins, and which pixel is hot.
    noise : Noise
    """

    points: PointsTruth
    galaxies: tuple[Galaxy, ...]
    doubles: Floats
    cosmic_rays: Floats
    hot_pixels: Floats
    noise: Noise

    def to_dict(self) -> dict[str, Any]:
        """The truth of the stars, and where everything else is, for JSON."""
        return {
            **self.points.to_dict(),
            "kind": "sky",
            "galaxies": [dict(vars(one)) for one in self.galaxies],
            "doubles": self.doubles.tolist(),
            "cosmic_rays": self.cosmic_rays.tolist(),
            "hot_pixels": self.hot_pixels.tolist(),
        }


def sky(
    sensor: Sensor,
    field: SkyField | None = None,
    *,
    shape: tuple[int, int] = (512, 512),
    background: float = 1000.0,
    noise: Noise | None = None,
    rng: np.random.Generator,
) -> tuple[Floats, SkyTruth]:
    """An image of stars, galaxies, doubles, cosmic rays and hot pixels, and the truth about it.

    Stars and galaxies are exact: the folded product of their spectrum and the OTF, each in a
    window of 96 px or more. Cosmic rays and hot pixels never pass through the optics: they are
    added to the pixels a track crosses, in proportion to its length in each.

    Parameters
    ----------
    sensor : Sensor
    field : SkyField, optional
        What there is; 30 stars among 300 galaxies unless given.
    shape : (rows, cols), optional
    background : float, optional
    noise : Noise, optional
        White with a standard deviation of 10 unless given; SNR refers to its noise on the
        background.
    rng : numpy.random.Generator

    Returns
    -------
    image : (rows, cols) array of float
    truth : SkyTruth

    Raises
    ------
    ModelError, OptionError
        If a number makes no sense, or an argument is of the wrong kind.
    """
    require_sensor(sensor)
    require_optional(SkyField, field=field)
    require_optional(Noise, noise=noise)
    field = SkyField() if field is None else field
    noise = Noise(read=10.0) if noise is None else noise
    require_finite(background=background)
    require_shape(shape)
    rng = require_rng(rng, "sky")
    std = float(noise.std(np.full(1, background))[0])
    flux_of_snr = std / peak_per_flux(sensor)

    stars = _places(field.stars, shape, 16.0, rng)
    fluxes = _log_uniform(field.snr, field.stars, rng) * flux_of_snr
    galaxies = _galaxies(field, shape, flux_of_snr, rng)
    doubles, double_fluxes = _doubles(field, shape, flux_of_snr, rng)
    objects: list[Point | Galaxy] = [
        Point(row, col, flux)
        for (row, col), flux in zip(
            np.vstack([stars, doubles]).tolist(),
            np.concatenate([fluxes, double_fluxes]).tolist(),
            strict=True,
        )
    ]
    image = np.full(shape, background)
    for one in (*objects, *galaxies):
        _add(image, sensor, one)
    image = noise.added_to(image, rng)
    rays = _add_cosmic_rays(image, field.cosmic_rays, std, rng)
    hot = np.rint(_places(field.hot_pixels, shape, 4.0, rng))
    for row, col in hot.astype(int).tolist():
        image[row, col] += std * float(_log_uniform((30.0, 600.0), 1, rng)[0])
    points = PointsTruth(sensor, stars, fluxes, background, noise)
    return image, SkyTruth(points, galaxies, doubles, rays, hot, noise)


def _places(
    count: int, shape: tuple[int, int], border_px: float, rng: np.random.Generator
) -> Floats:
    columns = [rng.uniform(border_px, size - 1 - border_px, count) for size in shape]
    return np.stack(columns, axis=1)


def _log_uniform(limits: tuple[float, float], count: int, rng: np.random.Generator) -> Floats:
    low, high = (math.log(one) for one in limits)
    return np.asarray(np.exp(rng.uniform(low, high, count)))


def _galaxies(
    field: SkyField, shape: tuple[int, int], flux_of_snr: float, rng: np.random.Generator
) -> tuple[Galaxy, ...]:
    count = field.galaxies
    columns = zip(
        _places(count, shape, 4.0, rng).tolist(),
        (_log_uniform(field.snr, count, rng) * flux_of_snr).tolist(),
        _log_uniform(field.half_light_px, count, rng).tolist(),
        (rng.uniform(size=count) < field.bulges).tolist(),
        rng.uniform(0.3, 1.0, count).tolist(),
        rng.uniform(0.0, 180.0, count).tolist(),
        strict=True,
    )
    return tuple(
        Galaxy(
            row, col, flux, half_light_px=half, axis_ratio=ratio, turn_deg=turn,
            profile="de-vaucouleurs" if bulge else "exponential",
        )
        for (row, col), flux, half, bulge, ratio, turn in columns
    )  # fmt: skip


def _doubles(
    field: SkyField, shape: tuple[int, int], flux_of_snr: float, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    first = _places(field.doubles, shape, 16.0, rng)
    fluxes = _log_uniform(field.snr, field.doubles, rng) * flux_of_snr
    apart, turn = rng.uniform(0.8, 3.0, field.doubles), rng.uniform(0, 2 * np.pi, field.doubles)
    second = first + apart[:, None] * np.stack([np.sin(turn), np.cos(turn)], axis=1)
    both = np.stack([fluxes, fluxes * rng.uniform(0.3, 1.0, field.doubles)], axis=1)
    return np.stack([first, second], axis=1).reshape(-1, 2), both.ravel()


def _add(image: Floats, sensor: Sensor, one: Point | Galaxy) -> None:
    """Add an object to the image in place, in a window as wide as the object asks for."""
    reach = _REACHES * one.half_light_px if isinstance(one, Galaxy) else 0.0
    side = _SMALLEST_PX + _STEP_PX * math.ceil(2 * reach / _STEP_PX)
    side = min(side, _LARGEST_PX)
    top, left = round(one.row) - side // 2, round(one.col) - side // 2
    moved = replace(one, row=one.row - top, col=one.col - left)
    stamp(image, render_patches(sensor, [moved], (side, side), margin_px=0), top, left)


def _add_cosmic_rays(image: Floats, count: int, std: float, rng: np.random.Generator) -> Floats:
    """Straight tracks of 0.2 to 8 px, each with an even charge along its length, in place."""
    starts = _places(count, (image.shape[0], image.shape[1]), 10.0, rng)
    lengths, turns = _log_uniform((0.2, 8.0), count, rng), rng.uniform(0, 2 * np.pi, count)
    charges = std * _log_uniform((30.0, 600.0), count, rng)
    for start, length, turn, charge in zip(
        starts, lengths.tolist(), turns.tolist(), charges.tolist(), strict=True
    ):
        steps = max(round(_STEPS_A_PIXEL * length), 1)
        along = (np.arange(steps) + 0.5) * length / steps
        rows = np.rint(start[0] + along * math.sin(turn)).astype(int)
        cols = np.rint(start[1] + along * math.cos(turn)).astype(int)
        # A longer track leaves more charge in all, and as much in every pixel it crosses.
        np.add.at(image, (rows, cols), charge * max(length, 1.0) / steps)
    return starts
