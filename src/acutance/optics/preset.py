"""Sensors that ship with the package, each a data file in the folder ``presets``."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from acutance.errors import ModelError
from acutance.optics.sensor import Sensor
from acutance.optics.sensor_file import SensorFile, sensor_file_from_toml

__all__ = ["preset", "presets"]


def presets() -> dict[str, SensorFile]:
    """All sensors that ship with the package, by name, each with its description and sources."""
    return dict(_files())


def preset(name: str) -> Sensor:
    """A sensor that ships with the package.

    Parameters
    ----------
    name : str
        "generic-2005", "ikonos-like" or "quickbird-like"; `presets` describes them.

    Returns
    -------
    Sensor

    Raises
    ------
    ModelError
        If there is no such sensor.
    """
    described = _files()
    if not isinstance(name, str) or name not in described:
        raise ModelError(f"there is no preset {name!r}, only {', '.join(described)}")
    return described[name].sensor


@cache
def _files() -> dict[str, SensorFile]:
    folder = files("acutance.optics") / "presets"
    texts = {
        file.name: file.read_text(encoding="utf-8")
        for file in folder.iterdir()
        if file.name.endswith(".toml")
    }
    described = [sensor_file_from_toml(texts[name], name) for name in sorted(texts)]
    return {one.name: one for one in described}
