"""Which bright spots of a region are measured, and why the others are not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.targets.points import tuned
from acutance.targets.points.detect import (
    RejectedSpot,
    Spot,
    find_spots,
    sort_spots,
)
from acutance.targets.points.extent import same_extent
from acutance.targets.points.match_places import match_spots
from acutance.targets.points.options import PointsOptions
from acutance.targets.region import RegionPixels

__all__ = ["Selection", "cover_rejected", "reject_extended", "reject_unlike", "select_spots"]


class Selection(NamedTuple):
    """Which bright spots of a region are measured.

    Attributes
    ----------
    places : (k, 2) array
        Of the usable sources, (row, col) in the region.
    rejected : tuple of RejectedSpot
        In pixels of the region.
    mixed : bool
        Whether they are points among objects that have sizes of their own.
    """

    places: Floats
    rejected: tuple[RejectedSpot, ...]
    mixed: bool


def select_spots(region: RegionPixels, wanted: Floats | None, options: PointsOptions) -> Selection:
    """The usable point sources of a region, and the bright spots that are none.

    Parameters
    ----------
    region : RegionPixels
    wanted : (n, 2) array, optional
        Approximate places (row, col) in the region; all spots without them.
    options : PointsOptions

    Raises
    ------
    TargetError
        If no spot is usable; the message counts the reasons.
    """
    everything, residual, noise = find_spots(region.pixels)
    spots, missing = (everything, ()) if wanted is None else match_spots(everything, wanted)
    usable, rejected, mixed = sort_spots(
        region.pixels, residual, spots,
        saturation=region.saturation_level, noise=noise, min_snr=options.min_snr,
        min_distance_px=options.min_distance_px, rivals=everything,
    )  # fmt: skip
    rejected = (*missing, *rejected)
    if mixed and len(usable) < tuned.MIN_POPULATION:
        raise TargetError(_no_population(len(usable), rejected))
    if not usable:
        raise TargetError(_refusal(rejected, options))
    by_peak = sorted(usable, key=lambda one: -one.peak)
    taken = by_peak[: options.max_sources]
    surplus = f"{options.max_sources} brighter ones were taken (max_sources)"
    left_out = [_left_out(one, surplus) for one in by_peak[options.max_sources :]]
    unasked = (one for one in everything if one not in spots and one.snr >= options.min_snr)
    left_out += [_left_out(one, "it is not among the positions that were given") for one in unasked]
    places = np.array([(one.row, one.col) for one in usable if one in taken])
    return Selection(places, (*rejected, *left_out), mixed)


def reject_extended(
    places: Floats, excess: Floats, std: Floats, rejected: tuple[RejectedSpot, ...]
) -> tuple[NDArray[np.bool_], tuple[RejectedSpot, ...]]:
    """The sources of a mixed field that have not the extent of its points.

    Parameters
    ----------
    places : (k, 2) array
    excess, std : (k,) arrays
        Variance of every source beyond that of the common PSF, as a share, and its deviation.
    rejected : tuple of RejectedSpot
        What was rejected before.

    Returns
    -------
    same : (k,) bool array
        Which sources remain.
    rejected : tuple of RejectedSpot
        The others, after what was rejected before.

    Raises
    ------
    TargetError
        If the sources have no extent in common.
    """
    same = same_extent(excess, std)
    if same is None:
        raise TargetError(_no_population(len(places), rejected))
    others = tuple(
        RejectedSpot(
            row, col, "extended" if more > 0 else "unlike",
            f"its variance differs from that of the points by {100 * more:+.0f} %",
        )
        for (row, col), more in zip(places[~same].tolist(), excess[~same].tolist(), strict=True)
    )  # fmt: skip
    return same, (*rejected, *others)


def _no_population(left: int, rejected: Sequence[RejectedSpot]) -> str:
    return (
        f"of {left + len(rejected)} bright spots no five of the sharpest have one size in common "
        f"({_counted(rejected)}): these are galaxies or other objects with sizes of their own, no "
        "points; choose a region with stars or mirrors, or give their positions"
    )


def reject_unlike(
    places: Floats, share: Floats, unlike: NDArray[np.bool_]
) -> tuple[RejectedSpot, ...]:
    """The sources that the blur of the others does not explain.

    Parameters
    ----------
    places : (k, 2) array
    share : (k,) array
        What that blur leaves of a source, as a share of its peak.
    unlike : (k,) bool array
        Which ones are rejected.
    """
    return tuple(
        RejectedSpot(
            row, col, "unlike",
            f"the blur of the others leaves {100 * left:.0f} % of its peak: it is no point",
        )
        for (row, col), left in zip(places[unlike].tolist(), share[unlike].tolist(), strict=True)
    )  # fmt: skip


def cover_rejected(image: Floats, rejected: Sequence[RejectedSpot]) -> Floats:
    """The image with NaN over what was rejected, lest its light disturb the sources."""
    height, width = image.shape
    clean = image.copy()
    for one in rejected:
        if one.reason != "no source":
            reach = tuned.COVERED_PX.get(one.reason, tuned.COVERED_ELSE_PX)
            top, left = max(int(one.row - reach), 0), max(int(one.col - reach), 0)
            bottom = min(int(one.row + reach) + 2, height)
            right = min(int(one.col + reach) + 2, width)
            rows, cols = np.ogrid[top:bottom, left:right]
            covered = np.hypot(rows - one.row, cols - one.col) <= reach
            clean[top:bottom, left:right][covered] = np.nan
    return clean


def _left_out(one: Spot, message: str) -> RejectedSpot:
    return RejectedSpot(one.row, one.col, "left out", message)


def _refusal(rejected: Sequence[RejectedSpot], options: PointsOptions) -> str:
    if not rejected:
        return (
            "no point source stands out of the noise: choose a region with sources, or a longer "
            "exposure"
        )
    return (
        f"none of {len(rejected)} bright spots is a usable point source ({_counted(rejected)}): "
        f"choose another region, or ask less (min_snr {options.min_snr:g}, min_distance_px "
        f"{options.min_distance_px:g})"
    )


def _counted(rejected: Sequence[RejectedSpot]) -> str:
    reasons = [one.reason for one in rejected]
    return ", ".join(f"{reasons.count(one)} {one}" for one in dict.fromkeys(reasons))
