"""The reference estimator of a star: every pixel is linear in the transfer function.

The image of a star with a known centre is a sum of the images of modes (`star_waves`), so level,
transfer, centre, phase and background are one linear regression, repeated until the centre has
settled. How much the transfer may differ from a Gaussian through a pixel is decided by the data
(`acutance.numerics.marginal_likelihood`), and where they determine nothing, below the frequency
of the rim and beyond that of the centre, the intervals widen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import NoStarError
from acutance.geometry.star_geometry import SiemensStar
from acutance.numerics.combined_prior import CombinedPrior
from acutance.numerics.marginal_likelihood import Posterior
from acutance.numerics.noise import Correlation, correlation, rounding_std
from acutance.numerics.otf_kernels import blur_before
from acutance.numerics.otf_modes import HIGHEST_CPP, MeanOtf, ProcessModes
from acutance.numerics.shape_error import ShapeError
from acutance.targets.periodic.curvature import find_curvature
from acutance.targets.periodic.otf_model import FittedOtf, level_row
from acutance.targets.periodic.otf_regression import (
    FREE_STD,
    PosedPixels,
    Regression,
    mean_variance,
    otf_prior,
    reweighted,
)
from acutance.targets.periodic.star_kernels import KERNEL_REACH_PX, kernel_columns
from acutance.targets.periodic.star_rings import first_radius, ring_modulations, shape_error
from acutance.targets.periodic.star_waves import (
    BlurredStar,
    StarTable,
    Wave,
    blurred_star,
    star_table,
)
from acutance.targets.periodic.stated_contrast import Levels, StatedContrast, with_level
from acutance.targets.periodic.tuned import (
    APERTURE_STD,
    NOISE_FLOOR,
    STAR_SHAPE_SHARE,
)
from acutance.targets.periodic.uneven_contrast import uneven_sides

__all__ = ["SIDE_MARGIN_PX", "StarSolution", "amplitude_of", "solve_star"]

_MAX_RIM_PX: Final = 300.0
"""At 300 px the tables of a star take half a gigabyte; they grow with the square."""
_RIM_MARGIN_PX: Final = 3.0
"""Pixels nearer to the star's rim are left out: the scene beyond it is not known."""
SIDE_MARGIN_PX: Final = 5.0
"""Pixels nearer to a straight side of a fan are left out."""
_MAX_PASSES: Final = 8
_MIN_PIXELS: Final = 400
_EXACT: Final = 1e-6
"""Of a modulation: no ring knows its own better."""
_SETTLED_PX: Final = 0.003
_SETTLED_RAD: Final = 0.003
_SETTLED_SHARE: Final = 0.05
_SETTLED_NOISE: Final = 0.03
_BACKGROUND: Final = 6
"""Columns of a background that is a polynomial of second order."""
_BACKGROUND_STD: Final = 1e3
_PHASE_STD_RAD: Final = 10.0
_FIRST: Final = _BACKGROUND + 1
"""The first mode of the transfer function, after background and phase."""
_PLACE: Final = slice(_FIRST + 4, _FIRST + 6)
_VARIANCE_STEP_PX2: Final = 0.02


@dataclass(frozen=True, eq=False)
class StarSolution:
    """A star, solved.

    Attributes
    ----------
    star : SiemensStar
        Where it is, as it settled.
    centre_std_px : (float, float)
        Standard deviation of its row and column.
    otf : FittedOtf
        Its level is the amplitude of the fundamental before the sensor.
    rows, cols : (n,) int arrays
        The pixels used.
    value, residual : (n,) arrays
        Their values and residuals, image units.
    noise : float
        Standard deviation of the noise, image units.
    correlation : Correlation
        Of the residuals of neighbouring pixels.
    inner_px, outer_px : float
        Radii between which pixels were used.
    middle : float
        Half way between dark and bright spokes, image units: the mean of what lies under them.
    stated : StatedContrast or None
        The stated levels, if there are any.
    curvature : Estimate
        Of the characteristic of the values.
    uneven : Estimate
        By which share the contrast rises to one side, other than by light.
    """

    star: SiemensStar
    centre_std_px: tuple[float, float]
    otf: FittedOtf
    rows: NDArray[np.intp]
    cols: NDArray[np.intp]
    value: Floats
    residual: Floats
    noise: float
    correlation: Correlation
    inner_px: float
    outer_px: float
    middle: float
    stated: StatedContrast | None
    curvature: Estimate
    uneven: Estimate

    @property
    def reach_cpp(self) -> tuple[float, float]:
        """Lowest and highest frequency of the spokes used."""
        return self.star.freq_cpp(self.outer_px), self.star.freq_cpp(self.inner_px)


def solve_star(
    image: Floats,
    star: SiemensStar,
    *,
    wave: Wave = "sine",
    levels: Levels | None = None,
    inner_px: float | None = None,
    robust: bool = True,
) -> StarSolution:
    """Solve for centre, phase, level, background and transfer function.

    No least squares of fixed weights: every pass finds the prior's amplitudes by the marginal
    likelihood, and the weights and the correlation of the noise from what it leaves.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel is not to be used.
    star : SiemensStar
        Where the star is, to a fraction of its spokes.
    wave : {"sine", "square"}, optional
    levels : Levels, optional
        Levels of the spokes, if something else in the image shows them.
    inner_px : float, optional
        Pixels nearer to the centre are not used; those of 1.3 c/px and more unless given.
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoStarError
        If the star is too large, or too few pixels are usable.
    """
    _require_fitting(star)
    inner = first_radius(star, inner_px)
    outer = star.rim_px - _RIM_MARGIN_PX
    rows, cols = _usable_pixels(image, star, inner, outer)
    value = image[rows, cols]
    rounding, base = rounding_std(value), float(np.median(value))
    above = value - base  # the prior of the background is one of contrasts
    mean, level = _first_fit(image, star, inner, outer)
    if levels is not None:
        level = amplitude_of(levels.bright - levels.dark, wave)
    weight = np.ones(value.size)
    noise_found = Correlation(1.0, 0.0, 0.0)
    earlier: Posterior | None = None
    noise: float | None = None
    for _ in range(_MAX_PASSES):
        table = star_table(
            mean, star.cycles, wave, math.floor(inner) - 1.0, math.ceil(outer) + 2.0,
            round(star.rim_px * 4) / 4,
        )  # fmt: skip
        blurred = blurred_star(
            blur_before(mean), star.cycles, wave, math.ceil(outer + KERNEL_REACH_PX) + 1.0,
            round(star.rim_px * 4) / 4,
        )  # fmt: skip
        design = _design(star, rows, cols, table, blurred, level)
        posed = PosedPixels.of(design, above, weight)
        fitted = _regression(posed, table, level, levels, noise_found.inflation, earlier, noise)
        standard = fitted.residual / fitted.noise
        again = reweighted(standard, rounding / fitted.noise) if robust else weight
        found = correlation(np.clip(standard, -4, 4), rows, cols)
        moved, step_px, step_rad = _moved(star, fitted.posterior, level)
        wider = _width_of_star(mean, fitted.otf)
        if (
            step_px < _SETTLED_PX
            and step_rad < _SETTLED_RAD
            and wider == mean
            and (levels is None or _has_settled(fitted.noise, noise, _SETTLED_NOISE))
            and float(np.max(np.abs(again - weight))) < _SETTLED_SHARE
            and _has_settled(found.inflation, noise_found.inflation, _SETTLED_SHARE)
        ):
            break
        star, noise = moved, fitted.noise
        earlier = fitted.posterior if wider == mean else None
        mean, level = wider, max(fitted.otf.level, 1e-3 * level)
        weight, noise_found = again, found
    residual = np.full(image.shape, np.nan)
    residual[rows, cols] = fitted.residual
    seen = shape_error(residual, star, fitted.noise, fitted.otf.level, inner, outer)
    otf = replace(fitted.otf, shape_error=_error_of_the_prior(fitted.otf).with_another(seen))
    stated, one = None, amplitude_of(1.0, wave)
    if levels is not None:
        free = _regression(posed, table, level, None, noise_found.inflation, None, None).otf
        stated = StatedContrast(levels, Estimate(free.level / one, free.level_std / one))
    contrast = fitted.otf.level / one
    spokes = design[:, _FIRST:] @ fitted.posterior.beta[_FIRST:]
    inflation = noise_found.inflation
    curvature = find_curvature(fitted, spokes + 0.5 * contrast, contrast, weight, inflation)
    _, angle = star.polar(rows.astype(float), cols.astype(float))
    uneven = uneven_sides(fitted, spokes, angle, fitted.posterior.beta[1:3], weight, inflation)
    middle = base + float(np.mean(design[:, :_BACKGROUND] @ fitted.posterior.beta[:_BACKGROUND]))
    col_std, row_std = (np.linalg.norm(fitted.posterior.factor[_PLACE], axis=1) / level).tolist()
    return StarSolution(
        star, (row_std, col_std), otf, rows, cols, value, fitted.residual, fitted.noise,
        noise_found, inner, outer, middle, stated, curvature, uneven,
    )  # fmt: skip


def _require_fitting(star: SiemensStar) -> None:
    """Refuse a star whose tables would take gigabytes."""
    if star.rim_px > _MAX_RIM_PX:
        raise NoStarError(
            f"the star found about row {star.row:.0f}, column {star.col:.0f} has a radius of "
            f"{star.rim_px:.0f} px, and at most {_MAX_RIM_PX:g} px are fitted: the spokes further "
            "out are coarse and show little of the sensor; choose a region around the star's "
            "middle"
        )


def _has_settled(new: float, old: float | None, share: float) -> bool:
    return old is not None and abs(new - old) < share * old


def amplitude_of(contrast: float, wave: Wave) -> float:
    """Amplitude of the fundamental of spokes of some contrast, dark to bright."""
    return 0.5 * contrast * (4 / math.pi if wave == "square" else 1.0)


def _usable_pixels(
    image: Floats, star: SiemensStar, inner: float, outer: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns of the pixels on the spokes.

    Raises
    ------
    NoStarError
        If there are too few.
    """
    rows, cols = np.nonzero(np.isfinite(image))
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    margin = SIDE_MARGIN_PX / np.maximum(radius, 1.0)
    kept = (radius > inner + 0.5) & (radius < outer) & star.holds(angle, margin)
    if np.count_nonzero(kept) < _MIN_PIXELS:
        raise NoStarError(
            f"the star of {star.cycles} cycles and {star.rim_px:.1f} px about row {star.row:.1f}, "
            f"column {star.col:.1f} leaves {np.count_nonzero(kept)} pixels to measure, at least "
            f"{_MIN_PIXELS} are needed: use a larger star, or a region that holds more of it"
        )
    return rows[kept], cols[kept]


def _first_fit(
    image: Floats, star: SiemensStar, inner: float, outer: float
) -> tuple[MeanOtf, float]:
    """A round Gaussian through a pixel and a level, from the modulation of the rings."""
    freq, modulation, std = ring_modulations(image, star, inner, outer)
    coarse = (freq < 0.6) & (modulation > 3 * std)
    if np.count_nonzero(coarse) < 3:
        raise NoStarError(
            "the spokes do not stand out of the noise in three rings: the star is too faint, too "
            "small or not where it was found; choose a region that holds the whole star"
        )
    f, m = freq[coarse], modulation[coarse]
    weight = (m / np.maximum(std[coarse], _EXACT * m)) * np.sqrt(1 / (1 + (f / 0.4) ** 4))
    design = np.stack([np.ones(f.size), -2 * math.pi**2 * f**2], axis=1)
    # The pixel's own blur is taken out, in its mean over the directions.
    own = np.log(m) + 2 * math.pi**2 * f**2 / 12
    fit, *_ = np.linalg.lstsq(design * weight[:, None], own * weight, rcond=None)
    variance = _rounded(float(np.clip(fit[1], 0.02, 4.0)))
    return MeanOtf(variance, 0.0, variance), math.exp(float(fit[0]))


def _rounded(variance: float) -> float:
    """In coarse steps, so that tables are used again."""
    return round(variance / _VARIANCE_STEP_PX2) * _VARIANCE_STEP_PX2


def _design(
    star: SiemensStar,
    rows: NDArray[np.intp],
    cols: NDArray[np.intp],
    table: StarTable,
    blurred: BlurredStar,
    level: float,
) -> Floats:
    """Columns of background, phase and modes, (n, m), with the star where it is taken to be."""
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    phase = star.cycles * angle + star.alpha_rad
    modes, by_phase = table.columns(radius, phase, angle)
    x, y = radius * np.cos(angle) / star.rim_px, radius * np.sin(angle) / star.rim_px
    background = (np.ones(x.size), x, y, x * x, x * y, y * y)
    kernels = kernel_columns(blurred, star, rows, cols)
    return np.column_stack([*background, level * by_phase, modes, kernels])


def _regression(
    posed: PosedPixels,
    table: StarTable,
    level: float,
    levels: Levels | None,
    inflation: float,
    earlier: Posterior | None,
    noise: float | None,
) -> Regression:
    """One regression; `noise` is that of the one before."""
    normal = posed.normal
    variance = mean_variance(normal, _FIRST + 6)
    if levels is not None:
        variance = variance if noise is None else noise**2
        row = np.zeros(normal.projection.size)
        row[_FIRST:] = level_row(row.size - _FIRST)
        stated, std = (
            amplitude_of(one, table.wave) for one in (levels.bright - levels.dark, levels.std)
        )
        normal = with_level(normal, row, stated, std, variance * inflation)
    prior = _prior(table.mean, level, level_stated=levels is not None)
    posterior = prior.posterior(normal, variance, inflation, earlier=earlier)
    otf = FittedOtf(table.mean, posterior.beta[_FIRST:], posterior.factor[_FIRST:])
    return Regression(posterior, otf, posed.residual(posterior), posed.design)


def _prior(mean: MeanOtf, level: float, *, level_stated: bool) -> CombinedPrior:
    """Background, phase and the mean's own modes are free; the apertures are about one pixel."""
    own_scale = np.append(np.full(_BACKGROUND, _BACKGROUND_STD), _PHASE_STD_RAD / level)
    return otf_prior(
        own_scale, np.zeros(_FIRST), np.repeat([FREE_STD, APERTURE_STD], [6, 2]),
        ProcessModes(mean.width_px), level, NOISE_FLOOR, level_stated=level_stated,
    )  # fmt: skip


def _error_of_the_prior(otf: FittedOtf) -> ShapeError:
    """What the prior does not know of a shape: few pixels of a star show any one direction."""
    return ShapeError.of(
        lambda u, v: otf.otf(u, v) - otf.mean.otf(u, v), HIGHEST_CPP, STAR_SHAPE_SHARE
    )


def _moved(
    star: SiemensStar, posterior: Posterior, level: float
) -> tuple[SiemensStar, float, float]:
    """The star of the regression, and the size of the update in px and in phase.

    The modes of the place move the image; the centre moves with it.
    """
    move = posterior.beta[_PLACE] / level
    turn = float(posterior.beta[_BACKGROUND])
    if not (np.all(np.isfinite(move)) and np.max(np.abs(move)) < 0.25 * star.rim_px):
        raise NoStarError(
            "the fit of the star did not settle: the pixels do not follow spokes about one "
            "centre; check the number of cycles, the wave (sine or square) and the region"
        )
    alpha = math.remainder(star.alpha_rad + turn, 2 * math.pi)
    moved = replace(star, row=star.row + float(move[1]), col=star.col + float(move[0]),
                    alpha_rad=alpha)  # fmt: skip
    return moved, float(np.max(np.abs(move))), abs(turn)


def _width_of_star(mean: MeanOtf, fitted: FittedOtf) -> MeanOtf:
    """The mean of the data's width, in coarse steps: the regression fits the rest."""
    level = float(fitted.beta[0])
    # A wider aperture by w is a Gaussian wider by w / 6: their coefficients are correlated.
    aperture = np.array([fitted.beta[6], 0.0, fitted.beta[7]]) / (6 * level)
    change = np.clip(fitted.beta[1:4] / level + aperture, -0.15, 0.15)
    xx, xy, yy = np.array([mean.xx, mean.xy, mean.yy]) + change
    xx, yy = max(float(xx), 0.02), max(float(yy), 0.02)
    limit = 0.9 * math.sqrt(xx * yy)
    moved = MeanOtf(_rounded(xx), _rounded(float(np.clip(xy, -limit, limit))), _rounded(yy))
    step = max(abs(moved.xx - mean.xx), abs(moved.xy - mean.xy), abs(moved.yy - mean.yy))
    return moved if step > 0.15 * (mean.xx + mean.yy + 1 / 6) else mean
