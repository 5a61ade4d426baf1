"""Measure all targets of all images, and keep the results in an archive."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from acutance.archive import Archive
from acutance.batch.image_list import ImageFile, content_of, list_images, stated_of
from acutance.batch.measure_image import BatchTask, BatchWork, MeasuredImage, measure_image
from acutance.batch.plan import BatchPlan, read_plan
from acutance.batch.plan_options import choose_options
from acutance.batch.remembered_images import KnownImage, RememberedImages
from acutance.batch.row_key import reading_digest, row_key, target_digest, unreadable_key
from acutance.batch.selected_bands import Band, selected
from acutance.batch.summary import BatchSummary, Tally
from acutance.errors import OptionError
from acutance.execution import require_workers, run_on_cluster, run_tasks
from acutance.raster.surveyed_targets import SurveyedTarget, read_targets, targets_of

__all__ = ["run_batch"]

Progress = Callable[[int, int], None]
KeptKeys = Callable[[Sequence[str]], None]

_READING = ("gsd_m", "nodata", "along_track", "linearize", "band_names")
_MANY_BYTES = 2 * 10**9
"""So many are read for their checksums by all processes."""
_PAUSE_S = 2.0
"""Between two writings of what was found out about images."""


def run_batch(
    plan: BatchPlan | str | os.PathLike[str] | None = None,
    *,
    images: str | Sequence[str] | None = None,
    targets: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    archive: str | os.PathLike[str] | None = None,
    bands: Sequence[str | int] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    kept: KeptKeys | None = None,
) -> BatchSummary:
    """Measure every target in every image, and keep the results in an archive.

    There is one row for every image, target and band: a measurement, or the reason why there is
    none. What the archive has already, of the same content and options, is not done again; so a
    batch that was interrupted, however, goes on where it was. An image that cannot be read is one
    row, and stops no other.

    Parameters
    ----------
    plan : BatchPlan or path, optional
        A plan, or the TOML file of one. The arguments below go before it, and are enough without.
    images : str or sequence of str, optional
        Paths, and patterns such as "images/*.tif".
    targets : path or mapping, optional
        GeoJSON features: see the documentation of batches.
    archive : path or str, optional
        A file, or the URL of a database.
    bands : sequence of (str or int), optional
        Names or numbers; all without it.
    workers : int, optional
        Processes; all cores without it. With more than one, a script has to guard its own start
        by ``if __name__ == "__main__"``.
    scheduler : str, optional
        Address of a dask scheduler whose workers see the images under the same names.
    progress : function of (images done, images in all), optional
    kept : function of keys, optional
        Told the keys of rows once the archive has them.

    Returns
    -------
    BatchSummary

    Raises
    ------
    OptionError
        If plan, targets or options hold what is not known.
    ArchiveError
        If the archive cannot be used.

    Examples
    --------
    >>> found = ac.run_batch(
    ...     images="images/*.tif", targets="targets.geojson", archive="campaign.db"
    ... )  # doctest: +SKIP
    >>> found.measured, found.reasons  # doctest: +SKIP
    """
    begin = time.monotonic()
    wanted = _wanted(plan, images, targets, archive, bands, workers, scheduler)
    work = _work(wanted)
    files = list_images(wanted.images)
    with Archive(wanted.archive) as place:
        batch = _Batch(wanted, work, place, progress, kept)
        batch.run(files)
        return batch.summary(len(files), time.monotonic() - begin)


def _wanted(
    plan: BatchPlan | str | os.PathLike[str] | None,
    images: str | Sequence[str] | None,
    targets: str | os.PathLike[str] | Mapping[str, Any] | None,
    archive: str | os.PathLike[str] | None,
    bands: Sequence[str | int] | None,
    workers: int | None,
    scheduler: str | None,
) -> BatchPlan:
    """The plan with the arguments that were given."""
    if plan is None:
        missing = [
            name
            for name, one in (("images", images), ("targets", targets), ("archive", archive))
            if one is None
        ]
        if missing:
            raise OptionError(f"{', '.join(missing)}: give them, or a plan that has them")
        plan = BatchPlan(images=(), targets={}, archive="")
    elif not isinstance(plan, BatchPlan):
        plan = read_plan(plan)
    given = {
        "images": None if images is None else _texts(images),
        "targets": targets if isinstance(targets, Mapping | None) else os.fspath(targets),
        "archive": None if archive is None else os.fspath(archive),
        "bands": None if bands is None else tuple(bands),
        "workers": workers,
        "dask": scheduler,
    }
    found = replace(plan, **{name: one for name, one in given.items() if one is not None})
    if found.workers is not None:
        require_workers(found.workers)
        if found.dask is not None:
            raise OptionError("workers and dask are both given: the cluster has its own")
    return found


def _texts(images: str | Sequence[str]) -> tuple[str, ...]:
    if isinstance(images, str | os.PathLike):
        return (os.fspath(images),)
    return tuple(os.fspath(one) for one in images)


def _work(plan: BatchPlan) -> BatchWork:
    """Targets with their options."""
    if isinstance(plan.targets, Mapping):
        crs = plan.targets.get("crs")
        targets = targets_of(plan.targets, "targets", crs if isinstance(crs, str) else None)
    else:
        targets = read_targets(plan.targets)
    chosen = choose_options(targets, plan.options)
    digests = [target_digest(one, how) for one, how in zip(targets, chosen, strict=True)]
    return BatchWork(targets, chosen, digests, plan.bands)


class _Batch:
    """A batch under way: what was there, what is to do, what came out."""

    def __init__(
        self,
        plan: BatchPlan,
        work: BatchWork,
        archive: Archive,
        progress: Progress | None,
        kept: KeptKeys | None,
    ) -> None:
        self.plan, self.work, self.archive = plan, work, archive
        self.progress, self.kept = progress, kept
        self.remembered, self.tally = RememberedImages(), Tally()
        self.done_before, self.added, self.measuring_s = 0, 0, 0.0
        self.finished, self.total = 0, 0
        self.run_number: int | None = None
        self.unreadable: list[str] = []
        self.learned: dict[ImageFile, KnownImage] = {}
        self.written_at = time.monotonic()
