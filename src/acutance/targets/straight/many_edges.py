"""Every usable edge of a target, grouped across and along, with the means and their consistency."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.geometry.angles import direction_difference
from acutance.geometry.line import Line
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.options import chosen_options
from acutance.targets.region import RoiLike, read_region
from acutance.targets.straight.edge import in_whole_image, measure_segment
from acutance.targets.straight.find_edges import find_segments
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.straight_measurement import StraightMeasurement
from acutance.targets.straight.tuned import MIN_CONTRAST_SHARE, MIN_STRENGTH_SHARE
from acutance.targets.target_result import EdgeGroup, Rejected, TargetResult

__all__ = ["combine_edges", "measure_edges"]


@one_thread
def measure_edges(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
) -> TargetResult[StraightMeasurement]:
    """Measure every usable edge of a target: four of a 2 x 2 checkerboard, the sides of a tarp.

    Edges with less than four fifths of the strongest contrast are left out: they are the
    target's border with its surroundings, or not of the target.

    Parameters
    ----------
    image, roi, gsd_m, method, options
        As in `acutance.measure_edge`.

    Returns
    -------
    TargetResult
    """
    region = read_region(image, roi, gsd_m)
    chosen = chosen_options(options, EdgeOptions)
    measured: list[StraightMeasurement] = []
    rejected: list[Rejected] = []
    strongest = 0.0
    for segment in find_segments(region.pixels):
        strongest = max(strongest, segment.strength)
        if segment.strength < MIN_STRENGTH_SHARE * strongest:
            break
        try:
            found = measure_segment(region, segment, method, chosen)
        except TargetError as error:
            where = _where(in_whole_image(segment.line, region))
            rejected.append(Rejected("fit", str(error), where))
            continue
        if not any(_same_edge(found, other) for other in measured):
            measured.append(found)
    kept, dim = _of_the_target(measured)
    return TargetResult(kept, (*rejected, *dim), combine_edges(kept))


def _where(line: Line) -> dict[str, float]:
    return {"row": line.row, "col": line.col, "normal_deg": line.normal_deg}


def _same_edge(one: StraightMeasurement, other: StraightMeasurement) -> bool:
    """Whether two measurements took the same stretch of the same edge."""
    turn_deg = direction_difference(one.line.normal_deg, other.line.normal_deg)
    offset = abs(float(other.line.normal_distance(one.line.row, one.line.col)))
    apart = abs(float(other.line.tangent_distance(one.line.row, one.line.col)))
    reach = 0.5 * min(one.line.length_px, other.line.length_px)
    return turn_deg < 5 and offset < 2 and apart < reach


def _of_the_target(
    measured: Sequence[StraightMeasurement],
) -> tuple[tuple[StraightMeasurement, ...], tuple[Rejected, ...]]:
    """Keep the edges with the target's contrast."""
    heights = [one.bright - one.dark for one in measured]
    least = MIN_CONTRAST_SHARE * max(heights, default=0.0)
    kept = tuple(one for one, height in zip(measured, heights, strict=True) if height >= least)
    dim = tuple(
        Rejected(
            "contrast",
            f"contrast {height:.4g} is less than {MIN_CONTRAST_SHARE:g} of the strongest edge's "
            f"{max(heights):.4g}: probably not of the target",
            _where(one.line),
        )
        for one, height in zip(measured, heights, strict=True)
        if height < least
    )
    return kept, dim


def combine_edges(
    measurements: Sequence[StraightMeasurement],
) -> dict[str, EdgeGroup[StraightMeasurement]]:
    """Group measurements by orientation and average each group."""
    groups: dict[str, EdgeGroup[StraightMeasurement]] = {}
    for orientation in ("across", "along"):
        own = tuple(one for one in measurements if one.orientation == orientation)
        if own:
            groups[orientation] = _group(own)
    return groups


def _group(own: tuple[StraightMeasurement, ...]) -> EdgeGroup[StraightMeasurement]:
    metrics, chi_square, p_value = {}, {}, {}
    for name in own[0].metrics():
        numbers = [one.metrics().get(name, Estimate(math.nan)) for one in own]
        mean, scatter = _weighted_mean(numbers)
        metrics[name] = mean
        chi_square[name] = scatter
        p_value[name] = _chance(scatter, len(own) - 1)
    return EdgeGroup(own[0].orientation, own, metrics, chi_square, p_value, len(own) - 1)


def _weighted_mean(numbers: Sequence[Estimate]) -> tuple[Estimate, float]:
    """Mean weighted by 1 / std^2, and chi-square about it; the Birge ratio widens the std."""
    value = np.array([number.value for number in numbers])
    std = np.array([number.std for number in numbers])
    lowest = numbers[0].lowest
    if not (np.isfinite(value).all() and np.isfinite(std).all() and (std > 0).all()):
        return Estimate(float(np.mean(value)), math.nan, lowest), math.nan
    if len(numbers) > 1 and (value < std).any():
        return Estimate(*_plain_mean(value, std), lowest), math.nan
    weight = 1 / std**2
    mean = float(weight @ value / weight.sum())
    scatter = float(weight @ (value - mean) ** 2)
    freedom = len(numbers) - 1
    widened = max(1.0, math.sqrt(scatter / freedom)) if freedom else 1.0
    return Estimate(mean, widened / math.sqrt(weight.sum()), lowest), scatter


def _plain_mean(value: Floats, std: Floats) -> tuple[float, float]:
    """Mean, and its deviation, of numbers of which some lie at their bound 0; see `EdgeGroup`."""
    scatter = float(np.std(value, ddof=1)) / math.sqrt(value.size)
    return float(np.mean(value)), max(math.sqrt(float(np.mean(std**2))), scatter)


def _chance(chi_square: float, freedom: int) -> float:
    """Chance of a larger chi-square."""
    from scipy.special import gammaincc

    if freedom < 1 or not math.isfinite(chi_square):
        return math.nan
    return float(gammaincc(freedom / 2, chi_square / 2))
