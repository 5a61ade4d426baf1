"""Measure a sensor from all straight edges of a scene."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.curves import Estimate, Otf2d
from acutance.curves.grid import Floats
from acutance.errors import FewEdgesError, NoDataError
from acutance.geometry.angles import axis_difference
from acutance.numerics.one_thread import one_thread
from acutance.raster import Box, Gsd, Image, Region, open_image
from acutance.scan.all_windows import Progress, Tell, answered_fit, part_of, scan_windows
from acutance.scan.band_pieces import UNSEEN
from acutance.scan.checks import check_scene
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.field import Field, field_places
from acutance.scan.first_guesses import BIN_DEG, sensor_guesses
from acutance.scan.left_out import left_out_by_reason
from acutance.scan.options import ScanOptions
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.scene_measurement import SceneMeasurement
from acutance.scan.sensor_fit import EdgesSeen, SensorFit, fit_sensor
from acutance.scan.stated_objects import behind_objects, gsd_of_part, require_statement
from acutance.scan.window_edges import UsedEdge, WindowEdges
from acutance.scan.windows import windows
from acutance.targets.options import chosen_options
from acutance.targets.processing_checks import scene_processing_checks
from acutance.targets.region import RoiLike, image_info, read_data

__all__ = ["edges_of_scene", "edges_seen", "measured_scene", "scan_scene"]

_MIN_EDGES = 8
_REASONS = 3
"""Of edges left out, that the error names; its `edges` have all of them."""
_MIN_GAP_DEG = 20.0


def scan_scene(
    image: Image | ArrayLike | str | os.PathLike[str],
    roi: RoiLike = None,
    *,
    gsd_m: float | Gsd | None = None,
    options: ScanOptions | None = None,
    workers: int = 1,
    scheduler: str | None = None,
    keep: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    tell: Tell | None = None,
) -> SceneMeasurement:
    """Measure a sensor from all straight edges of a scene.

    Every straight or gently curved edge that stands out is found and measured like a target
    (`acutance.measure_edge`). What all good ones share is the sensor; how soft their objects are
    is estimated with it, so that fields with blurred borders do not pass for a blurred sensor.

    Parameters
    ----------
    image : Image, (rows, cols) array_like or path
        An image of any size: it is read in windows.
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        Part of the image.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    options : ScanOptions, optional
    workers : int, optional
        Processes, each with its own windows, and then with its own first guesses of the sensor,
        where following them takes long; what is found is the same. With more than one, a script
        has to guard its own start by ``if __name__ == "__main__"``.
    scheduler : str, optional
        Address of a dask scheduler ("tcp://host:8786"): its workers, which have to see the file
        under the same name, are used instead of processes.
    keep : path, optional
        File in which finished windows are kept. A scan that was interrupted, however, goes on
        where it was when it is called again; a finished one leaves the file, and the same scan
        with other outputs measures no edge again. The file of another scan (the image
        changed, other options) is refused.
    progress : function of (windows done, windows in all), optional
    tell : function of str, optional
        Hears what was found so far, and that the sensor is being fitted.

    Returns
    -------
    SceneMeasurement
        Across and along track with standard deviations, the mean over the scene; every edge; the
        shares of ideal and soft objects.

    Raises
    ------
    ImageError, RegionError
        If there are no pixels to scan.
    NoDataError
        If no pixel holds data.
    FewEdgesError
        If too few edges can be used, or all have one direction; it holds the edges.
    OptionError
        If an option or the number of workers means nothing, a softness is stated in metres and
        there is no GSD, the scheduler cannot be reached, or `keep` is of another scan.

    Examples
    --------
    >>> scene = ac.scan_scene("scene.tif", workers=2)  # doctest: +SKIP
    >>> print(scene.across.mtf_nyquist, scene.along.mtf_nyquist)  # doctest: +SKIP
    >>> scene.edges.row[scene.edges.used]  # doctest: +SKIP
    """
    chosen, gsd = chosen_options(options, ScanOptions), Gsd.given(gsd_m)
    if isinstance(image, str | os.PathLike):
        image = open_image(image)
    source = Image.of(image)
    box, region = part_of(source, roi)
    require_statement(chosen, gsd_of_part(source, box, gsd))
    found = scan_windows(
        [source], box, region, gsd=gsd, options=chosen, workers=workers, scheduler=scheduler,
        keep=keep, progress=progress, tell=tell,
    )  # fmt: skip
    own = [one for (one,) in found]
    with answered_fit(len(found), keep):
        edges, seen = edges_seen(source, box, chosen, own)
        if tell is not None:
            tell(f"the sensor under {seen.x.size} of {edges.size} edges")
        return measured_scene(source, box, gsd, chosen, edges, fit_sensor(seen, workers), region)


def edges_of_scene(image: Image) -> SceneEdges:
    """Every edge of a whole image, measured and judged: of the sensor under them nothing is asked.

    Parameters
    ----------
    image : Image
    """
    found = scan_windows([image], Box.whole(image.shape), None, gsd=None, options=ScanOptions())
    return SceneEdges.of_rows([row for (window,) in found for row in window.rows])


def edges_seen(
    image: Image, box: Box, options: ScanOptions, found: Sequence[WindowEdges]
) -> tuple[SceneEdges, EdgesSeen]:
    """The edges of all windows of a band, and what those that are used say of the sensor.

    Parameters
    ----------
    image : Image
    box : Box
        The part that was scanned.
    options : ScanOptions
    found : sequence of WindowEdges

    Raises
    ------
    NoDataError
        If no pixel holds data.
    FewEdgesError
        If too few edges can be used, or all have one direction.
    """
    edges = SceneEdges.of_rows([row for window in found for row in window.rows])
    if not edges.size:
        _require_data(image, box, options)
    return edges, _seen([edge for window in found for edge in window.used], edges, image, box)


def measured_scene(
    image: Image,
    box: Box,
    gsd: Gsd | None,
    options: ScanOptions,
    edges: SceneEdges,
    fit: SensorFit,
    region: Region | None = None,
) -> SceneMeasurement:
    """The measurement of a band, whose sensor was fitted to its edges.

    Parameters
    ----------
    image : Image
    box : Box
        The part that was scanned.
    gsd : Gsd or None
        Instead of the image's own.
    options : ScanOptions
    edges : SceneEdges
    fit : SensorFit
    region : Region, optional
        In the part, where it is not all of the image.
    """
    gsd = gsd_of_part(image, box, gsd)
    info = image_info(image, box, gsd, "" if region is None else region.name)
    known = edges.with_objects(fit.member.mean_px, fit.member.ideal)
    field = Field(box.as_tuple(), *fit.field[:4])
    sensor = behind_objects(fit.otf, options, gsd, fit.common_errors_px2)
    transfer = Otf2d(field.mean_of(sensor), None if gsd is None else (gsd.row_m, gsd.col_m))
    return SceneMeasurement(
        kind="scene",
        method="population",
        transfer=transfer,
        snr=float(np.median(edges.snr[edges.used])),
        checks=check_scene(edges, fit, field, transfer, (image, box), info, options.limits),
        image=info,
        options=options.to_dict(),
        edges=known,
        field=field,
        objects={name: Estimate(value, std, 0.0, 1.0) for name, (value, std) in fit.kinds.items()},
        ideal_by_direction=fit.ideal_by_direction,
        forms=fit.forms,
        normal_deg_bins=tuple(fit.normal_deg.tolist()),
        details=fit,
    )


def _require_data(image: Image, box: Box, options: ScanOptions) -> None:
    """Refuse pixels of which none holds data."""
    for window in windows(box, options.window_px, image.shape, options.half_width_px):
        pixels, _ = read_data(image, window.core)
        if np.isfinite(pixels).any():
            return
    raise NoDataError(
        f"none of the {box.height} x {box.width} pixels holds data: all are nodata, masked, NaN or "
        "a constant fill; scan another image, or correct the nodata value if pixels that have it "
        "are data (nodata, --nodata; nan: every value is data)"
    )


@one_thread
def _seen(used: Sequence[UsedEdge], edges: SceneEdges, image: Image, box: Box) -> EdgesSeen:
    """What the used edges say.

    Raises
    ------
    FewEdgesError
        If there are too few edges, or all have one direction.
    """
    if not edges.size:
        raise FewEdgesError(
            f"no straight edge stands out in the {box.height} x {box.width} pixels: they are flat, "
            "or hold nothing straight; scan a larger part, or another image",
            edges,
        )
    unseen = np.char.startswith(edges.reason, UNSEEN)
    if unseen.all():
        raise FewEdgesError(
            f"the band shows none of the {edges.size} straight edges of the other bands, and at "
            f"least {_MIN_EDGES} are needed: it is flat, or its noise is stronger; leave it out",
            edges,
        )
    if len(used) < _MIN_EDGES:
        unshown = f", {unseen.sum()} of which this band does not show" if unseen.any() else ""
        raise FewEdgesError(
            f"{_counted(edges.size)} found{unshown}, and {len(used)} of them can be used, where "
            f"at least {_MIN_EDGES} are needed: {_common_reason(edges)}{_processing(image, box)}"
            "scan a larger part, or another image, or measure single edges",
            edges,
        )
    axis_deg = np.array([one.axis_deg for one in used])
    _, number = np.unique(np.floor((axis_deg + 90.0) / BIN_DEG), return_inverse=True)
    normal_deg = np.array([axis_deg[number == b].mean() for b in range(int(number.max()) + 1)])
    gap = max(axis_difference(float(a), float(b)) for a in normal_deg for b in normal_deg)
    if gap < _MIN_GAP_DEG:
        raise FewEdgesError(
            f"all {len(used)} edges that can be used have nearly one direction, normals within "
            f"{gap:.0f} degrees: two that differ by {_MIN_GAP_DEG:g} are needed; scan a larger "
            "part, or another image, or measure them with measure_edges",
            edges,
        )
    likelihoods = _likelihoods(used, number, axis_deg)
    x, y = field_places(box.as_tuple(), edges.row[edges.used], edges.col[edges.used])
    return EdgesSeen(likelihoods, normal_deg, sensor_guesses(used, normal_deg), x, y)


def _common_reason(edges: SceneEdges) -> str:
    """The most frequent reasons why edges are left out, with their counts."""
    unused = ~edges.used & ~np.char.startswith(edges.reason, UNSEEN)
    pairs = zip(edges.verdict[unused].tolist(), edges.reason[unused].tolist(), strict=True)
    found = left_out_by_reason(pairs)
    if not found:
        return ""
    named = [f"{one.edges} {one.verdict} ({one.reason})" for one in found[:_REASONS]]
    others = sum(one.edges for one in found[_REASONS:])
    named += [f"{others} for other reasons"] if others else []
    return f"of the others {', '.join(named)}; "


def _processing(image: Image, box: Box) -> str:
    """What processing left in the pixels: few edges of a resampled image are straight."""
    found = scene_processing_checks(image, box, {})
    return "".join(f"{check.message}; " for check in found if not check.passed)


def _counted(edges: int) -> str:
    return "1 straight edge was" if edges == 1 else f"{edges} straight edges were"


def _likelihoods(
    used: Sequence[UsedEdge], number: NDArray[np.intp], axis_deg: Floats
) -> EdgeLikelihoods:
    """Likelihoods of all edges in one stack."""
    freq = used[0].freq_cpp
    ranks = np.array([one.value.size for one in used])
    root = np.zeros((len(used), 2 * freq.size, int(ranks.max())))
    value = np.zeros((len(used), int(ranks.max())))
    for i, (one, rank) in enumerate(zip(used, ranks, strict=True)):
        root[i, :, :rank], value[i, :rank] = one.root, one.value
    return EdgeLikelihoods.of_roots(freq, root, value, ranks.astype(float), number, axis_deg)
