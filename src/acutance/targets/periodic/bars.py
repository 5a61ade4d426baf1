"""Measure groups of bars: finite square waves of some frequencies, in one or two directions."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Estimate, Mtf, Otf2d
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.errors import NoBarsError, OptionError
from acutance.geometry.angles import axis_difference, wrap_axis
from acutance.geometry.bar_group import Bars
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.raster.image import AlongTrack
from acutance.targets.options import chosen_options
from acutance.targets.periodic.bars_checks import bars_checks
from acutance.targets.periodic.bars_find import find_bars
from acutance.targets.periodic.bars_measurement import (
    BarsDetails,
    BarsGroup,
    BarsMeasurement,
    GroupProfile,
)
from acutance.targets.periodic.bars_options import BarsOptions
from acutance.targets.periodic.bars_pixels import GroupPixels, pixels_about
from acutance.targets.periodic.bars_readings import GroupReading, central, coltman_mtf, read_group
from acutance.targets.periodic.fit_bars import BarsSolution, solve_bars
from acutance.targets.region import RegionPixels, RoiLike, read_region

__all__ = ["BARS_METHODS", "measure_bars"]

BARS_METHODS = ("joint",)
_ONE_DIRECTION_DEG = 20.0
_MAX_OTHER_PATTERN = {"stated": 1.0, "found": 0.15}
"""Pattern that is left, relative to what bars explain. Checkerboards leave .2 and more."""


@one_thread
def measure_bars(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "joint",
    options: BarsOptions | None = None,
) -> BarsMeasurement:
    """Measure the groups of bars of a region.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        A region that holds the groups and some background around each; None is the whole image.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    method : {"joint"}, optional
        One fit of all groups.
    options : BarsOptions, optional
        Where the groups are, if they are not to be searched for.

    Returns
    -------
    BarsMeasurement

    Raises
    ------
    ImageError, RegionError, OptionError
        If there are no pixels to measure, or an option means nothing.
    NoBarsError
        If there are no bars, or not as they were described.
    """
    chosen = chosen_options(options, BarsOptions)
    if method not in BARS_METHODS:
        raise OptionError(f"there is no bars method {method!r}: {', '.join(BARS_METHODS)} is known")
    region = read_region(image, roi, gsd_m)
    groups, contrast = _groups_of(region, chosen)
    solved = solve_bars(
        region.pixels, groups, contrast=contrast, levels=chosen.levels, robust=chosen.robust
    )
    how: Literal["stated", "found"] = "stated" if chosen.groups else "found"
    _require_bars(solved, how)
    _require_near(groups, solved, how)
    directions = common_normals(tuple(one.bars for one in solved.groups), region.info.along_track)
    return BarsMeasurement(
        kind="bars",
        method=method,
        transfer=Otf2d(solved.otf, region.info.pixel_gsd_m),
        snr=solved.snr,
        checks=bars_checks(solved, directions, region, chosen.limits),
        image=region.info,
        options=chosen.to_dict(),
        details=_details(region, solved),
        groups=_measured_groups(region, solved),
        directions_deg=directions,
        contrast=Estimate(solved.otf.level, solved.otf.level_std),
    )


def _groups_of(region: RegionPixels, options: BarsOptions) -> tuple[tuple[Bars, ...], float]:
    """The groups of a region in its own pixels, stated or found, and their contrast."""
    if not options.groups:
        return find_bars(region.pixels, options.count)
    box = region.box
    groups = tuple(one.shifted(-box.row, -box.col) for one in options.groups)
    return groups, _contrast(region.pixels, groups)


def _contrast(image: Floats, groups: tuple[Bars, ...]) -> float:
    """Bars minus background, from the mean of every stated group and of what is next to it."""
    found = []
    for number, bars in enumerate(groups, 1):
        rows, cols = pixels_about(image, bars)
        value = image[rows, cols]
        across, along = bars.across_and_along(rows.astype(float), cols.astype(float))
        outside_px = np.abs(across) - 0.5 * bars.width_px
        middle = np.abs(along) < 0.4 * bars.length_px
        inside, outside = middle & (outside_px < 0), middle & (outside_px > 2) & (outside_px < 8)
        if not (inside.any() and outside.any()):
            raise NoBarsError(
                f"group {number} at row {bars.row:.1f}, column {bars.col:.1f} and the background "
                "next to it lie outside the region: check its place"
            )
        # Half of a group is bars, but for half a gap at its ends.
        share = 0.5 * bars.count / (bars.count - 0.5)
        found.append(float(np.mean(value[inside]) - np.mean(value[outside])) / share)
    contrast = float(np.median(found))
    if contrast == 0:
        raise NoBarsError(
            "the groups are as bright as the background next to them: check their places"
        )
    return contrast


def _require_bars(solved: BarsSolution, how: Literal["stated", "found"]) -> None:
    """Refuse groups in which a large share of another pattern is left beside the bars."""
    whole = float(np.var(np.concatenate([one.value for one in solved.groups])))
    left = float(np.var(np.concatenate(solved.residuals)))
    # Noise does not correlate from pixel to pixel; what does is a pattern.
    if solved.correlation.strongest * left > _MAX_OTHER_PATTERN[how] * (whole - left):
        raise NoBarsError(
            f"what was taken for groups of bars is another pattern: bars explain "
            f"{max(100 * (1 - left / whole), 0):.0f} % of its variance, and neighbouring pixels of "
            f"the rest correlate by {solved.correlation.strongest:.2f}; choose a region that holds "
            "the groups and some background around each, or state where they are (groups)"
        )


def _require_near(
    groups: tuple[Bars, ...], solved: BarsSolution, how: Literal["stated", "found"]
) -> None:
    """Refuse groups that settled elsewhere than where they were stated, or found, to be."""
    for number, (one, fitted) in enumerate(zip(groups, solved.groups, strict=True), 1):
        other = fitted.bars
        across, _ = one.across_and_along(np.array([other.row]), np.array([other.col]))
        moved, scale = float(across[0]), other.period_px / one.period_px
        if abs(moved) > 0.75 * one.period_px or abs(scale - 1) > 0.6 / one.count:
            raise NoBarsError(
                f"group {number} was {how} with a period of {one.period_px:.2f} px at row "
                f"{one.row:.1f}, column {one.col:.1f}; the pixels fit {other.period_px:.2f} px, "
                f"{moved:+.1f} px away: check its place, its number of bars and its period"
            )


def common_normals(groups: tuple[Bars, ...], along_track: AlongTrack = "y") -> tuple[float, ...]:
    """Mean normals of groups with nearly the same one, degrees; the nearest to across first."""
    kinds: list[list[float]] = []
    for bars in groups:
        for kind in kinds:
            if bars.angle_to(kind[0]) < _ONE_DIRECTION_DEG:
                kind.append(kind[0] + wrap_axis(bars.normal_deg - kind[0]))
                break
        else:
            kinds.append([bars.normal_deg])
    across_deg = 0.0 if along_track == "y" else 90.0
    means = [sum(kind) / len(kind) for kind in kinds]
    return tuple(sorted(means, key=lambda normal: axis_difference(normal, across_deg)))


def _details(region: RegionPixels, solved: BarsSolution) -> BarsDetails:
    """Pixels, residuals and profiles, as a fit left them."""
    left = np.full(region.pixels.shape, np.nan)
    profiles = []
    for one, residual, background in zip(
        solved.groups, solved.residuals, solved.backgrounds, strict=True
    ):
        left[one.rows, one.cols] = residual
        level = (one.value - background) / solved.otf.level
        profiles.append(GroupProfile(one.across, level, level - residual / solved.otf.level))
    return BarsDetails(region.pixels, left, tuple(profiles))


def _measured_groups(region: RegionPixels, solved: BarsSolution) -> tuple[BarsGroup, ...]:
    """All groups with their MTF and plain readings, in the whole image's pixels."""
    readings = [_reading(one, solved) for one in solved.groups]
    bars = [one.bars for one in solved.groups]
    return tuple(
        BarsGroup(
            bars=one.shifted(region.box.row, region.box.col),
            period_px=Estimate(one.period_px, std),
            mtf=_mtf_at(solved, one),
            reading=reading,
            coltman=_coltman(one, bars, readings),
        )
        for one, std, reading in zip(bars, solved.period_std_px, readings, strict=True)
    )


def _reading(one: GroupPixels, solved: BarsSolution) -> GroupReading:
    inside = central(one.bars, one.across)
    return read_group(
        one.bars, one.across[inside], one.value[inside], solved.otf.level, solved.noise
    )


def _mtf_at(solved: BarsSolution, bars: Bars) -> Estimate:
    """MTF at the frequency of a group along its normal."""
    x, y = unit_vector(bars.normal_deg)
    freq: Floats = bars.freq_cpp * np.array([0.0, 0.5, 1.0, 1.5])
    return Mtf(freq, solved.otf.otf(freq * x, freq * y), solved.otf.factor(freq * x, freq * y))(
        bars.freq_cpp
    )


def _coltman(one: Bars, groups: list[Bars], readings: list[GroupReading]) -> float:
    """MTF of a group by Coltman's series over the groups of its direction."""
    table = np.array(
        sorted(
            (other.freq_cpp, reading.ctf)
            for other, reading in zip(groups, readings, strict=True)
            if other.angle_to(one.normal_deg) < _ONE_DIRECTION_DEG
        )
    )
    series = coltman_mtf(table[:, 0], table[:, 1])
    return float(series[np.searchsorted(table[:, 0], one.freq_cpp)])
