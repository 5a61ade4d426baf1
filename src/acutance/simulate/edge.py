"""A straight edge between uniform plateaus, as a sensor sees it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from acutance.arguments import require_finite, require_kind, require_numbers, require_optional
from acutance.curves import HasResponse, Response
from acutance.curves.grid import Floats
from acutance.errors import ModelError
from acutance.geometry.angles import wrap_direction
from acutance.geometry.line import Line, Orientation
from acutance.optics.sensor import Sensor, normal_direction_deg, require_sensor
from acutance.simulate.ground import GroundNoise
from acutance.simulate.limits import require_darker, require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.resample import Regrid, render_regridded

__all__ = ["Polarity", "Truth", "edge", "line_through_centre", "render_edge"]

Polarity = Literal["rising", "falling"]


@dataclass(frozen=True, eq=False)
class Truth(HasResponse):
    """The truth of a simulated edge: the result of a perfect measurement.

    Parameters
    ----------
    response : Response
        The true curves along the normal, without uncertainty.
    line : Line
        Where the true ESF passes 50 %.
    dark, bright : float
        Plateau levels in image units.
    noise : Noise, optional
        Noise that was added to the image.
    regrid : Regrid, optional
        The resampling the image went through, after the noise.
    ground_noise : GroundNoise, optional
        Clutter of the scene, before the sensor.
    """

    response: Response
    line: Line
    dark: float
    bright: float
    noise: Noise | None = None
    regrid: Regrid | None = None
    ground_noise: GroundNoise | None = None

    @property
    def orientation(self) -> Orientation:
        """The image axis the MTF belongs to."""
        return self.line.orientation


def render_edge(
    sensor: Sensor, line: Line, shape: tuple[int, int], dark: float, bright: float
) -> Floats:
    """An endless edge without noise: every pixel is the ESF at its normal distance.

    Parameters
    ----------
    sensor : Sensor
    line : Line
        Where the image passes half way between the plateaus.
    shape : (rows, cols)
    dark, bright : float
        Plateau levels; the normal of `line` points towards `bright`.

    Returns
    -------
    (rows, cols) array
        Exact to the accuracy of `Profile`.

    Raises
    ------
    ModelError, OptionError
        If the image is too large, or an argument of the wrong kind.
    """
    require_sensor(sensor)
    require_kind(Line, line=line)
    require_shape(shape)
    require_finite(dark=dark, bright=bright)
    rows, cols = np.indices(shape)
    profile = sensor.profile(line.normal_deg)
    distance = line.normal_distance(rows, cols)
    return np.asarray(dark + (bright - dark) * profile.esf(distance + profile.half_px))


def edge(
    sensor: Sensor,
    *,
    angle_deg: float = 6.0,
    orientation: Orientation = "across",
    polarity: Polarity = "rising",
    shape: tuple[int, int] = (60, 40),
    dark: float = 200.0,
    bright: float = 1200.0,
    offset_px: float = 0.0,
    snr: float | None = None,
    noise: Noise | None = None,
    regrid: Regrid | None = None,
    ground_noise: GroundNoise | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[Floats, Truth]:
    """An image of a straight edge, and the truth about it.

    Parameters
    ----------
    sensor : Sensor
    angle_deg : float, optional
        Tilt of the edge against the nearer image axis, -45 to 45: a positive angle turns the
        normal from the column axis towards higher rows (from the row axis towards lower
        columns).
    orientation : {"across", "along"}, optional
        The axis the normal is near to: "across" gives a nearly vertical edge.
    polarity : {"rising", "falling"}, optional
        "rising": brighter towards higher columns ("across") or higher rows ("along").
    shape : (rows, cols), optional
    dark, bright : float, optional
        Plateau levels in image units, dark below bright.
    offset_px : float, optional
        Distance along the normal from the image's centre to the edge.
    snr : float, optional
        Contrast over the standard deviation of added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    regrid : Regrid, optional
        Resample the noisy image, which correlates its noise. Line, shape and truth are those of
        the resampled image.
    ground_noise : GroundNoise, optional
        Clutter, which the sensor blurs with the edge.
    rng : numpy.random.Generator, optional
        Source of randomness; needed as soon as there is noise.

    Returns
    -------
    image : (rows, cols) array of float
    truth : Truth

    Raises
    ------
    ModelError
        If the arguments contradict each other.
    OptionError
        If an argument is of the wrong kind: a name instead of a sensor, a shape that is no
        pair, a seed instead of `rng`.
    """
    require_sensor(sensor)
    if not isinstance(polarity, str) or polarity not in ("rising", "falling"):
        raise ModelError(f'polarity is {polarity!r}, it has to be "rising" or "falling"')
    require_shape(shape)
    require_optional(Regrid, regrid=regrid)
    require_optional(GroundNoise, ground_noise=ground_noise)
    require_finite(dark=dark, bright=bright, offset_px=offset_px)
    require_darker(dark, bright, 'polarity="falling" (--falling) turns the edge round')
    line = line_through_centre(shape, angle_deg, orientation, polarity).moved(offset_px, 0.0)
    added = noise_of_snr(bright - dark, snr, noise, dark)

    def drawn(at: Line, size: tuple[int, int]) -> Floats:
        uneven = 0.0 if ground_noise is None else ground_noise.seen_by(sensor, size, rng)
        return render_edge(sensor, at, size, dark, bright) + uneven

    if regrid is None:
        system, image = sensor, drawn(line, shape)
        image = image if added is None else added.added_to(image, rng)
    else:
        system = regrid.system(sensor)
        image = render_regridded(sensor, regrid, line, shape, drawn, added, rng)
    response = system.response_along(line.normal_deg)
    return image, Truth(response, line, dark, bright, added, regrid, ground_noise)


def line_through_centre(
    shape: tuple[int, int],
    angle_deg: float,
    orientation: Orientation,
    polarity: Polarity = "rising",
) -> Line:
    """The line of a target through the middle of an image of the given shape.

    Raises
    ------
    ModelError, OptionError
        If the tilt exceeds 45 degrees or the orientation is none.
    """
    require_numbers(angle_deg=angle_deg)
    if not abs(angle_deg) <= 45:
        raise ModelError(
            f"the edge is tilted by {angle_deg:g} deg against the nearer axis, which cannot "
            'exceed 45: use the other orientation ("across" or "along", --along)'
        )
    normal = normal_direction_deg(angle_deg, orientation) + (180.0 if polarity == "falling" else 0)
    along = shape[0] if orientation == "across" else shape[1]
    return Line(
        row=0.5 * (shape[0] - 1),
        col=0.5 * (shape[1] - 1),
        normal_deg=wrap_direction(normal),
        length_px=along / math.cos(math.radians(angle_deg)),
    )
