"""Many edges: every usable one of a target, grouped across and along, or those of given regions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import Any, Final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.errors import OptionError, TargetError
from acutance.geometry.angles import direction_difference
from acutance.geometry.line import Line
from acutance.numerics.one_thread import one_thread
from acutance.raster import Gsd, Image
from acutance.targets.in_turn import ImageRegions, are_many, in_turn
from acutance.targets.options import chosen_options
from acutance.targets.record import Record
from acutance.targets.region import RegionPixels, RoiLike, read_region
from acutance.targets.straight.edge import (
    edge_steps,
    in_whole_image,
    measure_segment,
    require_method,
)
from acutance.targets.straight.find_edges import find_segments
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.straight_measurement import StraightMeasurement
from acutance.targets.straight.tuned import MIN_CONTRAST_SHARE, MIN_STRENGTH_SHARE
from acutance.targets.target_result import EdgeGroup, Rejected, TargetResult
from acutance.targets.uncertainty_budget import (
    least_systematic_share,
    std_of_mean,
    systematic_share,
)

__all__ = ["combine_edges", "each_edge", "measure_edges"]

_BORDER_PX: Final = 1.5
_MAX_SHARED: Final = 0.05
"""Share of a border's pixels beyond which two edges are not counted as two."""
_SHARED_WORDS: Final = (
    "{:.0f} % of its border is that of an edge that was measured before: its line runs over two "
    "objects; choose a region with one of them (measure_edge, without --all)"
)


# An array of corners can be iterated over, too; it is one region.
@overload
def measure_edges(  # type: ignore[overload-overlap]
    image: Image | ArrayLike | ImageRegions,
    roi: Iterable[RoiLike],
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
    workers: int = 1,
) -> tuple[Record | Rejected, ...]: ...
@overload
def measure_edges(
    image: list[tuple[Image, RoiLike]],
    roi: None = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
    workers: int = 1,
) -> tuple[Record | Rejected, ...]: ...
@overload
def measure_edges(
    image: Image | ArrayLike,
    roi: RoiLike = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
) -> TargetResult[StraightMeasurement]: ...
def measure_edges(
    image: Any,
    roi: Any = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
    workers: int = 1,
) -> TargetResult[StraightMeasurement] | tuple[Record | Rejected, ...]:
    """Measure many edges: all of one target, or the one of each of many given regions.

    Of one region every usable edge is measured: four of a 2 x 2 checkerboard, the sides of a tarp.
    Edges with less than four fifths of the strongest contrast are left out: they are the target's
    border with its surroundings, or not of the target; `acutance.scan_scene` measures edges of
    every contrast.

    Of a list of regions the strongest edge of each is measured, as `acutance.measure_edge` does.
    `acutance.each_edge` gives the same results one by one.

    Parameters
    ----------
    image : Image, (rows, cols) array_like, or list of pairs
        One image; or a list of pairs (image, region) of several.
    roi : region, or list of regions
        As in `acutance.measure_edge`.
    gsd_m, method, options
        As in `acutance.measure_edge`.
    workers : int, optional
        Of many regions: processes that measure them, see `acutance.each_edge`.

    Returns
    -------
    TargetResult or tuple of Record and Rejected
        Of many regions a `Record` for each, with all numbers, deviations, checks and the verdict,
        in their order; a region that cannot be measured is a `Rejected` in its place.

    Examples
    --------
    >>> regions = [(120, 340, 40, 40), (500, 812, 60, 60)]
    >>> for found in ac.measure_edges(image, regions, workers=2):  # doctest: +SKIP
    ...     print(found.summary() if isinstance(found, ac.Record) else found.reason)
    """
    if are_many(image, roi):
        return tuple(
            each_edge(image, roi, gsd_m=gsd_m, method=method, options=options, workers=workers)
        )
    if workers != 1:
        raise OptionError(
            f"workers is {workers}, and one region is measured in this process: leave it out, or "
            "give a list of regions"
        )
    return _edges_of_target(read_region(image, roi, gsd_m), method, options)


def each_edge(
    image: Image | ArrayLike | ImageRegions,
    regions: Iterable[RoiLike] | None = None,
    *,
    gsd_m: float | Gsd | None = None,
    method: str = "spline",
    options: EdgeOptions | None = None,
    workers: int = 1,
) -> Iterator[Record | Rejected]:
    """Measure the strongest edge of each of many regions, and hand out one result after the other.

    Regions are taken as they are needed, the first alone, then up to eight together, and few
    results wait: memory stays flat, however many there are. For the pixels and the fit of one of
    them call `acutance.measure_edge`: its numbers are the same.

    Parameters
    ----------
    image : Image, (rows, cols) array_like, or iterable of pairs
        One image; or, without `regions`, pairs (image, region) of several. The array of a pair may
        be filled anew for the next one; a file has to stay as it is until its result is there.
    regions : iterable of regions, optional
        As in `acutance.measure_edge`.
    gsd_m, method, options
        As in `acutance.measure_edge`.
    workers : int, optional
        Processes, each on one core. With more than one, a script has to guard its own start by
        ``if __name__ == "__main__"``; one image in memory, and regions of such images in pairs,
        are kept in temporary files meanwhile.

    Returns
    -------
    iterator of Record and Rejected
        In the order of the regions. A `Rejected` has a stage ("image", "region", "options" or
        "fit"), the reason, and as values the number of the region, its file and itself.

    Raises
    ------
    OptionError
        If the method, the options or the number of workers mean nothing.
    """
    require_method(method)
    chosen = chosen_options(options, EdgeOptions)
    measure = partial(edge_steps, method=method, options=chosen)
    return in_turn(measure, image, regions, gsd_m=gsd_m, workers=workers)


@one_thread
def _edges_of_target(
    region: RegionPixels, method: str, options: EdgeOptions | None
) -> TargetResult[StraightMeasurement]:
    """Every usable edge of a region."""
    chosen = chosen_options(options, EdgeOptions)
    measured: list[StraightMeasurement] = []
    borders: list[NDArray[np.intp]] = []
    rejected: list[Rejected] = []
    strongest = 0.0
    for segment in find_segments(region.pixels):
        strongest = max(strongest, segment.strength)
        if segment.strength < MIN_STRENGTH_SHARE * strongest:
            break
        where = _where(in_whole_image(segment.line, region))
        try:
            found = measure_segment(region, segment, method, chosen)
        except TargetError as error:
            rejected.append(Rejected("fit", str(error), where))
            continue
        if any(_same_edge(found, other) for other in measured):
            continue
        border = _border(found)
        shared = max((_shared(border, other) for other in borders), default=0.0)
        if shared > _MAX_SHARED:
            rejected.append(Rejected("fit", _SHARED_WORDS.format(100 * shared), where))
            continue
        measured.append(found)
        borders.append(border)
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


def _border(one: StraightMeasurement) -> NDArray[np.intp]:
    """Numbers of the used pixels next to the line, in the region."""
    near = np.abs(one.details.distance_px) < _BORDER_PX
    return np.asarray(np.flatnonzero(one.details.used)[near])


def _shared(border: NDArray[np.intp], other: NDArray[np.intp]) -> float:
    """Share of an edge's border pixels that are the border of another, too.

    A line that runs on past the end of its object meets the border of the next one.
    """
    return float(np.mean(np.isin(border, other))) if border.size else 0.0


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


def _group(edges: tuple[StraightMeasurement, ...]) -> EdgeGroup[StraightMeasurement]:
    own, left_out = _best_and_others(edges)
    metrics, chi_square, p_value = {}, {}, {}
    for name in own[0].metrics():
        numbers = [one.metrics().get(name, Estimate(math.nan)) for one in own]
        most, least = (
            np.array([share(one.budget, one.orientation, name) for one in own])
            for share in (systematic_share, least_systematic_share)
        )
        mean, scatter = _weighted_mean(numbers, most, least)
        metrics[name] = mean
        chi_square[name] = scatter
        p_value[name] = _chance(scatter, len(own) - 1)
    freedom = len(own) - 1
    return EdgeGroup(own[0].orientation, own, metrics, chi_square, p_value, freedom, left_out)


def _best_and_others(
    edges: tuple[StraightMeasurement, ...],
) -> tuple[tuple[StraightMeasurement, ...], tuple[StraightMeasurement, ...]]:
    """The edges of the best verdict there is (good and usable ones alike), and the others."""
    for words in ({"good", "usable"}, {"doubtful"}):
        best = tuple(one for one in edges if one.verdict.word in words)
        if best:
            return best, tuple(one for one in edges if one.verdict.word not in words)
    return edges, ()


def _weighted_mean(
    numbers: Sequence[Estimate], most: Floats, least: Floats
) -> tuple[Estimate, float]:
    """Mean weighted by 1 / std^2, and chi-square; the Birge ratio widens the std.

    Of every variance a part is common to all, at most and at least so much, (n,): it does not
    average out, and it cannot make the numbers differ, so that chi-square is that of the rest.
    """
    value = np.array([number.value for number in numbers])
    std = np.array([number.std for number in numbers])
    lowest = numbers[0].lowest
    if not (np.isfinite(value).all() and np.isfinite(std).all() and (std > 0).all()):
        return Estimate(float(np.mean(value)), math.nan, lowest), math.nan
    if len(numbers) > 1 and (value < std).any():
        return Estimate(*_plain_mean(value, std), lowest), math.nan
    weight = std**-2 / np.sum(std**-2)
    mean = float(weight @ value)
    scatter = _chi_square(value, std * np.sqrt(1 - least))
    freedom = len(numbers) - 1
    widened = math.sqrt(scatter / freedom) if freedom and scatter > freedom else 1.0
    return Estimate(mean, std_of_mean(weight, std, most, widened), lowest), scatter


def _chi_square(value: Floats, own_std: Floats) -> float:
    """Of numbers about their mean; nan where one has no deviation of its own to judge by."""
    if not (own_std > 0).all():
        return math.nan
    mean = float(np.average(value, weights=own_std**-2))
    return float(np.sum(((value - mean) / own_std) ** 2))


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
