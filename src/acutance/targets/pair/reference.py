"""The reference sensor's own OTF: from its description, or from a measurement of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Mtf, Response
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.optics import Detector, Gaussian, Sensor
from acutance.raster import Gsd
from acutance.targets.measurement import SCHEMA, Measurement
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.pair.kernel_otf import ReferenceOtf

__all__ = [
    "MeasuredCurves",
    "ReferenceLike",
    "known_curves",
    "measured_reference",
    "reference_otf",
    "require_pixels",
    "sensor_of_nyquist",
]

Complexes = NDArray[np.complex128]

_GSD_SHARE = 0.05


@dataclass(frozen=True, eq=False)
class MeasuredCurves:
    """The MTF of a sensor in both directions, as a measurement of it tells.

    Parameters
    ----------
    across, along : Mtf
        One and the same where only one direction was measured.
    gsd_m : float, optional
        Of its pixels in metres: along the normal of a single direction, else along the rows.
    normal_deg : float, optional
        The single direction, from the column axis (0) towards the row axis (90).
    """

    across: Mtf
    along: Mtf
    gsd_m: float | None = None
    normal_deg: float | None = None

    @property
    def only_direction(self) -> str | None:
        """The single direction in words; ``None`` where both were measured."""
        if self.along is not self.across:
            return None
        if self.normal_deg is None:
            return "one direction"
        angle = (self.normal_deg + 90.0) % 180.0 - 90.0
        return f"one direction, {angle:.1f} degrees from the column axis"


ReferenceLike = (
    Sensor | Measurement | Measurement2d | MeasuredCurves | Response | Mtf | float | None
)
"""A sensor; a measurement of it (one direction, taken for both, or two); or its MTF at Nyquist."""


@dataclass(frozen=True, eq=False)
class _OfSensor:
    """A described sensor, without uncertainty."""

    sensor: Sensor
    ratio_across: float
    ratio_along: float

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        return np.asarray(
            self.sensor.otf(u_cpp / self.ratio_across, v_cpp / self.ratio_along), complex
        )

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        return np.zeros((u_cpp.size, 0), complex)


@dataclass(frozen=True, eq=False)
class _OfCurves:
    """Measured curves across and along; their product over the plane.

    Each curve is taken to be wrong by one number, its standard deviation at all frequencies
    together: the least favourable case, and the only one that a curve without covariance allows.
    """

    across: Mtf
    along: Mtf
    ratio_across: float
    ratio_along: float

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        over, down = self._values(u_cpp, v_cpp)
        return np.asarray(over[0] * down[0], complex)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        over, down = self._values(u_cpp, v_cpp)
        if self.along is self.across:
            return np.asarray(over[1] * down[0] + over[0] * down[1], complex)[:, None]
        return np.stack([over[1] * down[0], over[0] * down[1]], axis=1).astype(complex)

    def _values(
        self, u_cpp: Floats, v_cpp: Floats
    ) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        return (
            _read(self.across, np.abs(u_cpp) / self.ratio_across),
            _read(self.along, np.abs(v_cpp) / self.ratio_along),
        )


def _read(mtf: Mtf, freq_cpp: Floats) -> tuple[Floats, Floats]:
    """Value and standard deviation of a curve at frequencies in its own pixels."""
    value = np.interp(freq_cpp, mtf.freq_cpp, mtf.value)
    return np.asarray(value), np.asarray(np.interp(freq_cpp, mtf.freq_cpp, mtf.std))


def known_curves(reference: ReferenceLike) -> MeasuredCurves | None:
    """The curves of a measured reference; ``None`` for one that is described or not given."""
    if isinstance(reference, MeasuredCurves):
        return reference
    if isinstance(reference, Measurement2d):
        across, along = reference.across.mtf, reference.along.mtf
        return MeasuredCurves(across, along, reference.image.gsd_m)
    if isinstance(reference, Measurement):
        only, gsd_m = reference.mtf, reference.response.gsd_m
        return MeasuredCurves(only, only, gsd_m, reference.line.normal_deg)
    if isinstance(reference, Response):
        return MeasuredCurves(reference.mtf, reference.mtf, reference.gsd_m)
    return MeasuredCurves(reference, reference) if isinstance(reference, Mtf) else None


def require_pixels(curves: MeasuredCurves | None, gsd: Gsd | None) -> None:
    """Refuse a measured reference of other pixels than the high image's.

    Its frequencies are in cycles per pixel of its own image: in another product of the same
    sensor, or another sensor, they mean something else.

    Raises
    ------
    OptionError
        If both GSDs are known and differ by more than 5 %.
    """
    if curves is None or curves.gsd_m is None or gsd is None:
        return
    own = gsd.along_normal(curves.normal_deg or 0.0)
    if abs(math.log(curves.gsd_m / own)) > math.log(1 + _GSD_SHARE):
        raise OptionError(
            f"the reference was measured in pixels of {curves.gsd_m:.4g} m, those of the high "
            f"image have {own:.4g} m: its frequencies in cycles per pixel mean something else "
            "there. Measure the reference in the high image's own product, or state its MTF at "
            "Nyquist or its sensor"
        )


def reference_otf(
    reference: ReferenceLike, ratio_across: float, ratio_along: float
) -> ReferenceOtf | None:
    """The reference's OTF at frequencies of the low image.

    Parameters
    ----------
    reference : Sensor, Measurement, Measurement2d, MeasuredCurves, Response, Mtf, float or None
        One measured direction is taken for both. A number is the MTF at the reference's own
        Nyquist frequency, of a Gaussian blur and a full detector.
    ratio_across, ratio_along : float
        Ratio of the GSDs.

    Raises
    ------
    OptionError
        If it is none of these.
    """
    if reference is None:
        return None
    if isinstance(reference, float | int):
        reference = sensor_of_nyquist(float(reference))
    if isinstance(reference, Sensor):
        return _OfSensor(reference, ratio_across, ratio_along)
    curves = known_curves(reference)
    if curves is None:
        raise OptionError(
            f"reference_mtf is a {type(reference).__name__}: give a Sensor, a measurement, an Mtf, "
            "or the MTF at the reference's own Nyquist frequency as a number"
        )
    return _OfCurves(curves.across, curves.along, ratio_across, ratio_along)


def sensor_of_nyquist(mtf_nyquist: float) -> Sensor:
    """A Gaussian blur with a full detector that has a given MTF at Nyquist.

    Raises
    ------
    OptionError
        If the number is not between 0 and that of the detector alone, 0.637.
    """
    detector = 2 / math.pi
    if not 0 < mtf_nyquist < detector:
        raise OptionError(
            f"the reference's MTF at its Nyquist frequency is {mtf_nyquist:g}: it has to lie "
            f"between 0 and {detector:.3f}, that of a detector without any blur"
        )
    sigma = math.sqrt(math.log(detector / mtf_nyquist) / (2 * math.pi**2)) / 0.5
    return Sensor([Gaussian(sigma), Detector()])


def measured_reference(document: Any, origin: str) -> MeasuredCurves:
    """The curves of a measurement's JSON document ``acutance/measurement/1``.

    Parameters
    ----------
    document : dict
        Of an edge, a pulse (one direction, taken for both) or a 2-D method.
    origin : str
        What to call it in messages.

    Raises
    ------
    OptionError
        If it is no such document, or one of a ratio of two sensors' MTFs.
    """
    if not isinstance(document, Mapping) or document.get("schema") != SCHEMA:
        raise OptionError(f"{origin} is no document {SCHEMA}: write one with --json")
    if document.get("quantity") == "mtf_low_over_mtf_high":
        raise OptionError(
            f"{origin} is the ratio MTF_low / MTF_high, no sensor's own MTF: measure it again with "
            "--reference"
        )
    try:
        gsd = document.get("image", {}).get("gsd_m")
        gsd_m = None if gsd is None else float(gsd)
        if "across" in document:
            across, along = (_curve(document[name]["mtf"]) for name in ("across", "along"))
            return MeasuredCurves(across, along, gsd_m)
        only, line = _curve(document["mtf"]), document.get("line", {})
        normal = line.get("normal_deg")
        return MeasuredCurves(only, only, gsd_m, None if normal is None else float(normal))
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise OptionError(f"{origin} holds no MTF that can be read ({error})") from error


def _curve(curve: Mapping[str, Any]) -> Mtf:
    freq, value, std = (np.array(curve[name], float) for name in ("freq_cpp", "value", "std"))
    if freq.size < 4 or not (np.isfinite(value).all() and np.isfinite(std).all()):
        raise ValueError("its curve has gaps")
    return Mtf(freq, value.astype(complex), std[:, None].astype(complex))
