"""Trim a region to the usable pixels of one edge.

Next to a real edge there are other things: the target's end, a road, a second edge. A pixel is
usable if all pixels between it and the line look like the plateau of its side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError, SupportError
from acutance.geometry.line import Line
from acutance.numerics.noise import median, robust_scale
from acutance.targets.straight.bend import bent
from acutance.targets.straight.find_edges import Segment
from acutance.targets.straight.first_fit import FirstFit, fit_first
from acutance.targets.straight.pixels import EdgePixels, Pixels
from acutance.targets.straight.tuned import (
    MAX_TOLERANCE,
    MIN_ROWS,
    MIN_SNR,
    NEAR_TOLERANCE,
    PLATEAU_TOLERANCE,
)

__all__ = ["Extent", "UsablePixels", "near_line", "select_usable", "trim"]

_SIGNIFICANCE = 4.0
_MAX_HALF_WIDTH_PX = 40.0
_FAR_PX = 100.0
_FIRST_REACH_PX = 7.0
_REACH_WIDTHS = 2.5
_WIDER: Floats = np.array([1.0, 1.5, 2.0, 3.0, 4.0])
"""Widths of plateaus that are tried, in units of the smallest one needed."""


@dataclass(frozen=True)
class Extent:
    """The usable part of a region.

    Attributes
    ----------
    dark_px, bright_px : float
        How far the plateaus reach from the line (the width nine rows in ten have).
    length_px : float
        How long the edge is.
    whole : bool
        Whether the whole region is usable.
    """

    dark_px: float
    bright_px: float
    length_px: float
    whole: bool


def trim(image: Floats, segment: Segment) -> tuple[EdgePixels, Extent]:
    """The usable pixels of the edge found as `segment`.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel must not be used.
    segment : Segment

    Returns
    -------
    trimmed : EdgePixels
    extent : Extent

    Raises
    ------
    NoEdgeError
        If the edge is too low for the noise.
    SupportError
        If it is too short, or a side has no plateau.
    """
    image = near_line(image, segment.line)
    pixels = Pixels.of(image)
    edge = _first_fit(pixels.row, pixels.col, pixels.value, segment)
    usable = select_usable(image, pixels, edge, 0.5 * (segment.stop_px - segment.start_px))
    trimmed = EdgePixels(
        usable.image, usable.line, edge.dark, edge.dark + edge.height,
        edge.blur.sigma_px, edge.noise, edge.blur,
    )  # fmt: skip
    return trimmed, usable.extent


def near_line(image: Floats, line: Line) -> Floats:
    """An image without the pixels too far from a line to depend on the sensor, (rows, cols)."""
    rows, cols = image.shape
    if max(rows, cols) <= _FAR_PX:
        return image
    x, y = line.normal
    distance = np.add.outer(y * (np.arange(rows) - line.row), x * (np.arange(cols) - line.col))
    return np.where(np.abs(distance) < _FAR_PX, image, np.nan)


@dataclass(frozen=True, eq=False)
class UsablePixels:
    """The usable pixels of a target (NaN elsewhere), its line and its extent."""

    image: Floats
    line: Line
    extent: Extent


def select_usable(
    image: Floats, pixels: Pixels, edge: FirstFit, half_length_px: float
) -> UsablePixels:
    """The longest and widest stretch of the target whose surroundings look like its plateaus.

    Parameters
    ----------
    image : (rows, cols) array
    pixels : Pixels
        The image's finite pixels.
    edge : FirstFit
        The first fit of the target: an edge or a pulse.
    half_length_px : float
        Half the length over which it was found.

    Raises
    ------
    NoEdgeError
        If the plateaus are too rough for the target's height.
    SupportError
        If too few rows are usable.
    """
    rows, cols = pixels.at
    s = edge.line.normal_distance(pixels.row, pixels.col)
    t = edge.line.tangent_distance(pixels.row, pixels.col)
    residual = (pixels.value - edge.dark) / edge.height - edge.profile.mean(edge.blur, s)
    # One bad pixel is an outlier, and no structure of the plateaus.
    np.clip(residual, -1.0, 1.0, out=residual)
    structure = _structure_mask(image.shape, rows, cols, residual, s, t, edge, half_length_px)
    need = 1.5 * edge.blur.width_px + 1.5
    first, bins, dark_reach, bright_reach = _reaches(edge, s, t, structure, need)
    start, stop = _best_run(np.minimum(dark_reach, bright_reach), need)
    length = stop - start
    if length < MIN_ROWS:
        raise SupportError(
            f"only {length} rows of the target have at least {need:.1f} px of plateau on both "
            f"sides (at least {MIN_ROWS} are needed): choose a region with more of it"
        )
    whole = not structure.any()
    used = np.ones(s.size, bool)
    if not whole:
        last = edge.profile.positions_px[-1]
        used = (bins >= start) & (bins < stop)
        used &= (-s < dark_reach[bins]) & (s - last < bright_reach[bins])
        image = image.copy()
        image[rows[~used], cols[~used]] = np.nan
    if not used.any():
        raise SupportError(
            f"no pixel of the target's {length} rows is usable: next to its line they hold no "
            "data; choose a region with fewer missing pixels"
        )
    tenth = length // 10
    dark_px, bright_px = (
        float(np.sort(reach[start:stop])[tenth]) for reach in (dark_reach, bright_reach)
    )
    middle = first + 0.5 * (start + stop)
    line = replace(edge.line.slid(middle), length_px=float(length))
    _require_contrast(edge, residual[used])
    extent = Extent(dark_px, bright_px, float(length), whole)
    return UsablePixels(image, line, extent)


def _first_fit(row: Floats, col: Floats, value: Floats, segment: Segment) -> FirstFit:
    """Fit the Gaussian through a pixel near the segment: nearer for a sharper edge."""
    s = segment.line.normal_distance(row, col)
    t = segment.line.tangent_distance(row, col)
    along = (t > segment.start_px - 1) & (t < segment.stop_px + 1)
    reach, sigma_px = _FIRST_REACH_PX, 0.6
    for _ in range(3):
        near = along & (np.abs(s) < reach)
        dark, bright = value[near & (s < -0.5 * reach)], value[near & (s > 0.5 * reach)]
        if min(dark.size, bright.size) < MIN_ROWS:
            raise SupportError(
                f"the strongest edge has {dark.size} usable pixels on its dark and {bright.size} "
                f"on its bright side between {0.5 * reach:.1f} and {reach:.1f} px from it: choose "
                "a region that reaches further to both sides of the edge"
            )
        levels = median(dark), median(bright)
        if not levels[1] > levels[0]:
            raise NoEdgeError(
                f"the strongest edge separates levels of {levels[0]:.4g} and {levels[1]:.4g}, "
                "which is a line and not a step: choose a region with one bright and one dark side"
            )
        edge = fit_first(
            row[near], col[near], value[near], segment.line,
            dark=levels[0], bright=levels[1], sigma_px=sigma_px,
        )  # fmt: skip
        edge = bent(row[near], col[near], value[near], edge)
        if edge.blur.width_px * _REACH_WIDTHS <= reach:
            break
        reach, sigma_px = 1.2 * _REACH_WIDTHS * edge.blur.width_px, edge.blur.sigma_px
    if edge.height < MIN_SNR * edge.noise:
        raise NoEdgeError(
            f"the strongest edge has a height of {edge.height:.4g} in noise of {edge.noise:.3g}: "
            f"an SNR of {edge.height / edge.noise:.1f} where at "
            f"least {MIN_SNR:g} is needed; choose a region with more contrast or less noise"
        )
    return edge


def _require_contrast(edge: FirstFit, residual: Floats) -> None:
    """Refuse an edge whose height is not larger than the roughness of its plateaus."""
    roughness = math.sqrt(float(residual @ residual) / residual.size)
    if roughness * MIN_SNR > 1:
        raise NoEdgeError(
            f"the edge has a height of {edge.height:.4g}, and its sides vary by "
            f"{roughness * edge.height:.3g}: a ratio of {1 / roughness:.1f} where at "
            f"least {MIN_SNR:g} is needed; choose a region whose two sides are uniform"
        )


def _structure_mask(
    shape: tuple[int, ...],
    rows: NDArray[np.intp],
    cols: NDArray[np.intp],
    residual: Floats,
    s: Floats,
    t: Floats,
    edge: FirstFit,
    half_length_px: float,
) -> NDArray[np.bool_]:
    """Which pixels do not look like the plateau of their side, in the mean of 3 x 3 pixels."""
    place = rows * shape[1] + cols
    fields = np.zeros((2, *shape))
    fields[0].reshape(-1)[place] = residual
    fields[1].reshape(-1)[place] = 1.0
    total, known = _box(fields)
    smooth: Floats = (total / np.maximum(known, 1.0)).reshape(-1)[place]
    width = edge.blur.width_px
    outside = edge.profile.outside(s)
    around = (np.abs(t) < half_length_px) & (outside > width)
    around &= outside < _FIRST_REACH_PX + width
    noise = robust_scale(smooth[around]) if around.any() else 0.0
    # More than a fifth of the contrast is structure, however rough the plateaus are.
    tolerance = max(PLATEAU_TOLERANCE, min(_SIGNIFICANCE * noise, MAX_TOLERANCE))
    near = outside < 1.5 * width
    return np.abs(smooth) > np.where(near, max(NEAR_TOLERANCE, tolerance), tolerance)


def _box(values: Floats) -> Floats:
    """Sums over 3 x 3 pixels of every image, (k, rows, cols), zero beyond it."""
    images, rows, cols = values.shape
    padded = np.zeros((images, rows + 2, cols + 2))
    padded[:, 1:-1, 1:-1] = values
    down = padded[:, :-2] + padded[:, 1:-1] + padded[:, 2:]
    return np.asarray(down[..., :-2] + down[..., 1:-1] + down[..., 2:])


def _reaches(
    edge: FirstFit, s: Floats, t: Floats, structure: NDArray[np.bool_], need: float
) -> tuple[float, NDArray[np.intp], Floats, Floats]:
    """How far every row of the target is clear, before its first and behind its last step.

    Rows are one pixel long along the edge; the reach of a row ends before the first structure pixel
    of it or of the rows next to it, or at the last pixel. Structure is blurred too: where the reach
    exceeds `need`, it ends a width of the blur before the structure.
    """
    first = math.floor(float(t.min()))
    bins = (t - first).astype(np.intp)
    count = int(bins.max()) + 1
    reaches = []
    nothing = not structure.any()
    blur_px, last_step = edge.blur.width_px, edge.profile.positions_px[-1]
    for outwards in (-s, s - last_step):
        # A row whose only pixels lie further out has no plateau.
        outside = (outwards > 0) & (outwards < _MAX_HALF_WIDTH_PX + 1)
        last = np.zeros(count)
        np.maximum.at(last, bins[outside], outwards[outside])
        last = np.minimum(last + 0.5, _MAX_HALF_WIDTH_PX)
        if nothing:
            reaches.append(last)
            continue
        stop = np.full(count, np.inf)
        # Within the target a structure pixel spoils its row on both sides.
        wrong = structure & (outwards > -0.5 - last_step)
        np.minimum.at(stop, bins[wrong], np.maximum(outwards[wrong] - 1.0, 0.0))
        close = _spoiled(stop, 1)
        wary = _spoiled(stop, math.ceil(blur_px)) - blur_px
        reaches.append(np.minimum(last, np.maximum(wary, np.minimum(close, need))))
    return float(first), bins, reaches[0], reaches[1]


def _spoiled(stop: Floats, rows: int) -> Floats:
    """The reach of every row, where a structure pixel also ends the `rows` next to its own."""
    padded = np.pad(stop, rows, constant_values=np.inf)
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, 2 * rows + 1).min(axis=1))


def _best_run(reach: Floats, need: float) -> tuple[int, int]:
    """The best run of rows: long, with plateaus of at least `need` pixels.

    A wider plateau shortens the run; twice the need is worth a third of the rows.
    """
    wide = np.zeros((_WIDER.size, reach.size + 2), np.int8)
    wide[:, 1:-1] = reach >= need * _WIDER[:, None]
    turns = wide[:, 1:] - wide[:, :-1]
    plateau, starts = (turns > 0).nonzero()
    stops = (turns < 0).nonzero()[1]
    if starts.size == 0:
        return 0, 0
    best = int(np.argmax((stops - starts) * (1 - 0.5 ** _WIDER[plateau])))
    return int(starts[best]), int(stops[best])
