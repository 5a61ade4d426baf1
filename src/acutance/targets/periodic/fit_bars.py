"""The reference estimator of bars: all groups are one linear model of the transfer function (OTF).

Along its normal a group is a finite profile with a known spectrum P(f), so a pixel has the value

    background + contrast * integral P(f) H(f n) exp(2 pi i f s) df

which is linear in H: the modes of `otf_modes`, in the directions of the bars' normals. The widest
bars and the group as a whole determine the contrast, the finest ones the highest frequencies;
no group is taken for an endless wave. Place, period and direction of every group are fitted too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from acutance.curves import Estimate
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.geometry.bar_group import Bars
from acutance.numerics.combined_prior import CombinedPrior
from acutance.numerics.marginal_likelihood import Posterior
from acutance.numerics.noise import Correlation, correlation, rounding_std
from acutance.numerics.otf_modes import MeanOtf, ProcessModes
from acutance.targets.periodic.bars_ends import EndEffect, end_effects
from acutance.targets.periodic.bars_neighbours import CoarseModes, light_of_neighbours
from acutance.targets.periodic.bars_pixels import SIDE_PX, GroupPixels, group_columns
from acutance.targets.periodic.curvature import find_curvature
from acutance.targets.periodic.oblique_blur import aligned_or_turned
from acutance.targets.periodic.otf_model import FittedOtf, level_row, mode_count
from acutance.targets.periodic.otf_regression import (
    FREE_STD,
    PosedPixels,
    Regression,
    mean_variance,
    otf_prior,
    reweighted,
)
from acutance.targets.periodic.stated_contrast import Levels, StatedContrast, with_level
from acutance.targets.periodic.tuned import (
    APERTURE_STD,
    NEIGHBOURS_STD,
    NOISE_FLOOR,
    PLACE_STD_PERIODS,
    ROUNDNESS_STD,
)
from acutance.targets.periodic.uneven_contrast import uneven_groups

__all__ = ["BarsSolution", "solve_bars"]

_SIGMA_PX: Final = 0.5
_MAX_PLACE_PASSES: Final = 7
_MAX_PASSES: Final = 14
_PLACED_PX: Final = 0.05
_SETTLED_PX: Final = 0.005
_SETTLED_LIGHT: Final = 2e-4
_SETTLED_WEIGHT: Final = 0.05
_FIXED: Final = 1e-6
"""Prior standard deviation of coefficients that are not fitted."""
_BACKGROUND_STD: Final = 1e3
_OWN: Final = 5
"""Columns every group has for itself: level, slope, place, period, direction."""


@dataclass(frozen=True, eq=False)
class BarsSolution:
    """All groups, solved; the OTF's level is their common contrast.

    Attributes
    ----------
    otf : FittedOtf
    groups : tuple of GroupPixels
        The pixels of every group where it settled.
    residuals : tuple of (n,) arrays
        Their residuals, image units.
    backgrounds : tuple of float
        Background level of every group.
    period_std_px : tuple of float
        Standard deviations of their periods.
    noise : float
        Standard deviation of the noise, image units.
    correlation : Correlation
        Of the residuals of neighbouring pixels.
    stated : StatedContrast or None
        The stated levels, if there are any.
    curvature : Estimate
        Of the characteristic of the values.
    uneven : tuple of Estimate
        How much more contrast every group has than the others, as a share.
    """

    otf: FittedOtf
    groups: tuple[GroupPixels, ...]
    residuals: tuple[Floats, ...]
    backgrounds: tuple[float, ...]
    period_std_px: tuple[float, ...]
    noise: float
    correlation: Correlation
    stated: StatedContrast | None
    curvature: Estimate
    uneven: tuple[Estimate, ...]

    @property
    def snr(self) -> float:
        """Contrast over noise."""
        return abs(self.otf.level) / self.noise if self.noise > 0 else math.inf


def solve_bars(
    image: Floats,
    groups: tuple[Bars, ...],
    *,
    contrast: float,
    levels: Levels | None = None,
    robust: bool = True,
) -> BarsSolution:
    """Solve for transfer function, contrast, background and the place of every group.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel is not to be used.
    groups : tuple of Bars
        Where the groups are, to a quarter of their period.
    contrast : float
        First guess of bright minus dark; negative for dark bars.
    levels : Levels, optional
        Levels of background and bars, if something else in the image shows them.
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoBarsError
        If a group has too few pixels.
    """
    if levels is not None:
        contrast = math.copysign(levels.bright - levels.dark, contrast)
    # The prior of a background is one of contrasts, and their squares are to be told from noise.
    base = float(np.nanmedian(image))
    above = image - base
    mean, placed, contrast = _place_groups(above, groups, contrast)
    solved = _fit_otf(above, groups, placed, mean, contrast, levels, robust=robust)
    return replace(
        solved,
        groups=tuple(replace(one, value=image[one.rows, one.cols]) for one in solved.groups),
        backgrounds=tuple(base + one for one in solved.backgrounds),
    )


def _place_groups(
    image: Floats, stated: tuple[Bars, ...], contrast: float
) -> tuple[MeanOtf, tuple[Bars, ...], float]:
    """A Gaussian through a pixel, every group in its place, and the contrast.

    No least squares of fixed data: a group that moves takes in other pixels, and a mean that is
    widened has other modes.
    """
    mean, groups = MeanOtf(_SIGMA_PX**2, 0.0, _SIGMA_PX**2), stated
    for _ in range(_MAX_PLACE_PASSES):
        pixels = _pixels_of(image, groups)
        nothing = [np.zeros(one.value.size) for one in pixels]
        posed = _posed(pixels, mean, None, contrast, np.ones(sum(map(np.size, nothing))), nothing)
        fitted = _regression(posed, pixels, stated, mean, None, contrast)
        wider = _width_of_bars(mean, fitted.otf, pixels)
        settled = wider == mean and _longest_update(fitted, pixels) < _PLACED_PX
        groups = tuple(one.moved(_own(fitted, k)[0][2:]) for k, one in enumerate(pixels))
        mean, contrast = wider, _same_sign(fitted.otf.level, contrast)
        if settled:
            break
    return mean, groups, contrast


def _fit_otf(
    image: Floats,
    stated: tuple[Bars, ...],
    groups: tuple[Bars, ...],
    mean: MeanOtf,
    contrast: float,
    levels: Levels | None,
    *,
    robust: bool,
) -> BarsSolution:
    """The transfer function itself, with what bars' ends and neighbours do to the pixels.

    No least squares of fixed weights: every pass finds the prior's amplitudes by the marginal
    likelihood, and the weights and the correlation of the noise from what it leaves.
    """
    states = ProcessModes(mean.width_px)
    coarse = CoarseModes.of(mean, states)
    bars_ends = end_effects(mean, states, groups, SIDE_PX)
    before = _pixels_of(image, groups)
    rounding = rounding_std(image[np.isfinite(image)])
    weights = [np.ones(one.value.size) for one in before]
    all_light = [np.zeros(one.value.size) for one in before]
    noise_found = Correlation(1.0, 0.0, 0.0)
    earlier: Posterior | None = None
    for _ in range(_MAX_PASSES):
        pixels = _pixels_of(image, groups)
        ends = np.cumsum([one.value.size for one in pixels])[:-1]
        weight = np.concatenate(_taken_over(pixels, before, weights, 1.0))
        light = _taken_over(pixels, before, all_light, 0.0)
        posed = _posed(pixels, mean, states, contrast, weight, light, bars_ends)
        fitted = _regression(
            posed, pixels, stated, mean, states, contrast, levels, noise_found.inflation, earlier
        )
        standard = fitted.residual / fitted.noise
        again = reweighted(standard, rounding / fitted.noise) if robust else weight
        noise_found = _correlation(standard, pixels)
        found = light_of_neighbours(coarse, fitted.otf, pixels)
        change = max(float(np.max(np.abs(a - b))) for a, b in zip(found, light, strict=True))
        if (
            _longest_update(fitted, pixels) < _SETTLED_PX
            and change < _SETTLED_LIGHT
            and float(np.max(np.abs(again - weight))) < _SETTLED_WEIGHT
        ):
            break
        groups = tuple(one.moved(_own(fitted, k)[0][2:]) for k, one in enumerate(pixels))
        before, weights, all_light = pixels, np.split(again, ends), found
        earlier = fitted.posterior
        contrast = _same_sign(fitted.otf.level, contrast)
    seen = None
    if levels is not None:
        free = _regression(
            posed, pixels, stated, mean, states, contrast, inflation=noise_found.inflation
        ).otf
        seen = StatedContrast(levels, Estimate(abs(free.level), free.level_std))
    own = [_own(fitted, number) for number in range(len(pixels))]
    first = _OWN * len(pixels)
    modes = slice(first, None)
    bars = contrast * np.concatenate(light)
    bars += fitted.design[:, modes] @ fitted.posterior.beta[modes]
    return BarsSolution(
        otf=aligned_or_turned(fitted.otf, float(fitted.posterior.prior_std[first + 3])),
        groups=pixels,
        residuals=tuple(np.split(fitted.residual, ends)),
        backgrounds=tuple(float(value[0]) for value, _ in own),
        period_std_px=tuple(float(std[3]) for _, std in own),
        noise=fitted.noise,
        correlation=noise_found,
        stated=seen,
        curvature=find_curvature(fitted, bars, fitted.otf.level, weight, noise_found.inflation),
        uneven=uneven_groups(fitted, bars, ends, weight, noise_found.inflation),
    )


def _own(fitted: Regression, number: int) -> tuple[Floats, Floats]:
    """A group's own coefficients and their standard deviations, (5,) each."""
    own = slice(_OWN * number, _OWN * (number + 1))
    return fitted.posterior.beta[own], np.linalg.norm(fitted.posterior.factor[own], axis=1)


def _pixels_of(image: Floats, groups: tuple[Bars, ...]) -> tuple[GroupPixels, ...]:
    return tuple(GroupPixels.of(image, bars, number) for number, bars in enumerate(groups, 1))


def _taken_over(
    pixels: tuple[GroupPixels, ...],
    before: tuple[GroupPixels, ...],
    values: Sequence[Floats],
    new: float,
) -> list[Floats]:
    """Values of every group's pixels, after it has moved; of those it takes in `new`."""
    return [
        one.taken_over(was, own, new) for one, was, own in zip(pixels, before, values, strict=True)
    ]


def _same_sign(level: float, contrast: float) -> float:
    """The fitted contrast with the sign, and at least a thousandth, of the one before."""
    return math.copysign(max(abs(level), 1e-3 * abs(contrast)), contrast)


def _posed(
    pixels: tuple[GroupPixels, ...],
    mean: MeanOtf,
    states: ProcessModes | None,
    contrast: float,
    weight: Floats,
    light: list[Floats],
    bars_ends: Sequence[EndEffect] = (),
) -> PosedPixels:
    """All groups where they are taken to be, in one linear model; without `states` the mean's."""
    around = contrast * np.concatenate(light)
    design = _design(pixels, mean, states, contrast, around, bars_ends)
    return PosedPixels.of(design, np.concatenate([one.value for one in pixels]) - around, weight)


def _regression(
    posed: PosedPixels,
    pixels: tuple[GroupPixels, ...],
    stated: tuple[Bars, ...],
    mean: MeanOtf,
    states: ProcessModes | None,
    contrast: float,
    levels: Levels | None = None,
    inflation: float = 1.0,
    earlier: Posterior | None = None,
) -> Regression:
    """One regression of all groups."""
    first, normal = _OWN * len(pixels) + 1, posed.normal
    variance = mean_variance(normal, first + 4)
    if levels is not None:
        variance = variance if earlier is None else earlier.variance
        row = np.zeros(normal.projection.size)
        row[first:] = level_row(row.size - first)
        level = math.copysign(levels.bright - levels.dark, contrast)
        normal = with_level(normal, row, level, levels.std, variance * inflation)
    prior = _prior(pixels, stated, mean, states, contrast, level_stated=levels is not None)
    posterior = prior.posterior(normal, variance, inflation, earlier=earlier)
    otf = FittedOtf(mean, posterior.beta[first:], posterior.factor[first:])
    return Regression(posterior, otf, posed.residual(posterior), posed.design)


def _design(
    pixels: tuple[GroupPixels, ...],
    mean: MeanOtf,
    states: ProcessModes | None,
    contrast: float,
    around: Floats,
    bars_ends: Sequence[EndEffect],
) -> Floats:
    """Columns of all pixels, (n, m): every group's own, the light around them, the modes."""
    first = _OWN * len(pixels) + 1
    design = np.zeros((around.size, first + mode_count(states)))
    design[:, first - 1] = around
    start = 0
    for number, one in enumerate(pixels):
        here = slice(start, start + one.value.size)
        own = slice(_OWN * number, _OWN * (number + 1))
        design[here, first:], design[here, own] = group_columns(one, mean, states, contrast)
        if states is not None:
            design[here, first:] += bars_ends[number].columns(one.across, one.along)
        start += one.value.size
    return design


def _prior(
    pixels: tuple[GroupPixels, ...],
    stated: tuple[Bars, ...],
    mean: MeanOtf,
    states: ProcessModes | None,
    contrast: float,
    *,
    level_stated: bool,
) -> CombinedPrior:
    """Levels are free; places, periods and directions are those stated, to a part of a period.

    Their coefficients are the distances from the current to the fitted groups.
    """
    height = abs(contrast)
    scales, means = [], []
    for one, there in zip(pixels, stated, strict=True):
        bars = one.bars
        back, _ = bars.across_and_along(np.array([there.row]), np.array([there.col]))
        known = np.array([1.0, 0.5 / bars.count, 1.0 / bars.length_px])
        place_std = PLACE_STD_PERIODS * there.period_px * known / height
        scales.append([_BACKGROUND_STD, _BACKGROUND_STD, *place_std])
        turn = math.radians(there.normal_deg - bars.normal_deg)
        means.append([0.0, 0.0, float(back[0]), there.period_px - bars.period_px, turn])
    # Directions without bars are about as sharp as those with; a shift of the spread function is
    # that of all groups.
    aperture = _FIXED if states is None else APERTURE_STD
    mean_scale = np.repeat(
        [FREE_STD, ROUNDNESS_STD * (mean.xx + 1 / 12), _FIXED, aperture], [1, 3, 2, 2]
    )
    own_scale = np.append(np.concatenate(scales), NEIGHBOURS_STD / height)
    return otf_prior(
        own_scale, np.concatenate(means), mean_scale, states, height, NOISE_FLOOR,
        level_stated=level_stated,
    )  # fmt: skip


def _longest_update(fitted: Regression, pixels: tuple[GroupPixels, ...]) -> float:
    """How far the regression moves the pixels of a group at most, px."""
    return max(
        float(np.max(np.abs(_own(fitted, k)[0][2:] * [1.0, one.bars.count, one.bars.length_px])))
        for k, one in enumerate(pixels)
    )


def _width_of_bars(mean: MeanOtf, fitted: FittedOtf, pixels: tuple[GroupPixels, ...]) -> MeanOtf:
    """The mean with the width of the bars, and round: few directions determine no more."""
    cos, sin = unit_vector(np.array([one.bars.normal_deg for one in pixels]))
    xx, xy, yy = fitted.beta[1:4] / float(fitted.beta[0])
    change = float(np.mean(xx * cos**2 + 2 * xy * cos * sin + yy * sin**2))
    wanted = max(mean.xx + float(np.clip(change, -0.15, 0.15)), 0.02)
    if abs(wanted - mean.xx) < 0.05 * (mean.xx + 1 / 12):
        return mean
    return MeanOtf(wanted, 0.0, wanted)


def _correlation(standard: Floats, pixels: tuple[GroupPixels, ...]) -> Correlation:
    rows = np.concatenate([one.rows for one in pixels])
    cols = np.concatenate([one.cols for one in pixels])
    return correlation(np.clip(standard, -4, 4), rows, cols)
