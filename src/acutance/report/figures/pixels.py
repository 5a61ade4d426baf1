"""Images and maps of residuals, their axes counting pixels of the whole image."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from acutance.arguments import require_floats
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.report.paper import SHADE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["as_backdrop", "draw_residual_map", "show_pixels"]

MAX_SIGMAS = 4.0


def as_backdrop(pixels: ArrayLike | None) -> Floats | None:
    """The pixels to draw a result on, as a caller has them; masked ones are NaN.

    Raises
    ------
    OptionError
        If they are no image of one band.
    """
    if pixels is None:
        return None
    shown = require_floats("backdrop", pixels)
    if shown.ndim != 2 or not shown.size:
        raise OptionError(
            f"backdrop has shape {shown.shape}: give an image of one band, (rows, columns)"
        )
    hidden = pixels.mask if isinstance(pixels, np.ma.MaskedArray) else False
    return np.where(hidden, math.nan, shown)


def show_pixels(axes: Axes, pixels: Floats, row: int, col: int) -> None:
    """An image in grey, its first pixel at (row, col)."""
    import matplotlib

    low, high = np.nanpercentile(pixels, (0.5, 99.5))
    margin = 0.08 * (high - low)
    height, width = pixels.shape
    axes.imshow(
        pixels,
        cmap=matplotlib.colormaps["gray"].with_extremes(bad="#f6e7da"),
        vmin=low - margin, vmax=high + margin, extent=_extent(pixels, row, col),
        interpolation="nearest",
    )  # fmt: skip
    axes.grid(visible=False)
    axes.locator_params(axis="x", integer=True, nbins=_tick_count(width / height))
    axes.locator_params(axis="y", integer=True, nbins=_tick_count(height / width))
    axes.set(xlabel="column", ylabel="row")


def _extent(pixels: Floats, row: int, col: int, step: int = 1) -> tuple[float, float, float, float]:
    height, width = (step * size for size in pixels.shape)
    return col - 0.5, col + width - 0.5, row + height - 0.5, row - 0.5


def _tick_count(relative_length: float) -> int:
    """How many intervals between ticks have room on a side of an image."""
    return max(1, math.ceil(6 * min(1.0, relative_length) - 0.5))


def draw_residual_map(
    axes: Axes,
    residual_sigmas: Floats,
    row: int,
    col: int,
    *,
    step: int = 1,
    unused: str = SHADE,
) -> None:
    """Residuals in standard deviations, `step` pixels from one to the next.

    Pixels that were not used are NaN and get a colour of their own.
    """
    import matplotlib

    shown = axes.imshow(
        np.ma.masked_invalid(residual_sigmas),
        cmap=matplotlib.colormaps["RdBu_r"].with_extremes(bad=unused),
        vmin=-MAX_SIGMAS, vmax=MAX_SIGMAS, interpolation="nearest",
        extent=_extent(residual_sigmas, row, col, step),
    )  # fmt: skip
    axes.figure.colorbar(shown, ax=axes, shrink=0.8, label="standard deviations")
    axes.grid(visible=False)
    axes.set(xlabel="column", ylabel="row", title="Residuals")
