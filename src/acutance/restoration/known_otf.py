"""What is known of a sensor's transfer: from measurements, their documents, or its description."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from acutance.curves import Otf2d, OtfModel
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.numerics.one_thread import one_thread
from acutance.optics import Sensor
from acutance.raster import Gsd
from acutance.raster.image import AlongTrack
from acutance.restoration.filtered_otf import RememberedOtf, SensorOtf
from acutance.restoration.named_records import (
    Measured,
    combination_warnings,
    measured_inputs,
    median_snr,
    named_records,
    warnings_of,
)
from acutance.restoration.sliced_otf import SlicedOtf
from acutance.targets import Measurement, Record
from acutance.targets.check import VerdictWord
from acutance.targets.combine import combine
from acutance.targets.combine.curves import OtfSamples
from acutance.targets.combine.fit import combine_curves
from acutance.targets.own_mtf import require_own_mtf
from acutance.targets.slices import SLICE_DIRECTIONS_DEG, OtfSlices

__all__ = ["KnownOtf", "Measured", "known_otf"]

ISOTROPIC = "the same blur in all directions is assumed: only one was measured"


@dataclass(frozen=True, eq=False)
class KnownOtf(ShortRepr):
    """The optical transfer function (OTF) of a sensor over the plane, and what goes with it.

    Parameters
    ----------
    otf : Otf2d
        With its covariance; a described sensor has none.
    snr : float or None
        Of the measurements (their median).
    band : int or None
        The band of the image they share; ``None`` if they differ, or there is no image.
    along_track : {"y", "x"}
    sources : tuple of str
        What it comes from, in words.
    cautions : tuple of str
        What has to be said of it.
    verdict : {"good", "usable", "doubtful", "invalid"}
        Of the measurement, or of the combination.
    """

    otf: Otf2d
    snr: float | None = None
    band: int | None = None
    along_track: AlongTrack = "y"
    sources: tuple[str, ...] = ()
    cautions: tuple[str, ...] = ()
    verdict: VerdictWord = "good"

    @property
    def axes_deg(self) -> dict[str, float]:
        """Where across and along track point, from the column axis (0) to the row axis (90)."""
        across_deg = 0.0 if self.along_track == "y" else 90.0
        return {"across": across_deg, "along": 90.0 - across_deg}


@one_thread
def known_otf(
    given: Measured | Sensor | Otf2d | Sequence[Measured],
    *,
    isotropic: bool = False,
    gsd_m: float | Gsd | None = None,
    names: Sequence[str] | None = None,
) -> KnownOtf:
    """The OTF over the plane of frequencies, of whatever describes it.

    Parameters
    ----------
    given : Measurement, Record, dict, Sensor, Otf2d, or a sequence of measurements
        Several measurements are combined (`acutance.combine`).
    isotropic : bool, optional
        State that the blur is the same in all directions: a single edge shows one of them.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of theirs.
    names : sequence of str, optional
        What to call the measurements: the names of their files.

    Raises
    ------
    OptionError
        If it shows one direction only, or is no transfer function of a sensor.
    """
    found = _found(given, isotropic, names, gsd_m)
    gsd = Gsd.given(gsd_m)
    pixel_m = found.otf.gsd_m if gsd is None else (gsd.row_m, gsd.col_m)
    return replace(found, otf=Otf2d(RememberedOtf(found.otf.model), pixel_m))


def _found(
    given: Any, isotropic: bool, names: Sequence[str] | None, gsd_m: float | Gsd | None
) -> KnownOtf:
    if isinstance(given, Sensor):
        return KnownOtf(Otf2d(SensorOtf(given), given.pixel_m), sources=("a described sensor",))
    if isinstance(given, Otf2d):
        return KnownOtf(given, sources=("an OTF",))
    inputs = measured_inputs(given, names, also=", a Sensor or an Otf2d")
    records = named_records(inputs, names)
    if len(records) == 1:
        ((name, record),) = records.items()
        return _measured(inputs[0], name, record, isotropic)
    return _combined(records, gsd_m)


def _combined(records: Mapping[str, Record], gsd_m: float | Gsd | None) -> KnownOtf:
    """Measurements of several directions, combined.

    Raises
    ------
    OptionError
        If there is none, or they do not belong together.
    """
    both = combine(list(records.values()), names=list(records), gsd_m=gsd_m)
    bands = {one.image.band for one in records.values()}
    return KnownOtf(
        both.otf,
        median_snr(records.values()),
        bands.pop() if len(bands) == 1 else None,
        both.image.along_track,
        tuple(_in_words(one) for one in records.values()),
        (
            *(word for name, one in records.items() for word in _cautions(name, one)),
            *(f"the combination: {one}" for one in combination_warnings(both)),
        ),
        both.verdict.word,
    )


def _measured(given: Any, name: str, record: Record, isotropic: bool) -> KnownOtf:
    """One measurement: of all directions, or of one where the others are stated to be equal."""
    require_own_mtf(record, name)
    one_direction = record.slices.normal_deg.size == 1
    if one_direction and not isotropic:
        raise OptionError(
            f"{name} ({_in_words(record)}) shows one direction, and a kernel acts in all: give a "
            "measurement of another direction besides (across.json along.json), or state that the "
            "blur is the same in all directions (isotropic=True, --isotropic)"
        )
    cautions = _cautions(name, record)
    return KnownOtf(
        Otf2d(_plane(given, record.slices), record.image.pixel_gsd_m),
        record.snr if math.isfinite(record.snr) else None,
        record.image.band,
        record.image.along_track,
        (_in_words(record),),
        (*cautions, ISOTROPIC) if one_direction else cautions,
        record.verdict.word,
    )


def _plane(given: Any, slices: OtfSlices) -> OtfModel:
    """The OTF over the plane: of a whole measurement its own, of a record from its slices."""
    likelihood = slices.likelihood
    if slices.normal_deg.size == 1:
        # In other directions the own plane of such a measurement is its prior.
        slices, likelihood = _in_all_directions(slices), None
    elif isinstance(given, Measurement) and isinstance(given.transfer, Otf2d):
        return given.transfer.model
    u, v = slices.places
    samples = OtfSamples("measurement", u, v, slices.otf, slices.factor, likelihood)
    return SlicedOtf(combine_curves([samples]).otf, slices)


def _in_all_directions(slices: OtfSlices) -> OtfSlices:
    """One slice in every direction, its errors the same in all of them.

    What is the same in all directions is symmetric: only the real part is kept.
    """
    every = np.asarray(SLICE_DIRECTIONS_DEG)
    return OtfSlices(
        every,
        slices.freq_cpp,
        np.tile(slices.otf.real + 0j, every.size),
        np.tile(slices.factor.real + 0j, (every.size, 1)),
    )


def _in_words(record: Record) -> str:
    """Kind, method, direction and file of a measurement."""
    direction = " and ".join(record.measured_directions)
    path = record.image.path
    return f"{record.kind} by {record.method}, {direction}" + (f", {path}" if path else "")


def _cautions(name: str, record: Record) -> tuple[str, ...]:
    """What its failed checks warn of, by its name."""
    word = "" if record.kind == "combined" else f"{record.verdict.word}: "
    return tuple(f"{name}: {word}{one}" for one in warnings_of(record))
