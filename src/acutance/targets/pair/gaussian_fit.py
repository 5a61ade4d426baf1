"""The parametric fit of a pair: shift, gaussian, gain and offset, by least squares on the pixels.

This is the procedure of Li et al., "On-orbit MTF estimation methods", 5.3: blur the high image
with a first kernel, sample it at the low pixels, compare, change the kernel, and stop when the
residual's relative change falls below a threshold that the user sets.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.noise import robust_scale
from acutance.targets.pair.axis_gaussian import MAX_VARIANCE_PX2, MIN_VARIANCE_PX2, AxisGaussian
from acutance.targets.pair.tile import TapGrid, Tiles, core, filtered

__all__ = ["GaussianFit", "GaussianStep", "fit_gaussian"]

_MAX_SHIFT_UPDATE_PX = 0.6
_MAX_VARIANCE_UPDATE_PX2 = 0.25
_MIN_PIXELS = 60
_MOST_SCALES = 1e9


@dataclass(frozen=True)
class GaussianStep:
    """One iteration of the parametric fit.

    Parameters
    ----------
    residual : float
        Root mean square of the residual, outliers bounded, in units of the low image.
    change : float
        Its relative change against the iteration before.
    shift_px : (float, float)
    variance_px2 : (float, float)
        Shift and variance along (rows, columns), in low pixels.
    """

    residual: float
    change: float
    shift_px: tuple[float, float]
    variance_px2: tuple[float, float]


@dataclass(frozen=True, eq=False)
class GaussianFit:
    """The parametric kernel, and how it was found.

    Parameters
    ----------
    down, across : AxisGaussian
    gain, offset : float
        Of the low image against the blurred high one.
    noise : float
        Robust standard deviation of the residuals.
    signal : float
        Standard deviation of the blurred high image about the means of tiles, times the gain.
    correlation : float
        Between the low image and the blurred high one, local means left out.
    steps : sequence of GaussianStep
        The iterations.
    """

    down: AxisGaussian
    across: AxisGaussian
    gain: float
    offset: float
    noise: float
    signal: float
    correlation: float
    steps: Sequence[GaussianStep]


@dataclass(frozen=True, eq=False)
class _Sums:
    """Weighted sums over the pixels for the five unknowns, and robust statistics."""

    gram: Floats
    projection: Floats
    residual: float
    noise: float
    offset: float
    signal: float
    correlation: float


def fit_gaussian(
    tiles: Tiles,
    grid: TapGrid,
    down: AxisGaussian,
    across: AxisGaussian,
    *,
    stop_change: float = 1e-4,
    max_steps: int = 30,
    robust: bool = True,
) -> GaussianFit:
    """Fit shift and blur along both axes, gain and offset.

    No least squares of fixed weights: every iteration weighs the pixels by the noise of the one
    before, and sums them tile by tile, as residuals of a whole scene are too many to be kept.

    Parameters
    ----------
    tiles : Tiles
    grid : TapGrid
    down, across : AxisGaussian
        Where to start: the shifts have to be right to a pixel.
    stop_change : float, optional
        Relative change of the residual at which the iteration ends.
    max_steps : int, optional
    robust : bool, optional
        Bound the weight of pixels that fit badly.

    Raises
    ------
    TargetError
        If the two images have nothing in common.
    """
    gain, offset, noise = _first_guess(tiles, grid, down, across)
    steps: list[GaussianStep] = []
    before = np.inf
    while True:
        sums = _accumulate(tiles, grid, down, across, (gain, offset, noise), robust)
        change = abs(before - sums.residual) / sums.residual if sums.residual > 0 else 0.0
        shifts = (down.shift_px, across.shift_px)
        variances = (down.variance_px2, across.variance_px2)
        steps.append(GaussianStep(sums.residual, change, shifts, variances))
        before, noise, offset = sums.residual, sums.noise, sums.offset
        if change < stop_change or len(steps) > max_steps:
            break
        update = np.linalg.lstsq(sums.gram, sums.projection, rcond=1e-10)[0]
        gain += float(update[0])
        if gain == 0.0:
            break
        down = _updated(down, *(update[[1, 3]] / gain).tolist())
        across = _updated(across, *(update[[2, 4]] / gain).tolist())
    return GaussianFit(
        down, across, gain, offset, noise, abs(gain) * sums.signal, sums.correlation,
        tuple(steps),
    )  # fmt: skip


def _updated(axis: AxisGaussian, shift: float, variance: float) -> AxisGaussian:
    """A Gaussian after a step of the iteration, which is bounded."""
    by_shift = float(np.clip(shift, -_MAX_SHIFT_UPDATE_PX, _MAX_SHIFT_UPDATE_PX))
    by_variance = float(np.clip(variance, -_MAX_VARIANCE_UPDATE_PX2, _MAX_VARIANCE_UPDATE_PX2))
    bounded = np.clip(axis.variance_px2 + by_variance, MIN_VARIANCE_PX2, MAX_VARIANCE_PX2)
    return AxisGaussian(axis.shift_px + by_shift, float(bounded))


def _first_guess(
    tiles: Tiles, grid: TapGrid, down: AxisGaussian, across: AxisGaussian
) -> tuple[float, float, float]:
    """Gain, offset and noise as the median tile has them: a cloud spoils few tiles."""
    gains, offsets, powers, count = [], [], [], 0
    for tile in tiles():
        model = filtered(tile, grid, down.taps(grid.down)[:, :1], across.taps(grid.across)[:, :1])
        for y, m in _blocks(core(tile.low), core(model[:, :, 0, 0])):
            own = float(m @ m)
            if own > 0:
                gains.append(float(m @ y[0]) / own)
                powers.append(own)
                offsets.append(y[1] - gains[-1] * y[2])
        count += int(np.isfinite(core(tile.low)).sum())
    if not gains or count < _MIN_PIXELS:
        raise TargetError(
            f"{count} low pixels have both images around them and structure to compare, at least "
            f"{_MIN_PIXELS} are needed: choose a larger region, or one with less nodata"
        )
    heavy = np.array(powers) >= np.median(powers)
    gain = float(np.median(np.array(gains)[heavy]))
    return gain, float(np.median(np.array(offsets)[heavy])), 0.0


def _blocks(low: Floats, model: Floats) -> list[tuple[tuple[Floats, float, float], Floats]]:
    """Blocks of 8 by 8 pixels: low values about their mean, both means, model about its mean."""
    found = []
    for i in range(0, low.shape[0], 8):
        for j in range(0, low.shape[1], 8):
            y, m = low[i : i + 8, j : j + 8], model[i : i + 8, j : j + 8]
            usable = np.isfinite(y)
            if usable.sum() >= 16:
                y, m = y[usable], m[usable]
                found.append(((y - y.mean(), float(y.mean()), float(m.mean())), m - m.mean()))
    return found


def _accumulate(
    tiles: Tiles,
    grid: TapGrid,
    down: AxisGaussian,
    across: AxisGaussian,
    level: tuple[float, float, float],
    robust: bool,
) -> _Sums:
    gain, offset, noise = level
    gram, projection = np.zeros((5, 5)), np.zeros(5)
    power = weights = level_error = low_power = model_power = product = 0.0
    residuals: list[Floats] = []
    for tile in tiles():
        field = filtered(tile, grid, down.taps(grid.down)[:, :3], across.taps(grid.across)[:, :3])
        low, columns = core(tile.low), core(field)
        usable = np.isfinite(low)
        if usable.sum() < 8:
            continue
        y = low[usable]
        five = np.stack(
            [columns[usable][:, i, j] for i, j in ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2))], axis=1
        )
        rest = y - gain * five[:, 0] - offset
        weight = _weights(rest - np.median(rest), noise) if robust else np.ones(y.size)
        total = float(weight.sum())
        centred = five - weight @ five / total
        rest_centred = rest - weight @ rest / total
        pulled = centred * weight[:, None]
        gram += pulled.T @ centred
        projection += pulled.T @ rest_centred
        power += float(weight @ rest_centred**2)
        level_error += float(weight @ rest)
        weights += total
        y_centred = y - weight @ y / total
        low_power += float(weight @ y_centred**2)
        model_power += float(weight @ centred[:, 0] ** 2)
        product += float(weight @ (y_centred * centred[:, 0]))
        residuals.append(rest_centred)
    scale = robust_scale(np.concatenate(residuals))
    return _Sums(
        gram,
        projection,
        float(np.sqrt(power / weights)),
        scale,
        offset + level_error / weights,
        float(np.sqrt(model_power / weights)),
        product / float(np.sqrt(low_power * model_power)) if low_power * model_power > 0 else 0.0,
    )


def _weights(residual: Floats, noise: float) -> Floats:
    """Cauchy weights about four standard deviations; before a noise is known, about the median."""
    scale = noise if noise > 0 else robust_scale(residual)
    if not scale > 0:
        return np.ones(residual.size)
    # Where most residuals are next to nothing, the square of the others would overflow.
    return 1 / (1 + np.minimum(np.abs(residual) / (4 * scale), _MOST_SCALES) ** 2)
