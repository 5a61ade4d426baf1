"""The reference estimator of a star: every pixel is linear in the transfer function.

The image of a star with a known centre is a sum of the images of modes (`fit.star_waves`), so
level, transfer, centre, phase and ground are one linear regression, repeated until the centre has
settled. How much the transfer may depart from a plain blur is decided by the data
(`fit.posterior`), and where they say nothing, below the frequency of the rim and beyond that of
the centre, the intervals widen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import NoStarError
from acutance.geometry.star_geometry import FoundStar
from acutance.numerics.marginal_likelihood import Posterior, Prior, regress
from acutance.numerics.noise import Correlation, correlation, outlier_weights, robust_scale
from acutance.numerics.normal_equations import Normal
from acutance.targets.periodic.otf_model import PlaneModel
from acutance.targets.periodic.otf_modes import (
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
    MEAN_MODES,
    UNSEEN,
    PlaneBlur,
    ProcessModes,
)
from acutance.targets.periodic.star_rings import ring_modulations
from acutance.targets.periodic.star_waves import Wave, star_table
from acutance.targets.periodic.stated_contrast import Levels, with_level

__all__ = ["SIDE_MARGIN_PX", "StarSolution", "solve_star"]

_RIM_MARGIN_PX: Final = 3.0
"""Pixels nearer to the star's rim are left out: what lies beyond is not known."""
SIDE_MARGIN_PX: Final = 5.0
"""Pixels nearer to a straight side of a fan are left out."""
_FINEST_CPP: Final = 1.3
"""Pixels nearer to the centre see spokes finer than this: the printed centre may end there."""
_APERTURE_STD: Final = 0.18
_NOISE_FLOOR: Final = 2e-4
_MAX_PASSES: Final = 8
_LEAST_PIXELS: Final = 400
_GROUND: Final = 6


@dataclass(frozen=True, eq=False)
class StarSolution:
    """A star, solved.

    Attributes
    ----------
    star : FoundStar
        Where it is, as it settled.
    centre_std_px : (float, float)
        Standard deviation of its row and column.
    model : PlaneModel
    rows, cols : (n,) int arrays
        The pixels used.
    value, residual : (n,) arrays
        Their values, and what the fit leaves of them, image units.
    noise : float
        Standard deviation of the noise, image units.
    outlier : (n,) array
        Weight of every pixel, 1 where it is no outlier.
    correlation : Correlation
    inner_px, outer_px : float
        Radii between which pixels were used.
    """

    star: FoundStar
    centre_std_px: tuple[float, float]
    model: PlaneModel
    rows: NDArray[np.intp]
    cols: NDArray[np.intp]
    value: Floats
    residual: Floats
    noise: float
    outlier: Floats
    correlation: Correlation
    inner_px: float
    outer_px: float


@dataclass(frozen=True, eq=False)
class _Pixels:
    rows: NDArray[np.intp]
    cols: NDArray[np.intp]
    value: Floats


def solve_star(
    image: Floats,
    star: FoundStar,
    *,
    wave: Wave = "sine",
    levels: Levels | None = None,
    inner_px: float | None = None,
    robust: bool = True,
) -> StarSolution:
    """Solve for centre, phase, level, ground and transfer function.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel is not to be used.
    star : FoundStar
        Where the star is, to a fraction of its spokes.
    wave : {"sine", "square"}, optional
    levels : Levels, optional
        Levels of the spokes, if something else in the image shows them.
    inner_px : float, optional
        Pixels nearer to the centre are not used; those that see 1.3 c/px and more unless given.
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoStarError
        If too few pixels are usable, or the fit does not settle.
    """
    inner = max(star.radius_at(_FINEST_CPP), inner_px or 0.0, 1.5)
    outer = star.rim_px - _RIM_MARGIN_PX
    pixels = _select(image, star, inner, outer)
    blur, level = _start(image, star, inner, outer, levels, wave)
    outlier = np.ones(pixels.value.size)
    whiteness = Correlation(1.0, 0.0, 0.0)
    earlier: Posterior | None = None
    noise = 0.0
    for _ in range(_MAX_PASSES):
        solved = _pass(
            pixels, star, blur, level, wave, levels, outlier, whiteness.inflation, earlier,
            (inner, outer), noise,
        )  # fmt: skip
        standard = solved.residual / solved.noise
        again = _reweighted(standard) if robust else outlier
        found = correlation(np.clip(standard, -4, 4), pixels.rows, pixels.cols, (0.8, 0.6))
        move, turn, model = solved.move_px, solved.turn_rad, solved.model
        if not (np.all(np.isfinite(move)) and np.max(np.abs(move)) < 0.25 * star.rim_px):
            raise NoStarError(
                "the fit of the star did not settle: the pixels do not follow spokes about one "
                "centre; check the number of cycles, the wave (sine or square) and the region"
            )
        wider, changed = _moved_blur(blur, model)
        settled = (
            float(np.max(np.abs(move))) < 0.003
            and abs(turn) < 0.003
            and not changed
            and (levels is None or abs(solved.noise - noise) < 0.03 * noise)
            and float(np.max(np.abs(again - outlier))) < 0.05
            and abs(found.inflation / whiteness.inflation - 1) < 0.05
        )
        if settled:
            break
        star = replace(
            star, row=star.row + float(move[1]), col=star.col + float(move[0]),
            alpha_rad=math.remainder(star.alpha_rad + turn, 2 * math.pi),
        )  # fmt: skip
        earlier = None if changed else solved.posterior
        blur, level = wider, max(model.level, 1e-3 * level)
        outlier, whiteness, noise = again, found, solved.noise
    std = solved.move_std_px
    return StarSolution(
        star, (float(std[1]), float(std[0])), solved.model, pixels.rows, pixels.cols,
        pixels.value, solved.residual, solved.noise, outlier, whiteness, inner, outer,
    )  # fmt: skip


def _select(image: Floats, star: FoundStar, inner: float, outer: float) -> _Pixels:
    rows, cols = np.nonzero(np.isfinite(image))
    radius, angle = star.polar(rows.astype(float), cols.astype(float))
    margin = SIDE_MARGIN_PX / np.maximum(radius, 1.0)
    kept = (radius > inner + 0.5) & (radius < outer) & star.holds(angle, margin)
    if np.count_nonzero(kept) < _LEAST_PIXELS:
        raise NoStarError(
            f"the star of {star.cycles} cycles and {star.rim_px:.1f} px about row {star.row:.1f}, "
            f"column {star.col:.1f} leaves {np.count_nonzero(kept)} pixels to measure, at least "
            f"{_LEAST_PIXELS} are needed: use a larger star, or a region that holds more of it"
        )
    return _Pixels(rows[kept], cols[kept], image[rows[kept], cols[kept]])


def _start(
    image: Floats,
    star: FoundStar,
    inner: float,
    outer: float,
    levels: Levels | None,
    wave: Wave,
) -> tuple[PlaneBlur, float]:
    """Blur and level to depart from, from the modulation of the rings."""
    freq, modulation, std = ring_modulations(image, star, inner, outer)
    coarse = (freq < 0.6) & (modulation > 3 * std)
    if np.count_nonzero(coarse) < 3:
        raise NoStarError(
            "the spokes do not stand out of the noise in three rings: the star is too faint, too "
            "small or not where it was found"
        )
    f, m = freq[coarse], modulation[coarse]
    weight = (m / std[coarse]) * np.sqrt(1 / (1 + (f / 0.4) ** 4))
    design = np.stack([np.ones(f.size), -2 * math.pi**2 * f**2], axis=1)
    # The pixel's own fall is taken out, in its mean over the directions.
    own = np.log(m) + 2 * math.pi**2 * f**2 / 12
    fit, *_ = np.linalg.lstsq(design * weight[:, None], own * weight, rcond=None)
    variance = _rounded(float(np.clip(fit[1], 0.02, 4.0)))
    level = math.exp(float(fit[0]))
    if levels is not None:
        level = _amplitude(levels, wave)
    return PlaneBlur(variance, 0.0, variance), level


def _rounded(value: float) -> float:
    return round(value / 0.02) * 0.02


def _moved_blur(blur: PlaneBlur, model: PlaneModel) -> tuple[PlaneBlur, bool]:
    """The mean blur where the data want it, in coarse steps: the regression takes up the rest."""
    level = float(model.beta[0])
    # A wider aperture by w is a Gaussian wider by w / 6: the two share out what they explain.
    change = model.beta[1:4] / level + np.array([model.beta[6], 0.0, model.beta[7]]) / (6 * level)
    xx, xy, yy = np.array([blur.xx, blur.xy, blur.yy]) + np.clip(change, -0.15, 0.15)
    xx, yy = max(float(xx), 0.02), max(float(yy), 0.02)
    limit = 0.9 * math.sqrt(xx * yy)
    moved = PlaneBlur(_rounded(xx), _rounded(float(np.clip(xy, -limit, limit))), _rounded(yy))
    shift = max(abs(moved.xx - blur.xx), abs(moved.xy - blur.xy), abs(moved.yy - blur.yy))
    return (moved, True) if shift > 0.15 * (blur.xx + blur.yy + 1 / 6) else (blur, False)


def _amplitude(levels: Levels, wave: Wave) -> float:
    """Amplitude of the fundamental."""
    return 0.5 * (levels.bright - levels.dark) * (4 / math.pi if wave == "square" else 1.0)


@dataclass(frozen=True, eq=False)
class _Pass:
    posterior: Posterior
    model: PlaneModel
    residual: Floats
    noise: float
    move_px: Floats
    move_std_px: Floats
    turn_rad: float


def _pass(
    pixels: _Pixels,
    star: FoundStar,
    blur: PlaneBlur,
    level: float,
    wave: Wave,
    levels: Levels | None,
    outlier: Floats,
    inflation: float,
    earlier: Posterior | None,
    reach: tuple[float, float],
    noise: float,
) -> _Pass:
    """One regression about a centre; `noise` is that of the last one, 0 before the first."""
    radius, angle = star.polar(pixels.rows.astype(float), pixels.cols.astype(float))
    table = star_table(
        blur, star.cycles, wave, math.floor(reach[0]) - 1.0, math.ceil(reach[1]) + 2.0,
        round(star.rim_px * 4) / 4,
    )  # fmt: skip
    phase = star.cycles * angle + star.alpha_rad
    modes, by_phase = table.columns(radius, phase, angle)
    x, y = radius * np.cos(angle) / star.rim_px, radius * np.sin(angle) / star.rim_px
    ground = np.stack([np.ones(x.size), x, y, x * x, x * y, y * y])
    columns = np.vstack([ground, level * by_phase, modes.T])
    weighted = columns * outlier
    gram = weighted @ columns.T
    projection = weighted @ pixels.value
    data = float((outlier * pixels.value) @ pixels.value)
    count = float(np.sum(outlier))
    states = ProcessModes(blur.width_px)
    first = _GROUND + 1
    prior = _prior(states, first, level, unseen=levels is None)
    variance = _first_variance(pixels.value, gram, projection, data, count, first)
    normal = Normal(gram, projection, data, count)
    if levels is not None:
        variance = noise**2 if noise > 0 else variance
        model = PlaneModel(blur, np.zeros(modes.shape[1]), np.zeros((modes.shape[1], 1)))
        row = np.zeros(columns.shape[0])
        row[first:] = model.at_zero
        std = _amplitude(Levels(0.0, levels.std, 0.0), wave)
        normal = with_level(normal, row, _amplitude(levels, wave), std, variance * inflation)
    posterior = regress(normal, prior, variance, inflation, earlier)
    beta, factor = posterior.beta, posterior.factor
    model = PlaneModel(blur, beta[first:], factor[first:])
    # The modes of the place move the image; the centre moves with it.
    place = slice(first + 4, first + 6)
    return _Pass(
        posterior, model, pixels.value - columns.T @ beta, math.sqrt(posterior.variance),
        beta[place] / level, np.linalg.norm(factor[place], axis=1) / level,
        float(beta[_GROUND]),
    )  # fmt: skip


def _first_variance(
    value: Floats, gram: Floats, projection: Floats, data: float, count: float, first: int
) -> float:
    """Noise variance about the mean blur alone, which is more than the noise."""
    few = first + 6
    fit = np.linalg.lstsq(gram[:few, :few], projection[:few], rcond=1e-10)[0]
    misfit = data - float(fit @ projection[:few])
    return max(misfit / max(count - few, 1.0), 1e-12 * float(np.var(value)))


def _prior(states: ProcessModes, first: int, level: float, *, unseen: bool) -> Prior:
    """Ground, phase and the mean's own modes are free; the apertures are about one pixel."""
    own = states.blocks()
    m = first + MEAN_MODES + own.size
    block = np.full(m, -1)
    block[first + MEAN_MODES :] = own
    scale = np.full(m, 3.0)
    scale[:_GROUND] = 1e3
    scale[_GROUND] = 10.0 / level
    scale[first + 6 : first + 8] = _APERTURE_STD
    amplitude = LOG_AMPLITUDE + UNSEEN if unseen else LOG_AMPLITUDE
    return Prior(
        block, scale, np.zeros(m), amplitude, LOG_AMPLITUDE_STD, level, _NOISE_FLOOR * level
    )


def _reweighted(standard: Floats) -> Floats:
    return outlier_weights(standard / min(robust_scale(standard), 1.0))
