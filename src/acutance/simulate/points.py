"""Point sources, single or in arrays of mirrors, as a sensor sees them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_finite, require_floats, require_place, require_whole
from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError
from acutance.geometry.line import Orientation
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.limits import require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.scene import Point, render_patches

__all__ = ["PointsTruth", "mirror_columns", "mirror_square", "points"]


@dataclass(frozen=True, eq=False)
class PointsTruth(ShortRepr):
    """The truth of simulated point sources: the result of a perfect measurement.

    Parameters
    ----------
    sensor : Sensor
    positions : (n, 2) array
        True places of the sources as (row, col). A sensor with a trail shows them off by the
        centroid of its PSF, `centroid_px`.
    fluxes : (n,) array
        Light of each source, summed over pixels.
    background : float
    noise : Noise, optional
        Noise that was added to the image.
    """

    sensor: Sensor
    positions: Floats
    fluxes: Floats
    background: float
    noise: Noise | None = None

    def response(self, orientation: Orientation = "across") -> Response:
        """True curves across or along: those of the PSF integrated over the other axis."""
        return self.sensor.response(0.0, orientation)

    @property
    def centroid_px(self) -> tuple[float, float]:
        """Centroid (row, col) of the PSF, measured from its origin."""
        return self.sensor.profile(90.0).centroid_px, self.sensor.profile(0.0).centroid_px

    def to_dict(self) -> dict[str, Any]:
        """Sources and the true curves of both directions, for JSON."""
        directions: dict[str, Any] = {}
        orientations: tuple[Orientation, ...] = ("across", "along")
        for orientation in orientations:
            found = self.response(orientation)
            numbers = {name: number.value for name, number in found.metrics().items()}
            curve = {
                "freq_cpp": np.round(found.mtf.freq_cpp, 6).tolist(),
                "value": found.mtf.value.tolist(),
            }
            directions[orientation] = {**numbers, "mtf": curve}
        return {
            "kind": "points",
            "positions": self.positions.tolist(),
            "fluxes": self.fluxes.tolist(),
            "background": self.background,
            **directions,
        }


def mirror_columns(
    first: tuple[float, float],
    *,
    count: int = 10,
    step: tuple[float, float] = (10.2, 1.25),
    columns: int = 2,
    apart_px: float = 11.43,
) -> Floats:
    """Places of mirrors in slanted columns, those of the QuickBird campaign unless given.

    Steps of 10.2 px along and 1.25 px across spread the mirrors over phases of 0.2 by 0.25 px
    (Helder, Choi, Rangaswamy, SDSU, 2005, 5.7.2); the columns were 8 m, 11.43 px, apart (4.4).

    Parameters
    ----------
    first : (row, col)
        Place of the first mirror.
    count : int, optional
        Mirrors in a column.
    step : (row, col), optional
        From one mirror of a column to the next, in pixels.
    columns : int, optional
    apart_px : float, optional
        Distance of the columns.

    Returns
    -------
    (count * columns, 2) array

    Raises
    ------
    OptionError, ModelError
        If a number is none, or not finite; if there is no mirror.
    """
    require_place(first=first, step=step)
    require_whole(1, count=count, columns=columns)
    require_finite(apart_px=apart_px)
    down = np.arange(count)[:, None] * np.array(step)
    right = np.arange(columns)[:, None, None] * np.array([0.0, apart_px])
    return np.asarray((np.array(first) + right + down).reshape(-1, 2))


def mirror_square(first: tuple[float, float], *, side: int = 4, pitch_px: float = 5.25) -> Floats:
    """Places of mirrors in a square grid: 4 by 4 at 5.25 px have phases of 0.25 px.

    Parameters
    ----------
    first : (row, col)
        Place of the first mirror.
    side : int, optional
        Mirrors in a row and in a column.
    pitch_px : float, optional

    Returns
    -------
    (side * side, 2) array

    Raises
    ------
    OptionError, ModelError
        If a number is none, or not finite; if there is no mirror.
    """
    require_place(first=first)
    require_whole(1, side=side)
    require_finite(pitch_px=pitch_px)
    rows, cols = np.indices((side, side)) * pitch_px
    return np.column_stack([rows.ravel() + first[0], cols.ravel() + first[1]])


def points(
    sensor: Sensor,
    *,
    positions: ArrayLike | None = None,
    fluxes: ArrayLike | None = None,
    peak: float = 1000.0,
    background: float = 200.0,
    shape: tuple[int, int] | None = None,
    snr: float | None = None,
    noise: Noise | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[Floats, PointsTruth]:
    """An image of point sources on uniform ground, and the truth about it.

    Every pixel holds the PSF with the pixel's area at its distance: the folded OTF, exact but for
    light of the copies 64 px beyond the image.

    Parameters
    ----------
    sensor : Sensor
    positions : (n, 2) array_like, optional
        Places as (row, col); 20 mirrors in two columns unless given.
    fluxes : (n,) array_like or float, optional
        Light of each source, summed over pixels.
    peak : float, optional
        Signal that a source on the centre of a pixel adds to that pixel, instead of `fluxes`.
    background : float, optional
        Level of the ground.
    shape : (rows, cols), optional
        As much as the sources need with 12 px around, unless given.
    snr : float, optional
        Peak of the brightest source over the standard deviation of added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    rng : numpy.random.Generator, optional
        Source of randomness; needed as soon as there is noise.

    Returns
    -------
    image : (rows, cols) array of float
    truth : PointsTruth

    Raises
    ------
    ModelError
        If there are no sources, one lies outside the image, their numbers differ, a flux is not
        finite, or `peak` is not above 0.
    OptionError
        If an argument is of the wrong kind.
    """
    require_sensor(sensor)
    given = mirror_columns((12.0, 12.0)) if positions is None else positions
    places = require_floats("positions", given)
    if places.ndim != 2 or places.shape[0] == 0 or places.shape[1] != 2:
        raise ModelError(f"positions have shape {places.shape}, they have to be (n, 2): row, col")
    require_finite(peak=peak, background=background)
    if not peak > 0:
        raise ModelError(f"peak is {peak:g}, it has to be above 0: a source adds light")
    if not np.all(np.isfinite(places)):
        raise ModelError("a position is not a finite number: give (row, col) in pixels")
    if shape is None:
        last = np.ceil(places.max(axis=0)).astype(int) + 13
        shape = (int(last[0]), int(last[1]))
    require_shape(shape)
    if np.any(places < 0) or np.any(places > np.array(shape) - 1):
        raise ModelError(
            f"a source lies outside the image of {shape[0]} by {shape[1]} pixels: give a "
            "larger shape"
        )
    brightness = peak_per_flux(sensor)
    light = require_floats("fluxes", peak / brightness if fluxes is None else fluxes)
    if light.shape not in ((), (places.shape[0],)):
        raise ModelError(
            f"{light.size} fluxes were given for {places.shape[0]} positions: give one for each"
        )
    light = np.broadcast_to(light, places.shape[:1]).copy()
    if not np.all(np.isfinite(light)):
        raise ModelError("a flux is not a finite number: give the light of each source")
    sources = [
        Point(row, col, float(flux))
        for (row, col), flux in zip(places.tolist(), light, strict=True)
    ]
    image = background + render_patches(sensor, sources, shape)
    added = noise_of_snr(float(light.max()) * brightness, snr, noise, background)
    truth = PointsTruth(sensor, places, light, background, added)
    return (image if added is None else added.added_to(image, rng)), truth


def peak_per_flux(sensor: Sensor) -> float:
    """Signal that a source of flux 1 on the centre of a pixel adds to that pixel."""
    return float(render_patches(sensor, [Point(8.0, 8.0, 1.0)], (17, 17))[8, 8])
