"""What can be rendered: images of a size that fits into memory, a dark level below a bright one."""

from __future__ import annotations

from acutance import arguments
from acutance.errors import ModelError

__all__ = ["MAX_PIXELS", "MAX_SCENE_PIXELS", "require_darker", "require_shape"]

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
    rows, cols = arguments.require_shape(shape)
    if min(rows, cols) < 1 or rows * cols > most:
        raise ModelError(
            f"an image of {rows} by {cols} px was requested: rows and columns have to be 1 or "
            f"more, and {most / 1e6:.0f} million pixels are the most that can be rendered"
        )


def require_darker(dark: float, bright: float, advice: str, *, of: str = "") -> None:
    """Refuse a dark level of something that is not below the bright one, with advice.

    Raises
    ------
    ModelError
        Names both.
    """
    if not dark < bright:
        raise ModelError(
            f"{of}dark is {dark:g} and bright {bright:g}: dark has to be lower; {advice}"
        )
