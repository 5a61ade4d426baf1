"""Measure a Siemens star: every frequency in every direction, from one target."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Estimate, Mtf, Otf2d
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP, mtf_crossing
from acutance.curves.short_repr import ShortRepr
from acutance.errors import NoStarError, OptionError
from acutance.geometry.star_geometry import FoundStar
from acutance.numerics.noise import robust_scale
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.measurement import ImageInfo
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.options import chosen_options
from acutance.targets.periodic.fit_star import SIDE_MARGIN_PX, StarSolution, solve_star
from acutance.targets.periodic.otf_model import PlaneModel
from acutance.targets.periodic.star_checks import star_checks
from acutance.targets.periodic.star_find import find_star
from acutance.targets.periodic.star_options import StarOptions
from acutance.targets.periodic.star_rings import ring_modulations
from acutance.targets.region import RegionPixels, RoiLike, read_region

__all__ = ["STAR_METHODS", "Rings", "StarMeasurement", "measure_star"]

STAR_METHODS = ("joint",)
_FREQ_CPP: Floats = np.asarray(np.arange(101) * 0.01)
_DIRECTION_STEP_DEG = 5.0
_MOST_RAISED = 3.0
"""No restoration raises the contrast of coarse spokes so much."""


@dataclass(frozen=True, eq=False)
class Rings(ShortRepr):
    """The plain reading of a star: a sinusoid fitted to every ring of pixels.

    Attributes
    ----------
    freq_cpp : (n,) array
        Frequency of the spokes in the ring.
    modulation : (n,) array
        Amplitude of the sinusoid over that before the sensor: the MTF, as far as a ring shows
        one frequency. Near the centre it does not: spokes change within the blur.
    std : (n,) array
        Its standard deviation by the noise alone.
    """

    freq_cpp: Floats
    modulation: Floats
    std: Floats

    def to_dict(self) -> dict[str, list[float]]:
        """Frequencies, modulations and standard deviations as lists."""
        return {
            "freq_cpp": np.round(self.freq_cpp, 6).tolist(),
            "modulation": self.modulation.tolist(),
            "std": self.std.tolist(),
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class StarMeasurement(Measurement2d):
    """A measurement of one star.

    Parameters
    ----------
    star : FoundStar
        Where the star is, in pixels of the whole image.
    centre_std_px : (float, float)
        Standard deviation of the centre's row and column.
    level : Estimate
        Amplitude of the spokes before the sensor (of a square wave, its fundamental's).
    reach_cpp : (float, float)
        Lowest and highest frequency of the spokes used: the MTF is continued beyond.
    rings : Rings
        The plain reading, as evidence.
    pixels, residual : (rows, cols) arrays
        The cut, and what the fit leaves of the pixels used (NaN elsewhere), image units.
    """

    star: FoundStar
    centre_std_px: tuple[float, float]
    level: Estimate
    reach_cpp: tuple[float, float]
    rings: Rings
    pixels: Floats
    residual: Floats

    @cached_property
    def mtf(self) -> Mtf:
        """Mean of the MTF over `directions_deg`."""
        return mean_over_directions(self.otf, self.directions_deg)

    @property
    def directions_deg(self) -> Floats:
        """Directions across the spokes, from the column axis towards the row axis, (n,).

        Of a fan those in which it shows Nyquist's frequency (or the highest it does): its spokes
        are that fine near the centre, where the margin beside its straight sides takes most.
        """
        star = self.star
        first, sweep = star.first_deg, star.sweep_deg
        if sweep < 360:
            fine_px = star.radius_at(min(NYQUIST_CPP, self.reach_cpp[1]))
            beside = math.degrees(SIDE_MARGIN_PX / fine_px)
            # Of a fan that is too narrow at that radius the middle remains.
            beside = min(beside, 0.5 * sweep)
            first, sweep = first + beside, sweep - 2 * beside
        # Opposite spokes show the same direction: half a turn is all.
        sweep = min(sweep, 180.0)
        count = max(round(sweep / _DIRECTION_STEP_DEG), 1)
        return np.asarray(first + 90 + (np.arange(count) + 0.5) * sweep / count)

    def mtf_by_direction(self, freq_cpp: float, directions_deg: Floats) -> tuple[Floats, Floats]:
        """MTF at one frequency in some directions, and its standard deviation, (n,) each."""
        angle = np.radians(directions_deg)
        u, v = freq_cpp * np.cos(angle), freq_cpp * np.sin(angle)
        # As a curve over directions: every one with its own variance.
        curve = Mtf(directions_deg, self.otf.model.otf(u, v), self.otf.model.factor(u, v))
        return curve.value, curve.std

    @property
    def noise(self) -> float:
        """Standard deviation of what the fit leaves, outliers aside, image units."""
        return robust_scale(self.residual[np.isfinite(self.residual)])

    @property
    def mtf_nyquist(self) -> Estimate:
        """Mean MTF at 0.5 cycles per pixel."""
        return self.mtf(NYQUIST_CPP)

    @property
    def mtf50_cpp(self) -> Estimate:
        """Frequency at which the mean MTF falls to one half."""
        return mtf_crossing(self.mtf, 0.5)

    @property
    def centre(self) -> tuple[Estimate, Estimate]:
        """Row and column of the centre in the whole image."""
        row_std, col_std = self.centre_std_px
        return Estimate(self.star.row, row_std), Estimate(self.star.col, col_std)

    @property
    def nyquist_px(self) -> float:
        """Radius within which spokes across the grid are undersampled."""
        return self.star.radius_at(NYQUIST_CPP)

    def evidence(self) -> dict[str, Any]:
        row, col = self.centre
        return {
            "star": {
                "row": row.to_dict(),
                "col": col.to_dict(),
                "cycles": self.star.cycles,
                "rim_px": self.star.rim_px,
                "first_deg": self.star.first_deg,
                "sweep_deg": self.star.sweep_deg,
                "level": self.level.to_dict(),
                "reach_cpp": list(self.reach_cpp),
                "nyquist_px": self.nyquist_px,
            },
            "mean": {
                "mtf_nyquist": self.mtf_nyquist.to_dict(),
                "mtf50_cpp": self.mtf50_cpp.to_dict(),
                "mtf": self.mtf.to_dict(),
            },
            "rings": self.rings.to_dict(),
        }


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
    roi : Region, Box, (row, col, height, width) or None
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
    pixels = read_region(image, roi, gsd_m)
    found = find_star(pixels.pixels, cycles, _local(chosen.centre, pixels))
    solved = solve_star(
        pixels.pixels, found, wave=chosen.wave, levels=chosen.levels,
        inner_px=chosen.inner_px, robust=chosen.robust,
    )  # fmt: skip
    return _measurement(pixels, solved, method, chosen)


def _require_cycles(cycles: Any) -> None:
    if cycles is None:
        return
    if not (isinstance(cycles, Real) and float(cycles).is_integer()):
        raise OptionError(
            f"cycles is {cycles!r}: give the whole number of periods in a full turn, or None to "
            "count them"
        )
    if not 4 <= float(cycles) <= 1000:
        raise OptionError(f"a star of {cycles} cycles: 4 to 1000 can be measured")


def _local(centre: tuple[float, float] | None, pixels: RegionPixels) -> tuple[float, float] | None:
    return None if centre is None else (centre[0] - pixels.box.row, centre[1] - pixels.box.col)


def _measurement(
    pixels: RegionPixels, solved: StarSolution, method: str, options: StarOptions
) -> StarMeasurement:
    """Put together what a measurement holds; the star moves into the whole image's pixels."""
    model = solved.model
    star, level = solved.star, Estimate(model.level, model.level_std)
    snr = _contrast(model, options) / solved.noise if solved.noise > 0 else math.inf
    freq, modulation, std = ring_modulations(pixels.pixels, star, solved.inner_px, solved.outer_px)
    _require_spokes(level, float(modulation.max()), options.wave)
    residual = np.full(pixels.pixels.shape, np.nan)
    residual[solved.rows, solved.cols] = solved.residual
    gsd = pixels.gsd
    return StarMeasurement(
        kind="star",
        method=method,
        otf=Otf2d(model, None if gsd is None else (gsd.row_m, gsd.col_m)),
        snr=snr,
        checks=star_checks(pixels, solved, snr, options.limits),
        image=_info(pixels),
        options=options.to_dict(),
        star=replace(star, row=star.row + pixels.box.row, col=star.col + pixels.box.col),
        centre_std_px=solved.centre_std_px,
        level=level,
        reach_cpp=(
            star.cycles / (2 * math.pi * solved.outer_px),
            star.cycles / (2 * math.pi * solved.inner_px),
        ),
        rings=Rings(freq, modulation / level.value, std / level.value),
        pixels=pixels.pixels,
        residual=residual,
    )


def _require_spokes(level: Estimate, seen: float, wave: str) -> None:
    """Refuse a fit whose spokes have far less contrast than the image of them."""
    if seen > _MOST_RAISED * abs(level.value):
        other = "sine" if wave == "square" else "square"
        raise NoStarError(
            f"the image's spokes have an amplitude of {seen:.4g}, and those of the fitted {wave} "
            f"star {level}: no sensor raises contrast so much. The spokes may be a {other} wave "
            f"(--wave {other}), or have another number of cycles"
        )


def _contrast(model: PlaneModel, options: StarOptions) -> float:
    """From dark to bright spokes."""
    return 2 * model.level * (math.pi / 4 if options.wave == "square" else 1.0)


def _info(pixels: RegionPixels) -> ImageInfo:
    gsd_m = None
    if pixels.gsd is not None:
        gsd_m = math.sqrt(pixels.gsd.row_m * pixels.gsd.col_m)
    return ImageInfo(
        pixels.image.path, pixels.image.band, gsd_m, pixels.box.as_tuple(), pixels.image.crs
    )


def mean_over_directions(otf: Otf2d, directions_deg: Floats) -> Mtf:
    """Mean MTF over some directions, as a curve with its covariance."""
    value, spread = np.zeros(_FREQ_CPP.size), None
    for angle in np.radians(directions_deg):
        u, v = _FREQ_CPP * math.cos(angle), _FREQ_CPP * math.sin(angle)
        one = Mtf(_FREQ_CPP, otf.model.otf(u, v), otf.model.factor(u, v))
        own = one.covariance_factor
        value += one.value
        spread = own if spread is None else spread + own
    count = max(directions_deg.size, 1)
    factor = np.zeros((_FREQ_CPP.size, 1)) if spread is None else spread / count
    return Mtf(_FREQ_CPP, (value / count).astype(complex), factor.astype(complex))
