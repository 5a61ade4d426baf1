"""Images of one site on many days, by a sensor that changes, through air that differs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_all, require_finite, require_rng
from acutance.errors import ModelError, OptionError
from acutance.optics.aperture import Gaussian
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.campaign import render_site
from acutance.simulate.tarps import EdgeTarps, PulseTarp

__all__ = ["Overflight", "overflights"]


@dataclass(frozen=True, eq=False)
class Overflight:
    """One image of the site.

    Attributes
    ----------
    acquired : datetime
    pixels : (rows, cols) uint16 array
    shift_px : (float, float)
        By how much the site lies further down and to the right than it was said to.
    sensor : Sensor
        As it was that day, without the air.
    air_px : float
        Standard deviation of the Gaussian blur of the air.
    """

    acquired: datetime
    pixels: NDArray[np.uint16]
    shift_px: tuple[float, float]
    sensor: Sensor
    air_px: float


def overflights(
    sensor_on: Callable[[datetime], Sensor],
    tarps: Sequence[EdgeTarps | PulseTarp],
    shape: tuple[int, int],
    dates: Sequence[datetime],
    *,
    noise_std: float,
    air_px: float,
    rng: np.random.Generator,
    pointing_px: float = 2.0,
) -> Iterator[Overflight]:
    """One image a date.

    Parameters
    ----------
    sensor_on : function of a datetime
        The sensor as it is that day.
    tarps : sequence of EdgeTarps and PulseTarp
        Where they are said to lie; in each image they lie elsewhere by `pointing_px`.
    shape : (rows, cols)
    dates : sequence of datetime
    noise_std : float
        Of every pixel, in image units.
    air_px : float
        The air blurs each image by a Gaussian whose standard deviation is drawn from a half-normal
        distribution of this scale, in pixels.
    rng : numpy.random.Generator
    pointing_px : float, optional
        Standard deviation of the shift of an image, in either axis.

    Yields
    ------
    Overflight

    Raises
    ------
    ModelError
        If a deviation is negative or not finite.
    OptionError
        If an argument is of the wrong kind, or `sensor_on` gives no sensor.
    """
    if not callable(sensor_on):
        raise OptionError(
            f"sensor_on is {sensor_on!r:.80}: give a function of a date, lambda day: sensor"
        )
    require_all((EdgeTarps, PulseTarp), "tarps", tarps)
    require_all(datetime, "dates", dates)
    rng = require_rng(rng, "an overflight")
    require_finite(noise_std=noise_std, air_px=air_px, pointing_px=pointing_px)
    if min(noise_std, air_px, pointing_px) < 0:
        raise ModelError(
            f"noise {noise_std:g}, air {air_px:g} px and pointing {pointing_px:g} px were "
            "requested: standard deviations are 0 or more"
        )
    for acquired in dates:
        row, col = (float(one) for one in rng.normal(0.0, pointing_px, 2))
        blur = float(abs(rng.normal(0.0, air_px)))
        sensor = require_sensor(sensor_on(acquired))
        seen = replace(sensor, blocks=[*sensor.blocks, Gaussian(blur)]) if blur else sensor
        there = [_moved(tarp, row, col) for tarp in tarps]
        pixels = render_site(seen, there, shape).image + rng.normal(0.0, noise_std, shape)
        counts = np.clip(np.rint(pixels), 0, np.iinfo(np.uint16).max).astype(np.uint16)
        yield Overflight(acquired, counts, (row, col), sensor, blur)


def _moved(tarp: EdgeTarps | PulseTarp, row: float, col: float) -> EdgeTarps | PulseTarp:
    return replace(tarp, row=tarp.row + row, col=tarp.col + col)
