"""The proof: edges measured before and after a filter, beside what was predicted of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
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
from acutance.scan import scan_scene
from acutance.targets.straight import StraightMeasurement, measure_edge

__all__ = ["RestorationProof", "VerifiedEdge", "verify_restoration"]

RegionLike = Region | Box | tuple[int, int, int, int]


@dataclass(frozen=True, eq=False)
class VerifiedEdge(ShortRepr):
    """An edge, or all edges of a scene in one direction, before and after a filter.

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
        As measured; ``nan`` of a scene.
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
        One edge each. Without them all edges of the scene are measured (`acutance.scan_scene`).
    method : str, optional
        Of `acutance.measure_edge`. The reference states all of its uncertainty; where a filter
        aims at points (``desired="point"``) its expectation of sensors draws the MTF at Nyquist up
        by some hundredths, and "iso12233", which expects nothing, is off by less.

    Returns
    -------
    RestorationProof

    Raises
    ------
    NoEdgeError
        If no edge can be measured in both.
    """
    if not regions:
        return RestorationProof(tuple(_of_scene(before, after, filter)))
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


def _of_scene(before: Image, after: Image, filter: RestorationFilter) -> Iterable[VerifiedEdge]:
    """Across and along of a scene, all of its edges together."""
    scenes = scan_scene(before), scan_scene(after)
    across_deg = 0.0 if before.along_track == "y" else 90.0
    for name, normal_deg in (("across", across_deg), ("along", 90.0 - across_deg)):
        one, other = (scene.directions[name] for scene in scenes)  # type: ignore[index]
        yield VerifiedEdge(
            name, normal_deg, one.mtf_nyquist, other.mtf_nyquist,
            one.mtf_nyquist * _gain(filter, normal_deg), math.nan, math.nan, other.overshoot,
        )  # fmt: skip


def _gain(filter: RestorationFilter, normal_deg: float) -> float:
    """Modulus of the filter's transfer at Nyquist along a normal."""
    x, y = unit_vector(normal_deg)
    return float(np.abs(filter.otf(NYQUIST_CPP * x, NYQUIST_CPP * y)))
