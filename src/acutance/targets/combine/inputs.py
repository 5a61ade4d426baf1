"""What is combined: measurements as results or as the JSON documents the commands write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

import numpy as np

from acutance.curves import Mtf
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.targets.measurement import SCHEMA, Measurement
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.slices import PlaneSlices
from acutance.targets.straight.many_edges import TargetResult

__all__ = ["Combinable", "MeasuredInput", "common_flight", "read_inputs"]

Combinable = Measurement | Measurement2d | TargetResult | Mapping[str, Any]
"""A result, or its JSON document."""

_COHERENT_CPP = 0.08
_AT_LOWEST = (0.2, 2.0)


@dataclass(frozen=True, eq=False)
class MeasuredInput(ShortRepr):
    """One measurement as the combination sees it.

    Parameters
    ----------
    name : str
    kind, method : str
    slices : PlaneSlices
    gsd_m : float or None
        Along the normal of a single direction, else along the rows.
    pixel_gsd_m : (float, float) or None
        Between rows and between columns; ``None`` where the document does not say.
    along_track : {"y", "x"}
    path : str or None
    place : tuple of float
        Where in the image: the line of an edge or a pulse, the region of another target.
    failed_checks : tuple of str
    covariance_known : bool
        Whether the measurement tells how errors at different frequencies belong together.
    """

    name: str
    kind: str
    method: str
    slices: PlaneSlices
    gsd_m: float | None
    along_track: str
    path: str | None
    place: tuple[float, ...]
    failed_checks: tuple[str, ...]
    covariance_known: bool
    pixel_gsd_m: tuple[float, float] | None = None

    @property
    def of_plane(self) -> bool:
        """Whether it knows all directions."""
        return self.slices.normal_deg.size > 1

    @property
    def direction(self) -> str:
        """The direction of its slice, or that it has all."""
        if self.of_plane:
            return "all"
        return f"{(float(self.slices.normal_deg[0]) + 90.0) % 180.0 - 90.0:.1f}°".replace("-", "−")


def read_inputs(
    measurements: Sequence[Combinable], names: Sequence[str] | None = None
) -> tuple[MeasuredInput, ...]:
    """Take results and documents apart into single measurements.

    Parameters
    ----------
    measurements : sequence of Measurement, Measurement2d, TargetResult or dict
    names : sequence of str, optional
        One for each; the names of files.

    Raises
    ------
    OptionError
        If one is nothing that can be combined, or they do not belong together.
    """
    single = (Measurement, Measurement2d, TargetResult, Mapping, str)
    if isinstance(measurements, single) or not isinstance(measurements, Iterable):
        raise OptionError(
            f"a single {type(measurements).__name__} was given: give a list of measurements, "
            "combine([first, second])"
        )
    measurements = tuple(measurements)
    if names is not None and len(names) != len(measurements):
        raise OptionError(f"{len(names)} names were given for {len(measurements)} measurements")
    found: list[MeasuredInput] = []
    for i, one in enumerate(measurements):
        found += _parts(one, None if names is None else names[i], i + 1)
    return _distinctly_named(found)


def _parts(one: Combinable, name: str | None, number: int) -> list[MeasuredInput]:
    documents: list[Mapping[str, Any]]
    if isinstance(one, TargetResult):
        documents = [edge.to_dict() for edge in one.measurements]
    elif isinstance(one, Measurement | Measurement2d):
        documents = [one.to_dict()]
    elif isinstance(one, Mapping):
        documents = _documents(one, name or f"measurement {number}")
    else:
        raise OptionError(
            f"measurement {number} is a {type(one).__name__}: give results of measure_edge, "
            "measure_pulse and the like, or their JSON documents"
        )
    several = len(documents) > 1
    return [
        _input(document, name, f"{name or 'edge'} {i}" if several else name, number)
        for i, document in enumerate(documents, start=1)
    ]


def _documents(document: Mapping[str, Any], origin: str) -> list[Mapping[str, Any]]:
    schema = document.get("schema")
    if schema == SCHEMA:
        return [document]
    inside = document.get("measurements")
    if schema == "acutance/target/1" and isinstance(inside, Sequence):
        return [one for one in inside if isinstance(one, Mapping)]
    if schema == "acutance/comparison/1":
        raise OptionError(
            f"{origin} holds one target measured by several methods: the same pixels count only "
            "once, so measure with one method (without --compare)"
        )
    if isinstance(schema, str) and schema.startswith("acutance/"):
        raise OptionError(f"{origin} is a document {schema}, no measurement ({SCHEMA})")
    raise OptionError(
        f"{origin} is no measurement of acutance: write one with a measuring command and --json"
    )


def _input(
    document: Mapping[str, Any], origin: str | None, name: str | None, number: int
) -> MeasuredInput:
    called = origin or f"measurement {number}"
    try:
        return _read(document, called, name)
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        if isinstance(error, OptionError):
            raise
        raise OptionError(f"{called} cannot be read as a measurement ({error!r})") from error


def _read(document: Mapping[str, Any], called: str, name: str | None) -> MeasuredInput:
    kind, method, image = document["kind"], document["method"], document["image"]
    if kind == "combined":
        raise OptionError(
            f"{called} is a combination already: combine the measurements it was made of, so "
            "that none counts twice"
        )
    if kind == "biresolution" and not document["options"].get("reference_given", True):
        raise OptionError(
            f"{called} is the ratio MTF_low / MTF_high, since the reference's own MTF was not "
            "given: measure it again with --reference"
        )
    slices, known = _slices(document, called)
    _require_transfer(slices, called)
    line = document.get("line")
    place = [float(one) for one in image["roi"]]
    if line is not None:
        place = [float(line[key]) for key in ("row", "col", "normal_deg")]
    word = document.get("orientation", "")
    gsd, sides = image["gsd_m"], image.get("pixel_gsd_m")
    return MeasuredInput(
        name or " ".join(one for one in (kind, word) if one),
        str(kind),
        str(method),
        slices,
        None if gsd is None else float(gsd),
        str(image.get("along_track", "y")),
        image["path"],
        tuple(place),
        tuple(one["name"] for one in document["checks"] if not one["passed"]),
        known,
        None if sides is None else (float(sides[0]), float(sides[1])),
    )


def _require_transfer(slices: PlaneSlices, called: str) -> None:
    """Refuse what is no transfer function, and one without any standard deviation."""
    lowest = np.abs(slices.otf.reshape(slices.normal_deg.size, -1)[:, 0])
    least, most = _AT_LOWEST
    if not (np.all(lowest > least) and np.all(lowest < most)):
        raise OptionError(
            f"{called}: its MTF at {slices.freq_cpp[0]:g} c/px is {lowest.min():.3g} to "
            f"{lowest.max():.3g}, that of a sensor is near 1: the document was changed, or the "
            "measurement failed"
        )
    if not np.any(slices.factor):
        raise OptionError(
            f"{called} has no standard deviations, so it cannot be weighted: measure it with a "
            "method that reports them"
        )


def _slices(document: Mapping[str, Any], called: str) -> tuple[PlaneSlices, bool]:
    if "plane" in document:
        try:
            return PlaneSlices.from_dict(document["plane"]), True
        except OptionError as error:
            raise OptionError(f"{called}: {error}") from error
    if "line" in document:
        curves = [(document["mtf"], float(document["line"]["normal_deg"]))]
    else:
        turned = document["image"].get("along_track", "y") == "x"
        angles = (90.0, 0.0) if turned else (0.0, 90.0)
        curves = [
            (document[key]["mtf"], at) for key, at in zip(("across", "along"), angles, strict=True)
        ]
    slices = [PlaneSlices.of_curve(_curve(curve), at) for curve, at in curves]
    blocks = [one.factor for one in slices]
    columns = np.cumsum([0, *(one.shape[1] for one in blocks)])
    factor = np.zeros((sum(one.shape[0] for one in blocks), columns[-1]), complex)
    row = 0
    for block, left, right in zip(blocks, columns[:-1], columns[1:], strict=True):
        factor[row : row + block.shape[0], left:right] = block
        row += block.shape[0]
    whole = PlaneSlices(
        np.concatenate([one.normal_deg for one in slices]),
        slices[0].freq_cpp,
        np.concatenate([one.otf for one in slices]),
        factor,
    )
    return whole, all("factor_real" in curve for curve, _ in curves)


def _curve(curve: Mapping[str, Any]) -> Mtf:
    """The MTF of a document; without its factor, errors are taken to be alike over 0.08 c/px."""
    freq, value, std, phase = (
        np.array(curve[key], float) for key in ("freq_cpp", "value", "std", "phase_rad")
    )
    otf = value * np.exp(1j * phase)
    if not (np.isfinite(otf).all() and np.isfinite(std).all()):
        raise ValueError("its curve has gaps")
    if "factor_real" in curve:
        return Mtf(freq, otf, np.array(curve["factor_real"]) + 1j * np.array(curve["factor_imag"]))
    alike: Floats = np.exp(-0.5 * ((freq[:, None] - freq) / _COHERENT_CPP) ** 2)
    size, vector = np.linalg.eigh(alike)
    root = std[:, None] * vector * np.sqrt(np.maximum(size, 0.0))
    turn = np.exp(1j * phase)[:, None]
    return Mtf(freq, otf, np.concatenate([turn * root, 1j * turn * root], axis=1))


def _distinctly_named(inputs: Sequence[MeasuredInput]) -> tuple[MeasuredInput, ...]:
    """Names as short as they can be: files without their folders, equal ones numbered."""
    from dataclasses import replace

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


def common_flight(inputs: Sequence[MeasuredInput]) -> str:
    """The image axis along track, which all inputs share.

    Raises
    ------
    OptionError
        If they differ.
    """
    first = inputs[0]
    for one in inputs[1:]:
        if one.along_track != first.along_track:
            raise OptionError(
                f"{first.name} was measured with along-track {first.along_track}, {one.name} with "
                f"{one.along_track}: measure them alike"
            )
    return first.along_track
