"""Measure edges before and after a filter, for the proof that it does what was predicted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from acutance.arguments import require_all, require_kind
from acutance.curves import Estimate
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import AcutanceError, NoEdgeError
from acutance.geometry.angles import axis_difference, is_nearer_columns
from acutance.raster import Box, Image, Region
from acutance.restoration.proof import RestorationProof, VerifiedEdge
from acutance.restoration.restoration_filter import RestorationFilter, require_filter
from acutance.scan import SceneEdges, edges_of_scene
from acutance.targets.straight import StraightMeasurement, measure_edge
from acutance.targets.uncertainty_budget import std_of_mean, systematic_share

__all__ = ["verify_restoration"]

_MAX_EDGES, _MIN_LENGTH_PX, _HALF_WIDTH_PX = 80, 20.0, 9.0

_OTHER = {"across": "along", "along": "across"}
_LEAST_MTF = 1e-3
_Pair = tuple[StraightMeasurement, StraightMeasurement]
RegionLike = Region | Box | tuple[int, int, int, int]


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
        `acutance.scan_scene` would use are measured.
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
    OptionError
        If an argument is of the wrong kind.
    """
    require_kind(Image, before=before, after=after)
    require_filter(filter)
    if not isinstance(regions, Mapping):
        regions = require_all(object, "regions", regions)
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
        _designed(filter, [before], np.ones(1)), white_noise_gain=filter.noise_gain,
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
        for region in _regions_of(edges_of_scene(before))
        if (pair := _tried(before, after, region, method)) is not None
    ]
    if not found:
        raise NoEdgeError(
            f"the image was searched for edges of {_MIN_LENGTH_PX:g} px, and none could be "
            "measured before and after: name regions with edges (regions, --roi)"
        )
    groups: dict[str, list[_Pair]] = {"across": [], "along": []}
    for pair in found:
        groups[pair[0].orientation].append(pair)
    return [
        _mean_edge(f"{name}, {len(own)} edge{'s' * (len(own) > 1)}", own, filter)
        for name, own in groups.items()
        if own
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
    """Weighted mean of edges across or along; the weights are those after the filter."""
    before, after = zip(*pairs, strict=True)
    weight = np.array([one.mtf_nyquist.std**-2 for one in after])
    weight /= weight.sum()
    gain = np.array([_gain(filter, one.line.normal_deg) for one in before])
    return VerifiedEdge(
        name,
        before[0].line.normal_deg if len(pairs) == 1 else None,
        _mean(before, "mtf_nyquist", weight),
        _mean(after, "mtf_nyquist", weight),
        _mean(before, "mtf_nyquist", weight, gain),
        float(np.median([one.snr for one in before])),
        float(np.median([one.snr for one in after])),
        _mean(after, "overshoot", weight),
        designed=_designed(filter, before, weight),
        count=len(pairs),
        white_noise_gain=filter.noise_gain,
    )


def _designed(
    filter: RestorationFilter, edges: Sequence[StraightMeasurement], weight: Floats
) -> Estimate:
    """MTF at Nyquist along the edges' normals of the sensor the filter was designed for.

    Of a Gaussian its logarithm varies with the square of the cosine of the angle to an axis; other
    sensors are about as far between their axes.
    """
    # The image may state another axis as that of its track than the filter.
    names = [
        "across" if is_nearer_columns(edge.line.normal_deg) == (filter.along_track == "y")
        else "along"
        for edge in edges
    ]  # fmt: skip
    own, other = (
        [filter.before.directions[name].mtf_nyquist for name in those]
        for those in (names, [_OTHER[name] for name in names])
    )
    share = np.sin(np.radians([edge.line.angle_deg for edge in edges])) ** 2
    value, beside = (np.maximum([one.value for one in some], _LEAST_MTF) for some in (own, other))
    std = float(weight @ np.nan_to_num([one.std for one in own]))
    return Estimate(float(weight @ (value ** (1 - share) * beside**share)), std, 0.0)


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
