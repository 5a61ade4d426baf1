"""Groups of bars, the periodic targets that are read by eye, as a sensor sees them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.arguments import require_finite, require_floats, require_numbers
from acutance.curves import Response
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError, OptionError
from acutance.geometry.bar_group import Bars
from acutance.geometry.line import Line, Orientation
from acutance.optics.block import Transfer, require, require_count
from acutance.optics.sensor import Sensor, normal_direction_deg, require_sensor
from acutance.simulate.limits import require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.scene import Patch, add_patches

__all__ = ["BarGroup", "BarsTruth", "bars"]

GAP_PX = 10.0
"""Background between two groups, and around them."""

MAX_BARS = 10_000
"""Of a group: far more than any target has."""

HARMONICS, BAND_CPP = (25, 10_000), 8.0
"""Odd harmonics of square bars in the contrast: all up to a frequency, 25 to 10 000 of them."""


@dataclass(frozen=True)
class BarGroup(Bars):
    """A group of bars as it lies in a scene."""

    def __post_init__(self) -> None:
        require_count(self, MAX_BARS, count=self.count)
        require(self, above=True, period_px=self.period_px, length_px=self.length_px)
        require(self, -math.inf, row=self.row, col=self.col, normal_deg=self.normal_deg)

    def patches(self, contrast: float) -> list[Patch]:
        """The bars as rectangles of the given level above the background."""
        middle = Line(self.row, self.col, self.normal_deg)
        lines = [middle.moved(place, 0.0) for place in self.places_px.tolist()]
        half = 0.5 * self.period_px
        return [
            Patch(one.row, one.col, half, self.length_px, self.normal_deg, contrast)
            for one in lines
        ]


@dataclass(frozen=True, eq=False)
class BarsTruth(ShortRepr):
    """The truth of simulated bars: the result of a perfect measurement.

    Parameters
    ----------
    sensor : Sensor
    groups : tuple of BarGroup
        All with the same normal.
    dark, bright : float
        Levels of the background and of the bars.
    noise : Noise, optional
        Noise that was added to the image.
    """

    sensor: Sensor
    groups: tuple[BarGroup, ...]
    dark: float
    bright: float
    noise: Noise | None = None

    @property
    def response(self) -> Response:
        """The true curves along the bars' normal."""
        return self.sensor.response_along(self.groups[0].normal_deg)

    @property
    def freq_cpp(self) -> Floats:
        """Frequencies of the groups, (n,)."""
        return np.array([group.freq_cpp for group in self.groups])

    @property
    def mtf(self) -> Floats:
        """MTF at the frequencies of the groups, (n,)."""
        return np.asarray(np.abs(self._otf(self.freq_cpp)))

    @property
    def ctf(self) -> Floats:
        """Contrast of endless square bars, where it is read midway on bars and gaps, (n,).

        Coltman's series ``4/pi sum_k (-1)^k Re OTF((2k+1) f) / (2k+1)`` (JOSA 44, 468, 1954), with
        the phase relative to the LSF's centroid, as far as any sensor passes its terms.
        """
        count = math.ceil(0.5 * BAND_CPP / float(self.freq_cpp.min()))
        number = np.arange(min(max(count, HARMONICS[0]), HARMONICS[1]))
        odd = 2 * number + 1
        signs = (-1.0) ** number / odd
        return np.asarray(4 / math.pi * self._otf(np.outer(self.freq_cpp, odd)).real @ signs)

    def _otf(self, freq_cpp: Floats) -> Transfer:
        x, y = unit_vector(self.groups[0].normal_deg)
        centroid = self.sensor.profile(self.groups[0].normal_deg).centroid_px
        otf = self.sensor.otf(freq_cpp * x, freq_cpp * y)
        return np.asarray(otf * np.exp(2j * math.pi * freq_cpp * centroid))

    def to_dict(self) -> dict[str, Any]:
        """Groups with their frequencies, MTF and contrast, for JSON."""
        described = [
            {
                "region": group.region.tolist(),
                "period_px": group.period_px,
                "freq_cpp": group.freq_cpp,
                "count": group.count,
                "mtf": float(mtf),
                "ctf": float(ctf),
            }
            for group, mtf, ctf in zip(self.groups, self.mtf, self.ctf, strict=True)
        ]
        return {
            "kind": "bars",
            "normal_deg": self.groups[0].normal_deg,
            "dark": self.dark,
            "bright": self.bright,
            "groups": described,
        }


def bars(
    sensor: Sensor,
    *,
    periods_px: Sequence[float] = (8.0, 6.0, 5.0, 4.0, 3.2, 2.5, 2.0),
    count: int = 5,
    length_px: float = 24.0,
    angle_deg: float = 0.0,
    orientation: Orientation = "across",
    dark: float = 200.0,
    bright: float = 1200.0,
    snr: float | None = None,
    noise: Noise | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[Floats, BarsTruth]:
    """An image of groups of bars below one another, and the truth about it.

    Every bar is a rectangle rendered by its closed-form spectrum: exact as `render_patches`.

    Parameters
    ----------
    sensor : Sensor
    periods_px : sequence of float, optional
        Distance of two bars in each group, in pixels.
    count : int, optional
        Bars in a group.
    length_px : float, optional
        Length of the bars.
    angle_deg : float, optional
        Tilt of the bars against the nearer image axis, -45 to 45.
    orientation : {"across", "along"}, optional
        The axis their normal is near to: "across" gives nearly vertical bars.
    dark, bright : float, optional
        Levels of the background and of the bars, in image units.
    snr : float, optional
        Contrast over the standard deviation of added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    rng : numpy.random.Generator, optional
        Source of randomness; needed as soon as there is noise.

    Returns
    -------
    image : (rows, cols) array of float
        As large as the groups need.
    truth : BarsTruth

    Raises
    ------
    ModelError
        If the arguments contradict each other.
    OptionError
        If an argument is of the wrong kind.
    """
    require_sensor(sensor)
    require_numbers(length_px=length_px, angle_deg=angle_deg)
    periods = require_floats("periods_px", periods_px)
    if periods.ndim != 1:
        raise OptionError(
            f"periods_px is {periods_px!r:.80}: it has to be a sequence, a number for each group"
        )
    sizes = (*periods.tolist(), length_px)
    if not periods.size or not all(0 < size < math.inf for size in sizes):
        raise ModelError(
            f"bars of periods {tuple(periods.tolist())}, {length_px:g} px long: there has to be a "
            "period, and all have to be finite and above 0"
        )
    require_finite(dark=dark, bright=bright)
    if not abs(angle_deg) <= 45 or dark == bright:
        raise ModelError(
            f"bars tilted by {angle_deg:g} deg of level {bright:g} on {dark:g}: the tilt cannot "
            "exceed 45, and the levels have to differ"
        )
    normal = normal_direction_deg(angle_deg, orientation)
    pitch = length_px + GAP_PX
    offsets = (np.arange(periods.size) - 0.5 * (periods.size - 1)) * pitch
    across = Line(0.0, 0.0, normal).normal
    loose = [
        BarGroup(float(t) * across[0], -float(t) * across[1], normal, p, count, length_px)
        for t, p in zip(offsets, periods.tolist(), strict=True)
    ]
    corners = np.concatenate([group.region for group in loose])
    low, high = corners.min(axis=0) - GAP_PX, corners.max(axis=0) + GAP_PX
    shape = (math.ceil(high[0] - low[0]), math.ceil(high[1] - low[1]))
    require_shape(shape)
    groups = tuple(
        BarGroup(g.row - low[0], g.col - low[1], normal, g.period_px, count, length_px)
        for g in loose
    )
    image = np.full(shape, float(dark))
    for group in groups:
        add_patches(image, sensor, group.patches(bright - dark))
    added = noise_of_snr(bright - dark, snr, noise, min(dark, bright))
    truth = BarsTruth(sensor, groups, dark, bright, added)
    return (image if added is None else added.added_to(image, rng)), truth
