"""Many given regions, of one image or of several: each is measured, or rejected in its place."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.errors import AcutanceError, ImageError, OptionError, RegionError
from acutance.execution import require_workers, results_in_turn
from acutance.numerics.one_thread import one_thread
from acutance.raster import Box, Image
from acutance.raster.disk_copy import disk_copy
from acutance.targets.measurement import Measurement
from acutance.targets.record import Record
from acutance.targets.region import RoiLike
from acutance.targets.steps import Steps, stacks, together
from acutance.targets.target_result import Rejected

__all__ = ["ImageRegions", "are_many", "in_turn"]

Measure = Callable[[Image, RoiLike], Steps[Measurement]]
ImageRegions = Iterable[tuple[Image | ArrayLike, RoiLike]]
"""Pairs of an image and a region of it."""


def in_turn(
    measure: Measure,
    image: Image | ArrayLike | ImageRegions,
    regions: Iterable[RoiLike] | None = None,
    *,
    workers: int = 1,
) -> Iterator[Record | Rejected]:
    """Measure regions in one process, or on several; results in their order.

    Regions are taken as they are needed, the first one alone, then a few more each time, and few
    results wait: memory stays flat however many there are.

    Parameters
    ----------
    measure : function of (image, region)
        In steps; at the top of a module, or a ``functools.partial`` of one.
    image : Image, (rows, cols) array_like or pairs
        Of all regions; or, without `regions`, pairs of an image and a region.
    regions : iterable of regions, optional
    workers : int, optional
        Processes. With more than one, a script has to guard its own start by
        ``if __name__ == "__main__"``, and images in memory are kept in temporary files meanwhile.

    Returns
    -------
    iterator of Record and Rejected
        What cannot be measured is rejected with stage ("image", "region", "options" or
        "fit"), reason and place. It ends no run.

    Raises
    ------
    OptionError
        If there is no worker.
    """
    require_workers(workers)
    pairs = image if regions is None else _of_one(image, regions)
    return _results(measure, _numbered(pairs), workers)


def _results(
    measure: Measure, pairs: Iterator[tuple[int, Any, Any]], workers: int
) -> Iterator[Record | Rejected]:
    # The first result has to wait for no other.
    if workers == 1:
        for some in stacks(pairs, first=1):
            yield from _records(measure, some)
        return
    with TemporaryDirectory(prefix="acutance-") as folder:
        there = stacks(_on_disk(pairs, Path(folder)), first=1)
        for found in results_in_turn(partial(_fields, measure), there, workers=workers):
            yield from (one if isinstance(one, Rejected) else Record(one) for one in found)


def are_many(image: Any, roi: Any) -> bool:
    """Whether what stands for one region are many, or what stands for an image are pairs."""
    if roi is None:
        return _are_pairs(image)
    if isinstance(roi, np.ndarray):
        # Two columns are the corners of one polygon.
        return roi.ndim == 2 and roi.shape[1] != 2
    if isinstance(roi, list | tuple):
        return not any(isinstance(one, int | float | np.number) for one in roi)
    return isinstance(roi, Iterator)


def _are_pairs(image: Any) -> bool:
    """Whether something is no image but pairs of an image and a region."""
    if isinstance(image, Iterator):
        return True
    if not isinstance(image, list | tuple) or not image:
        return False
    first = image[0]
    return isinstance(first, tuple) and len(first) == 2 and isinstance(first[0], Image | np.ndarray)


def _of_one(image: Any, regions: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
    source = Image.of(image)
    if isinstance(regions, str | bytes | type) or not isinstance(regions, Iterable):
        raise OptionError(f"regions are {regions!r:.80}: give a list of regions")
    return ((source, roi) for roi in regions)


def _numbered(pairs: Any) -> Iterator[tuple[int, Any, Any]]:
    for place, pair in enumerate(pairs):
        try:
            image, roi = pair
        except (TypeError, ValueError):
            raise OptionError(
                f"without regions a list of pairs (image, region) is measured, and number "
                f"{place + 1} is {pair!r:.80}: give regions"
            ) from None
        yield place, image, roi


def _on_disk(pairs: Iterator[tuple[int, Any, Any]], folder: Path) -> Iterator[tuple[int, Any, Any]]:
    """The same regions, of images that other processes can read."""
    copies: dict[int, Image] = {}
    for place, image, roi in pairs:
        copy = copies.get(id(image))
        if copy is None:
            try:
                copy = disk_copy(Image.of(image), folder)
            except ImageError:
                # The process that is to measure it says so.
                yield place, image, roi
                continue
            if isinstance(image, Image | np.ndarray):
                copies[id(image)] = copy
                weakref.finalize(image, copies.pop, id(image), None)
        yield place, copy, roi


# What a record derives from a fit are products of many small matrices too.
@one_thread
def _records(measure: Measure, some: Sequence[tuple[int, Any, Any]]) -> list[Record | Rejected]:
    """The record of every region, or why there is none."""
    return together([_record(measure, *numbered) for numbered in some])


def _record(measure: Measure, place: int, image: Any, roi: Any) -> Steps[Record | Rejected]:
    """The record of one region, or why there is none."""
    try:
        found = yield from measure(image, roi)
        # Numbers are read from the curves, and checks are answered, when they are asked for first.
        yield
        found.numbers()
        yield
        tuple(found.checks)
        yield
        return found.record
    except AcutanceError as error:
        return Rejected(_stage(error), str(error), _where(place, image, roi))


def _fields(
    measure: Measure, some: Sequence[tuple[int, Any, Any]]
) -> list[Mapping[str, Any] | Rejected]:
    """The records' fields, on their way to another process: curves go as arrays, unwritten."""
    records = _records(measure, some)
    return [one if isinstance(one, Rejected) else one.fields for one in records]


def _stage(error: AcutanceError) -> str:
    kinds = (("image", ImageError), ("region", RegionError), ("options", OptionError))
    return next((stage for stage, kind in kinds if isinstance(error, kind)), "fit")


def _where(place: int, image: Any, roi: Any) -> dict[str, Any]:
    """Which region of which image."""
    found: dict[str, Any] = {"place": place, "path": getattr(image, "path", None)}
    if isinstance(roi, Box):
        found["roi"] = list(roi.as_tuple())
    elif isinstance(roi, np.ndarray):
        found["roi"] = roi.tolist()
    elif isinstance(roi, tuple | list):
        found["roi"] = list(roi)
    return found
