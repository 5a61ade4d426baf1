"""Which bright spots of a region are measured, and why the others are not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.targets.points import tuned
from acutance.targets.points.detect import (
    RejectedSpot,
    Spot,
    find_spots,
    match_spots,
    sort_spots,
)
from acutance.targets.points.options import PointsOptions
from acutance.targets.region import RegionPixels

__all__ = ["cover_rejected", "reject_unlike", "select_spots"]


def select_spots(
    region: RegionPixels, wanted: Floats | None, options: PointsOptions
) -> tuple[Floats, tuple[RejectedSpot, ...]]:
    """The usable point sources of a region, and the bright spots that are none.

    Parameters
    ----------
    region : RegionPixels
    wanted : (n, 2) array, optional
        Approximate places (row, col) in the region; all spots without them.
    options : PointsOptions

    Returns
    -------
    places : (k, 2) array
        Of the usable sources, (row, col) in the region.
    rejected : tuple of RejectedSpot
        In pixels of the region.

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
    if not usable:
        raise TargetError(_refusal(rejected, options))
    by_peak = sorted(usable, key=lambda one: -one.peak)
    taken = by_peak[: options.max_sources]
    surplus = f"{options.max_sources} brighter ones were taken (max_sources)"
    left_out = [_left_out(one, surplus) for one in by_peak[options.max_sources :]]
    unasked = (one for one in everything if one not in spots and one.snr >= options.min_snr)
    left_out += [_left_out(one, "it is not among the positions that were given") for one in unasked]
    places = np.array([(one.row, one.col) for one in usable if one in taken])
    return places, (*rejected, *left_out)


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
        if one.reason not in ("no source", "edge"):
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
    reasons = [one.reason for one in rejected]
    counted = ", ".join(f"{reasons.count(one)} {one}" for one in dict.fromkeys(reasons))
    return (
        f"none of {len(rejected)} bright spots is a usable point source ({counted}): choose "
        f"another region, or ask less (min_snr {options.min_snr:g}, min_distance_px "
        f"{options.min_distance_px:g})"
    )
