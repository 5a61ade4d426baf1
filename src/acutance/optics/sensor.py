"""A sensor: the product of its optical transfer function (OTF) blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_floats, require_numbers
from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.direction import gsd_along, unit_vector
from acutance.curves.grid import FREQ_CPP, Floats
from acutance.errors import ModelError, OptionError
from acutance.optics.aberrations import Aberrations
from acutance.optics.aperture import Defocus, Diffraction
from acutance.optics.block import Axis, Block, Transfer, has_otf
from acutance.optics.profile import Profile

__all__ = [
    "TRUTH_DISTANCE_PX",
    "Sensor",
    "normal_direction_deg",
    "require_sensor",
    "spread_over_plane",
]

TRUTH_DISTANCE_PX: Floats = np.linspace(-16.0, 16.0, 641)
"""Distances of a truth's spread functions: farther than measured ones, since nothing is noise."""


def normal_direction_deg(angle_deg: float, orientation: Axis) -> float:
    """Direction of an edge's normal, from the column axis towards the row axis (downwards).

    Parameters
    ----------
    angle_deg : float
        Tilt of the edge against the nearer image axis; its sign is the sense of the turn.
    orientation : {"across", "along"}
        The axis the normal is near to: "across" the column axis, "along" the row axis.

    Raises
    ------
    ModelError
        If the tilt is no finite number, or the orientation none of these.
    """
    _require_angle("angle_deg", angle_deg)
    if not isinstance(orientation, str) or orientation not in ("across", "along"):
        raise ModelError(f'orientation is {orientation!r}, it has to be "across" or "along"')
    return angle_deg + (90.0 if orientation == "along" else 0.0)


def _require_angle(name: str, angle_deg: float) -> None:
    if not isinstance(angle_deg, Real) or not math.isfinite(angle_deg):
        raise ModelError(f"{name} is {angle_deg!r:.80}: give a finite number of degrees")


def _as_blocks(blocks: Any) -> tuple[Block, ...]:
    """The blocks of a sensor as a tuple.

    Raises
    ------
    ModelError
        If there is no sequence of them, or one has no OTF.
    """
    try:
        found = tuple(blocks)
    except TypeError:
        raise ModelError(
            f"the blocks are a {type(blocks).__name__}: give a list, such as "
            "[Gaussian(0.4), Detector()]"
        ) from None
    for number, one in enumerate(found, start=1):
        if not has_otf(one):
            raise ModelError(
                f"block {number} is {one!r}, which has no OTF: give blocks such as Gaussian(0.4) "
                "or Detector()"
            )
    _require_one_pupil(found)
    return found


def _require_one_pupil(blocks: tuple[Block, ...]) -> None:
    """Refuse an aperture described twice, such as once in focus and once out of it."""
    pupils = [one for one in blocks if isinstance(one, Diffraction | Defocus | Aberrations)]
    kinds = {type(one) for one in pupils}
    if len(kinds) > 1:
        raise ModelError(
            f"{' and '.join(map(str, pupils))} describe one pupil {len(pupils)} times, and its OTF "
            f"is not their product: write {_alone(pupils)} alone, which holds the diffraction too"
        )


def _alone(pupils: Sequence[Diffraction | Defocus | Aberrations]) -> str:
    """What describes one pupil, of several that do."""
    obscuration = max(one.obscuration for one in pupils)
    curved = next((one for one in pupils if isinstance(one, Defocus)), None)
    if curved is None or any(isinstance(one, Aberrations) for one in pupils):
        return "Aberrations"
    return f"Defocus({curved.waves:g}, {curved.cutoff_cpp:g}, obscuration={obscuration:g})"


@dataclass(frozen=True)
class Sensor:
    """A linear, shift-invariant imaging system: its OTF is the product of its blocks' OTFs.

    Parameters
    ----------
    blocks : sequence of Block
        The causes of blur, in any order.
    gsd_m : float, optional
        Ground sampling distance: the size of a pixel on the ground in metres.
    gsd_along_m : float, optional
        Distance from one row to the next in metres, where it differs from that between columns.

    Raises
    ------
    ModelError
        If there is no block, one has no OTF, a pupil is described twice, or a GSD is
        not above 0.

    Examples
    --------
    >>> from acutance import optics
    >>> sensor = Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=0.7)
    >>> print(sensor.mtf()(0.5))
    0.2891
    """

    blocks: Sequence[Block]
    gsd_m: float | None = None
    gsd_along_m: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "blocks", _as_blocks(self.blocks))
        if not self.blocks:
            raise ModelError("a sensor needs at least one block, such as Detector()")
        for name in ("gsd_m", "gsd_along_m"):
            size = getattr(self, name)
            if size is None:
                continue
            if not isinstance(size, Real):
                raise ModelError(f"{name} is {size!r}: give a number of metres")
            if not 0 < float(size) < math.inf:
                raise ModelError(f"{name} is {size:g}, it has to be finite and above 0")
        if self.gsd_along_m is not None and self.gsd_m is None:
            raise ModelError("gsd_along_m was given without gsd_m: give the distance both ways")

    @property
    def pixel_m(self) -> tuple[float, float] | None:
        """Size of a pixel in metres along (rows, columns): from row to row, column to column."""
        if self.gsd_m is None:
            return None
        return (self.gsd_along_m or self.gsd_m), self.gsd_m

    def gsd_along_normal_m(self, normal_deg: float) -> float | None:
        """Metres per pixel of distance along an edge's normal; ``None`` without a GSD.

        Raises
        ------
        ModelError
            If the direction is no finite number.
        """
        _require_angle("normal_deg", normal_deg)
        return None if self.pixel_m is None else gsd_along(self.pixel_m, normal_deg)

    def otf(self, u: ArrayLike, v: ArrayLike) -> Transfer:
        """OTF at frequencies `u` (across) and `v` (along) in cycles per pixel, 1 at zero.

        The arrays broadcast against each other. Real when every block is symmetric.

        Raises
        ------
        OptionError
            If a frequency is no number.
        """
        u, v = require_floats("u", u), require_floats("v", v)
        product: Transfer = np.ones(np.broadcast_shapes(u.shape, v.shape))
        for block in self.blocks:
            product = product * block.otf(u, v)
        return product

    def profile(self, normal_deg: float) -> Profile:
        """Edge and line spread functions at any distance, for a normal in any direction.

        Profiles are cached. See `Profile` for the accuracy.

        Raises
        ------
        ModelError
            If the direction is no finite number, or the sensor is infinitely sharp.
        """
        _require_angle("normal_deg", normal_deg)
        return _profile(self, float(normal_deg))

    def response_along(self, normal_deg: float) -> Response:
        """The true curves for an edge whose normal points in `normal_deg`, dark to bright.

        The OTF is the slice ``otf(f cos t, f sin t)`` with its phase relative to the centroid
        of the LSF, on frequencies 0 to 1 cycles per pixel in steps of 0.01; edge spread function
        (ESF) and LSF lie on distances of -16 to 16 px in steps of 0.05 px from the 50 % point. A
        truth has no uncertainty: the covariance factors have no columns.
        """
        profile = self.profile(normal_deg)
        shift = np.exp(2j * math.pi * FREQ_CPP * profile.centroid_px)
        places = TRUTH_DISTANCE_PX + profile.half_px
        nothing = np.zeros((TRUTH_DISTANCE_PX.size, 0))
        return Response(
            esf=Esf(TRUTH_DISTANCE_PX, profile.esf(places), nothing),
            lsf=Lsf(TRUTH_DISTANCE_PX, profile.lsf(places), nothing),
            mtf=Mtf(
                FREQ_CPP,
                _slice(self, normal_deg, FREQ_CPP) * shift,
                np.zeros((FREQ_CPP.size, 0), complex),
            ),
            gsd_m=self.gsd_along_normal_m(normal_deg),
        )

    def response(self, angle_deg: float = 0.0, orientation: Axis = "across") -> Response:
        """The true curves for an edge of the given tilt, brighter towards higher columns (rows).

        Parameters
        ----------
        angle_deg : float, optional
            Tilt against the nearer image axis; its sign matters only to asymmetric sensors.
        orientation : {"across", "along"}, optional
            "across": the normal is near the column axis.
        """
        return self.response_along(normal_direction_deg(angle_deg, orientation))

    def mtf(self, angle_deg: float = 0.0, orientation: Axis = "across") -> Mtf:
        """The true MTF; see `response`."""
        return self.response(angle_deg, orientation).mtf

    def esf(self, angle_deg: float = 0.0, orientation: Axis = "across") -> Esf:
        """The true ESF; see `response`."""
        return self.response(angle_deg, orientation).esf

    def lsf(self, angle_deg: float = 0.0, orientation: Axis = "across") -> Lsf:
        """The true LSF; see `response`."""
        return self.response(angle_deg, orientation).lsf

    def psf(self, half_width_px: float = 5.0, step_px: float = 0.1) -> tuple[Floats, Floats]:
        """Point spread function around its origin, pixel area included.

        By a discrete Fourier transform over at least 64 px, so light further away than 32 px is
        folded back, and detail finer than two steps is left out.

        Parameters
        ----------
        half_width_px : float, optional
            Half the width of the returned square, below 32 px.
        step_px : float, optional
            Spacing of the grid in pixels, below 0.5.

        Returns
        -------
        distance_px : (n,) array
            Places along either axis.
        psf : (n, n) array
            Light per square pixel at (row, column) distances; its integral over the plane is 1.

        Raises
        ------
        OptionError
            If half width or step is no number.
        ModelError
            If the grid is too coarse or too wide.
        """
        require_numbers(half_width_px=half_width_px, step_px=step_px)
        if not (0 < step_px < 0.5 and step_px <= half_width_px < 32):
            raise ModelError(
                f"a PSF of half width {half_width_px:g} px in steps of {step_px:g} px was "
                "requested: the step has to be below 0.5, the half width between one step and 32"
            )
        return spread_over_plane(self.otf, half_width_px, step_px, 32.0)


def require_sensor(sensor: Any) -> Sensor:
    """The sensor of a caller.

    Raises
    ------
    OptionError
        If it is something else, such as a name.
    """
    if not isinstance(sensor, Sensor):
        name = sensor if isinstance(sensor, str) else "generic-2005"
        raise OptionError(
            f"sensor is {sensor!r:.80}: give a Sensor, by its name acutance.optics.preset({name!r})"
            ", of a TOML file acutance.optics.read_sensor(path)"
        )
    return sensor


def spread_over_plane(
    otf: Callable[[Floats, Floats], Transfer], half_width: float, step: float, room: float
) -> tuple[Floats, Floats]:
    """Point spread function of an OTF on a square grid, by a discrete Fourier transform.

    Parameters
    ----------
    otf : function of (u, v)
        Frequencies in cycles per unit of length.
    half_width, step : float
        Half the width of the returned square, and the spacing of its grid.
    room : float
        Half the period of the transform: light further away is folded back.

    Returns
    -------
    distance : (n,) array
    psf : (n, n) array
        Light per unit of area at (row, column) distances.
    """
    size = 2 * math.ceil(room / step)
    u: Floats = np.asarray(np.fft.rfftfreq(size, step), np.float64)
    v: Floats = np.asarray(np.fft.fftfreq(size, step)[:, None], np.float64)
    plane = np.fft.fftshift(np.fft.irfft2(otf(u, v), (size, size))) / step**2
    reach = round(half_width / step)
    window = slice(size // 2 - reach, size // 2 + reach + 1)
    distance = np.arange(-reach, reach + 1, dtype=float) * step
    return distance, np.ascontiguousarray(plane[window, window])


def _slice(sensor: Sensor, normal_deg: float, freq_cpp: Floats) -> Transfer:
    x, y = unit_vector(normal_deg)
    return sensor.otf(freq_cpp * x, freq_cpp * y)


@lru_cache(maxsize=16)
def _profile(sensor: Sensor, normal_deg: float) -> Profile:
    return Profile.of_otf(lambda freq_cpp: _slice(sensor, normal_deg, freq_cpp))
