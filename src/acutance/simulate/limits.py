"""What can be rendered: sizes that fit into memory, levels that are numbers."""

from __future__ import annotations

import math

from acutance.errors import ModelError

__all__ = ["MAX_PIXELS", "MAX_SCENE_PIXELS", "require_finite", "require_shape"]

MAX_PIXELS = 25_000_000
"""Of an image of a single target, which takes about 120 bytes a pixel while it is rendered."""

MAX_SCENE_PIXELS = 400_000_000
"""Of a scene of many targets, rendered in windows, which takes about 12 bytes a pixel."""


def require_shape(shape: tuple[int, int], most: int = MAX_PIXELS) -> None:
    """Refuse an image without pixels, or with more than fit into an ordinary memory.

    Raises
    ------
    ModelError
        Names the shape and the limit.
    """
    rows, cols = shape
    if min(shape) < 1 or rows * cols > most:
        raise ModelError(
            f"an image of {rows} by {cols} px was asked for: rows and columns have to be 1 or "
            f"more, and {most / 1e6:.0f} million pixels are the most that can be rendered"
        )


def require_finite(**values: float) -> None:
    """Refuse what is infinite or not a number.

    Raises
    ------
    ModelError
        Names the argument.
    """
    for name, value in values.items():
        if not math.isfinite(value):
            raise ModelError(f"{name} is {value:g}, it has to be a finite number")
