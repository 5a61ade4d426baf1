"""Find a pulse, the two parallel edges of a target, and trim a region to it."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats, crossing
from acutance.errors import NoEdgeError, SupportError, TargetError
from acutance.numerics.noise import median
from acutance.targets.straight.bend import bent
from acutance.targets.straight.find_edges import Segment, find_segments
from acutance.targets.straight.first_fit import fit_first
from acutance.targets.straight.fit_pulse import PulsePixels
from acutance.targets.straight.step_profile import pulse_profile
from acutance.targets.straight.surroundings import line_distances, pixels_along
from acutance.targets.straight.trim import Extent, near_line, select_usable
from acutance.targets.straight.tuned import MIN_SNR

__all__ = ["find_pulse"]

_CANDIDATES = 6
_REACH_PX = 7.0
_MIN_PIXELS = 8
_MAX_WIDTH_PX = 24.0
_PROFILE_STEP_PX = 0.5
_SPOILED = 0.005


def find_pulse(
    image: Floats, width_px: float | None = None, *, fit_width: bool = True
) -> tuple[PulsePixels, Extent]:
    """The strongest pulse of an image and its usable pixels.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel must not be used. The pulse may be brighter or darker than the plateaus.
    width_px : float, optional
        Its width along the normal; without it the profile gives a first guess.
    fit_width : bool, optional
        Whether the width is fitted while the pulse is located.

    Raises
    ------
    NoEdgeError, SupportError
        If there is none, or too little of it; of several candidates the first one's reason.
    """
    first: TargetError | None = None
    for sign in (1.0, -1.0):
        for segment in find_segments(sign * image, _CANDIDATES):
            try:
                return _at(sign * image, segment, width_px, sign, fit_width)
            except TargetError as error:
                first = first or error
    raise first or NoEdgeError(
        f"no straight pulse stands out in the {image.shape[0]} x {image.shape[1]} pixels: choose "
        "a region that holds one pulse with a plateau on both sides"
    )


def _at(
    image: Floats, segment: Segment, stated_px: float | None, sign: float, fit_width: bool
) -> tuple[PulsePixels, Extent]:
    """The pulse whose rising side is `segment`."""
    image = near_line(image, segment.line)
    row, col, value, s = pixels_along(
        image, *line_distances(image.shape, segment.line),
        segment.start_px - 1, segment.stop_px + 1, np.inf,
    )  # fmt: skip
    width_px = _guessed_width(s, value) if stated_px is None else stated_px
    reach = _REACH_PX
    plateaus = [
        value[(outside > 0.5 * reach) & (outside < reach)] for outside in (-s, s - width_px)
    ]
    top = value[np.abs(s - 0.5 * width_px) < max(0.25 * width_px, 0.6)]
    if min(top.size, *(plateau.size for plateau in plateaus)) < _MIN_PIXELS:
        raise SupportError(
            f"the plateaus of the pulse of {width_px:.2f} px have {plateaus[0].size} and "
            f"{plateaus[1].size} usable pixels {0.5 * reach:g} to {reach:g} px from it, at least "
            f"{_MIN_PIXELS} are needed: choose a region that reaches further to both sides, and "
            "check the width if it was stated"
        )
    left, right, level = (median(part) for part in (*plateaus, top))
    if not (level > left and level > right):
        raise NoEdgeError(
            f"the strongest line separates levels of {sign * left:.4g}, {sign * level:.4g} and "
            f"{sign * right:.4g}: no pulse of {width_px:.2f} px between two equal plateaus; "
            "choose a region with one pulse, or state another width"
        )
    pulse = fit_first(
        row, col, value, segment.line, dark=left, bright=level,
        profile=pulse_profile(width_px, (level - right) / (level - left)), fit_width=fit_width,
    )  # fmt: skip
    pulse = bent(row, col, value, pulse, fit_width=fit_width)
    if pulse.height < MIN_SNR * pulse.noise:
        raise NoEdgeError(
            f"the strongest pulse has a height of {pulse.height:.4g} in noise of "
            f"{pulse.noise:.3g}: an SNR of {pulse.height / pulse.noise:.1f} where at least "
            f"{MIN_SNR:g} is needed; choose a region with more contrast or less noise"
        )
    usable = select_usable(image, pulse, 0.5 * (segment.stop_px - segment.start_px))
    width, height_ratio = pulse.profile.positions_px[1], -pulse.profile.shares[1]
    trimmed = PulsePixels(
        usable.image, usable.line, pulse.dark, pulse.dark + pulse.height, pulse.blur.sigma_px,
        pulse.noise, pulse.blur, width, height_ratio, sign,
    )  # fmt: skip
    return trimmed, usable.extent


def _guessed_width(s: Floats, value: Floats) -> float:
    """Distance from the rising side to where the profile has fallen half way back."""
    # Means of few pixels each: a bad pixel would look like the pulse.
    share = np.arange(value.size) / max(value.size - 1, 1)
    least, largest = np.interp((_SPOILED, 1 - _SPOILED), share, np.sort(value)).tolist()
    value = np.minimum(np.maximum(value, least), largest)
    bins = ((s + _REACH_PX) / _PROFILE_STEP_PX).astype(np.intp)
    inside = (bins >= 0) & (s < _MAX_WIDTH_PX)
    count = np.bincount(bins[inside])
    total = np.bincount(bins[inside], value[inside])
    known = count > 0
    centre = (np.flatnonzero(known) + 0.5) * _PROFILE_STEP_PX - _REACH_PX
    profile = total[known] / count[known]
    grid = np.arange(float(centre[0]), float(centre[-1]), _PROFILE_STEP_PX)
    level = np.interp(grid, centre, profile)
    behind = grid > 0
    if not behind.any():
        raise SupportError(
            "the region ends at the rising side of the pulse: choose one that holds both sides"
        )
    plateau = median(level[grid < -1.0]) if (grid < -1.0).any() else float(level[0])
    # The first maximum behind the rising side, not the brightest place of the scene.
    falling = np.flatnonzero(np.diff(level[behind]) < 0)
    top = float(level[behind][int(falling[0])]) if falling.size else float(level.max())
    place = grid[behind][int(falling[0])] if falling.size else 0.0
    width = crossing(grid, level, 0.5 * (plateau + top), float(place))
    if not width > 0:
        raise NoEdgeError(
            f"no falling side of the pulse was found within {_MAX_WIDTH_PX:g} px: state its width, "
            "or choose a region that holds both sides"
        )
    return float(width)
