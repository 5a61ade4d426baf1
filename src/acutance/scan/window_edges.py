"""The edges of one window of an image, in one band or several: found, measured, judged."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.geometry.angles import direction_difference, wrap_axis
from acutance.numerics.clipping import ClipLevels, clip_levels
from acutance.numerics.one_thread import one_thread
from acutance.numerics.stacked import stacked
from acutance.raster import Box, Gsd, Image, Region
from acutance.scan.band_pieces import Unseen, band_pieces, in_band
from acutance.scan.edge_points import gradient
from acutance.scan.options import ScanOptions
from acutance.scan.pieces import region_box
from acutance.scan.windows import Window
from acutance.targets.region import RegionPixels, read_data
from acutance.targets.steps import Steps, stacks, together
from acutance.targets.straight import StraightMeasurement
from acutance.targets.straight.edge import segment_steps
from acutance.targets.straight.find_edges import Segment
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.surroundings import line_distances

__all__ = ["UsedEdge", "WindowEdges", "scan_window"]

_MIN_SIDE_PX = 16
_EDGE_OPTIONS = EdgeOptions()


@dataclass(frozen=True, eq=False)
class UsedEdge:
    """What an edge says of the sensor along its normal.

    Attributes
    ----------
    axis_deg : float
        Of its normal, -90 to 90.
    freq_cpp : (k,) array
    otf : (k,) complex array
        As measured, along the axis.
    root : (2 k, r) array
    value : (r,) array
        What the pixels alone say of the OTF f, real parts first: ``root.T @ f`` is `value` with
        independent errors of one.
    """

    axis_deg: float
    freq_cpp: Floats
    otf: NDArray[np.complex128]
    root: Floats
    value: Floats

    @classmethod
    def of(cls, found: StraightMeasurement) -> UsedEdge:
        """From a measurement that is to be used; opposite normals have conjugate OTFs.

        Where the edge lies is no property of the sensor.
        """
        slices = found.slices
        assert slices.likelihood is not None
        by_place = np.asarray(-2j * np.pi * slices.freq_cpp[:, None], complex)
        likelihood = slices.likelihood.near(slices.otf, by_place)
        root, value = likelihood.root, likelihood.values - likelihood.level
        otf, axis_deg = slices.otf, wrap_axis(found.normal_deg)
        if direction_difference(found.normal_deg, axis_deg) > 90.0:
            root, otf = root.conj(), otf.conj()
        return cls(axis_deg, slices.freq_cpp, otf, stacked(root), value)


@dataclass(frozen=True, eq=False)
class WindowEdges:
    """The edges of a window.

    Attributes
    ----------
    rows : list of dict
        Columns of `SceneEdges` of every edge.
    used : list of UsedEdge
        Those that are used, in the same order.
    """

    rows: list[dict[str, Any]]
    used: list[UsedEdge]


@one_thread
def scan_window(
    images: Sequence[Image],
    window: Window,
    *,
    gsd: Gsd | None,
    options: ScanOptions,
    region: Region | None = None,
) -> list[WindowEdges]:
    """Find the edges of one window, and measure them in every band.

    Parameters
    ----------
    images : sequence of Image
        The bands, of equal shape.
    window : Window
    gsd : Gsd or None
        Instead of the images' own.
    options : ScanOptions
    region : Region, optional
        Pixels outside of it are not used.

    Returns
    -------
    list of WindowEdges
        One a band, all of the same edges in the same order.
    """
    if min(window.whole.shape) < _MIN_SIDE_PX:
        return [WindowEdges([], []) for _ in images]
    every = [_pixels(image, window.whole, region) for image in images]
    slopes = [gradient(pixels) for pixels in every]
    found = band_pieces(slopes, window, options)
    return [
        _measured(image, pixels, in_band(found, band, slope, options), window.whole, gsd, options)
        for band, (image, pixels, slope) in enumerate(zip(images, every, slopes, strict=True))
    ]


def _pixels(image: Image, box: Box, region: Region | None) -> Floats:
    """The pixels of a box, NaN outside the region."""
    pixels, _ = read_data(image, box)
    return pixels if region is None else np.where(region.mask(box), pixels, np.nan)


def _measured(
    image: Image,
    pixels: Floats,
    segments: Iterable[Segment | Unseen],
    whole: Box,
    gsd: Gsd | None,
    options: ScanOptions,
) -> WindowEdges:
    """The edges of one band."""
    # Within a window no GSD changes that much that an edge would see it.
    gsd = gsd or image.gsd(whole.row + whole.height / 2, whole.col + whole.width / 2)
    # The side of a shadow or a roof is too small to show that it is clipped: its window is not.
    clipped = clip_levels(pixels[np.isfinite(pixels)])

    def measured(segment: Segment | Unseen) -> Steps[tuple[dict[str, Any], UsedEdge | None]]:
        if isinstance(segment, Unseen):
            return _place(segment.segment, whole) | {"reason": segment.reason}, None
        around, own = _around(image, gsd, pixels, clipped, whole, segment, options)
        return (yield from _edge(around, own, _place(segment, whole)))

    every = [one for some in stacks(segments) for one in together(list(map(measured, some)))]
    return WindowEdges([row for row, _ in every], [used for _, used in every if used is not None])


def _edge(
    around: RegionPixels, segment: Segment, place: dict[str, Any]
) -> Steps[tuple[dict[str, Any], UsedEdge | None]]:
    """Columns of an edge, in steps, and what it says of the sensor if it is to be used."""
    try:
        found = yield from segment_steps(around, segment, "spline", _EDGE_OPTIONS, of_scene=True)
    except TargetError as error:
        return place | {"reason": str(error)}, None
    yield
    numbers = _numbers(found)
    yield
    verdict = found.verdict
    row = (
        place
        | numbers
        | {
            "verdict": verdict.word,
            "reason": verdict.sentence if verdict.warns else "",
            "used": not verdict.warns,
        }
    )
    yield
    return row, None if verdict.warns else UsedEdge.of(found)


def _around(
    image: Image,
    gsd: Gsd | None,
    pixels: Floats,
    clipped: ClipLevels,
    whole: Box,
    segment: Segment,
    options: ScanOptions,
) -> tuple[RegionPixels, Segment]:
    """The pixels beside a piece, and the piece in their coordinates.

    What lies beyond its ends belongs to its neighbours: no pixel is used twice.
    """
    box = region_box(segment, options.half_width_px, Box.whole(whole.shape))
    at = Box(whole.row + box.row, whole.col + box.col, box.height, box.width)
    line = segment.line
    moved = replace(line, row=line.row - box.row, col=line.col - box.col)
    _, t = line_distances(box.shape, moved)
    beside = (segment.start_px <= t) & (t <= segment.stop_px)
    own = np.where(beside, pixels[box.slices], np.nan)
    region = RegionPixels(own, at, image.saturation_level, gsd, image, clipped=clipped)
    return region, replace(segment, line=moved)


def _place(segment: Segment, whole: Box) -> dict[str, Any]:
    """Where an edge was found, in pixels of the image."""
    line = segment.line
    return {
        "row": line.row + whole.row,
        "col": line.col + whole.col,
        "normal_deg": line.normal_deg,
        "length_px": segment.stop_px - segment.start_px,
    }


def _numbers(found: StraightMeasurement) -> dict[str, Any]:
    """Columns of an edge that was measured, without its verdict."""
    columns: dict[str, Any] = {
        "row": found.line.row,
        "col": found.line.col,
        "normal_deg": found.normal_deg,
        "length_px": found.line.length_px,
        "place_std_px": found.line.offset_std_px,
        "snr": found.snr,
    }
    for name in ("mtf_nyquist", "rer", "fwhm_px"):
        number = getattr(found, name)
        columns |= {name: number.value, f"{name}_std": number.std}
    return {key: np.nan if value is None else value for key, value in columns.items()}
