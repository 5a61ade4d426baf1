"""Known characteristic curves of images: from stored values to values proportional to light.

A sensor's blur is a convolution of light. Products made to be looked at store a curve of it: sRGB,
a power law, a logarithm, a table of the scanner. Turned back before anything else is measured, the
values are linear again.
"""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from acutance.arguments import require_floats, require_kind, require_numbers
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ImageError, OptionError
from acutance.raster.pixels import PixelSource
from acutance.raster.region import Box

__all__ = [
    "Characteristic",
    "LinearizeLike",
    "LinearizedPixels",
    "LogCurve",
    "PowerCurve",
    "SrgbCurve",
    "TableCurve",
    "characteristic",
    "table_of",
]

_NUMBER = r"\d*\.?\d+"
_NAMED = rf"(srgb|log)(:.*)?|{_NUMBER}"
_SRGB_KNEE = 0.04045
_SRGB_SLOPE = 12.92
_SRGB_OFFSET = 0.055
_SRGB_GAMMA = 2.4
_MAX_FLOAT_SRGB = 1.5
_GAMMAS = (0.1, 10.0)
_MAX_DECADES = 12.0
_MIN_ROWS = 3
_DARK_NOISE, _DARK_NOISE_OF_SCALE = 0.1, 0.001
"""Shares of the largest value and of white that values may be below 0: noise about it does, and so
do undershoots of kernels."""


class Characteristic(Protocol):
    """A curve that values went through, and its inverse."""

    @property
    def words(self) -> str:
        """What the curve is, for reports and documents."""
        ...

    def linear(self, values: Floats) -> Floats:
        """Values proportional to light, of the same shape; NaN stays NaN.

        Raises
        ------
        ImageError
            If the curve does not have such values.
        """
        ...


@dataclass(frozen=True)
class SrgbCurve:
    """The curve of sRGB (IEC 61966-2-1).

    Parameters
    ----------
    full_scale : float
        The stored value of white, which stays where it is.

    Raises
    ------
    OptionError
        If it is no number above 0.
    """

    full_scale: float

    def __post_init__(self) -> None:
        _require_scale(self.full_scale)

    @property
    def words(self) -> str:
        """What the curve is."""
        return f"sRGB (IEC 61966-2-1), white at {self.full_scale:g}"

    def linear(self, values: Floats) -> Floats:
        """Values proportional to light, of the same shape."""
        _require_light(values, self.full_scale, "sRGB")
        share = values / self.full_scale
        if self.full_scale == 1 and _largest(share) > _MAX_FLOAT_SRGB:
            raise ImageError(
                f"sRGB of floats runs from 0 to 1, and there are values up to {_largest(share):g}: "
                "state the value of white, as in sRGB:255"
            )
        size = np.abs(share)
        bent = ((size + _SRGB_OFFSET) / (1 + _SRGB_OFFSET)) ** _SRGB_GAMMA
        light = np.where(size <= _SRGB_KNEE, size / _SRGB_SLOPE, bent)
        return np.asarray(np.copysign(light, share) * self.full_scale)


@dataclass(frozen=True)
class PowerCurve:
    """Values that are the 1 / gamma-th power of light.

    Parameters
    ----------
    gamma : float
        0.1 to 10; above 1 of images made to be looked at.
    full_scale : float
        The value that stays where it is: it sets the unit of the linear values and no more.
    """

    gamma: float
    full_scale: float

    def __post_init__(self) -> None:
        require_numbers(gamma=self.gamma)
        _require_scale(self.full_scale)
        low, high = _GAMMAS
        if not low <= self.gamma <= high:
            raise OptionError(
                f"a gamma of {self.gamma:g} was asked for: it has to be {low:g} to {high:g}, the "
                "power of the stored values that is proportional to light"
            )

    @property
    def words(self) -> str:
        """What the curve is."""
        return f"gamma {self.gamma:g}, full scale {self.full_scale:g}"

    def linear(self, values: Floats) -> Floats:
        """Values proportional to light, of the same shape; noise below 0 stays below 0."""
        _require_light(values, self.full_scale, "a power of light")
        share = values / self.full_scale
        return np.asarray(np.copysign(np.abs(share) ** self.gamma, share) * self.full_scale)


@dataclass(frozen=True)
class LogCurve:
    """Values that are a logarithm of light.

    Parameters
    ----------
    decade : float
        By how much they rise where there is ten times as much light: 1 for log10, 10 for dB,
        2.3026 for natural logarithms.
    """

    decade: float

    def __post_init__(self) -> None:
        require_numbers(decade=self.decade)
        if not (self.decade > 0 and math.isfinite(self.decade)):
            raise OptionError(
                f"log:{self.decade:g} was asked for: state by how much the values rise for ten "
                "times the light, a number above 0"
            )

    @property
    def words(self) -> str:
        """What the curve is."""
        return f"logarithm, {self.decade:g} for ten times the light"

    def linear(self, values: Floats) -> Floats:
        """Values proportional to light, of the same shape."""
        decades = values / self.decade
        if _largest(np.abs(decades)) > _MAX_DECADES:
            raise ImageError(
                f"values up to {_largest(np.abs(values)):g} are {_largest(np.abs(decades)):.0f} "
                "powers of ten of light: state by how much the values rise for ten times the "
                "light, as in log:85"
            )
        return np.asarray(10.0**decades)


@dataclass(frozen=True, eq=False)
class TableCurve(ShortRepr):
    """A table of stored values and light, straight in between.

    Parameters
    ----------
    name : str
        Of its file.
    values, light : (n,) arrays
        Both rise from row to row.
    """

    name: str
    values: Floats
    light: Floats

    def __post_init__(self) -> None:
        require_kind(str, name=self.name)
        for name in ("values", "light"):
            object.__setattr__(self, name, require_floats(name, getattr(self, name)))
        if self.values.ndim != 1 or self.values.shape != self.light.shape or not self.values.size:
            raise OptionError(
                f"a table of values of shape {self.values.shape} and light of shape "
                f"{self.light.shape}: give two columns of one length"
            )

    @classmethod
    def of_file(cls, path: str) -> TableCurve:
        """Read a table of two columns, comma, semicolon or blanks between; a header may be there.

        Raises
        ------
        OptionError
            If it is none, or not strictly rising.
        """
        require_kind(str, path=path)
        rows = _rows(path)
        values, light = rows.T
        for column, title in ((values, "stored value"), (light, "light")):
            falls = np.flatnonzero(np.diff(column) <= 0)
            if falls.size:
                before, behind = column[falls[0]], column[falls[0] + 1]
                raise OptionError(
                    f"{path}: the {title} goes from {before:g} to {behind:g} (rows {falls[0] + 1} "
                    f"and {falls[0] + 2}): both columns have to rise from row to row"
                )
        return cls(Path(path).name, values, light)

    @property
    def words(self) -> str:
        """What the curve is."""
        return (
            f"table {self.name}, {self.values.size} rows from {self.values[0]:g} to "
            f"{self.values[-1]:g}"
        )

    def summary(self) -> str:
        """The table in one line."""
        return self.words

    def linear(self, values: Floats) -> Floats:
        """Values proportional to light, of the same shape."""
        finite = values[np.isfinite(values)]
        if finite.size and not self.values[0] <= finite.min() <= finite.max() <= self.values[-1]:
            raise ImageError(
                f"the image has values from {finite.min():g} to {finite.max():g}, and {self.name} "
                f"rows from {self.values[0]:g} to {self.values[-1]:g}: add rows for the others, or "
                "declare the value of pixels without data (nodata, --nodata)"
            )
        light = np.interp(values, self.values, self.light)
        return np.where(np.isfinite(values), light, np.nan)


LinearizeLike = str | float | Characteristic | None
"""A name ("sRGB", "sRGB:255", "log:85"), a gamma, the path of a table, or a curve."""


@dataclass(frozen=True, eq=False)
class LinearizedPixels:
    """Pixels of a source, turned back through a characteristic curve.

    Parameters
    ----------
    source : PixelSource
    curve : Characteristic
    """

    source: PixelSource
    curve: Characteristic

    def read(self, box: Box) -> Floats:
        """(height, width) linear values of a box; NaN where unusable."""
        return self.curve.linear(self.source.read(box))


def characteristic(asked: LinearizeLike, full_scale: float | None) -> Characteristic | None:
    """The curve that was asked for.

    Parameters
    ----------
    asked : str, float, Characteristic or None
        "sRGB" or "sRGB:WHITE", "log:DECADE", a gamma, or the path of a table.
    full_scale : float or None
        The largest value the image's type or file allows; None of floats stands for 1.

    Raises
    ------
    OptionError
        If there is no such curve.
    """
    scale = 1.0 if full_scale is None else full_scale
    if asked is None:
        return None
    if isinstance(asked, int | float) and not isinstance(asked, bool):
        return PowerCurve(float(asked), scale)
    if not isinstance(asked, str):
        if hasattr(asked, "linear") and hasattr(asked, "words"):
            return asked
        raise OptionError(
            f"linearize is of type {type(asked).__name__}: give sRGB, log:DECADE, a gamma or the "
            "path of a table"
        )
    name, _, number = asked.partition(":")
    if name.lower() == "srgb":
        return SrgbCurve(_number(asked, number) if number else scale)
    if name.lower() == "log":
        return LogCurve(_number(asked, number) if number else math.log(10))
    return TableCurve.of_file(asked)


def table_of(asked: LinearizeLike) -> str | None:
    """The path of the table that was asked for; None of any other curve."""
    is_name = not isinstance(asked, str) or re.fullmatch(_NAMED, asked.lower())
    return None if is_name else str(asked)


def _require_scale(full_scale: float) -> None:
    require_numbers(full_scale=full_scale)
    if not 0 < full_scale < math.inf:
        raise OptionError(f"full_scale is {full_scale:g}: give the value of white, above 0")


def _require_light(values: Floats, full_scale: float, law: str) -> None:
    """Refuse values that are below 0 by more than noise: the curve has none.

    Raises
    ------
    ImageError
        Names the lowest.
    """
    finite = values[np.isfinite(values)]
    lowest = float(finite.min()) if finite.size else 0.0
    if lowest >= 0:
        return
    if -lowest > max(_DARK_NOISE * _largest(np.abs(finite)), _DARK_NOISE_OF_SCALE * full_scale):
        raise ImageError(
            f"the image has values down to {lowest:g}, and {law} is never below 0: add what was "
            "subtracted from them, give the curve as a table, or declare the value of pixels "
            "without data (nodata, --nodata)"
        )


def _number(asked: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not (number > 0 and math.isfinite(number)):
        raise OptionError(f"{asked}: {text!r} has to be a number above 0, as in sRGB:255 or log:85")
    return number


def _rows(path: str) -> Floats:
    """The numbers of a table, (n, 2)."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        if re.fullmatch(_NUMBER, path):
            raise OptionError(
                f"the curve {path!r} is a text: a power law is the number {path} "
                f"(linearize={path}, --gamma {path})"
            ) from error
        missing = isinstance(error, FileNotFoundError)
        why = "there is no such file" if missing else "it cannot be read as text"
        raise OptionError(
            f"{path} is none of the known curves (sRGB, log:DECADE) and no table, {why}: "
            "give the path of a text file with two columns, stored value and light"
        ) from error
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    delimiter = next((mark for mark in ",;\t" if lines and mark in lines[-1]), " ")
    read = list(csv.reader(lines, delimiter=delimiter, skipinitialspace=True))
    if read and not _are_numbers(read[0]):
        del read[0]
    wrong = next((row for row in read if not _are_numbers(row)), None)
    if wrong is not None or len(read) < _MIN_ROWS:
        many = "row" if len(read) == 1 else "rows"
        found = f"a row {wrong}" if wrong is not None else f"{len(read)} {many} of numbers"
        raise OptionError(
            f"{path} has {found}: a table has {_MIN_ROWS} rows or more of two numbers, stored "
            "value and light"
        )
    return np.array([[float(cell) for cell in row[:2]] for row in read])


def _are_numbers(row: list[str]) -> bool:
    try:
        return len(row) >= 2 and all(math.isfinite(float(cell)) for cell in row[:2])
    except ValueError:
        return False


def _largest(values: Floats) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if finite.size else 0.0
