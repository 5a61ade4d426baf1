"""Interpolating an image onto another grid, as ground processing does."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import map_coordinates

from acutance.arguments import require_finite, require_floats
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.geometry.line import Line
from acutance.optics import Resampling, Rescaled, Sensor, Shift
from acutance.optics.block import require
from acutance.optics.interpolation import (
    KERNEL_REACH_PX,
    Interpolation,
    interpolation_weight,
    require_kernel,
)
from acutance.simulate.noise import Noise

__all__ = ["Regrid", "render_regridded", "resample"]


def resample(
    image: Floats,
    rows: ArrayLike,
    cols: ArrayLike,
    *,
    kernel: Interpolation = "cubic",
    a: float = -0.5,
) -> Floats:
    """Interpolate an image at given places.

    Parameters
    ----------
    image : (m, n) array
    rows, cols : (p, q) arrays
        Places in pixels of `image`; integers are pixel centres. Shift, stretch and rotation are
        all given by these.
    kernel : {"nearest", "bilinear", "cubic", "spline", "lanczos"}, optional
    a : float, optional
        Parameter of the cubic kernel; see `acutance.optics.interpolation`.

    Returns
    -------
    (p, q) array
        Pixels beyond the border repeat those at the border.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind.
    ModelError
        If there is no such kernel.
    """
    require_kernel("resample", kernel)
    require_finite(a=a)
    image = require_floats("image", image)
    if image.ndim != 2 or image.size == 0:
        raise OptionError(f"image has the shape {image.shape}: give rows and columns of pixels")
    places = [require_floats("rows", rows), require_floats("cols", cols)]
    if not all(np.isfinite(one).all() for one in places):
        raise OptionError("a place in rows or cols is not finite: leave it out")
    row_at, col_at = np.broadcast_arrays(*places)
    if kernel == "spline":
        return np.asarray(map_coordinates(image, [row_at, col_at], order=3, mode="nearest"))
    top, left = np.floor(row_at).astype(int), np.floor(col_at).astype(int)
    result = np.zeros(row_at.shape)
    reach = math.ceil(KERNEL_REACH_PX[kernel])
    for row in (top + k for k in range(1 - reach, reach + 1)):
        down = interpolation_weight(kernel, row - row_at, a)
        for col in (left + k for k in range(1 - reach, reach + 1)):
            right = interpolation_weight(kernel, col - col_at, a)
            inside = np.clip(row, 0, image.shape[0] - 1), np.clip(col, 0, image.shape[1] - 1)
            result += down * right * image[inside]
    return result


@dataclass(frozen=True)
class Regrid:
    """A new grid over an image, shifted and slightly stretched about the image's centre.

    Pixel p of the new image shows the place ``centre + scale * (p - centre) + shift``.

    Parameters
    ----------
    shift_row_px, shift_col_px : float, optional
        Shift in old pixels; a target goes along, so only fractions of a pixel change its image.
    scale : float, optional
        Size of the new pixels in old ones, 0.5 to 2. At 1 all new pixels have the same phase
        and the resampled system is known exactly; otherwise the phases vary, the transfer is
        that of the mean phase, and single pixels differ from it with their phase.
    kernel : {"nearest", "bilinear", "cubic", "spline", "lanczos"}, optional
    a : float, optional
        Parameter of the cubic kernel.
    """

    shift_row_px: float = 0.0
    shift_col_px: float = 0.0
    scale: float = 1.0
    kernel: Interpolation = "cubic"
    a: float = -0.5

    def __post_init__(self) -> None:
        require(self, 0.5, 2.0, scale=self.scale)
        require(self, -1e6, 1e6, shift_row_px=self.shift_row_px, shift_col_px=self.shift_col_px)
        require_kernel("Regrid", self.kernel)
        require(self, -math.inf, a=self.a)

    def system(self, sensor: Sensor) -> Sensor:
        """The sensor and the resampling as one system, in new pixels."""
        sizes = (sensor.gsd_m, sensor.gsd_along_m)
        gsd_m, gsd_along_m = (None if size is None else size * self.scale for size in sizes)
        if self.scale == 1:
            shift = Shift(self.shift_row_px, self.shift_col_px, self.kernel, self.a)
            return Sensor([*sensor.blocks, shift], gsd_m, gsd_along_m)
        averaged = Sensor([*sensor.blocks, Resampling(self.kernel, self.a)])
        return Sensor([Rescaled(averaged, self.scale)], gsd_m, gsd_along_m)

    def margin_px(self, shape: tuple[int, int]) -> int:
        """How much wider the old image has to be on every side, in old pixels."""
        reach = max(abs(self.shift_row_px), abs(self.shift_col_px))
        kernel_px = max(math.ceil(KERNEL_REACH_PX[self.kernel]), 2)
        return math.ceil(reach + abs(self.scale - 1) * max(shape)) + kernel_px + 1

    def source_line(self, line: Line, shape: tuple[int, int], moved_px: float) -> Line:
        """The line in old pixels that becomes `line` in new ones.

        Parameters
        ----------
        line : Line
            In pixels of the new image.
        shape : (rows, cols)
            Of the new image.
        moved_px : float
            How far along the normal, in old pixels, the resampling moves the 50 % point.
        """
        rows, cols = (0.5 * (size - 1) for size in shape)
        x, y = line.normal
        return Line(
            rows + self.scale * (line.row - rows) + self.shift_row_px - moved_px * y,
            cols + self.scale * (line.col - cols) + self.shift_col_px - moved_px * x,
            line.normal_deg,
            length_px=line.length_px * self.scale,
        )

    def apply(self, image: Floats, shape: tuple[int, int], margin_px: int) -> Floats:
        """The new image of the given shape, from an old one with a margin around that shape."""
        rows, cols = (np.arange(size) - 0.5 * (size - 1) for size in shape)
        row = self.scale * rows + 0.5 * (shape[0] - 1) + self.shift_row_px + margin_px
        col = self.scale * cols + 0.5 * (shape[1] - 1) + self.shift_col_px + margin_px
        return resample(image, row[:, None], col[None, :], kernel=self.kernel, a=self.a)


def render_regridded(
    sensor: Sensor,
    regrid: Regrid,
    line: Line,
    shape: tuple[int, int],
    render: Callable[[Line, tuple[int, int]], Floats],
    noise: Noise | None,
    rng: np.random.Generator | None,
) -> Floats:
    """A straight target rendered with a margin, made noisy, and interpolated onto a new grid.

    Parameters
    ----------
    sensor : Sensor
        Before the resampling.
    regrid : Regrid
    line : Line
        The target's line in the new image.
    shape : (rows, cols)
        Of the new image.
    render : function of (line, shape)
        Draws the target, without noise, in old pixels.
    noise : Noise or None
        Added before the resampling.
    rng : numpy.random.Generator or None
    """
    # The target is placed by the shift: whole pixels of it would only widen the old image.
    row, col = (one - round(one) for one in (regrid.shift_row_px, regrid.shift_col_px))
    regrid = replace(regrid, shift_row_px=row, shift_col_px=col)
    half_new_px = regrid.system(sensor).profile(line.normal_deg).half_px * regrid.scale
    moved_px = half_new_px - sensor.profile(line.normal_deg).half_px
    source = regrid.source_line(line, shape, moved_px)
    margin = regrid.margin_px(shape)
    source = Line(source.row + margin, source.col + margin, source.normal_deg)
    image = render(source, (shape[0] + 2 * margin, shape[1] + 2 * margin))
    return regrid.apply(image if noise is None else noise.added_to(image, rng), shape, margin)
