"""The proof: edges measured before and after a filter, beside what was predicted of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.direction import unit_vector
from acutance.curves.metrics import NYQUIST_CPP
from acutance.curves.short_repr import ShortRepr
from acutance.errors import AcutanceError, NoEdgeError
from acutance.raster import Box, Image, Region
from acutance.restoration.restoration_filter import RestorationFilter
from acutance.scan import SceneEdges, scan_scene
from acutance.targets.straight import StraightMeasurement, measure_edge

__all__ = ["RestorationProof", "VerifiedEdge", "verify_restoration"]

_MAX_EDGES, _MIN_LENGTH_PX, _HALF_WIDTH_PX = 80, 20.0, 9.0

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
    """

    name: str
    normal_deg: float
    before: Estimate
    after: Estimate
    predicted: Estimate
    snr_before: float
    snr_after: float
    overshoot: Estimate

    @property
    def off(self) -> float:
        """Measured minus predicted."""
        return self.after.value - self.predicted.value

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

    def summary(self) -> str:
        """How far measured and predicted are apart at most."""
        worst = max(self.edges, key=lambda one: abs(one.off))
        return f"{len(self.edges)} edges, off by {worst.off:+.4f} at most (of {worst.after})"

    def to_dict(self) -> dict[str, Any]:
        """All edges, for JSON."""
        return {"edges": [one.to_dict() for one in self.edges], "rejected": list(self.rejected)}


def verify_restoration(
    before: Image,
    after: Image,
    filter: RestorationFilter,
    regions: Sequence[RegionLike] = (),
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
    regions : sequence of Region, Box or (row, column, height, width), optional
        One edge each. Without them the longest edges that `acutance.scan_scene` uses are measured.
    method : str, optional
        Of `acutance.measure_edge`. The reference states all of its uncertainty, but where a filter
        aims at points (``desired="point"``) no sensor it expects falls so steeply at Nyquist, and
        it reads some hundredths too much; "iso12233" expects nothing.

    Returns
    -------
    RestorationProof

    Raises
    ------
    NoEdgeError
        If no edge can be measured in both.
    """
    if not regions:
        return RestorationProof(tuple(_of_scene(before, after, filter, method)))
    edges, rejected = [], []
    for number, region in enumerate(regions, start=1):
        try:
            pair = (
                measure_edge(before, region, method=method),
                measure_edge(after, region, method=method),
            )
        except AcutanceError as error:
            rejected.append(f"region {number}: {error}")
        else:
            edges.append(_of_edge(f"region {number}", *pair, filter))
    if not edges:
        raise NoEdgeError(f"no edge could be measured before and after: {'; '.join(rejected)}")
    return RestorationProof(tuple(edges), tuple(rejected))


def _of_edge(
    name: str, before: StraightMeasurement, after: StraightMeasurement, filter: RestorationFilter
) -> VerifiedEdge:
    normal_deg = before.line.normal_deg
    return VerifiedEdge(
        name, normal_deg, before.mtf_nyquist, after.mtf_nyquist,
        before.mtf_nyquist * _gain(filter, normal_deg), before.snr, after.snr, after.overshoot,
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
        edge
        for region in _regions_of(scan_scene(before).edges)
        if (edge := _tried(before, after, region, filter, method)) is not None
    ]
    if not found:
        raise NoEdgeError(
            "no edge of the scene could be measured before and after: name regions with edges "
            "(--roi)"
        )
    across_deg = 0.0 if before.along_track == "y" else 90.0
    groups: dict[str, list[VerifiedEdge]] = {"across": [], "along": []}
    for edge in found:
        is_across = (edge.normal_deg - across_deg + 45.0) % 180.0 < 90.0
        groups["across" if is_across else "along"].append(edge)
    return [_mean_edge(f"{name}, {len(own)} edges", own) for name, own in groups.items() if own]


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


def _tried(
    before: Image, after: Image, region: Region, filter: RestorationFilter, method: str
) -> VerifiedEdge | None:
    """An edge before and after; ``None`` where one of them cannot be measured."""
    try:
        pair = [measure_edge(image, region, method=method) for image in (before, after)]
    except AcutanceError:
        return None
    return _of_edge("", pair[0], pair[1], filter)


def _mean_edge(name: str, edges: Sequence[VerifiedEdge]) -> VerifiedEdge:
    """Weighted mean of edges of one direction; the weights are those after the filter."""
    weight = np.array([edge.after.std**-2 for edge in edges])
    share = weight / weight.sum()

    def mean(numbers: Sequence[Estimate]) -> Estimate:
        value = sum(one * number.value for one, number in zip(share, numbers, strict=True))
        error = [one * number.std for one, number in zip(share, numbers, strict=True)]
        return Estimate(float(value), float(np.linalg.norm(error)), 0.0)

    return VerifiedEdge(
        name,
        float(np.median([edge.normal_deg for edge in edges])),
        mean([edge.before for edge in edges]),
        mean([edge.after for edge in edges]),
        mean([edge.predicted for edge in edges]),
        float(np.median([edge.snr_before for edge in edges])),
        float(np.median([edge.snr_after for edge in edges])),
        mean([edge.overshoot for edge in edges]),
    )


def _gain(filter: RestorationFilter, normal_deg: float) -> float:
    """Modulus of the filter's transfer at Nyquist along a normal."""
    x, y = unit_vector(normal_deg)
    return float(np.abs(filter.otf(NYQUIST_CPP * x, NYQUIST_CPP * y)))
