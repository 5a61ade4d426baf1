"""The reference estimator of bars: all groups are one linear model of the transfer function.

Along its normal a group is a finite profile with a known spectrum P(f), so a pixel sees

    ground + contrast * integral P(f) H(f n) exp(2 pi i f s) df

which is linear in H: the modes of `fit.star_modes`, in the directions of the bars' normals. The
widest bars and the group as a whole tell the contrast, the finest ones the highest frequencies;
nothing is taken for an endless wave. Place, period and direction of every group are fitted too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import NoBarsError
from acutance.geometry.bar_group import Bars
from acutance.numerics.marginal_likelihood import Posterior, Prior, regress
from acutance.numerics.noise import Correlation, correlation, outlier_weights, robust_scale
from acutance.numerics.normal_equations import Normal
from acutance.targets.periodic.bars_ends import OtfTable, end_effect, light_of_neighbours
from acutance.targets.periodic.bars_seen import SeenGroup, group_columns
from acutance.targets.periodic.otf_model import PlaneModel
from acutance.targets.periodic.otf_modes import (
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
    MEAN_MODES,
    UNSEEN,
    PlaneBlur,
    ProcessModes,
)
from acutance.targets.periodic.stated_contrast import Levels, with_level

__all__ = ["BarsSolution", "GroupFit", "solve_bars"]

_SIGMA_PX: Final = 0.5
_NOISE_FLOOR: Final = 1e-3
_MAX_PASSES: Final = 16
_PLAIN_PASSES: Final = 6
_APERTURE_STD: Final = 0.18
_SETTLED_PX: Final = 0.005
_PLAIN_PX: Final = 0.05
_SETTLED_END: Final = 2e-4
_KNOWN: Final = 0.3
"""How well the caller knows where a group is, in periods."""
_ROUND: Final = 0.4
_AROUND: Final = 1.0
_OWN: Final = 5
"""Columns every group has for itself: level, slope, place, period, direction."""


@dataclass(frozen=True, eq=False)
class GroupFit:
    """One group of a solved target.

    Attributes
    ----------
    bars : Bars
        Where it is, as it settled.
    place_std_px, period_std_px : float
        Standard deviations of its place along the normal, and of its period.
    rows, cols : (n,) int arrays
        The pixels used.
    across_px, value, residual : (n,) arrays
        Distance along the normal, value, and what the fit leaves of it.
    dark : float
        Level of the ground under the group.
    """

    bars: Bars
    place_std_px: float
    period_std_px: float
    rows: NDArray[np.intp]
    cols: NDArray[np.intp]
    across_px: Floats
    value: Floats
    residual: Floats
    dark: float


@dataclass(frozen=True, eq=False)
class BarsSolution:
    """All groups, solved; the model's level is their common contrast.

    Attributes
    ----------
    model : PlaneModel
    groups : tuple of GroupFit
    noise : float
        Standard deviation of the noise, image units.
    outlier : (n,) array
        Weight of every pixel of all groups, in their order.
    correlation : Correlation
        Of the residuals of neighbouring pixels.
    """

    model: PlaneModel
    groups: tuple[GroupFit, ...]
    noise: float
    outlier: Floats
    correlation: Correlation


def solve_bars(
    image: Floats,
    groups: tuple[Bars, ...],
    *,
    contrast: float,
    levels: Levels | None = None,
    robust: bool = True,
) -> BarsSolution:
    """Solve for transfer function, contrast, ground and the place of every group.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where a pixel is not to be used.
    groups : tuple of Bars
        Where the groups are, to a quarter of their period.
    contrast : float
        First guess of bright less dark; its sign tells which the bars are.
    levels : Levels, optional
        Levels of ground and bars, if something else in the image shows them.
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoBarsError
        If a group has too few pixels, or does not settle near where it was said to be.
    """
    blur = PlaneBlur(_SIGMA_PX**2, 0.0, _SIGMA_PX**2)
    if levels is not None:
        contrast = math.copysign(levels.bright - levels.dark, contrast)
    said, outlier = groups, np.ones(0)
    ends: list[Floats] = []
    whiteness = Correlation(1.0, 0.0, 0.0)
    earlier: Posterior | None = None
    # First a plain blur, until every group is in its place, then the transfer function itself.
    plain = True
    for number in range(_MAX_PASSES):
        seen = [SeenGroup.of(image, bars, place) for place, bars in enumerate(groups, 1)]
        count = sum(one.value.size for one in seen)
        if outlier.size != count:
            outlier, earlier = np.ones(count), None
        if [one.size for one in ends] != [one.value.size for one in seen]:
            ends = [np.zeros(one.value.size) for one in seen]
        solved = _pass(
            seen, said, blur, contrast, outlier, whiteness.inflation, earlier, ends,
            None if plain else levels, plain=plain,
        )  # fmt: skip
        again = _reweighted(solved.residual / solved.noise) if robust and not plain else outlier
        wider, changed = _moved_blur(blur, solved.model, seen) if plain else (blur, False)
        moved = tuple(one.moved(step) for one, step in zip(seen, solved.steps, strict=True))
        longest = max(
            max(abs(step[0]), abs(step[1]) * one.bars.count, abs(step[2]) * one.bars.length_px)
            for one, step in zip(seen, solved.steps, strict=True)
        )
        settled = longest < (_PLAIN_PX if plain else _SETTLED_PX) and not changed
        if not plain:
            whiteness = _whiteness(solved, seen)
            found = _surroundings(solved.model, seen)
            change = max(float(np.max(np.abs(a - b))) for a, b in zip(found, ends, strict=True))
            settled = (
                settled and change < _SETTLED_END and float(np.max(np.abs(again - outlier))) < 0.05
            )
            if settled:
                break
            ends = found
        earlier = None if changed or plain else solved.posterior
        plain = plain and not settled and number < _PLAIN_PASSES
        groups, outlier, blur = moved, again, wider
        contrast = math.copysign(max(abs(solved.model.level), 1e-3 * abs(contrast)), contrast)
    _require_near(said, groups)
    return BarsSolution(solved.model, _fits(seen, solved), solved.noise, outlier, whiteness)


def _whiteness(solved: _Pass, seen: list[SeenGroup]) -> Correlation:
    rows, cols = (np.concatenate([getattr(one, name) for one in seen]) for name in ("rows", "cols"))
    return correlation(np.clip(solved.residual / solved.noise, -4, 4), rows, cols, (0.8, 0.6))


def _surroundings(model: PlaneModel, seen: list[SeenGroup]) -> list[Floats]:
    """What the bars' ends take from every group's pixels, and other groups add, for contrast 1."""
    table = OtfTable.of(model)
    beside = light_of_neighbours(
        table, [one.bars for one in seen], [(one.rows, one.cols) for one in seen]
    )
    return [
        end_effect(table, one.bars, one.across, one.along) + other
        for one, other in zip(seen, beside, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class _Pass:
    posterior: Posterior
    model: PlaneModel
    residual: Floats
    noise: float
    steps: list[Floats]
    steps_std: list[Floats]
    dark: list[float]


def _pass(
    seen: list[SeenGroup],
    said: tuple[Bars, ...],
    blur: PlaneBlur,
    contrast: float,
    outlier: Floats,
    inflation: float,
    earlier: Posterior | None,
    ends: list[Floats],
    levels: Levels | None,
    *,
    plain: bool,
) -> _Pass:
    """One regression with all groups where they are; a `plain` one knows no processes."""
    states = None if plain else ProcessModes(blur.width_px)
    first = _OWN * len(seen) + 1
    m = first + MEAN_MODES + (0 if states is None else states.blocks().size)
    around = contrast * np.concatenate(ends)
    value = np.concatenate([one.value for one in seen]) - around
    design = np.zeros((value.size, m))
    design[:, first - 1] = around
    start = 0
    for number, one in enumerate(seen):
        here = slice(start, start + one.value.size)
        start += one.value.size
        own = slice(_OWN * number, _OWN * (number + 1))
        design[here, first:], design[here, own] = group_columns(one, blur, states, contrast)
    weighted = design * outlier[:, None]
    gram, projection = weighted.T @ design, weighted.T @ value
    data, total = float((outlier * value) @ value), float(np.sum(outlier))
    variance = _first_variance(gram, projection, data, total, first + 4)
    normal = Normal(gram, projection, data, total)
    if levels is not None:
        variance = variance if earlier is None else earlier.variance
        row = np.zeros(m)
        row[first:] = PlaneModel(blur, np.zeros(m - first), np.zeros((m - first, 1))).at_zero
        level = math.copysign(levels.bright - levels.dark, contrast)
        normal = with_level(normal, row, level, levels.std, variance * inflation)
    prior = _prior(blur, states, seen, said, first, contrast, unseen=levels is None)
    posterior = regress(normal, prior, variance, inflation, earlier)
    beta, factor = posterior.beta, posterior.factor
    steps = [beta[_OWN * k + 2 : _OWN * k + 5] for k in range(len(seen))]
    spread = [np.linalg.norm(factor[_OWN * k + 2 : _OWN * k + 5], axis=1) for k in range(len(seen))]
    return _Pass(
        posterior, PlaneModel(blur, beta[first:], factor[first:]), value - design @ beta,
        math.sqrt(posterior.variance), steps, spread,
        [float(beta[_OWN * k]) for k in range(len(seen))],
    )  # fmt: skip


def _first_variance(gram: Floats, projection: Floats, data: float, count: float, few: int) -> float:
    """Noise variance about the mean blur alone, which is more than the noise."""
    fit = np.linalg.lstsq(gram[:few, :few], projection[:few], rcond=1e-10)[0]
    misfit = data - float(fit @ projection[:few])
    return max(misfit / max(count - few, 1.0), 1e-12 * data / max(count, 1.0))


def _prior(
    blur: PlaneBlur,
    states: ProcessModes | None,
    seen: list[SeenGroup],
    said: tuple[Bars, ...],
    first: int,
    contrast: float,
    *,
    unseen: bool,
) -> Prior:
    """Levels are free; places, periods and directions are as they were said, to a part of a period.

    Their columns say how far the groups still have to go from where they are.
    """
    own = np.empty(0, np.intp) if states is None else states.blocks()
    m = first + MEAN_MODES + own.size
    height = abs(contrast)
    block = np.full(m, -1)
    block[first + MEAN_MODES :] = own
    scale, mean = np.full(m, 3.0), np.zeros(m)
    for number, (one, there) in enumerate(zip(seen, said, strict=True)):
        bars = one.bars
        back, _ = bars.across_and_along(np.array([there.row]), np.array([there.col]))
        place = slice(_OWN * number + 2, _OWN * number + 5)
        scale[_OWN * number : _OWN * number + 2] = 1e3
        known = np.array([1.0, 0.5 / bars.count, 1.0 / bars.length_px])
        scale[place] = _KNOWN * there.period_px * known / height
        mean[place] = (
            float(back[0]), there.period_px - bars.period_px,
            math.radians(there.normal_deg - bars.normal_deg),
        )  # fmt: skip
    # What lies around is told by the last pass's model, as far as that is known.
    scale[first - 1] = _AROUND / height
    # A shift of the whole spread function is that of all groups.
    scale[first + 4 : first + 6] = 1e-6
    # Directions without bars are about as sharp as those with.
    scale[first + 1 : first + 4] = _ROUND * (blur.xx + 1 / 12)
    scale[first + 6 : first + 8] = 1e-6 if states is None else _APERTURE_STD
    amplitude = LOG_AMPLITUDE + UNSEEN if unseen else LOG_AMPLITUDE
    floor = _NOISE_FLOOR * height
    return Prior(block, scale, mean, amplitude, LOG_AMPLITUDE_STD, height, floor)


def _moved_blur(
    blur: PlaneBlur, model: PlaneModel, seen: list[SeenGroup]
) -> tuple[PlaneBlur, bool]:
    """The mean blur as wide as the bars see it, and round: few directions cannot tell more."""
    angle = np.radians([one.bars.normal_deg for one in seen])
    cos, sin = np.cos(angle), np.sin(angle)
    xx, xy, yy = model.beta[1:4] / float(model.beta[0])
    change = float(np.mean(xx * cos**2 + 2 * xy * cos * sin + yy * sin**2))
    wanted = max(blur.xx + float(np.clip(change, -0.15, 0.15)), 0.02)
    if abs(wanted - blur.xx) < 0.05 * (blur.xx + 1 / 12):
        return blur, False
    return PlaneBlur(wanted, 0.0, wanted), True


def _reweighted(standard: Floats) -> Floats:
    return outlier_weights(standard / min(robust_scale(standard), 1.0))


def _require_near(said: tuple[Bars, ...], found: tuple[Bars, ...]) -> None:
    """Refuse groups that went elsewhere than where they were said to be."""
    for number, (one, other) in enumerate(zip(said, found, strict=True), 1):
        across, _ = one.across_and_along(np.array([other.row]), np.array([other.col]))
        moved, scale = float(across[0]), other.period_px / one.period_px
        if abs(moved) > 0.75 * one.period_px or abs(scale - 1) > 0.6 / one.count:
            raise NoBarsError(
                f"group {number} was said to have a period of {one.period_px:.2f} px at row "
                f"{one.row:.1f}, column {one.col:.1f}; the pixels would rather have "
                f"{other.period_px:.2f} px, {moved:+.1f} px away: check its place, its number of "
                "bars and its period"
            )


def _fits(seen: list[SeenGroup], solved: _Pass) -> tuple[GroupFit, ...]:
    fits, start = [], 0
    for one, std, dark in zip(seen, solved.steps_std, solved.dark, strict=True):
        residual = solved.residual[start : start + one.value.size]
        start += one.value.size
        place_std, period_std = float(std[0]), float(std[1])
        pixels = (one.rows, one.cols, one.across, one.value)
        fits.append(GroupFit(one.bars, place_std, period_std, *pixels, residual, dark))
    return tuple(fits)
