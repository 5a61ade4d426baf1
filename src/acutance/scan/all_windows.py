"""All windows of an image, each a task of its own: on several processes, or on a cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from acutance.errors import ImageError, OptionError, RegionError
from acutance.execution import require_workers, run_on_cluster, run_tasks
from acutance.raster import Box, Gsd, Image, Region
from acutance.raster.disk_copy import disk_copy, named_from_root
from acutance.scan.kept_windows import KeptWindows
from acutance.scan.options import ScanOptions
from acutance.scan.scan_identity import scan_identity
from acutance.scan.window_edges import WindowEdges, scan_window
from acutance.scan.windows import Window, windows
from acutance.targets.region import RoiLike, chosen_region

__all__ = ["Progress", "Tell", "answered_fit", "part_of", "scan_windows"]

Found = list[WindowEdges]
"""The edges of a window: of every band."""
Progress = Callable[[int, int], None]
"""Function of (windows done, windows in all)."""
Tell = Callable[[str], None]
"""Function of words: what was found so far, and what is done then."""
_MIN_SIDE_PX = 8


def part_of(image: Image, roi: RoiLike) -> tuple[Box, Region | None]:
    """The part of an image to be read, and the region in it unless it is the whole image.

    Windows are read with a margin, of which pixels beyond the region are no part.

    Raises
    ------
    RegionError
        If it is not inside the image, or smaller than any edge.
    """
    where = Box.whole(image.shape) if roi is None else chosen_region(roi)
    box = where if isinstance(where, Box) else where.box(image.shape)
    box.require_inside(image.shape)
    region = None if roi is None else where
    if isinstance(region, Box):
        region = None if box == Box.whole(image.shape) else Region.from_box(box)
    if min(box.shape) < _MIN_SIDE_PX:
        raise RegionError(
            f"{box.height} x {box.width} pixels were to be scanned, and an edge needs at least "
            f"{_MIN_SIDE_PX} both ways; give a larger part or image"
        )
    return box, region


def scan_windows(
    images: Sequence[Image],
    box: Box,
    region: Region | None,
    *,
    gsd: Gsd | None,
    options: ScanOptions,
    workers: int = 1,
    scheduler: str | None = None,
    keep: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    tell: Tell | None = None,
) -> list[list[WindowEdges]]:
    """The edges of all windows, in their order, and of every band.

    Parameters
    ----------
    images : sequence of Image
        The bands, of equal shape.
    box : Box
        The part to be scanned.
    region : Region or None
        Pixels outside of it are not used.
    gsd : Gsd or None
        Instead of the images' own.
    options : ScanOptions
    workers : int, optional
        Processes.
    scheduler : str, optional
        Address of a dask scheduler whose workers are used instead.
    keep : path, optional
        File in which finished windows are kept.
    progress : function of (windows done, windows in all), optional
    tell : function of str, optional
        Hears after every window how many edges were found so far.

    Raises
    ------
    OptionError
        If there is no worker, a cluster is to read an image in memory or cannot be reached, or
        the file is of another scan.
    """
    require_workers(workers)
    parts = list(windows(box, options.window_px, images[0].shape, options.half_width_px))
    scan = partial(scan_window, gsd=gsd, options=options, region=region)
    if scheduler is None:
        run = partial(_run_here, scan, images, workers=workers)
    else:
        run = partial(_run_on_cluster, scan, images, scheduler=scheduler)
    if keep is None:
        return _all_windows(run, parts, None, progress, tell)
    with KeptWindows(keep, scan_identity(images, box, region, gsd, options)) as kept:
        return _all_windows(run, parts, kept, progress, tell)


def _all_windows(
    run: Callable[[Sequence[Window], Callable[[int, Found], None]], None],
    parts: Sequence[Window],
    kept: KeptWindows | None,
    progress: Progress | None,
    tell: Tell | None,
) -> list[Found]:
    """Windows that are kept already, and then the others, as they are finished."""
    done: dict[int, Found] = {} if kept is None else dict(kept.done)
    todo = [place for place in range(len(parts)) if place not in done]

    def say() -> None:
        if tell is not None:
            tell(_edges_so_far(done.values()))
        if progress is not None:
            progress(len(done), len(parts))

    if done:
        say()

    def add(number: int, found: Found) -> None:
        place = todo[number]
        if kept is not None:
            kept.keep(place, found)
        done[place] = found
        say()

    try:
        run([parts[place] for place in todo], add)
    except KeyboardInterrupt:
        path = None if kept is None else kept.path
        raise KeyboardInterrupt(_interruption(len(done), len(parts), path)) from None
    return [done[place] for place in range(len(parts))]


def _edges_so_far(done: Collection[Found]) -> str:
    """How many edges were found, and how many of them can be used in the band that shows most."""
    edges = sum(len(first.rows) for first, *_ in done)
    used = (sum(len(one.used) for one in band) for band in zip(*done, strict=True))
    return f"{edges} edges, {max(used, default=0)} to be used"


def _run_here(
    scan: Callable[[Sequence[Image], Window], Found],
    images: Sequence[Image],
    parts: Sequence[Window],
    add: Callable[[int, Found], None],
    workers: int,
) -> None:
    """Windows on the processes of this machine."""
    used = max(1, min(workers, len(parts)))
    with ExitStack() as stack:
        if used > 1:
            folder = Path(stack.enter_context(TemporaryDirectory(prefix="acutance-")))
            images = [disk_copy(image, folder) for image in images]
        run_tasks(partial(scan, images), parts, add, workers=used, chunk=1)


def _run_on_cluster(
    scan: Callable[[Sequence[Image], Window], Found],
    images: Sequence[Image],
    parts: Sequence[Window],
    add: Callable[[int, Found], None],
    scheduler: str,
) -> None:
    """Windows on the workers of a cluster."""
    try:
        run_on_cluster(partial(scan, _on_cluster(images)), parts, add, scheduler=scheduler)
    except ImageError as error:
        raise ImageError(
            f"{error}. A worker of {scheduler} found this: all of them have to see the file under "
            "this name"
        ) from error


def _on_cluster(images: Sequence[Image]) -> list[Image]:
    """The same images, as machines that see the same files find them.

    Raises
    ------
    OptionError
        If one is in memory.
    """
    if any(image.path is None for image in images):
        raise OptionError(
            "the image is in memory, where the workers of a cluster cannot read it: write it to a "
            "file that all of them see (acutance.raster.write_geotiff), and scan that"
        )
    return [named_from_root(image) for image in images]


@contextmanager
def answered_fit(windows: int, keep: str | os.PathLike[str] | None) -> Iterator[None]:
    """Say of all windows what an interrupt leaves of them, while sensors are fitted to their edges.

    Parameters
    ----------
    windows : int
        How many there are.
    keep : path, optional
        The file that keeps them.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_interruption(windows, windows, keep)) from None


def _interruption(done: int, total: int, kept: str | os.PathLike[str] | None) -> str:
    if kept is None:
        return (
            f"interrupted: {done} of {total} windows were done and are lost; name a file that "
            "keeps them (keep, --keep) and a scan goes on where it was"
        )
    return (
        f"interrupted: {done} of {total} windows are kept in {kept}; run the same command "
        "again to go on"
    )
