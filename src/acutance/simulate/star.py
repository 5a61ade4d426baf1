"""A Siemens star, every frequency in every direction, as a sensor sees it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import require_finite, require_floats, require_kind, require_place
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError
from acutance.geometry.angles import direction_difference, wrap_direction
from acutance.optics.block import require, require_count
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.ground import MAX_SUBPIXELS, render_raster
from acutance.simulate.limits import require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.scene import require_canvas, stamp

__all__ = ["Star", "StarTruth", "Wave", "add_star", "star"]

Wave = Literal["sine", "square"]
SUBPIXELS = 10
"""Squares a pixel side is drawn with; borders of spokes are drawn as shares of a square."""

ROOM_PX = 12
"""Background rendered around the star: light scattered further comes from the other side."""


@dataclass(frozen=True)
class Star:
    """Spokes about a centre: ``k`` bright and ``k`` dark ones, or a sine of ``k`` periods.

    Parameters
    ----------
    row, col : float
        Centre in pixels.
    radius_px : float
        Outer radius.
    cycles : int
        Periods k in a full turn.
    wave : {"sine", "square"}
        Form of the modulation round the centre.
    start_deg, sweep_deg : float
        Where the star begins, from the column axis towards the row axis, and how far it goes:
        360 for a full star, less for a fan.
    finest_cpp : float
        Inside the radius where the spokes reach this frequency the star is uniform grey.

    Raises
    ------
    ModelError
        If a number or the wave makes no sense, or the grey centre reaches the rim.
    """

    row: float
    col: float
    radius_px: float
    cycles: int = 36
    wave: Wave = "sine"
    start_deg: float = 0.0
    sweep_deg: float = 360.0
    finest_cpp: float = 1.5

    def __post_init__(self) -> None:
        require_count(self, 1000, cycles=self.cycles)
        require(self, -math.inf, row=self.row, col=self.col, start_deg=self.start_deg)
        require(self, above=True, radius_px=self.radius_px)
        require(self, 0.0, 2.5, above=True, finest_cpp=self.finest_cpp)
        require(self, 0.0, 360.0, above=True, sweep_deg=self.sweep_deg)
        if not isinstance(self.wave, str) or self.wave not in ("sine", "square"):
            raise ModelError(f'Star: wave is {self.wave!r}, it has to be "sine" or "square"')
        if not self.inner_px < self.radius_px:
            raise ModelError(
                f"Star: {self.cycles} cycles reach {self.finest_cpp:g} c/px at {self.inner_px:.1f} "
                f"px, beyond the radius of {self.radius_px:g} px: use fewer cycles"
            )

    @property
    def inner_px(self) -> float:
        """Radius of the grey centre."""
        return self.cycles / (2 * math.pi * self.finest_cpp)

    def freq_cpp(self, radius_px: ArrayLike) -> Floats:
        """Frequency round the centre at a radius: ``k / (2 pi r)``."""
        return np.asarray(self.cycles / (2 * math.pi * require_floats("radius_px", radius_px)))

    def radius_at_px(self, freq_cpp: ArrayLike) -> Floats:
        """Radius at which the spokes have a frequency."""
        return np.asarray(self.cycles / (2 * math.pi * np.asarray(freq_cpp, float)))

    def drawn(self, rows: Floats, cols: Floats, fine_px: float) -> tuple[Floats, Floats]:
        """Modulation (-1 to 1) and coverage (0 to 1) at places, means over about `fine_px`."""
        y, x = rows - self.row, cols - self.col
        radius = np.hypot(x, y)
        half = 0.5 * self.sweep_deg
        turn_deg = wrap_direction(np.degrees(np.arctan2(y, x)) - self.start_deg - half) + half
        fine_deg = np.degrees(np.minimum(fine_px / np.maximum(radius, 1e-9), 2 * math.pi))
        first, last = turn_deg - 0.5 * fine_deg, turn_deg + 0.5 * fine_deg
        if self.sweep_deg < 360:
            first, last = np.maximum(first, 0.0), np.minimum(last, self.sweep_deg)
        if self.wave == "square":
            wave = self._mean_square(first, last)
        else:
            wave = np.sin(np.radians(self.cycles * turn_deg))
        wave = wave * np.clip(0.5 + (radius - self.inner_px) / fine_px, 0.0, 1.0)
        cover = np.clip(0.5 + (self.radius_px - radius) / fine_px, 0.0, 1.0)
        return wave, cover * np.clip((last - first) / fine_deg, 0.0, 1.0)

    def _mean_square(self, first_deg: Floats, last_deg: Floats) -> Floats:
        """Mean of the square wave between two angles from its beginning.

        At a border of a fan it is that of the part inside: a spoke ends there, and the next one
        would be of the other sign.
        """
        # The integral of a square wave is a triangle wave.
        first, last = (
            direction_difference(self.cycles * one, 0.0) for one in (first_deg, last_deg)
        )
        return np.asarray((last - first) / (self.cycles * np.maximum(last_deg - first_deg, 1e-9)))


@dataclass(frozen=True, eq=False)
class StarTruth(ShortRepr):
    """The truth of a simulated star: the result of a perfect measurement.

    Parameters
    ----------
    sensor : Sensor
    star : Star
    dark, bright : float
        Levels between which the spokes go.
    ground : float
        Level around the star.
    noise : Noise, optional
        Noise that was added to the image.
    """

    sensor: Sensor
    star: Star
    dark: float
    bright: float
    ground: float
    noise: Noise | None = None

    def mtf_toward(self, direction_deg: float, freq_cpp: ArrayLike) -> Floats:
        """MTF for spokes whose normal points in a direction, at frequencies in c/px."""
        (x, y), freq = unit_vector(direction_deg), np.asarray(freq_cpp, float)
        return np.abs(self.sensor.otf(freq * x, freq * y))

    def mtf_mean(self, freq_cpp: ArrayLike, directions_deg: ArrayLike | None = None) -> Floats:
        """Mean of the MTF over some directions, at frequencies in c/px.

        Parameters
        ----------
        freq_cpp : float or (n,) array_like
        directions_deg : (k,) array_like, optional
            Directions of the normals; those of all spokes unless given.
        """
        freq = require_floats("freq_cpp", freq_cpp)
        if directions_deg is None:
            middle = (np.arange(360) + 0.5) / 360 * self.star.sweep_deg
            # The normal of a spoke is a quarter turn from the spoke.
            directions_deg = self.star.start_deg + middle + 90.0
        x, y = unit_vector(np.atleast_1d(require_floats("directions_deg", directions_deg)))
        u, v = np.multiply.outer(freq, x), np.multiply.outer(freq, y)
        return np.asarray(np.mean(np.abs(self.sensor.otf(u, v)), axis=-1))

    def to_dict(self) -> dict[str, Any]:
        """Geometry, levels and the mean MTF, for JSON."""
        star = self.star
        freq = np.round(np.arange(0.0, 1.001, 0.02), 6)
        return {
            "kind": "star",
            "row": star.row,
            "col": star.col,
            "radius_px": star.radius_px,
            "inner_px": star.inner_px,
            "cycles": star.cycles,
            "wave": star.wave,
            "start_deg": star.start_deg,
            "sweep_deg": star.sweep_deg,
            "dark": self.dark,
            "bright": self.bright,
            "ground": self.ground,
            "mtf": {"freq_cpp": freq.tolist(), "value": self.mtf_mean(freq).tolist()},
        }


def add_star(
    image: NDArray[Any], sensor: Sensor, star: Star, *, mean: float, amplitude: float
) -> None:
    """Add a star to an image in place.

    It is drawn on a grid of 1/10 px. Against 1/30 px no pixel changes by more than 1e-3 of the
    contrast for a sine (at the rim; 1e-4 at the grey centre, nothing between), 2e-3 for a square
    wave (where borders follow the rim or a diagonal of the grid; 1e-3 elsewhere).

    Parameters
    ----------
    image : (rows, cols) array
        Changed in place.
    sensor : Sensor
    star : Star
    mean, amplitude : float
        Mean level of the star above what is there, and the modulation about it.

    Raises
    ------
    ModelError
        If the star is too large to be drawn, or a level is not finite.
    OptionError
        If an argument is of the wrong kind.
    """
    require_canvas(image)
    require_sensor(sensor)
    require_kind(Star, star=star)
    require_finite(mean=mean, amplitude=amplitude)
    side = 2 * (math.ceil(star.radius_px) + ROOM_PX)
    if (side * SUBPIXELS) ** 2 > MAX_SUBPIXELS:
        raise ModelError(
            f"a star of {star.radius_px:g} px is drawn with {(side * SUBPIXELS) ** 2 / 1e6:.0f} "
            f"million squares of 1/{SUBPIXELS} px, {MAX_SUBPIXELS / 1e6:.0f} million are possible: "
            "use a smaller radius"
        )
    top, left = round(star.row) - side // 2, round(star.col) - side // 2
    fine = (np.arange(side * SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
    wave, cover = star.drawn(fine[:, None] + top, fine[None, :] + left, 1 / SUBPIXELS)
    level = (mean + amplitude * wave) * cover
    drawn: Literal["points", "means"] = "points" if star.wave == "sine" else "means"
    stamp(image, render_raster(sensor, level, SUBPIXELS, drawn=drawn), top, left)


def star(
    sensor: Sensor,
    *,
    cycles: int = 36,
    shape: tuple[int, int] = (128, 128),
    radius_px: float = 52.0,
    wave: Wave = "sine",
    start_deg: float = 0.0,
    sweep_deg: float = 360.0,
    finest_cpp: float = 1.5,
    centre: tuple[float, float] | None = None,
    dark: float = 200.0,
    bright: float = 1200.0,
    ground: float | None = None,
    snr: float | None = None,
    noise: Noise | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[Floats, StarTruth]:
    """An image of a Siemens star, and the truth about it; accuracy as `add_star` states.

    Parameters
    ----------
    sensor : Sensor
    cycles : int, optional
        Periods in a full turn.
    shape : (rows, cols), optional
    radius_px : float, optional
        Outer radius.
    wave : {"sine", "square"}, optional
    start_deg, sweep_deg : float, optional
        Where the star begins and how far it goes; 360 is a full star, less a fan.
    finest_cpp : float, optional
        Frequency at which the spokes end in a grey centre, 2.5 at most.
    centre : (row, col), optional
        The middle of the image unless given.
    dark, bright : float, optional
        Levels between which the spokes go, in image units.
    ground : float, optional
        Level around the star; half way between dark and bright unless given.
    snr : float, optional
        Contrast over the standard deviation of added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    rng : numpy.random.Generator, optional
        Source of randomness; needed as soon as there is noise.

    Returns
    -------
    image : (rows, cols) array of float
    truth : StarTruth

    Raises
    ------
    ModelError
        If the arguments contradict each other, or the star does not fit into the image.
    OptionError
        If an argument is of the wrong kind.
    """
    require_sensor(sensor)
    require_shape(shape)
    middle = (0.5 * (shape[0] - 1), 0.5 * (shape[1] - 1))
    centre = middle if centre is None else centre
    require_place(centre=centre)
    require_finite(dark=dark, bright=bright, start_deg=start_deg)
    mean = 0.5 * (dark + bright)
    around = mean if ground is None else ground
    require_finite(ground=around)
    target = Star(*centre, radius_px, cycles, wave, start_deg, sweep_deg, finest_cpp)
    room = min(*centre, shape[0] - 1 - centre[0], shape[1] - 1 - centre[1])
    if not dark < bright or radius_px > room:
        raise ModelError(
            f"a star of {radius_px:g} px from {dark:g} to {bright:g} was requested: dark has to be "
            f"the lower one, and the image has room for {room:.1f} px"
        )
    image = np.full(shape, float(around))
    add_star(image, sensor, target, mean=mean - around, amplitude=0.5 * (bright - dark))
    added = noise_of_snr(bright - dark, snr, noise, min(dark, around))
    truth = StarTruth(sensor, target, dark, bright, around, added)
    return (image if added is None else added.added_to(image, rng)), truth
