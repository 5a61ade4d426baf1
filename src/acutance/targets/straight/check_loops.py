"""Loops over the pixels and the curves of a fit, for the checks of straight targets.

Of every pixel, `before` and `behind` are the distances outwards from the target's first and last
step; values and residuals are shares of the contrast. `first` and `step` are those of the regular
grid that a curve is given on.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled, inlined

__all__ = [
    "BLOCK_PX",
    "blocks_of",
    "blotches",
    "border_offsets",
    "change_along",
    "far_side",
    "largest_bump",
    "largest_odd_part",
    "linear_at",
    "mean_std",
    "parts_along",
    "pixels_far",
    "rise_outwards",
    "second_peak",
    "side_upwards",
    "slope_and_bend",
    "standard_squares",
]

BLOCK_PX = 4
"""Side of the blocks of pixels whose means are compared."""


@inlined
def linear_at(values: Floats, first: float, step: float, place: float) -> float:
    """Linear interpolation of a curve at one place; beyond its ends it is level."""
    position = min(max((place - first) / step, 0.0), values.size - 1.0)
    cell = min(int(position), values.size - 2)
    return float(values[cell] + (position - cell) * (values[cell + 1] - values[cell]))


@compiled
def mean_std(value: Floats, before: Floats, behind: Floats, far_px: float) -> float:
    """Mean standard deviation of the two plateaus, of those with more than one pixel."""
    sides, total = 0, 0.0
    for outwards in (before, behind):
        count, mean, power = 0, 0.0, 0.0
        for k in range(value.size):
            there = outwards[k] > far_px
            count += there
            mean += value[k] if there else 0.0
        if count < 2:
            continue
        mean /= count
        for k in range(value.size):
            off = value[k] - mean if outwards[k] > far_px else 0.0
            power += off * off
        sides += 1
        total += math.sqrt(power / count)
    return total / sides if sides else 0.0


@compiled
def standard_squares(
    residual: Floats, fitted: Floats, dark: float, bright: float
) -> tuple[Floats, Floats]:
    """Squared residuals over the variances of the noise, and these, (n,) each.

    The variance rises from that of the dark side to that of the bright one with the fitted image.
    """
    square, variance = np.empty(fitted.size), np.empty(fitted.size)
    for k in range(fitted.size):
        variance[k] = dark + (bright - dark) * min(max(fitted[k], 0.0), 1.0)
        square[k] = residual[k] * residual[k] / variance[k]
    return square, variance


@compiled
def pixels_far(
    residual: Floats, rows: NDArray[np.intp], cols: NDArray[np.intp], before: Floats,
    behind: Floats, far_px: float,
) -> tuple[Floats, NDArray[np.intp], NDArray[np.intp]]:  # fmt: skip
    """Residuals of the plateaus' pixels, each plateau about its own level; rows and columns."""
    left = np.empty(residual.size)
    row, col = np.empty(left.size, np.intp), np.empty(left.size, np.intp)
    n = 0
    for outwards in (before, behind):
        start, total = n, 0.0
        for k in range(residual.size):
            if outwards[k] > far_px:
                left[n], row[n], col[n] = residual[k], rows[k], cols[k]
                total += residual[k]
                n += 1
        for k in range(start, n):
            left[k] -= total / (n - start)
    return left[:n].copy(), row[:n].copy(), col[:n].copy()


@compiled
def parts_along(
    t: Floats, before: Floats, near: NDArray[np.intp], part_px: float, fewest: int, most: int
) -> tuple[NDArray[np.intp], int]:
    """The part of the target's length in which every near pixel lies, and how many there are.

    As many as there are lengths of `part_px` next to the first step, over the whole length.
    """
    first, last = np.min(t), np.max(t)
    low, high = np.inf, -np.inf
    for k in near:
        if abs(before[k]) < 1:
            low, high = min(low, t[k]), max(high, t[k])
    parts = max(fewest, min(most, int(max(high - low, 0.0) // part_px)))
    part = np.empty(near.size, np.intp)
    for i in range(near.size):
        place = (t[near[i]] - first) * (parts / max(last - first, 1e-9))
        part[i] = min(int(place), parts - 1)
    return part, parts


@compiled
def slope_and_bend(
    lsf: Floats, first: float, step: float, before: Floats, near: NDArray[np.intp]
) -> tuple[Floats, Floats]:
    """An LSF and its derivative at every near pixel, (m,) each; no derivative beyond its grid."""
    last = first + step * (lsf.size - 1)
    derivative = (lsf[2:] - lsf[:-2]) / (2 * step)
    slope, bend = np.empty(near.size), np.empty(near.size)
    for i in range(near.size):
        s = -before[near[i]]
        slope[i] = linear_at(lsf, first, step, s)
        inside = first + step <= s <= last - step
        bend[i] = linear_at(derivative, first + step, step, s) if inside else 0.0
    return slope, bend


@compiled
def change_along(
    part: NDArray[np.intp], parts: int, column: Floats, residual: Floats, near: NDArray[np.intp],
    variance: float, sigmas: float,
) -> float:  # fmt: skip
    """Amount of a column in the residuals of the parts of an edge, rms beyond their noise.

    The amounts ``share / power`` are least squares of the near pixels of every part, with variances
    ``variance / power``; parts in which the column is weak do not count. 0 within chance.

    Parameters
    ----------
    part, near : (m,) int arrays
        The part of every near pixel, and its number among all pixels.
    parts : int
    column : (m,) array
    residual : (n,) array
        Of all pixels.
    variance : float
        Of the residuals.
    sigmas : float
        How far the chi square of the amounts may exceed its degrees of freedom by chance.
    """
    power, share = np.zeros(parts), np.zeros(parts)
    for i in range(part.size):
        power[part[i]] += column[i] * column[i]
        share[part[i]] += column[i] * residual[near[i]]
    usable = power > 0.3 * np.sort(power)[parts // 2]
    power, share = power[usable], share[usable]
    freedom = power.size - 1
    if freedom < 1:
        # Pixels lie next to one part of the edge at most.
        return 0.0
    # The mean of all parts belongs to the fit and is no change along the edge.
    mean = np.sum(share) / np.sum(power)
    chi_square, excess = 0.0, 0.0
    for k in range(power.size):
        square, chance = (share[k] / power[k] - mean) ** 2, variance / power[k]
        chi_square += square / max(chance, 1e-18)
        excess += (square - chance) / power.size
    if chi_square <= freedom + sigmas * math.sqrt(2 * freedom):
        return 0.0
    return math.sqrt(max(excess, 0.0))


@compiled
def border_offsets(
    residual: Floats, slope: Floats, near: NDArray[np.intp], before: Floats, behind: Floats,
    far_px: float, steep_share: float,
) -> tuple[int, float, float, float]:  # fmt: skip
    """What a rough border leaves of the pixels where the image is steep.

    Returns
    -------
    count : int
        How many near pixels are steeper than a share of the steepest.
    power : float
        Their mean square residual.
    noise : float
        That of the noisier plateau.
    steepness : float
        Mean square slope of the steep pixels.
    """
    steepest, noise = 0.0, 0.0
    for one in slope:
        steepest = max(steepest, abs(one))
    count, power, steepness = 0, 0.0, 0.0
    for i in range(near.size):
        if abs(slope[i]) > steep_share * steepest:
            count += 1
            power += residual[near[i]] * residual[near[i]]
            steepness += slope[i] * slope[i]
    for outwards in (before, behind):
        pixels, total = 0, 0.0
        for k in range(residual.size):
            there = outwards[k] > far_px
            pixels += there
            total += residual[k] * residual[k] if there else 0.0
        noise = max(noise, total / max(pixels, 1))
    return count, power / max(count, 1), noise, steepness / max(count, 1)


@compiled
def far_side(outwards: Floats, value: Floats, from_px: float) -> tuple[Floats, Floats]:
    """Distances and values of the pixels that lie further outwards than `from_px`, (m,) each."""
    far = np.empty((2, outwards.size))
    n = 0
    for k in range(outwards.size):
        if outwards[k] > from_px:
            far[0, n], far[1, n] = outwards[k], value[k]
            n += 1
    return far[0, :n].copy(), far[1, :n].copy()


@compiled
def rise_outwards(
    outwards: Floats, value: Floats, middle: float, most: float
) -> tuple[float, float, float]:
    """Mean distance of some pixels, its spread, and their values' along it.

    Values count from `middle` on, by no more than `most`.
    """
    mean_px, power, rise = float(np.mean(outwards)), 0.0, 0.0
    for k in range(outwards.size):
        offset = outwards[k] - mean_px
        power += offset * offset
        rise += offset * min(max(value[k] - middle, -most), most)
    return mean_px, power, rise


@compiled
def side_upwards(values: Floats, middle: float, outwards: Floats, from_px: float) -> Floats:
    """Values of the pixels of a side, negated where they lie below the middle on average; (m,).

    Of the pixels that lie further outwards than `from_px`.
    """
    found, n, above = np.empty(values.size), 0, 0.0
    for k in range(values.size):
        if outwards[k] > from_px:
            found[n] = values[k]
            above += values[k] - middle
            n += 1
    return found[:n].copy() if above > 0 else -found[:n]


@compiled
def blocks_of(rows: NDArray[np.intp], cols: NDArray[np.intp]) -> NDArray[np.intp]:
    """The block of 4 x 4 pixels in which every pixel lies, (n,)."""
    across = np.max(cols) // BLOCK_PX + 1
    found = np.empty(rows.size, np.intp)
    for k in range(rows.size):
        found[k] = rows[k] // BLOCK_PX * across + cols[k] // BLOCK_PX
    return found


@compiled
def blotches(
    block: NDArray[np.intp], field: Floats, outwards: Floats, from_px: float, smoothness: float
) -> float:
    """Standard deviation of means over blocks of pixels, without the share of noise.

    Of the pixels that lie further outwards than `from_px`. Means over n pixels of noise whose power
    is `smoothness` times that of white noise have that many n-ths of its variance, and the pixels
    of a block scatter about their mean by the rest.
    """
    size = np.max(block) + 1
    count, total, power = np.zeros(size), np.zeros(size), np.zeros(size)
    pixels, level = 0, 0.0
    for k in range(block.size):
        if outwards[k] > from_px:
            pixels += 1
            level += field[k]
    level /= max(pixels, 1)
    for k in range(block.size):
        if outwards[k] > from_px:
            value = field[k] - level
            count[block[k]] += 1
            total[block[k]] += value
            power[block[k]] += value * value
    full = count >= BLOCK_PX**2 // 2
    count, total, power = count[full], total[full], power[full]
    if count.size < 3:
        return 0.0
    mean = total / count
    shared = np.minimum(smoothness, 0.5 * count)
    noise = np.sum(power - count * mean * mean) / max(np.sum(count - shared), 1)
    excess = np.var(mean) * mean.size / (mean.size - 1) - noise * np.mean(shared / count)
    return math.sqrt(max(excess, 0.0))


@compiled
def largest_bump(
    distance: Floats, curve: Floats, std: Floats, from_px: float, to_px: float
) -> float:
    """How far a curve goes up and down on either side, beyond two of its usual deviations.

    Between two distances from 0; half of its way is one bump.
    """
    worst = 0.0
    for direction in (-1.0, 1.0):
        there = (direction * distance > from_px) & (direction * distance < to_px)
        side, usual = curve[there], np.sort(std[there])
        if side.size < 2:
            continue
        way = 0.0
        for k in range(1, side.size):
            way += abs(side[k] - side[k - 1])
        detour = way - abs(side[-1] - side[0])
        worst = max(worst, 0.5 * detour - 2.0 * usual[usual.size // 2])
    return worst


@compiled
def second_peak(curve: Floats) -> float:
    """Height of the highest other peak of a curve over the lowest place before it.

    Relative to the first; what lies below 0 is no valley.
    """
    top = int(np.argmax(curve))
    highest, worst = curve[top], 0.0
    for direction in (-1, 1):
        valley, place = highest, top
        while 0 <= place < curve.size:
            valley = min(valley, curve[place])
            worst = max(worst, curve[place] - max(valley, 0.0))
            place += direction
    return float(worst / highest)


@compiled
def largest_odd_part(
    esf: Floats, first: float, step: float, middles_px: Floats, apart_px: Floats
) -> float:
    """Largest odd part of an ESF about that one of some middles where it is smallest."""
    least, largest = np.inf, 0.0
    for middle in middles_px:
        power, most = 0.0, 0.0
        for apart in apart_px:
            odd = linear_at(esf, first, step, middle + apart) - 1
            odd += linear_at(esf, first, step, middle - apart)
            power += odd * odd
            most = max(most, abs(odd))
        if power < least:
            least, largest = power, most
    return float(largest)
