"""The images of a batch over processes, or over the workers of a cluster.

A scene occupies one process for long. Images with scenes are spread as far as every process has as
many; of those left over the scenes come one after the other, each over all processes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from acutance.batch.measure_image import BatchTask, BatchWork, MeasuredImage, measure_image
from acutance.errors import ArchiveError
from acutance.execution import run_on_cluster, run_tasks

__all__ = ["spread_images"]

Keep = Callable[[int, MeasuredImage], None]


def spread_images(
    work: BatchWork,
    tasks: Sequence[BatchTask],
    keep: Keep,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
) -> None:
    """Measure all images.

    Parameters
    ----------
    work : BatchWork
    tasks : sequence of BatchTask
    keep : function of (place of the task, MeasuredImage)
        Called in this process; what it has of an image already, it passes over.
    workers : int, optional
        Processes; all cores without it.
    scheduler : str, optional
        Address of a dask scheduler, whose workers are used instead.
    """
    measure = partial(measure_image, work)
    if scheduler is not None:
        run_on_cluster(measure, tasks, keep, scheduler=scheduler)
        return
    count = workers or os.cpu_count() or 1
    has_scenes = any(target.kind == "scene" for target in work.targets)
    left = len(tasks) % count if has_scenes else 0
    even = len(tasks) - left
    run_tasks(measure, tasks[:even], keep, workers=count, chunk=1)
    if left:
        _spread_scenes(work, tasks[even:], lambda place, found: keep(even + place, found), count)


def _spread_scenes(
    work: BatchWork,
    tasks: Sequence[BatchTask],
    keep: Keep,
    workers: int,
) -> None:
    """All other targets image by image over processes, then scene by scene."""
    others = _work_of(work, [target.kind != "scene" for target in work.targets])
    scenes = _work_of(work, [target.kind == "scene" for target in work.targets])
    begun: dict[int, MeasuredImage] = {}

    def keep_whole(place: int, found: MeasuredImage) -> None:
        keep(place, found if place not in begun else _joined(begun[place], found))

    try:
        if others.targets:
            run_tasks(partial(measure_image, others), tasks, begun.__setitem__, workers=workers,
                      chunk=1)  # fmt: skip
        scan = partial(measure_image, replace(scenes, scan_workers=workers))
        run_tasks(scan, tasks, keep_whole, workers=1)
    except BaseException:
        # Rows of the image that was in work are not to be measured again; whole ones are kept.
        with suppress(ArchiveError):
            for place, found in begun.items():
                keep(place, found)
        raise


def _work_of(work: BatchWork, is_meant: Sequence[bool]) -> BatchWork:
    """The work on some of the targets."""
    places = [place for place, meant in enumerate(is_meant) if meant]
    return replace(
        work,
        targets=[work.targets[place] for place in places],
        chosen=[work.chosen[place] for place in places],
        digests=[work.digests[place] for place in places],
    )


def _joined(begun: MeasuredImage, rest: MeasuredImage) -> MeasuredImage:
    """What was measured of an image in two parts; one that cannot be read has one row in all."""
    if begun.bands is None:
        return begun
    seconds = begun.measuring_s + rest.measuring_s
    return replace(rest, entries=[*begun.entries, *rest.entries], measuring_s=seconds)
