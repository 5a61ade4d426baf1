"""The proof: edges measured before and after a filter, beside what was predicted of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.direction import unit_vector
from acutance.curves.estimate import normal_quantile
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.curves.short_repr import ShortRepr
from acutance.errors import AcutanceError, NoEdgeError
from acutance.geometry.angles import axis_difference
from acutance.raster import Box, Image, Region
from acutance.restoration.restoration_filter import RestorationFilter
from acutance.scan import SceneEdges, scan_scene
from acutance.targets.straight import StraightMeasurement, measure_edge
from acutance.targets.uncertainty_budget import std_of_mean, systematic_share

__all__ = ["RestorationProof", "VerifiedEdge", "verify_restoration"]

_MAX_EDGES, _MIN_LENGTH_PX, _HALF_WIDTH_PX = 80, 20.0, 9.0

_AGREES_LEVEL = 0.95
_SAME_LINE_DEG = 0.5
_UNLIKE, _DESIGN_STD = 4.0, 0.01
"""Deviations from the design that are named; what edges off the axes and of other ground add."""
_SHARED_AND_OWN_ERROR: dict[str, tuple[float, float]] = {
    "spline": (0.0, 0.005),
    "sdsu-2005": (0.95, 0.006),
    "kompsat-2014": (0.0, 0.03),
    "iso12233": (0.95, 0.004),
    "fermi": (0.0, 0.06),
}
"""By method: correlation of the errors before and after, and what it errs by besides, in MTF.

From simulated edges of three sensors at SNR 40, 100 and 300, kernels of noise gain 1.4 and 2.2.
Plain methods read both images by the same sums, so their errors are the same. The reference sees
another sensor after the filter, with what it expects of that, and the errors are nearly
independent. Methods that fit a shape miss one that overshoots."""

_Pair = tuple[StraightMeasurement, StraightMeasurement]
RegionLike = Region | Box | tuple[int, int, int, int]


@dataclass(frozen=True, eq=False)
class VerifiedEdge(ShortRepr):
    """An edge, or the mean of a scene's edges in one direction, before and after a filter.

    Parameters
    ----------
    name : str
    normal_deg : float
        Direction of the normal.
    before, after : Estimate
        MTF at Nyquist as measured.
    predicted : Estimate
        That before, times the filter's own transfer there.
    snr_before, snr_after : float
        As measured; of a scene the medians.
    overshoot : Estimate
        After, as measured.
    method : str
        Of `acutance.measure_edge`.
    turned_deg : float
        Angle between the lines found before and after.
    designed : Estimate, optional
        MTF at Nyquist across or along that the filter was designed for.
    count : int
        Edges, of a mean.
    """

    name: str
    normal_deg: float
    before: Estimate
    after: Estimate
    predicted: Estimate
    snr_before: float
    snr_after: float
    overshoot: Estimate
    method: str = "spline"
    turned_deg: float = 0.0
    designed: Estimate | None = None
    count: int = 1

    @property
    def off(self) -> float:
        """Measured minus predicted."""
        return self.after.value - self.predicted.value

    @property
    def difference(self) -> Estimate:
        """Measured minus predicted, with its deviation.

        Both measurements see the same pixels, and how much of their errors is the same depends on
        the method: by the reference next to nothing, by "iso12233" and "sdsu-2005" nearly all, as
        long as both find the same line. So the deviation is the root of the sum of both squares,
        less what they share, with what the method errs by besides. Within two deviations are, in
        simulations, .99 of 630 differences by the reference, .97 of 300 after kernels that aim at
        points, and .94 to 1 of 590 by the other methods.
        """
        shared, own = _SHARED_AND_OWN_ERROR[self.method]
        if abs(self.turned_deg) > _SAME_LINE_DEG:
            shared = 0.0
        after, predicted = self.after.std, self.predicted.std
        noise = after**2 + predicted**2 - 2 * shared * after * predicted
        return Estimate(self.off, math.sqrt(noise + own**2))

    @property
    def deviations(self) -> float:
        """How many of its deviations the difference has."""
        return self.off / self.difference.std

    @property
    def unlike_design(self) -> float:
        """How many deviations MTF at Nyquist before the filter is above what it was designed for.

        Negative below it; 0 where that is not known.
        """
        if self.designed is None:
            return 0.0
        known = self.designed.std if math.isfinite(self.designed.std) else 0.0
        return (self.before.value - self.designed.value) / math.hypot(
            self.before.std, known, _DESIGN_STD
        )

    @property
    def noise_gain(self) -> float:
        """SNR before over that after: the noise gain as the edge shows it."""
        return self.snr_before / self.snr_after

    def to_dict(self) -> dict[str, Any]:
        """All numbers, for JSON."""
        return {
            "name": self.name,
            "normal_deg": self.normal_deg,
            "mtf_nyquist_before": self.before.to_dict(),
            "mtf_nyquist_after": self.after.to_dict(),
            "mtf_nyquist_predicted": self.predicted.to_dict(),
            "difference": self.difference.to_dict(),
            "deviations": self.deviations,
            "mtf_nyquist_designed": None if self.designed is None else self.designed.to_dict(),
            "overshoot_after": self.overshoot.to_dict(),
            "snr_before": self.snr_before,
            "snr_after": self.snr_after,
        }


@dataclass(frozen=True, eq=False)
class RestorationProof(ShortRepr):
    """Edges before and after a filter.

    Parameters
    ----------
    edges : tuple of VerifiedEdge
    rejected : tuple of str
        Regions without a result, and why.
    """

    edges: tuple[VerifiedEdge, ...]
    rejected: tuple[str, ...] = ()

    @property
    def worst(self) -> VerifiedEdge:
        """The edge whose difference has the most deviations."""
        return max(self.edges, key=lambda one: abs(one.deviations))

    @property
    def limit(self) -> float:
        """Deviations that the worst of so many edges keeps in 95 % of all proofs that agree."""
        return normal_quantile(_AGREES_LEVEL ** (1 / len(self.edges)))

    @property
    def agrees(self) -> bool:
        """Whether every edge was measured as predicted, within its deviation."""
        return abs(self.worst.deviations) <= self.limit

    @property
    def sentence(self) -> str:
        """Whether the image is as sharp as predicted, in words of deviations."""
        worst = self.worst
        count = sum(one.count for one in self.edges)
        of = f"{count} edges" if count > 1 else "the edge"
        by = f"{worst.name} by {worst.difference.value:+.4f} ± {worst.difference.std:.4f}"
        if self.agrees:
            return (
                f"agrees with the prediction: {of} within {abs(worst.deviations):.1f} deviations "
                f"(at most {self.limit:.1f} are expected)"
            )
        return (
            f"does not agree with the prediction: {by}, {abs(worst.deviations):.1f} deviations "
            f"(at most {self.limit:.1f} are expected)"
        ).replace("-", "−")

    @property
    def notes(self) -> tuple[str, ...]:
        """Where the image is not that of the sensor the filter was designed for."""
        unlike = max(self.edges, key=lambda one: abs(one.unlike_design))
        if unlike.designed is None or abs(unlike.unlike_design) < _UNLIKE:
            return ()
        why = (
            "it is of another sensor or band, or was sharpened before"
            if unlike.unlike_design > 0
            else "it is of another sensor or band, or its borders are soft themselves"
        )
        return (
            f"{unlike.name}: before the filter MTF at Nyquist is {unlike.before}, and the filter "
            f"was designed for {unlike.designed} ({abs(unlike.unlike_design):.0f} deviations): "
            f"{why}; it does not become what the design promises",
        )

    def summary(self) -> str:
        """Whether measured and predicted agree."""
        return self.sentence

    def to_dict(self) -> dict[str, Any]:
        """All edges, for JSON."""
        return {
            "agrees": self.agrees,
            "sentence": self.sentence,
            "notes": list(self.notes),
            "edges": [one.to_dict() for one in self.edges],
            "rejected": list(self.rejected),
        }


def verify_restoration(
    before: Image,
    after: Image,
    filter: RestorationFilter,
    regions: Sequence[RegionLike] | Mapping[str, RegionLike] = (),
    *,
    method: str = "spline",
) -> RestorationProof:
    """Measure edges before and after a filter, and set them beside the prediction.

    The prediction is made of the same edges before: their MTF times the filter's transfer in the
    direction of their normal. So it holds the error of the edge, which both measurements share, and
    what is left is the error of the proof.

    Parameters
    ----------
    before, after : Image
    filter : RestorationFilter
    regions : sequence or mapping of Region, Box or (row, column, height, width), optional
        One edge each, by name or by number. Without them the longest edges that
        `acutance.scan_scene` uses are measured.
    method : str, optional
        Of `acutance.measure_edge`. The reference states all of its uncertainty, but where a filter
        aims at points (``desired="point"``) few sensors it expects fall so steeply at Nyquist, and
        it reads about .01 too much; "iso12233" expects nothing.

    Returns
    -------
    RestorationProof

    Raises
    ------
    NoEdgeError
        If no edge can be measured in both.
    """
    if not regions:
        found = _of_scene(before, after, filter, method)
        return RestorationProof(tuple(replace(one, method=method) for one in found))
    named = regions if isinstance(regions, Mapping) else _numbered(regions)
    edges, rejected = [], []
    for name, region in named.items():
        try:
            pair = (
                measure_edge(before, region, method=method),
                measure_edge(after, region, method=method),
            )
        except AcutanceError as error:
            rejected.append(f"{name}: {error}")
        else:
            edges.append(_of_edge(name, *pair, filter))
    if not edges:
        raise NoEdgeError(f"no edge could be measured before and after: {'; '.join(rejected)}")
    return RestorationProof(tuple(edges), tuple(rejected))


def _numbered(regions: Sequence[RegionLike]) -> dict[str, RegionLike]:
    return {f"region {number}": region for number, region in enumerate(regions, start=1)}


def _of_edge(
    name: str, before: StraightMeasurement, after: StraightMeasurement, filter: RestorationFilter
) -> VerifiedEdge:
    normal_deg = before.line.normal_deg
    return VerifiedEdge(
        name, normal_deg, before.mtf_nyquist, after.mtf_nyquist,
        before.mtf_nyquist * _gain(filter, normal_deg), before.snr, after.snr, after.overshoot,
        before.method, axis_difference(after.line.normal_deg, normal_deg),
        _designed(filter, before.orientation),
    )  # fmt: skip


def _of_scene(
    before: Image, after: Image, filter: RestorationFilter, method: str
) -> list[VerifiedEdge]:
    """The longest edges of a scene, found before the filter: weighted means across and along.

    Raises
    ------
    NoEdgeError
        If none can be measured in both images.
    """
    found = [
        pair
        for region in _regions_of(scan_scene(before).edges)
        if (pair := _tried(before, after, region, method)) is not None
    ]
    if not found:
        raise NoEdgeError(
            "no edge of the scene could be measured before and after: name regions with edges "
            "(--roi)"
        )
    groups: dict[str, list[_Pair]] = {"across": [], "along": []}
    for pair in found:
        groups[pair[0].orientation].append(pair)
    return [
        _mean_edge(f"{name}, {len(own)} edges", own, filter) for name, own in groups.items() if own
    ]


def _regions_of(edges: SceneEdges) -> list[Region]:
    """Boxes around the longest used edges, turned with them."""
    used = np.flatnonzero(edges.used & (edges.length_px >= _MIN_LENGTH_PX))
    longest = used[np.argsort(-edges.length_px[used])][:_MAX_EDGES]
    regions = []
    for i in longest:
        x, y = unit_vector(float(edges.normal_deg[i]))
        half = 0.5 * float(edges.length_px[i])
        corners = [
            (
                float(edges.row[i]) + along * half * x + over * _HALF_WIDTH_PX * y,
                float(edges.col[i]) - along * half * y + over * _HALF_WIDTH_PX * x,
            )
            for along, over in ((-1, -1), (-1, 1), (1, 1), (1, -1))
        ]
        regions.append(Region(np.array(corners)))
    return regions


def _tried(before: Image, after: Image, region: Region, method: str) -> _Pair | None:
    """An edge before and after; ``None`` where one of them cannot be measured."""
    try:
        return (
            measure_edge(before, region, method=method), measure_edge(after, region, method=method),
        )  # fmt: skip
    except AcutanceError:
        return None


def _mean_edge(name: str, pairs: Sequence[_Pair], filter: RestorationFilter) -> VerifiedEdge:
    """Weighted mean of edges of one direction; the weights are those after the filter."""
    before, after = zip(*pairs, strict=True)
    weight = np.array([one.mtf_nyquist.std**-2 for one in after])
    weight /= weight.sum()
    gain = np.array([_gain(filter, one.line.normal_deg) for one in before])
    return VerifiedEdge(
        name,
        float(np.median([one.line.normal_deg for one in before])),
        _mean(before, "mtf_nyquist", weight),
        _mean(after, "mtf_nyquist", weight),
        _mean(before, "mtf_nyquist", weight, gain),
        float(np.median([one.snr for one in before])),
        float(np.median([one.snr for one in after])),
        _mean(after, "overshoot", weight),
        designed=_designed(filter, before[0].orientation),
        count=len(pairs),
    )


def _designed(filter: RestorationFilter, orientation: str) -> Estimate:
    return filter.before.directions[orientation].mtf_nyquist


def _mean(
    edges: Sequence[StraightMeasurement], name: str, weight: Floats, gain: Floats | float = 1.0
) -> Estimate:
    """Weighted mean of a number; what all edges' errors have in common does not average out."""
    numbers = [getattr(one, name) for one in edges]
    value, std = (
        gain * np.array([getattr(one, part) for one in numbers]) for part in ("value", "std")
    )
    common = np.array([systematic_share(one.budget, one.orientation, name) for one in edges])
    return Estimate(float(weight @ value), std_of_mean(weight, std, common), 0.0)


def _gain(filter: RestorationFilter, normal_deg: float) -> float:
    """Modulus of the filter's transfer at Nyquist along a normal."""
    x, y = unit_vector(normal_deg)
    return float(np.abs(filter.otf(NYQUIST_CPP * x, NYQUIST_CPP * y)))
