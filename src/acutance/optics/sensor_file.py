"""Sensors described in TOML: read, checked, and written.

::

    name = "my-sensor"
    description = "What it is and where its numbers are from."
    gsd_m = 0.7

    [[block]]
    kind = "Gaussian"
    sigma_m = 0.28
    source = "Prelaunch report, table 4"

Every block has the name and the parameters of its class. A length named ``..._px`` may be given
in metres as ``..._m``, a frequency named ``..._cpp`` in cycles per metre as ``..._cpm``; both
are converted with the GSD along the parameter's own axis.
"""

from __future__ import annotations

import inspect
import json
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from acutance.arguments import require_kind, require_path, require_types
from acutance.errors import ModelError, OptionError
from acutance.execution.partial_folder import named_whole_file
from acutance.optics.block import Block
from acutance.optics.catalogue import BLOCKS
from acutance.optics.sensor import Sensor, require_sensor

__all__ = [
    "SensorFile",
    "read_sensor",
    "sensor_file_from_toml",
    "sensor_file_to_toml",
    "write_sensor",
]

_KEYS = ("name", "description", "gsd_m", "gsd_along_m", "block")
_METRIC = {"px": "m", "cpp": "cpm"}
_ROW_SIZES = ("sigma_along_px", "height_px", "row_px", "drift_px")
_COL_SIZES = ("col_px", "drift_across_px")
# Sizes across that hold along as well unless the other one is given.
_TWINS: dict[str, tuple[str, ...]] = {
    "sigma_px": ("sigma_along_px", "sigma_along_m"),
    "width_px": ("height_px", "height_m"),
}


@dataclass(frozen=True)
class SensorFile:
    """A sensor with what is known about it.

    Parameters
    ----------
    sensor : Sensor
    name : str
        A short name, as files and options use it.
    description : str
        What it is and where its numbers are from.
    sources : tuple of str
        Where each block's numbers are from, in the sensor's order; empty where it is not known.

    Raises
    ------
    OptionError
        If a field is of another kind, or there are other numbers of sources and blocks.
    """

    sensor: Sensor
    name: str = ""
    description: str = ""
    sources: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        require_types(self)
        if len(self.sources) not in (0, len(self.sensor.blocks)):
            raise OptionError(
                f"SensorFile: {len(self.sources)} sources of {len(self.sensor.blocks)} blocks: "
                "give one of each block, '' where it is not known"
            )


def read_sensor(path: str | os.PathLike[str], gsd_m: float | None = None) -> Sensor:
    """Read a sensor from a TOML file.

    Parameters
    ----------
    path : str or path
    gsd_m : float, optional
        GSD of square pixels, instead of what the file states: lengths in metres keep their metres,
        those in pixels their pixels.

    Returns
    -------
    Sensor

    Raises
    ------
    OptionError
        If it is no path.
    ModelError
        If the file cannot be read, is no TOML, or describes no sensor; the message names the
        file, the block and the key.
    """
    require_path(path=path)
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError(
            f"the sensor file {path} cannot be read ({reason}): check its path"
        ) from error
    return sensor_file_from_toml(text, os.fspath(path), gsd_m).sensor


def write_sensor(described: Sensor | SensorFile, path: str | os.PathLike[str]) -> None:
    """Write a sensor as a TOML file that `read_sensor` reads back as the same sensor.

    Parameters
    ----------
    described : Sensor or SensorFile
    path : str or path
        An existing file is replaced once the new one is whole.

    Raises
    ------
    OptionError
        If it is neither a sensor nor the description of one, or there is no path.
    ModelError
        If a block has no place in a file, or the file cannot be written.
    """
    require_path(path=path)
    text = sensor_file_to_toml(
        described if isinstance(described, SensorFile) else SensorFile(require_sensor(described))
    )
    with named_whole_file(path, ModelError) as part:
        part.write_text(text, encoding="utf-8")


def sensor_file_from_toml(
    text: str, origin: str = "the sensor", gsd_m: float | None = None
) -> SensorFile:
    """Read a sensor's description.

    Parameters
    ----------
    text : str
        TOML.
    origin : str, optional
        What to call it in messages: the file's name.
    gsd_m : float, optional
        GSD of square pixels, instead of the one that is described.

    Raises
    ------
    OptionError
        If it is no text.
    ModelError
        If it is no TOML or describes no sensor.
    """
    if not isinstance(text, str):
        raise OptionError(f"text is {text!r:.80}: give TOML, of a file by read_sensor(path)")
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ModelError(f"{origin} is no TOML: {error}") from error
    unknown = [key for key in table if key not in _KEYS]
    if unknown:
        raise ModelError(f"{origin}: {unknown[0]!r} is no key here, only {', '.join(_KEYS)}")
    described = table.get("block", [])
    if not isinstance(described, list) or not described:
        raise ModelError(f"{origin}: a sensor needs at least one [[block]]")
    sizes = {key: _number(table[key], key, origin) for key in _KEYS[2:4] if key in table}
    if gsd_m is not None:
        sizes = {"gsd_m": gsd_m}
    try:
        pixel_m = Sensor([BLOCKS["Detector"].make()], **sizes).pixel_m
        blocks = [
            _block(one, pixel_m, f"{origin}, block {i}") for i, one in enumerate(described, 1)
        ]
        sensor = Sensor(blocks, **sizes)
    except ModelError as error:
        named = str(error).startswith(origin)
        raise error if named else ModelError(f"{origin}: {error}") from error
    sources = tuple(str(one.get("source", "")) for one in described)
    name, description = (str(table.get(key, "")).strip() for key in ("name", "description"))
    return SensorFile(sensor, name, description, sources)


def sensor_file_to_toml(described: SensorFile) -> str:
    """A sensor's description as TOML, lengths in pixels; reading it gives an equal one.

    Raises
    ------
    OptionError
        If it is no description of a sensor.
    ModelError
        If a block is none of `acutance.optics.BLOCKS`, or holds another system.
    """
    require_kind(SensorFile, described=described)
    sensor = described.sensor
    lines = [
        f"{key} = {json.dumps(value, ensure_ascii=False)}"
        for key, value in (("name", described.name), ("description", described.description))
        if value
    ]
    lines += [
        f"{key} = {float(size)!r}"
        for key, size in (("gsd_m", sensor.gsd_m), ("gsd_along_m", sensor.gsd_along_m))
        if size is not None
    ]
    sources = described.sources or ("",) * len(sensor.blocks)
    for block, source in zip(sensor.blocks, sources, strict=True):
        lines += ["", "[[block]]", f'kind = "{_kind_of(block)}"']
        values = ((one.name, getattr(block, one.name)) for one in fields(block))  # type: ignore[arg-type]
        lines += [f"{name} = {_toml(value)}" for name, value in values if value is not None]
        if source:
            lines.append(f"source = {json.dumps(source, ensure_ascii=False)}")
    return "\n".join(lines).lstrip("\n") + "\n"


def _kind_of(block: Block) -> str:
    kind = type(block).__name__
    if kind not in BLOCKS or kind == "Rescaled":
        writable = ", ".join(name for name in BLOCKS if name != "Rescaled")
        raise ModelError(
            f"{kind} cannot be written to a file: describe the sensor by {writable} "
            "in its own pixels"
        )
    return kind


def _toml(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, str):
        return json.dumps(value)
    # A number of numpy has a repr of its own ("np.float64(0.4)"), which is no TOML.
    return repr(value.item() if isinstance(value, np.generic) else value)


def _block(table: Any, pixel_m: tuple[float, float] | None, origin: str) -> Block:
    """The block a TOML table describes, its metres converted to pixels."""
    kind = table.get("kind") if isinstance(table, Mapping) else None
    if kind not in BLOCKS or kind == "Rescaled":
        known = ", ".join(name for name in BLOCKS if name != "Rescaled")
        found = "it has no kind" if kind is None else f"kind is {kind!r}"
        raise ModelError(f"{origin}: {found}, it has to be one of {known}")
    origin = f"{origin} ({kind})"
    parameters = inspect.signature(BLOCKS[kind].make).parameters
    given = {key: value for key, value in table.items() if key not in ("kind", "source")}
    values: dict[str, Any] = {}
    for key, value in given.items():
        name = _parameter(key, list(parameters), origin)
        if name in values:
            raise ModelError(f"{origin}: {name} is given in pixels and in metres: leave one out")
        if name == key:
            values[name] = _value(value, key, origin)
            continue
        size_m = _size_m(name, key, given, parameters, pixel_m, origin)
        number = _number(value, key, origin)
        values[name] = number / size_m if name.endswith("_px") else number * size_m
    empty = inspect.Parameter.empty
    lacking = [n for n, one in parameters.items() if one.default is empty and n not in values]
    if lacking:
        raise ModelError(f"{origin}: {', '.join(lacking)} has to be given")
    try:
        return BLOCKS[kind].make(**values)
    except ModelError as error:
        raise ModelError(f"{origin}: {error}") from error


def _parameter(key: str, names: list[str], origin: str) -> str:
    """The parameter a key stands for: itself, or the one in pixels that it gives in metres."""
    metric = {
        f"{stem}_{_METRIC[unit]}": name
        for name in names
        for stem, _, unit in [name.rpartition("_")]
        if unit in _METRIC
    }
    if key in names:
        return key
    if key in metric:
        return metric[key]
    raise ModelError(f"{origin}: {key!r} is no parameter, only {', '.join([*names, *metric])}")


def _size_m(
    name: str,
    key: str,
    given: Mapping[str, Any],
    parameters: Mapping[str, inspect.Parameter],
    pixel_m: tuple[float, float] | None,
    origin: str,
) -> float:
    """Size of a pixel along the axis a parameter acts on."""
    if pixel_m is None:
        raise ModelError(
            f"{origin}: {key} is in metres, which needs gsd_m at the top of the file "
            "(or --gsd of the commands that have it)"
        )
    row_m, col_m = pixel_m
    if row_m == col_m or name in _COL_SIZES:
        return col_m
    if name in _ROW_SIZES:
        return row_m
    if "axis" in parameters:
        axis = given.get("axis", parameters["axis"].default)
        return col_m if axis == "across" else row_m
    twins = _TWINS.get(name, ())
    if set(twins) & set(given):
        return col_m
    has_twin = bool(set(twins) & set(parameters))
    advice = f"give {twins[1]} too" if has_twin else "give it in pixels"
    raise ModelError(
        f"{origin}: {key} holds in all directions, but pixels of {row_m:g} m by {col_m:g} m make "
        f"it two numbers: {advice}"
    )


def _value(value: Any, key: str, origin: str) -> Any:
    if isinstance(value, list):
        return tuple(_value(item, key, origin) for item in value)
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ModelError(f"{origin}: {key} is {value!r}, it has to be a number or a word")
    return value


def _number(value: Any, key: str, origin: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ModelError(f"{origin}: {key} is {value!r}, it has to be a number")
    return float(value)
