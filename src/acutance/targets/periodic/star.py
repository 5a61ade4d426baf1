"""Measure a Siemens star: every frequency in every direction, from one target."""

from __future__ import annotations

import math
from dataclasses import replace
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Estimate, Otf2d
from acutance.errors import NoStarError, OptionError
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.options import chosen_options
from acutance.targets.periodic.fit_star import StarSolution, amplitude_of
from acutance.targets.periodic.star_centre import solve_spokes
from acutance.targets.periodic.star_checks import star_checks
from acutance.targets.periodic.star_find import find_star
from acutance.targets.periodic.star_measurement import Rings, StarDetails, StarMeasurement
from acutance.targets.periodic.star_options import StarOptions
from acutance.targets.periodic.star_rings import ring_modulations
from acutance.targets.periodic.star_waves import Wave
from acutance.targets.periodic.tuned import MAX_RAISED, MIN_LEVEL_SIGMAS
from acutance.targets.region import RegionPixels, RoiLike, read_region

__all__ = ["STAR_METHODS", "measure_star"]

STAR_METHODS = ("joint",)


@one_thread
def measure_star(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    cycles: int | None = 36,
    gsd_m: float | Gsd | None = None,
    method: str = "joint",
    options: StarOptions | None = None,
) -> StarMeasurement:
    """Measure the star of a region.

    Parameters
    ----------
    image : Image or (rows, cols) array_like
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        A loose region around the star; None is the whole image.
    cycles : int or None, optional
        Periods in a full turn, also of a fan; None counts them.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    method : {"joint"}, optional
        One fit of all pixels.
    options : StarOptions, optional

    Returns
    -------
    StarMeasurement

    Raises
    ------
    ImageError, RegionError, OptionError
        If there are no pixels to measure, or an option means nothing.
    NoStarError
        If there is no star, or it has another number of cycles.
    """
    chosen = chosen_options(options, StarOptions)
    if method not in STAR_METHODS:
        raise OptionError(f"there is no star method {method!r}: {', '.join(STAR_METHODS)} is known")
    _require_cycles(cycles)
    region = read_region(image, roi, gsd_m)
    found = find_star(region.pixels, cycles, _in_region(chosen.centre, region))
    solved = solve_spokes(
        region.pixels, found, wave=chosen.wave, levels=chosen.levels,
        inner_px=chosen.inner_px, robust=chosen.robust,
    )  # fmt: skip
    rings = _rings(region, solved)
    _require_spokes(solved, rings, chosen.wave)
    snr = _snr(solved, chosen.wave)
    return StarMeasurement(
        kind="star",
        method=method,
        transfer=Otf2d(solved.otf, region.info.pixel_gsd_m),
        snr=snr,
        checks=star_checks(solved, snr, region, chosen.limits),
        image=region.info,
        options=chosen.to_dict(),
        details=_details(region, solved),
        star=replace(
            solved.star, row=solved.star.row + region.box.row, col=solved.star.col + region.box.col
        ),
        centre_std_px=solved.centre_std_px,
        level=Estimate(solved.otf.level, solved.otf.level_std),
        reach_cpp=solved.reach_cpp,
        rings=rings,
    )


def _require_cycles(cycles: Any) -> None:
    if cycles is None:
        return
    if not (isinstance(cycles, Real) and float(cycles).is_integer()):
        raise OptionError(
            f"cycles is {cycles!r}: give the whole number of periods in a full turn, or None to "
            "count them"
        )
    if not 4 <= float(cycles) <= 1000:
        raise OptionError(f"a star of {cycles} cycles was asked for: give 4 to 1000")


def _in_region(
    centre: tuple[float, float] | None, region: RegionPixels
) -> tuple[float, float] | None:
    return None if centre is None else (centre[0] - region.box.row, centre[1] - region.box.col)


def _rings(region: RegionPixels, solved: StarSolution) -> Rings:
    """The plain reading, over the amplitude before the sensor."""
    freq, modulation, std = ring_modulations(
        region.pixels, solved.star, solved.inner_px, solved.outer_px
    )
    return Rings(freq, modulation / solved.otf.level, std / solved.otf.level)


def _require_spokes(solved: StarSolution, rings: Rings, wave: Wave) -> None:
    """Refuse a fit whose spokes have far less contrast than the image of them, or none for sure."""
    level = solved.otf.level
    largest = float(np.max(rings.modulation * level))
    undetermined = level < MIN_LEVEL_SIGMAS * solved.otf.level_std
    impossible = largest > MAX_RAISED * abs(level)
    if not (impossible or undetermined):
        return
    other = "sine" if wave == "square" else "square"
    why = "no sensor makes the one of the other. The"
    if not impossible:
        why = (
            f"the coarsest that were used have {solved.reach_cpp[0]:.2g} c/px, and do not show it. "
            "State the levels of wide patches of the same materials (dark and bright, --dark, "
            "--bright), or use a star with fewer cycles or a larger radius; or the"
        )
    raise NoStarError(
        f"the image's spokes have an amplitude of {largest:.4g}, and those of the fitted "
        f"{wave} star of {solved.star.cycles} cycles {Estimate(level, solved.otf.level_std)}: "
        f"{why} spokes may be a {other} wave (--wave {other}), or have another number of "
        "cycles: count them by eye, and state it (cycles, --cycles)"
    )


def _snr(solved: StarSolution, wave: Wave) -> float:
    """Contrast from dark to bright spokes, over noise."""
    contrast = solved.otf.level / amplitude_of(1.0, wave)
    return contrast / solved.noise if solved.noise > 0 else math.inf


def _details(region: RegionPixels, solved: StarSolution) -> StarDetails:
    residual = np.full(region.pixels.shape, np.nan)
    residual[solved.rows, solved.cols] = solved.residual
    return StarDetails(region.pixels, residual)
