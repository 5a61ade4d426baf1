"""The reference sensor's own OTF: from its description, or from a measurement of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Mtf, Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.geometry.angles import axis_difference, wrap_axis
from acutance.geometry.line import axis_names
from acutance.optics import Detector, Gaussian, Sensor
from acutance.raster import Gsd
from acutance.raster.gsd import gsd_in_words
from acutance.targets.measurement import Measurement
from acutance.targets.own_mtf import require_own_mtf
from acutance.targets.pair.reference_otf import ReferenceOtf
from acutance.targets.record import Record
from acutance.targets.recorded_direction import RecordedDirection
from acutance.targets.target_result import TargetResult

__all__ = [
    "MeasuredCurves",
    "ReferenceLike",
    "known_curves",
    "measured_reference",
    "reference_otf",
    "sensor_of_nyquist",
]

Complexes = NDArray[np.complex128]

_MAX_GSD_DIFFERENCE = 0.05
_MIN_FREQUENCIES = 4


@dataclass(frozen=True, eq=False)
class MeasuredCurves(ShortRepr):
    """The MTF of a sensor along the two axes of its pixels, as it was measured.

    Parameters
    ----------
    across, along : Mtf
        Along the rows of pixels (0 degrees) and down the columns (90); one and the same where only
        one direction was measured.
    pixel_gsd_m : (float, float), optional
        GSD from row to row and from column to column.
    normal_deg : float, optional
        The single direction, from the column axis (0) towards the row axis (90).
    """

    across: Mtf
    along: Mtf
    pixel_gsd_m: tuple[float, float] | None = None
    normal_deg: float | None = None

    @property
    def only_direction(self) -> str | None:
        """The single direction in words; ``None`` where both were measured."""
        if self.along is not self.across:
            return None
        if self.normal_deg is None:
            return "one direction"
        return f"one direction, {wrap_axis(self.normal_deg):.1f} degrees from the column axis"

    def require_pixels(self, gsd: Gsd | None) -> None:
        """Refuse curves of other pixels than the high image's.

        Their frequencies are in cycles per pixel of their own image: in another product of the same
        sensor, or another sensor, they mean something else.

        Raises
        ------
        OptionError
            If both GSDs are known and differ by more than 5 %, along rows or columns.
        """
        if self.pixel_gsd_m is None or gsd is None:
            return
        of_image = gsd.row_m, gsd.col_m
        pairs = zip(self.pixel_gsd_m, of_image, strict=True)
        if max(abs(math.log(one / other)) for one, other in pairs) > math.log1p(
            _MAX_GSD_DIFFERENCE
        ):
            raise OptionError(
                f"the reference was measured in pixels of {gsd_in_words(self.pixel_gsd_m)}, those "
                f"of the high image have {gsd_in_words(of_image)}: its frequencies in cycles per "
                "pixel mean something else there. Measure the reference in the high image's own "
                "product, or state its MTF at Nyquist or its sensor"
            )


ReferenceLike = (
    Sensor
    | Measurement
    | TargetResult[Any]
    | Record
    | MeasuredCurves
    | Response
    | Mtf
    | float
    | None
)
"""A sensor; a measurement of it (one direction, taken for both, or two); or its MTF at Nyquist."""


@dataclass(frozen=True, eq=False)
class _OfSensor:
    """A described sensor, without uncertainty."""

    sensor: Sensor
    ratio_across: float
    ratio_along: float

    @property
    def only_direction(self) -> str | None:
        return None

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        return np.asarray(
            self.sensor.otf(u_cpp / self.ratio_across, v_cpp / self.ratio_along), complex
        )

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        return np.zeros((u_cpp.size, 0), complex)


@dataclass(frozen=True, eq=False)
class _OfCurves:
    """Measured curves along both axes; their product over the plane.

    Each curve is taken to be wrong by one number, its standard deviation at all frequencies
    together: the least favourable case, and the only one that a curve without covariance allows.
    """

    curves: MeasuredCurves
    ratio_across: float
    ratio_along: float

    @property
    def only_direction(self) -> str | None:
        return self.curves.only_direction

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        over, down = self._values(u_cpp, v_cpp)
        return np.asarray(over[0] * down[0], complex)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        over, down = self._values(u_cpp, v_cpp)
        if self.curves.only_direction is not None:
            return np.asarray(over[1] * down[0] + over[0] * down[1], complex)[:, None]
        return np.stack([over[1] * down[0], over[0] * down[1]], axis=1).astype(complex)

    def _values(
        self, u_cpp: Floats, v_cpp: Floats
    ) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        return (
            _interpolated(self.curves.across, np.abs(u_cpp) / self.ratio_across),
            _interpolated(self.curves.along, np.abs(v_cpp) / self.ratio_along),
        )


def _interpolated(mtf: Mtf, freq_cpp: Floats) -> tuple[Floats, Floats]:
    """Value and standard deviation of a curve at frequencies in its own pixels."""
    value = np.interp(freq_cpp, mtf.freq_cpp, mtf.value)
    return np.asarray(value), np.asarray(np.interp(freq_cpp, mtf.freq_cpp, mtf.std))


def known_curves(reference: ReferenceLike) -> MeasuredCurves | None:
    """The curves of a measured reference; ``None`` for one that is described or not given.

    Raises
    ------
    OptionError
        If it is the ratio of two sensors' MTFs, or has no curve.
    """
    if isinstance(reference, MeasuredCurves):
        return reference
    if isinstance(reference, Measurement):
        return _of_measurement(reference)
    if isinstance(reference, Record):
        return _of_record(reference)
    if isinstance(reference, TargetResult):
        return _of_edges(reference)
    if isinstance(reference, Response):
        only, gsd_m = _plain(reference.mtf), reference.gsd_m
        return MeasuredCurves(only, only, None if gsd_m is None else (gsd_m, gsd_m))
    if isinstance(reference, Mtf):
        only = _plain(reference)
        return MeasuredCurves(only, only)
    return None


def _of_measurement(reference: Measurement) -> MeasuredCurves:
    require_own_mtf(reference.record, "the reference")
    gsd_m, normal_deg = reference.image.pixel_gsd_m, reference.normal_deg
    if normal_deg is not None:
        only = _plain(reference.response.mtf)
        return MeasuredCurves(only, only, gsd_m, normal_deg)
    across, along = (_plain(reference.mtf_at(angle)) for angle in (0.0, 90.0))
    return MeasuredCurves(across, along, gsd_m)


def _of_edges(reference: TargetResult[Any]) -> MeasuredCurves:
    """The strongest edge of either direction, or of the one there is."""
    if not reference.measurements:
        raise OptionError("the reference is a target of which no edge was measured: give another")
    strongest = [group.measurements[0] for group in reference.groups.values()]
    if len(strongest) < 2:
        return _of_measurement(reference.measurements[0])
    by_normal = sorted(strongest, key=lambda edge: axis_difference(edge.normal_deg or 0.0, 0.0))
    across, along = (_plain(edge.response.mtf) for edge in by_normal)
    return MeasuredCurves(across, along, by_normal[0].image.pixel_gsd_m)


def _of_record(reference: Record, origin: str = "the reference") -> MeasuredCurves:
    require_own_mtf(reference, origin)
    found, gsd_m = reference.directions, reference.image.pixel_gsd_m
    try:
        curves = {name: _recorded(one) for name, one in found.items()}
        if len(curves) == 1:
            (only,) = curves.values()
            normal = reference.document.get("line", {}).get("normal_deg")
            return MeasuredCurves(only, only, gsd_m, None if normal is None else float(normal))
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise OptionError(f"{origin} holds no MTF that can be read ({error})") from error
    x, y = axis_names(reference.image.along_track)
    return MeasuredCurves(curves[x], curves[y], gsd_m)


def _recorded(direction: RecordedDirection) -> Mtf:
    freq, value, std = direction.curve("mtf")
    if freq.size < _MIN_FREQUENCIES or not (np.isfinite(value).all() and np.isfinite(std).all()):
        raise ValueError("its curve has gaps")
    return Mtf(freq, value.astype(complex), std[:, None].astype(complex))


def _plain(mtf: Mtf) -> Mtf:
    """Values and standard deviations of a curve alone: nothing else of it is read."""
    return Mtf(mtf.freq_cpp, mtf.value.astype(complex), mtf.std[:, None].astype(complex))


def reference_otf(
    reference: ReferenceLike, ratio_across: float, ratio_along: float, gsd: Gsd | None = None
) -> ReferenceOtf | None:
    """The reference's OTF at frequencies of the low image.

    Parameters
    ----------
    reference : ReferenceLike
        One measured direction is taken for both. A number is the MTF at the reference's own
        Nyquist frequency, of a Gaussian blur and a full detector.
    ratio_across, ratio_along : float
        Ratio of the GSDs along the rows of pixels and down the columns.
    gsd : Gsd, optional
        Of the high image: curves of other pixels are refused.

    Raises
    ------
    OptionError
        If it is none of these, the ratio of two sensors' MTFs, or of other pixels.
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
    curves.require_pixels(gsd)
    return _OfCurves(curves, ratio_across, ratio_along)


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
    try:
        record = Record.from_dict(document)
    except OptionError as error:
        raise OptionError(f"{origin}: {error}") from error
    return _of_record(record, origin)
