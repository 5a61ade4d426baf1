"""Trim a region to the usable pixels of one edge.

Next to a real edge there are other things: the target's end, a road, a second edge. A pixel is
usable if all pixels between it and the line look like the plateau of its side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError, SupportError
from acutance.geometry.line import Line
from acutance.numerics.noise import median, robust_scale
from acutance.targets.straight.bend import bent
from acutance.targets.straight.find_edges import Segment
from acutance.targets.straight.first_fit import FirstFit, fit_first
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.surroundings import (
    best_rows,
    bounded_residual,
    line_distances,
    local_mean,
    pixels_along,
    reach_before_structure,
    reach_of_rows,
    values_beside,
)
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
_BUMP, _BUMP_QUANTILE = 4.0, 0.9
"""Where a tenth of the pixels leave the mean of both levels by so many times their difference,
there is a line or a pulse and no step."""


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
    edge = _first_fit(image, segment)
    usable = select_usable(image, edge, 0.5 * (segment.stop_px - segment.start_px))
    trimmed = EdgePixels(
        usable.image, usable.line, edge.dark, edge.dark + edge.height,
        edge.blur.sigma_px, edge.noise, edge.blur,
    )  # fmt: skip
    return trimmed, usable.extent


def near_line(image: Floats, line: Line) -> Floats:
    """An image without the pixels too far from a line to depend on the sensor, (rows, cols)."""
    rows, cols = image.shape
    if max(rows, cols) <= _FAR_PX:
        return np.ascontiguousarray(image)
    x, y = line.normal
    distance = np.add.outer(y * (np.arange(rows) - line.row), x * (np.arange(cols) - line.col))
    return np.where(np.abs(distance) < _FAR_PX, image, np.nan)


@dataclass(frozen=True, eq=False)
class UsablePixels:
    """The usable pixels of a target (NaN elsewhere), its line and its extent."""

    image: Floats
    line: Line
    extent: Extent


def select_usable(image: Floats, edge: FirstFit, half_length_px: float) -> UsablePixels:
    """The rows of the target whose surroundings look like its plateaus: many, far to both sides.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel must not be used.
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
    s, t = line_distances(image.shape, edge.line)
    residual = bounded_residual(
        image, s, edge.dark, edge.height, edge.profile.steps, edge.blur.sigma_px,
        edge.blur.aperture_px,
    )  # fmt: skip
    need = 1.5 * edge.blur.width_px + 1.5
    first, reaches, whole = _reaches(edge, residual, s, t, half_length_px, need)
    rows = best_rows(np.minimum(*reaches), need)
    length = int(np.count_nonzero(rows))
    if length < MIN_ROWS:
        raise SupportError(
            f"{length} px of the target's length have at least {need:.1f} px of plateau on "
            f"both sides (at least {MIN_ROWS} are needed): choose a region with more of it"
        )
    used = np.isfinite(residual)
    if not whole:
        last = edge.profile.positions_px[-1]
        place = np.where(used, t - first, 0).astype(np.intp)
        dark_reach, bright_reach = reaches[:, place]
        used &= rows[place] & (-s < dark_reach) & (s - last < bright_reach)
        image = np.where(used, image, np.nan)
    if not used.any():
        raise SupportError(
            f"no pixel of the target's {length} rows is usable: next to its line they hold no "
            "data; choose a region with fewer missing pixels"
        )
    dark_px, bright_px = np.sort(reaches[:, rows])[:, length // 10].tolist()
    middle = first + 0.5 + float(np.flatnonzero(rows).mean())
    line = replace(edge.line.slid(middle), length_px=float(length))
    _require_contrast(edge, residual[used])
    extent = Extent(dark_px, bright_px, float(length), whole)
    return UsablePixels(image, line, extent)


def _first_fit(image: Floats, segment: Segment) -> FirstFit:
    """Fit the Gaussian through a pixel near the segment: nearer for a sharper edge."""
    s, t = line_distances(image.shape, segment.line)
    reach, sigma_px = _FIRST_REACH_PX, 0.6
    for _ in range(3):
        row, col, value, away = pixels_along(
            image, s, t, segment.start_px - 1, segment.stop_px + 1, reach
        )
        dark, bright = value[away < -0.5 * reach], value[away > 0.5 * reach]
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
                "which is a line or a pulse and not a step: measure a pulse as one (measure_pulse, "
                "acutance pulse), or choose a region with one bright and one dark side"
            )
        edge = fit_first(
            row, col, value, segment.line, dark=levels[0], bright=levels[1], sigma_px=sigma_px
        )
        edge = bent(row, col, value, edge)
        if edge.blur.width_px * _REACH_WIDTHS <= reach:
            break
        reach, sigma_px = 1.2 * _REACH_WIDTHS * edge.blur.width_px, edge.blur.sigma_px
    if edge.height < MIN_SNR * edge.noise:
        between = float(np.quantile(np.abs(value - sum(levels) / 2), _BUMP_QUANTILE))
        if between > _BUMP * edge.height:
            raise NoEdgeError(
                f"the strongest edge separates levels that differ by {edge.height:.3g}, and what "
                f"lies between them by {between:.4g}: it is a line or a pulse and no step; measure "
                "a pulse as one (measure_pulse, acutance pulse), or choose a region with one edge"
            )
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


def _reaches(
    edge: FirstFit, residual: Floats, s: Floats, t: Floats, half_length_px: float, need: float
) -> tuple[int, Floats, bool]:
    """How far every row is clear, before the target's first and behind its last step, (2, n).

    Rows are one pixel long along the edge, from the first number; the reach of a row ends before
    structure, or at the last pixel. The last result is whether there is no structure.
    """
    width, last_step = edge.blur.width_px, edge.profile.positions_px[-1]
    mean = local_mean(residual)
    tolerance = _tolerance(
        values_beside(mean, s, t, last_step, width, width + _FIRST_REACH_PX, half_length_px)
    )
    # A row whose only pixels lie further out has no plateau.
    first, last, stop, structure = reach_of_rows(
        mean, s, t, last_step, _MAX_HALF_WIDTH_PX + 1, tolerance, 1.5 * width,
        max(NEAR_TOLERANCE, tolerance),
    )  # fmt: skip
    last = np.minimum(last + 0.5, _MAX_HALF_WIDTH_PX)
    if not structure:
        return first, last, True
    reach = reach_before_structure(stop, width, need)
    return first, np.minimum(last, reach), False


def _tolerance(plateaus: Floats) -> float:
    """How far local means, of which some are given, may lie from a uniform plateau."""
    noise = robust_scale(plateaus) if plateaus.size else 0.0
    # More than a fifth of the contrast is structure, however rough the plateaus are.
    return max(PLATEAU_TOLERANCE, min(_SIGNIFICANCE * noise, MAX_TOLERANCE))
