"""Measure a sensor in several bands at once, and the shifts between them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import require_all
from acutance.curves.short_repr import ShortRepr
from acutance.errors import FewEdgesError, ImageError, NoEdgeError
from acutance.execution import results_in_turn
from acutance.raster import Gsd, Image, open_bands
from acutance.raster.band_label import label_band
from acutance.scan.all_windows import Progress, Tell, answered_fit, part_of, scan_windows
from acutance.scan.band_shift import BandShift, band_shift
from acutance.scan.edge_table import EdgeTable
from acutance.scan.options import ScanOptions
from acutance.scan.scene import edges_seen, measured_scene
from acutance.scan.scene_edges import SceneEdges
from acutance.scan.scene_measurement import SceneMeasurement
from acutance.scan.sensor_fit import EdgesSeen, SensorFit, fit_sensor
from acutance.scan.stated_objects import gsd_of_part, require_statement
from acutance.targets.options import chosen_options
from acutance.targets.region import RoiLike
from acutance.targets.target_result import Rejected

__all__ = ["BandEdges", "BandScenes", "scan_bands"]

_MIN_RATIO = 8
"""Of both other sides to the last, from which this is an axis of bands: no scene is so narrow."""


@dataclass(frozen=True, eq=False)
class BandEdges(EdgeTable):
    """The edges of several bands in one table: every edge has a row in each band.

    Parameters
    ----------
    by_band : mapping of str to SceneEdges
    names : mapping of str to (str or None)
        Of the bands, where they are known.
    """

    by_band: Mapping[str, SceneEdges]
    names: Mapping[str, str | None] = field(default_factory=dict)

    def columns(self) -> dict[str, NDArray[Any]]:
        """All arrays by name; the first is the band, by its number, then its name if it has one."""
        each = {name: one.columns() for name, one in self.by_band.items()}
        sizes = [one.size for one in self.by_band.values()]
        bands = {"band": np.repeat(np.array(list(each)), sizes)}
        if any(self.names.values()):
            own = [self.names.get(name) or name for name in each]
            bands["band_name"] = np.repeat(np.array(own), sizes)
        names = next(iter(each.values()))
        joined = {name: np.concatenate([own[name] for own in each.values()]) for name in names}
        return {**bands, **joined}


@dataclass(frozen=True, eq=False)
class BandScenes(ShortRepr):
    """A sensor measured in several bands of a scene.

    Parameters
    ----------
    scenes : mapping of str to SceneMeasurement
        By the number of the band, in the order they were asked for. All have the same edges in
        the same order; one that a band does not show is not used there.
    shifts : mapping of str to BandShift
        Where each other band lies relative to the first that was measured; a band that shares too
        few edges with it is missing.
    rejected : tuple of Rejected
        Bands that could not be measured, and why; `values` hold the "band".
    unshifted : tuple of Rejected
        Bands that were measured and have no shift, and why; `values` hold the "band".
    """

    scenes: Mapping[str, SceneMeasurement]
    shifts: Mapping[str, BandShift]
    rejected: tuple[Rejected, ...] = ()
    unshifted: tuple[Rejected, ...] = ()

    @property
    def first(self) -> str:
        """The band that shifts are relative to."""
        return next(iter(self.scenes))

    def label(self, band: str) -> str:
        """A band by its number, and its name where that is known: "2 (B3)"."""
        scene = self.scenes.get(band)
        if scene is not None:
            return label_band(band, scene.image.band_name)
        missing = (one for one in self.rejected if one.values["band"] == band)
        return label_band(band, next((one.values.get("band_name") for one in missing), None))

    @property
    def measurements(self) -> tuple[SceneMeasurement, ...]:
        """The measurements of all bands."""
        return tuple(self.scenes.values())

    def _repr_html_(self) -> str:
        from acutance.report import notebook_html

        return notebook_html(self)

    def summary(self) -> str:
        """Which bands, and the MTF at Nyquist of each."""
        return "; ".join(
            f"band {self.label(name)}: mtf_nyquist across {one.across.mtf_nyquist}, along "
            f"{one.along.mtf_nyquist}"
            for name, one in self.scenes.items()
        )

    @property
    def edges(self) -> BandEdges:
        """The edges of all bands in one table."""
        return BandEdges(
            {name: one.edges for name, one in self.scenes.items()},
            {name: one.image.band_name for name, one in self.scenes.items()},
        )


def scan_bands(
    image: str | os.PathLike[str] | Sequence[Image | ArrayLike] | NDArray[Any],
    bands: Sequence[int | str] | None = None,
    *,
    roi: RoiLike = None,
    gsd_m: float | Gsd | None = None,
    options: ScanOptions | None = None,
    workers: int = 1,
    scheduler: str | None = None,
    keep: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    tell: Tell | None = None,
) -> BandScenes:
    """Measure a sensor in several registered bands of a scene, and the shifts between them.

    Edges are found once, each in the band that shows it best, and measured at the same place in
    every band that shows it.

    Parameters
    ----------
    image : path, sequence of Image or (bands, rows, cols) array_like
        Bands of one grid, displaced by less than about 2 pixels.
    bands : sequence of int or str, optional
        Which bands, by their numbers, from 1, or of a file by their names, too; all of them without
        it (a band of transparency is none).
    roi : Region, Box, (row, col, height, width), (n, 2) corners or None
        Part of the image.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the image's own.
    options : ScanOptions, optional
    workers, scheduler, keep : optional
        As of `acutance.scan_scene`.
    progress : function of (done, in all), optional
        Of windows and then of bands, whose sensors are fitted.
    tell : function of str, optional
        As of `acutance.scan_scene`.

    Returns
    -------
    BandScenes
        A `SceneMeasurement` of every band, and where the bands lie relative to the first.

    Raises
    ------
    ImageError, RegionError
        If there are no pixels to scan, or the bands differ in shape.
    FewEdgesError
        If no band has enough edges; it holds them.
    OptionError
        As of `acutance.scan_scene`.

    Examples
    --------
    >>> found = ac.scan_bands("scene.tif", [1, 2, 3], workers=2)  # doctest: +SKIP
    >>> found.scenes["2"].across.mtf_nyquist, found.shifts["2"].row_px  # doctest: +SKIP
    """
    chosen, gsd = chosen_options(options, ScanOptions), Gsd.given(gsd_m)
    images = _bands(image, bands)
    first = next(iter(images.values()))
    box, region = part_of(first, roi)
    require_statement(chosen, gsd_of_part(first, box, gsd))
    counted = None if progress is None else _WindowsAndBands(progress, len(images))
    found = scan_windows(
        list(images.values()), box, region, gsd=gsd, options=chosen, workers=workers,
        scheduler=scheduler, keep=keep, progress=counted, tell=tell,
    )  # fmt: skip
    seen: dict[str, tuple[SceneEdges, EdgesSeen]] = {}
    rejected: list[Rejected] = []
    refused: dict[str, SceneEdges] = {}
    for place, (name, one) in enumerate(images.items()):
        try:
            seen[name] = edges_seen(one, box, chosen, [windows[place] for windows in found])
        except FewEdgesError as error:
            rejected.append(Rejected("fit", str(error), _named(name, one)))
            refused[name] = error.edges
            if counted is not None:
                counted.band_is_done(len(found), len(rejected))
    if tell is not None and seen:
        tell("the sensor of one band" if len(seen) == 1 else f"the sensors of {len(seen)} bands")
    scenes: dict[str, SceneMeasurement] = {}
    with answered_fit(len(found), keep):
        for (name, (edges, _)), fit in zip(seen.items(), _fits(seen, workers), strict=True):
            scenes[name] = measured_scene(images[name], box, gsd, chosen, edges, fit, region)
            if counted is not None:
                counted.band_is_done(len(found), len(rejected) + len(scenes))
    if not scenes:
        whose = "the band" if len(images) == 1 else f"none of the {len(images)} bands"
        not_measured = "could not be measured" if len(images) == 1 else "could be measured"
        raise FewEdgesError(f"{whose} {not_measured}: {rejected[0].reason}", BandEdges(refused))
    shifts, unshifted = _shifts(scenes)
    return BandScenes(scenes, shifts, tuple(rejected), unshifted)


def _fits(seen: Mapping[str, tuple[SceneEdges, EdgesSeen]], workers: int) -> Iterator[SensorFit]:
    """The sensors of all bands in turn: several bands at once, or one on all processes."""
    at_once = min(workers, len(seen))
    fit = partial(fit_sensor, workers=1 if at_once > 1 else workers)
    return results_in_turn(fit, [own for _, own in seen.values()], workers=at_once)


@dataclass(frozen=True)
class _WindowsAndBands:
    """Progress of windows and bands in one count."""

    progress: Progress
    bands: int

    def __call__(self, done: int, windows: int) -> None:
        self.progress(done, windows + self.bands)

    def band_is_done(self, windows: int, done: int) -> None:
        self.progress(windows + done, windows + self.bands)


def _named(band: str, image: Image) -> dict[str, str]:
    """What a band that was not measured is called."""
    name = image.band_name
    return {"band": band} if name is None else {"band": band, "band_name": name}


def _shifts(
    scenes: Mapping[str, SceneMeasurement],
) -> tuple[dict[str, BandShift], tuple[Rejected, ...]]:
    """Shifts of all bands relative to the first, and bands without one."""
    (_, first), *others = scenes.items()
    shifts: dict[str, BandShift] = {}
    unshifted: list[Rejected] = []
    for name, one in others:
        try:
            shifts[name] = band_shift(first.edges, one.edges)
        except NoEdgeError as error:
            unshifted.append(Rejected("shift", str(error), {"band": name}))
    return shifts, tuple(unshifted)


def _bands(image: Any, bands: Sequence[int | str] | None) -> dict[str, Image]:
    """The bands by their numbers.

    Raises
    ------
    ImageError
        If there is no such band, or they differ in shape.
    """
    if isinstance(image, str | os.PathLike):
        found = {str(one.band): one for one in open_bands(image, bands)}
    elif isinstance(image, Image):
        raise ImageError(
            "the image is one band: give the path of the file, or a sequence of its bands"
        )
    else:
        _require_bands(image)
        numbered = _numbered([Image.of(one) for one in image])
        asked = None if bands is None else require_all((Integral, str), "bands", bands)
        wanted = list(numbered) if asked is None else [str(one) for one in asked]
        missing = [one for one in wanted if one not in numbered]
        if missing or not wanted:
            raise ImageError(
                f"band {', '.join(missing) or 'none'} was requested of {len(numbered)}: choose "
                f"bands from 1 to {len(numbered)}"
            )
        found = {one: numbered[one] for one in wanted}
    shapes = {one.shape for one in found.values()}
    if len(shapes) > 1:
        raise ImageError(
            "the bands differ in shape ("
            + ", ".join(f"{rows} x {cols}" for rows, cols in sorted(shapes))
            + "): scan those of one grid together"
        )
    return found


def _require_bands(image: Any) -> None:
    """Refuse an array whose first axis is not that of the bands: its rows would be taken for them.

    Raises
    ------
    ImageError
        If it is one band, or the bands come last.
    """
    if isinstance(image, type) or not isinstance(image, Iterable):
        raise ImageError(
            f"the image is {image!r:.80}: give the path of a file, or a sequence of its bands"
        )
    shape = tuple(getattr(image, "shape", ()))
    if len(shape) == 2:
        raise ImageError(
            f"the array has shape {shape}, that of one band: measure it with scan_scene, or give "
            "several bands, (bands, rows, columns)"
        )
    if len(shape) == 3 and _MIN_RATIO * shape[2] <= min(shape[:2]):
        raise ImageError(
            f"the array has shape {shape}, and bands come first, (bands, rows, columns): here they "
            "seem to come last, give numpy.moveaxis(array, -1, 0), or array[..., band] for one to "
            "scan_scene; if they do come first, give list(array)"
        )


def _numbered(images: Sequence[Image]) -> dict[str, Image]:
    """Bands by their numbers in their files; where these repeat, by their order."""
    own = [str(one.band) for one in images if one.path is not None]
    if len(set(own)) == len(images):
        return dict(zip(own, images, strict=True))
    return {str(place): one for place, one in enumerate(images, start=1)}
