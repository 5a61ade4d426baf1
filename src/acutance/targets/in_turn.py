"""Many given regions, of one image or of several: each is measured, or rejected in its place."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from acutance.errors import AcutanceError, ImageError, OptionError, RegionError
from acutance.execution import require_workers, results_in_turn
from acutance.numerics.one_thread import one_thread
from acutance.raster import Box, Gsd, Image
from acutance.raster.disk_copy import disk_copy
from acutance.targets.measurement import Measurement
from acutance.targets.record import Record
from acutance.targets.region import RegionPixels, RoiLike, read_region
from acutance.targets.steps import Steps, stacks, together
from acutance.targets.target_result import Rejected

__all__ = ["ImageRegions", "are_many", "in_turn"]

Measure = Callable[[RegionPixels], Steps[Measurement]]
ImageRegions = Iterable[tuple[Image | ArrayLike, RoiLike]]
"""Pairs of an image and a region of it."""

_Where = dict[str, Any]
"""Which region of which image, for whoever reads that it was rejected."""
_Read = RegionPixels | Rejected
"""The pixels of a region, or why there are none."""


def in_turn(
    measure: Measure,
    image: Image | ArrayLike | ImageRegions,
    regions: Iterable[RoiLike] | None = None,
    *,
    gsd_m: float | Gsd | None = None,
    workers: int = 1,
) -> Iterator[Record | Rejected]:
    """Measure regions in one process, or on several; results in their order.

    Regions are taken as they are needed, the first one alone, then a few more each time, and few
    results wait: memory stays flat however many there are. What is in memory is read when it is
    taken: whoever hands out pairs may fill the same array anew for the next one.

    Parameters
    ----------
    measure : function of the pixels of a region
        In steps; at the top of a module, or a ``functools.partial`` of one.
    image : Image, (rows, cols) array_like or pairs
        Of all regions; or, without `regions`, pairs of an image and a region.
    regions : iterable of regions, optional
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the images' own.
    workers : int, optional
        Processes. With more than one, a script has to guard its own start by
        ``if __name__ == "__main__"``, and what is in memory waits in temporary files.

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
    given: Any = image
    if regions is None:
        return _results(measure, partial(_of_pairs, given, gsd_m), workers)
    source = Image.of(given)
    if isinstance(regions, str | bytes | type) or not isinstance(regions, Iterable):
        raise OptionError(f"regions are {regions!r:.80}: give a list of regions")
    return _results(measure, partial(_of_one, source, regions, gsd_m), workers)


def _results(
    measure: Measure, waiting: Callable[[Path | None], Iterator[_Waiting]], workers: int
) -> Iterator[Record | Rejected]:
    # The first result has to wait for no other.
    if workers == 1:
        for some in stacks(waiting(None), first=1):
            yield from _records(measure, some)
        return
    with TemporaryDirectory(prefix="acutance-") as folder:
        there = stacks(waiting(Path(folder)), first=1)
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


class _Waiting(NamedTuple):
    """A region that was taken.

    Attributes
    ----------
    where : dict
    pixels : function
        Gives them, in the process that is to measure them.
    """

    where: _Where
    pixels: Callable[[], _Read]


def _of_one(
    image: Image, regions: Iterable[Any], gsd_m: float | Gsd | None, folder: Path | None
) -> Iterator[_Waiting]:
    """Regions of one image, which other processes read in a file if there is a folder for it."""
    if folder is not None:
        # Where it cannot be read, the process that is to measure it says so.
        with suppress(ImageError):
            image = disk_copy(image, folder)
    for place, roi in enumerate(regions):
        where = _where(place, image, roi)
        yield _Waiting(where, partial(_read, where, image, _own(roi), gsd_m))


def _of_pairs(
    pairs: Iterable[Any], gsd_m: float | Gsd | None, folder: Path | None
) -> Iterator[_Waiting]:
    """Regions of pairs: files are read by the process that measures, arrays at once."""
    for place, pair in enumerate(pairs):
        try:
            image, roi = pair
        except (TypeError, ValueError):
            raise OptionError(
                f"without regions a list of pairs (image, region) is measured, and number "
                f"{place + 1} is {pair!r:.80}: give regions"
            ) from None
        where = _where(place, image, roi)
        if isinstance(image, Image) and image.path is not None:
            yield _Waiting(where, partial(_read, where, image, _own(roi), gsd_m))
            continue
        found = _read_apart(where, image, roi, gsd_m)
        yield _Waiting(where, partial(_as_is, found) if folder is None else _stored(found, folder))


def _own(roi: Any) -> Any:
    """A region that its caller does not change."""
    return roi.copy() if isinstance(roi, np.ndarray | list) else roi


def _read(where: _Where, image: Any, roi: Any, gsd_m: float | Gsd | None) -> _Read:
    try:
        return read_region(image, roi, gsd_m)
    except AcutanceError as error:
        return _rejected(error, where)


def _read_apart(where: _Where, image: Any, roi: Any, gsd_m: float | Gsd | None) -> _Read:
    """The pixels of a region, of which nothing is left to be read in the image."""
    try:
        return read_region(image, roi, gsd_m).apart()
    except AcutanceError as error:
        return _rejected(error, where)


def _as_is(found: _Read) -> _Read:
    return found


def _stored(found: _Read, folder: Path) -> Callable[[], _Read]:
    """Pixels that wait in a file: many, and large ones, would fill the memory."""
    with NamedTemporaryFile(dir=folder, delete=False) as file:
        pickle.dump(found, file, pickle.HIGHEST_PROTOCOL)
    return partial(_fetched, Path(file.name))


def _fetched(path: Path) -> _Read:
    """What a file holds, which is needed once."""
    found: _Read = pickle.loads(path.read_bytes())
    path.unlink()
    return found


# What a record derives from a fit are products of many small matrices too.
@one_thread
def _records(measure: Measure, some: Sequence[_Waiting]) -> list[Record | Rejected]:
    """The record of every region, or why there is none."""
    return together([_record(measure, *one) for one in some])


def _record(
    measure: Measure, where: _Where, pixels: Callable[[], _Read]
) -> Steps[Record | Rejected]:
    """The record of one region, or why there is none."""
    region = pixels()
    if isinstance(region, Rejected):
        return region
    try:
        found = yield from measure(region)
        # Numbers are read from the curves, and checks are answered, when they are asked for first.
        yield
        found.numbers()
        yield
        tuple(found.checks)
        yield
        return found.record
    except AcutanceError as error:
        return _rejected(error, where)


def _fields(measure: Measure, some: Sequence[_Waiting]) -> list[Mapping[str, Any] | Rejected]:
    """The records' fields, on their way to another process: curves go as arrays, unwritten."""
    records = _records(measure, some)
    return [one if isinstance(one, Rejected) else one.fields for one in records]


def _rejected(error: AcutanceError, where: _Where) -> Rejected:
    kinds = (("image", ImageError), ("region", RegionError), ("options", OptionError))
    stage = next((stage for stage, kind in kinds if isinstance(error, kind)), "fit")
    return Rejected(stage, str(error), where)


def _where(place: int, image: Any, roi: Any) -> _Where:
    """Which region of which image."""
    found: _Where = {"place": place, "path": getattr(image, "path", None)}
    if isinstance(roi, Box):
        found["roi"] = list(roi.as_tuple())
    elif isinstance(roi, np.ndarray):
        found["roi"] = roi.tolist()
    elif isinstance(roi, tuple | list):
        found["roi"] = list(roi)
    return found
