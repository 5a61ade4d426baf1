"""Inputs of a combination: results, their records, or the JSON documents of the commands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import Any

import numpy as np

from acutance.arguments import require_texts
from acutance.curves import Mtf
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.geometry.angles import wrap_axis
from acutance.raster.image import AlongTrack
from acutance.targets.measurement import Measurement
from acutance.targets.own_mtf import require_own_mtf
from acutance.targets.record import SCHEMA, ImageInfo, Record
from acutance.targets.slices import OtfSlices
from acutance.targets.target_result import TargetResult

__all__ = [
    "Combinable",
    "MeasuredInput",
    "common_flight",
    "direction_in_words",
    "read_inputs",
    "records_of",
    "without",
]

Combinable = Measurement | Record | TargetResult[Measurement] | Mapping[str, Any]
"""A result, its record, or its JSON document."""

_COHERENT_CPP = 0.08
_AT_LOWEST = (0.2, 2.0)


@dataclass(frozen=True, eq=False)
class MeasuredInput(ShortRepr):
    """One measurement as the combination reads it.

    Parameters
    ----------
    name : str
    record : Record
    slices : OtfSlices
    covariance_known : bool
        Whether the record holds the covariance of errors at different frequencies.
    """

    name: str
    record: Record
    slices: OtfSlices
    covariance_known: bool

    @property
    def kind(self) -> str:
        """The target."""
        return self.record.kind

    @property
    def image(self) -> ImageInfo:
        """Where the pixels came from."""
        return self.record.image

    @property
    def warnings(self) -> tuple[str, ...]:
        """Names of the checks by which its numbers may be off; notes only widen deviations."""
        failed = self.record.failed_checks
        return tuple(check.name for check in failed if check.severity != "note")

    @property
    def has_all_directions(self) -> bool:
        """Whether it shows all directions."""
        return self.slices.normal_deg.size > 1

    @property
    def direction(self) -> str:
        """The direction of its slice, or that it has all."""
        return direction_in_words(self.slices.normal_deg.tolist())


def direction_in_words(normal_deg: Sequence[float]) -> str:
    """One direction as text, -90 to 90 degrees; of several that they are all."""
    if len(normal_deg) > 1:
        return "all"
    return f"{wrap_axis(normal_deg[0]):.1f}°".replace("-", "−")


def read_inputs(
    measurements: Sequence[Combinable], names: Sequence[str] | None = None
) -> tuple[MeasuredInput, ...]:
    """Take results and documents apart into single measurements.

    Parameters
    ----------
    measurements : sequence of Measurement, Record, TargetResult or dict
    names : sequence of str, optional
        One for each; the names of files.

    Raises
    ------
    OptionError
        If one is no result, record or document that can be combined.
    """
    single = (Measurement, Record, TargetResult, Mapping, str)
    if isinstance(measurements, single) or not isinstance(measurements, Iterable):
        raise OptionError(
            f"a single {type(measurements).__name__} was given: give a list of measurements, "
            "combine([first, second])"
        )
    measurements = tuple(measurements)
    if names is not None and len(require_texts("names", names)) != len(measurements):
        raise OptionError(
            f"{len(names)} names were given for {len(measurements)} measurements: give one for each"
        )
    found: list[MeasuredInput] = []
    for i, one in enumerate(measurements):
        name = None if names is None else names[i]
        records = records_of(one, name or f"measurement {i + 1}")
        several = [
            f"{name or 'edge'} {record.image.region or k + 1}" for k, record in enumerate(records)
        ]
        called = [name] if len(records) == 1 else several
        found += [
            _input(record, name or f"measurement {i + 1}", own)
            for record, own in zip(records, called, strict=True)
        ]
    return _distinctly_named(found)


def without(inputs: Sequence[MeasuredInput], leave_out: Sequence[str]) -> list[MeasuredInput]:
    """Inputs without those of some names.

    Raises
    ------
    OptionError
        If one of the names is that of none; it lists those that there are.
    """
    known = [one.name for one in inputs]
    unknown = [name for name in require_texts("leave_out", leave_out) if name not in known]
    if unknown:
        raise OptionError(
            f"none is called {', '.join(unknown)}, so it cannot be left out: there are "
            f"{', '.join(known)}"
        )
    return [one for one in inputs if one.name not in leave_out]


def records_of(one: Combinable, origin: str) -> tuple[Record, ...]:
    """The records of a result or a document.

    Raises
    ------
    OptionError
        If it is none of measurements; it names `origin`.
    """
    if isinstance(one, TargetResult):
        return tuple(edge.record for edge in one.measurements)
    if isinstance(one, Measurement):
        return (one.record,)
    if isinstance(one, Record):
        return (one,)
    if isinstance(one, Mapping):
        return tuple(_read(document, origin) for document in _documents(one, origin))
    raise OptionError(
        f"{origin} is a {type(one).__name__}: give results of measure_edge, measure_pulse and the "
        "like, their records, or their JSON documents"
    )


def _documents(document: Mapping[str, Any], origin: str) -> list[Mapping[str, Any]]:
    schema = document.get("schema")
    if schema == SCHEMA:
        return [document]
    part = {"acutance/target/1": "measurements", "acutance/regions/1": "results"}.get(str(schema))
    inside = document.get(part) if part else None
    if isinstance(inside, Sequence):
        found = [one for one in inside if isinstance(one, Mapping)]
        return [single for one in found for single in _documents(one, origin)]
    if schema == "acutance/comparison/1":
        raise OptionError(
            f"{origin} holds one target measured by several methods: the same pixels count only "
            "once, so measure with one method (without --compare)"
        )
    if schema == "acutance/bands/1":
        raise OptionError(
            f"{origin} holds a measurement of every band: give that of one (--band N --json)"
        )
    if isinstance(schema, str) and schema.startswith("acutance/"):
        raise OptionError(
            f"{origin} is a document {schema}, no measurement ({SCHEMA}): give the JSON "
            "document of a measurement"
        )
    raise OptionError(
        f"{origin} is no measurement of acutance: write one with a measuring command and --json"
    )


def _read(document: Mapping[str, Any], origin: str) -> Record:
    try:
        return Record.from_dict(document)
    except OptionError as error:
        raise OptionError(f"{origin}: {error}") from error


def _input(record: Record, origin: str, name: str | None) -> MeasuredInput:
    """One measurement with its slices.

    Raises
    ------
    OptionError
        If it is a combination or a ratio, no transfer function, or without deviations.
    """
    if record.kind == "combined":
        raise OptionError(
            f"{origin} is a combination already: combine the measurements it was made of, so "
            "that none counts twice"
        )
    require_own_mtf(record, origin)
    try:
        slices, known = _slices(record)
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        raise OptionError(f"{origin} cannot be read as a measurement: {error}") from error
    _require_transfer(slices, origin)
    oriented = (record.kind, str(record.document.get("orientation", "")))
    return MeasuredInput(name or " ".join(filter(None, oriented)), record, slices, known)


def _require_transfer(slices: OtfSlices, origin: str) -> None:
    """Refuse curves that are no transfer function, and those without standard deviations."""
    lowest = np.abs(slices.otf.reshape(slices.normal_deg.size, -1)[:, 0])
    low, high = _AT_LOWEST
    if not (np.all(lowest > low) and np.all(lowest < high)):
        raise OptionError(
            f"{origin}: its MTF at {slices.freq_cpp[0]:g} c/px is {lowest.min():.3g} to "
            f"{lowest.max():.3g}, that of a sensor is near 1: the document was changed, or the "
            "measurement failed; measure it again"
        )
    if not np.any(slices.factor):
        raise OptionError(
            f"{origin} has no standard deviations, so it cannot be weighted: measure it with a "
            "method that reports them"
        )


def _slices(record: Record) -> tuple[OtfSlices, bool]:
    """The slices of a record; of documents of older versions they follow from the curves."""
    if "plane" in record.document:
        return record.slices, True
    line = record.document.get("line")
    across_deg = 0.0 if record.image.along_track == "y" else 90.0
    directions_deg = {"across": across_deg, "along": 90.0 - across_deg}
    without = [name for name, one in record.directions.items() if not one.has_curve("mtf")]
    if without:
        raise OptionError(f"it holds no MTF {without[0]} track, numbers alone")
    curves = [
        (one.document["mtf"], float(line["normal_deg"]) if line else directions_deg[name])
        for name, one in record.directions.items()
    ]
    slices = [OtfSlices.of_curve(_curve(curve), at) for curve, at in curves]
    blocks = [one.factor for one in slices]
    columns = np.cumsum([0, *(one.shape[1] for one in blocks)])
    factor = np.zeros((sum(one.shape[0] for one in blocks), columns[-1]), complex)
    row = 0
    for block, left, right in zip(blocks, columns[:-1], columns[1:], strict=True):
        factor[row : row + block.shape[0], left:right] = block
        row += block.shape[0]
    whole = OtfSlices(
        np.concatenate([one.normal_deg for one in slices]),
        slices[0].freq_cpp,
        np.concatenate([one.otf for one in slices]),
        factor,
    )
    return whole, all("factor_real" in curve for curve, _ in curves)


def _curve(curve: Mapping[str, Any]) -> Mtf:
    """The MTF of a document; without its factor, errors are taken to be equal over 0.08 c/px."""
    freq, value, std, phase = (
        np.array(curve[key], float) for key in ("freq_cpp", "value", "std", "phase_rad")
    )
    otf = value * np.exp(1j * phase)
    if not (np.isfinite(otf).all() and np.isfinite(std).all()):
        raise ValueError("its curve has gaps")
    if "factor_real" in curve:
        return Mtf(freq, otf, np.array(curve["factor_real"]) + 1j * np.array(curve["factor_imag"]))
    coherent: Floats = np.exp(-0.5 * ((freq[:, None] - freq) / _COHERENT_CPP) ** 2)
    size, vector = np.linalg.eigh(coherent)
    root = std[:, None] * vector * np.sqrt(np.maximum(size, 0.0))
    phasor = np.exp(1j * phase)[:, None]
    return Mtf(freq, otf, np.concatenate([phasor * root, 1j * phasor * root], axis=1))


def _distinctly_named(inputs: Sequence[MeasuredInput]) -> tuple[MeasuredInput, ...]:
    """Names as short as they can be: files without their folders, equal ones numbered."""
    names = [_short(one.name) for one in inputs]
    found = []
    for i, one in enumerate(inputs):
        name = names[i]
        if names.count(name) > 1:
            name = f"{name} ({names[: i + 1].count(name)})"
        found.append(replace(one, name=name))
    return tuple(found)


def _short(name: str) -> str:
    path = PurePath(name)
    return path.stem if path.suffix == ".json" else name


def common_flight(inputs: Sequence[MeasuredInput]) -> AlongTrack:
    """The image axis along track, which all inputs share.

    Raises
    ------
    OptionError
        If they differ.
    """
    first = inputs[0]
    for one in inputs[1:]:
        if one.image.along_track != first.image.along_track:
            raise OptionError(
                f"{first.name} was measured with along-track {first.image.along_track}, {one.name} "
                f"with {one.image.along_track}: measure both with the same axis along track"
            )
    return first.image.along_track
