"""Sensors that ship with the package, each a data file in the folder ``presets``."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from acutance.errors import ModelError
from acutance.optics.sensor import Sensor
from acutance.optics.sheet import SensorSheet, sheet_from_toml

__all__ = ["preset", "presets"]


def presets() -> dict[str, SensorSheet]:
    """All sensors that ship with the package, by name, each with its description and sources."""
    return dict(_sheets())


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
    sheets = _sheets()
    if name not in sheets:
        raise ModelError(f"there is no preset {name!r}, only {', '.join(sheets)}")
    return sheets[name].sensor


@cache
def _sheets() -> dict[str, SensorSheet]:
    folder = files("acutance.optics") / "presets"
    texts = {
        file.name: file.read_text(encoding="utf-8")
        for file in folder.iterdir()
        if file.name.endswith(".toml")
    }
    sheets = [sheet_from_toml(texts[name], name) for name in sorted(texts)]
    return {sheet.name: sheet for sheet in sheets}
