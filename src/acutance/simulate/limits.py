"""What can be rendered: by a sensor, in a size that fits into memory, levels that are numbers."""

from __future__ import annotations

import math
import operator
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves.grid import Floats
from acutance.errors import ModelError, OptionError
from acutance.optics.sensor import Sensor

__all__ = [
    "MAX_PIXELS",
    "MAX_SCENE_PIXELS",
    "require_finite",
    "require_floats",
    "require_kind",
    "require_numbers",
    "require_place",
    "require_rng",
    "require_sensor",
    "require_shape",
]

MAX_PIXELS = 25_000_000
"""Of an image of a single target, which takes about 120 bytes a pixel while it is rendered."""

MAX_SCENE_PIXELS = 400_000_000
"""Of a scene of many targets, rendered in windows: up to 12 bytes a pixel in memory."""


def require_shape(shape: tuple[int, int], most: int = MAX_PIXELS) -> None:
    """Refuse an image without pixels, or with more than fit into an ordinary memory.

    Raises
    ------
    OptionError
        If it is no pair of whole numbers.
    ModelError
        Names the shape and the limit.
    """
    try:
        rows, cols = map(operator.index, shape)
    except (TypeError, ValueError):
        raise OptionError(
            f"shape is {shape!r:.80}: it has to be two whole numbers, (rows, columns)"
        ) from None
    if min(rows, cols) < 1 or rows * cols > most:
        raise ModelError(
            f"an image of {rows} by {cols} px was requested: rows and columns have to be 1 or "
            f"more, and {most / 1e6:.0f} million pixels are the most that can be rendered"
        )


def require_numbers(**values: float) -> None:
    """Refuse what is of another kind than a number.

    Raises
    ------
    OptionError
        Names the argument.
    """
    for name, value in values.items():
        if not isinstance(value, Real):
            raise OptionError(f"{name} is {value!r:.80}, it has to be a number")


def require_finite(**values: float) -> None:
    """Refuse what is infinite or not a number.

    Raises
    ------
    OptionError
        If it is something else than a number: names the argument.
    ModelError
        If it is an infinite number, or NaN.
    """
    require_numbers(**values)
    for name, value in values.items():
        if not math.isfinite(value):
            raise ModelError(f"{name} is {value:g}, it has to be a finite number")


def require_kind(kind: type, **values: Any) -> None:
    """Refuse what is neither left out (``None``) nor an object of a class.

    Raises
    ------
    OptionError
        Names the argument and the class.
    """
    for name, value in values.items():
        if value is not None and not isinstance(value, kind):
            raise OptionError(f"{name} is {value!r:.80}: give {kind.__name__}(...)")


def require_floats(name: str, values: ArrayLike) -> Floats:
    """Numbers of a caller as an array.

    Raises
    ------
    OptionError
        If it holds something else: names the argument.
    """
    try:
        return np.asarray(values, float)
    except (TypeError, ValueError):
        raise OptionError(f"{name} is {values!r:.80}: it has to hold numbers") from None


def require_place(**values: tuple[float, float]) -> None:
    """Refuse what is no pair of finite numbers, (row, column).

    Raises
    ------
    OptionError
        If it is something else than two numbers: names the argument.
    ModelError
        If one of them is infinite, or NaN.
    """
    for name, place in values.items():
        try:
            row, col = place
        except (TypeError, ValueError):
            raise OptionError(
                f"{name} is {place!r:.80}: it has to be two numbers, (row, column)"
            ) from None
        require_finite(**{f"the row of {name}": row, f"the column of {name}": col})


def require_rng(rng: np.random.Generator | None, wanted: str) -> np.random.Generator:
    """The random generator of a caller, for what needs one.

    Raises
    ------
    ModelError
        If there is none.
    OptionError
        If it is something else, such as a seed.
    """
    if rng is None:
        raise ModelError(f"{wanted} was requested without rng: pass numpy.random.default_rng()")
    if not isinstance(rng, np.random.Generator):
        seed = rng if isinstance(rng, int) else ""
        raise OptionError(f"rng is {rng!r:.80}: pass numpy.random.default_rng({seed})")
    return rng


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
