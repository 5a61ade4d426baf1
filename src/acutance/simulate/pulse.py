"""A pulse target, two parallel edges between plateaus, as a sensor sees it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_finite, require_kind, require_optional
from acutance.curves import HasResponse, Response
from acutance.curves.grid import Floats, crossing
from acutance.errors import ModelError
from acutance.geometry.line import Line, Orientation
from acutance.optics.sensor import Sensor, require_sensor
from acutance.simulate.edge import line_through_centre
from acutance.simulate.ground import GroundNoise
from acutance.simulate.limits import require_shape
from acutance.simulate.noise import Noise, noise_of_snr
from acutance.simulate.resample import Regrid, render_regridded
from acutance.simulate.scene import Patch, render_patches

__all__ = ["PulseTruth", "pulse", "render_pulse"]


@dataclass(frozen=True, eq=False)
class PulseTruth(HasResponse):
    """The truth of a simulated pulse: the result of a perfect measurement.

    Parameters
    ----------
    system : Sensor
        System of the image: the sensor, and the resampling if there was one.
    line : Line
        The middle of the pulse as the image shows it: half way between the places where the
        sensor's ESF passes 50 % at either edge. Its normal points from the left background to the
        right one, towards higher columns (rows).
    width_px : float
        True width along the normal, in pixels of the image.
    left, level, right : float
        Levels of the background before the pulse, of the pulse, and of the background behind it.
    noise : Noise, optional
        Noise that was added to the image.
    regrid : Regrid, optional
        The resampling the image went through, after the noise.
    ground_noise : GroundNoise, optional
        Clutter of the scene, before the sensor.
    """

    system: Sensor
    line: Line
    width_px: float
    left: float
    level: float
    right: float
    noise: Noise | None = None
    regrid: Regrid | None = None
    ground_noise: GroundNoise | None = None

    @cached_property
    def response(self) -> Response:
        """The true curves of the system along the normal: those of an edge, not of the pulse."""
        return self.system.response_along(self.line.normal_deg)

    @property
    def orientation(self) -> Orientation:
        """The image axis the MTF belongs to."""
        return self.line.orientation

    @property
    def width_m(self) -> float | None:
        """True width in metres; ``None`` without a GSD."""
        gsd_m = self.response.gsd_m
        return None if gsd_m is None else self.width_px * gsd_m

    def prf(self, distance_px: ArrayLike) -> Floats:
        """Pulse response function: a pulse of height 1 on a background of 0.

        Parameters
        ----------
        distance_px : array
            Normal distances in pixels from the middle of the pulse.

        Returns
        -------
        array of the same shape
            ``ESF(s + width / 2) - ESF(s - width / 2)``, with the ESF's 50 % point at 0.
        """
        profile = self.system.profile(self.line.normal_deg)
        s = np.asarray(distance_px, float) + profile.half_px
        half = 0.5 * self.width_px
        return np.asarray(profile.esf(s + half) - profile.esf(s - half))

    @cached_property
    def prf_fwhm_px(self) -> float:
        """Width of the pulse response function at half of its maximum, in pixels."""
        reach = 0.5 * self.width_px + 8.0
        distance = np.linspace(-reach, reach, 2 * round(reach / 0.01) + 1)
        response = self.prf(distance)
        peak = int(np.argmax(response))
        top, at = float(response[peak]), float(distance[peak])
        rise, fall = (crossing(distance, response, 0.5 * top, at, way) for way in (-1, 1))
        return fall - rise

    def to_dict(self) -> dict[str, Any]:
        """Geometry, levels, numbers and curves, for JSON."""
        found = self.response
        return {
            "kind": "pulse",
            "orientation": self.orientation,
            "line": self.line.to_dict(),
            "angle_deg": self.line.angle_deg,
            "width_px": self.width_px,
            "width_m": self.width_m,
            "left": self.left,
            "level": self.level,
            "right": self.right,
            "prf_fwhm_px": self.prf_fwhm_px,
            **{name: number.value for name, number in found.metrics().items()},
            "mtf": {
                "freq_cpp": np.round(found.mtf.freq_cpp, 6).tolist(),
                "value": found.mtf.value.tolist(),
            },
        }


def render_pulse(
    sensor: Sensor,
    line: Line,
    shape: tuple[int, int],
    *,
    width_px: float,
    left: float,
    level: float,
    right: float,
    length_px: float | None = None,
) -> Floats:
    """A pulse without noise: two steps, each the ESF at its normal distance.

    Parameters
    ----------
    sensor : Sensor
    line : Line
        Middle of the pulse, as in `PulseTruth`.
    shape : (rows, cols)
    width_px : float
        Width along the normal.
    left, level, right : float
        Levels of the background before the pulse, of the pulse, and of the background behind it.
    length_px : float, optional
        Length of the pulse, centred on the line's point; endless unless given. Beyond its ends
        the two backgrounds meet in the middle of the pulse.

    Returns
    -------
    (rows, cols) array
        Exact to the accuracy of `Profile`; with ends, to that of `render_patches`.

    Raises
    ------
    ModelError, OptionError
        If the image is too large, or an argument of the wrong kind.
    """
    require_sensor(sensor)
    require_kind(Line, line=line)
    require_shape(shape)
    require_finite(width_px=width_px, left=left, level=level, right=right)
    if length_px is not None:
        require_finite(length_px=length_px)
    profile = sensor.profile(line.normal_deg)
    half = 0.5 * width_px
    s = line.normal_distance(*np.indices(shape)) + profile.half_px
    if length_px is None:
        first, second = profile.esf(s + half), profile.esf(s - half)
        return np.asarray(left + (level - left) * first + (right - level) * second)
    plateaus = left + ((right - left) * profile.esf(s) if right != left else 0.0)
    # The line is where the image shows the middle; the tarp itself lies the ESF's 50 % point off.
    middle = line.moved(-profile.half_px, 0.0)
    sides = [
        (middle.moved(0.5 * way * half, 0.0), below) for way, below in ((-1, left), (1, right))
    ]
    tarp = [
        Patch(at.row, at.col, half, length_px, line.normal_deg, level - below)
        for at, below in sides
    ]
    return np.asarray(plateaus + render_patches(sensor, tarp, shape))


def pulse(
    sensor: Sensor,
    *,
    width_px: float = 3.0,
    angle_deg: float = 6.0,
    orientation: Orientation = "across",
    shape: tuple[int, int] = (60, 40),
    dark: float = 100.0,
    bright: float = 1200.0,
    right_dark: float | None = None,
    length_px: float | None = None,
    offset_px: float = 0.0,
    snr: float | None = None,
    noise: Noise | None = None,
    regrid: Regrid | None = None,
    ground_noise: GroundNoise | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[Floats, PulseTruth]:
    """An image of a pulse target, and the truth about it.

    Parameters
    ----------
    sensor : Sensor
    width_px : float, optional
        Width along the normal, in pixels of the image; above 0.
    angle_deg : float, optional
        Tilt of the pulse against the nearer image axis, -45 to 45; signs as in `edge`.
    orientation : {"across", "along"}, optional
        The axis the normal is near to: "across" gives a nearly vertical pulse.
    shape : (rows, cols), optional
    dark : float, optional
        Level of the plateaus, in image units.
    bright : float, optional
        Level of the pulse; below `dark` for a dark pulse between bright plateaus.
    right_dark : float, optional
        Level of the plateau on the side of higher columns (rows), if it differs from `dark`.
    length_px : float, optional
        Length of the pulse; endless unless given.
    offset_px : float, optional
        Distance along the normal from the image's centre to the middle of the pulse.
    snr : float, optional
        Height of the pulse over the mean of the plateaus, divided by the standard deviation of
        added white noise.
    noise : Noise, optional
        A description of the noise, instead of `snr` or, without `read`, together with it.
    regrid : Regrid, optional
        Resample the noisy image; line, width, shape and truth are those of the new image.
    ground_noise : GroundNoise, optional
        Clutter, which the sensor blurs with the pulse.
    rng : numpy.random.Generator, optional
        Source of randomness; needed as soon as there is noise.

    Returns
    -------
    image : (rows, cols) array of float
    truth : PulseTruth

    Raises
    ------
    ModelError
        If the arguments contradict each other, or the pulse does not fit in the image.
    OptionError
        If an argument is of the wrong kind.
    """
    require_sensor(sensor)
    behind = dark if right_dark is None else right_dark
    require_shape(shape)
    require_optional(Regrid, regrid=regrid)
    require_optional(GroundNoise, ground_noise=ground_noise)
    require_finite(dark=dark, bright=bright, right_dark=behind, width_px=width_px)
    require_finite(length_px=0.0 if length_px is None else length_px, offset_px=offset_px)
    _require_pulse(width_px, length_px, (dark, bright, behind))
    line = line_through_centre(shape, angle_deg, orientation).moved(offset_px, 0.0)
    _require_inside(line, width_px, shape)
    added = noise_of_snr(bright - 0.5 * (dark + behind), snr, noise, min(dark, behind, bright))

    def drawn(at: Line, size: tuple[int, int], scale: float = 1.0) -> Floats:
        uneven = 0.0 if ground_noise is None else ground_noise.seen_by(sensor, size, rng)
        return uneven + render_pulse(
            sensor,
            at,
            size,
            width_px=width_px * scale,
            left=dark,
            level=bright,
            right=behind,
            length_px=None if length_px is None else length_px * scale,
        )

    if regrid is None:
        system, image = sensor, drawn(line, shape)
        image = image if added is None else added.added_to(image, rng)
    else:
        scale = regrid.scale
        system = regrid.system(sensor)
        image = render_regridded(
            sensor, regrid, line, shape, lambda at, size: drawn(at, size, scale), added, rng
        )
    truth = PulseTruth(system, line, width_px, dark, bright, behind, added, regrid, ground_noise)
    return image, truth


def _require_pulse(
    width_px: float, length_px: float | None, levels: tuple[float, float, float]
) -> None:
    left, level, right = levels
    if not width_px > 0:
        raise ModelError(f"width_px is {width_px:g}, it has to be above 0 (--width-px, --width-m)")
    if length_px is not None and not length_px > 0:
        raise ModelError(f"length_px is {length_px:g}, it has to be above 0 (--length)")
    if not (level - left) * (level - right) > 0:
        raise ModelError(
            f"the pulse has level {level:g} between backgrounds of {left:g} and {right:g}: it "
            "has to be above both or below both"
        )


def _require_inside(line: Line, width_px: float, shape: tuple[int, int]) -> None:
    """Refuse a pulse whose sides do not both cross the middle of the image."""
    rows, cols = shape
    row, col = 0.5 * (rows - 1), 0.5 * (cols - 1)
    ends = ((row, 0.0), (row, cols - 1.0)) if line.orientation == "across" else (
        (0.0, col), (rows - 1.0, col)
    )  # fmt: skip
    before, behind = (float(line.normal_distance(*end)) for end in ends)
    if not before < -0.5 * width_px < 0.5 * width_px < behind:
        raise ModelError(
            f"the sides of the pulse lie {0.5 * width_px:.1f} px on either hand of its middle, "
            f"the image of {rows} by {cols} px ends {-before:.1f} px before and {behind:.1f} px "
            "behind it: use a larger image (--size), or a narrower pulse "
            "(--width-px, --width-m)"
        )
