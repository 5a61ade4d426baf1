"""One image of a batch, in a worker: opened once, every target measured or rejected."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass, field, replace
from datetime import date
from typing import Any

from acutance.archive.entry import Entry, ImageEntry
from acutance.batch.entries import image_entry, image_facts, target_entry
from acutance.batch.path_text import path_as_text
from acutance.batch.place_target import NotHereError, PlacedTarget, place_target
from acutance.batch.plan import StatedOfImages
from acutance.batch.plan_options import ChosenOptions
from acutance.batch.reason_words import UNREADABLE, words_of
from acutance.batch.row_key import Reading, day_of, row_key, unreadable_key
from acutance.batch.selected_bands import Band, selected
from acutance.batch.summary import NO_FILE
from acutance.errors import AcutanceError, ImageError, OptionError, RegionError, WorkerError
from acutance.execution import interruptible, is_ending
from acutance.numerics.one_thread import one_thread
from acutance.raster import Box, Gsd, Image, open_bands
from acutance.raster.metadata import ImageStatement, read_statement
from acutance.raster.sensor_model import SensorModel, georeference_of
from acutance.raster.surveyed_targets import SurveyedTarget
from acutance.targets.region import image_info, stated_gsd
from acutance.targets.target_result import Rejected

__all__ = ["BatchTask", "BatchWork", "MeasuredImage", "measure_image"]


@dataclass(frozen=True)
class BatchWork:
    """What is the same for all images.

    Parameters
    ----------
    targets : sequence of SurveyedTarget
    chosen : sequence of ChosenOptions
        Of every target.
    digests : sequence of str
        Of every target with its options.
    bands : tuple of (str or int), or None
        Names or numbers; all without it.
    scan_workers : int
        Processes of a scene, where images are measured one after the other.
    """

    targets: Sequence[SurveyedTarget]
    chosen: Sequence[ChosenOptions]
    digests: Sequence[str]
    bands: tuple[str | int, ...] | None
    scan_workers: int = 1


@dataclass(frozen=True)
class BatchTask:
    """One image.

    Parameters
    ----------
    path : str
    place : str
        The same from the root: processes may stand in other folders.
    content : str or None
        SHA-256; None if it cannot be read.
    stated : StatedOfImages
        Of this image.
    reading : Reading
        Digests of how it is read.
    done : frozenset of str
        Keys of its rows that the archive has.
    without_gsd : frozenset of str
        Keys among them of rejections from a time when no GSD of the image was known: where its
        documents state one now, they are done again.
    """

    path: str
    place: str
    content: str | None
    stated: StatedOfImages
    reading: Reading
    done: frozenset[str]
    without_gsd: frozenset[str] = frozenset()


@dataclass(frozen=True)
class MeasuredImage:
    """What a worker returns.

    Parameters
    ----------
    entries : list of Entry
    bands : tuple of Band, or None
        All of the image; None where it cannot be opened.
    day : str or None
        Of the acquisition.
    measuring_s : float
        Of the processor, spent in measurements, of all the worker did.
    by_rpc : bool
        Whether its RPC locate it, and need the height of the ground.
    image : ImageEntry or None
        All that is known of it; None where it cannot be opened.
    facts : mapping
        What it says of itself.
    """

    entries: list[Entry]
    bands: tuple[Band, ...] | None
    day: str | None
    measuring_s: float
    by_rpc: bool = False
    image: ImageEntry | None = None
    facts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class _Opened:
    """An image with all it says."""

    images: tuple[Image, ...]
    bands: tuple[Band, ...]
    statement: ImageStatement
    entry: ImageEntry
    acquired: date | None
    height_m: float | None
    by_rpc: bool
    facts: Mapping[str, Any]


@one_thread
def measure_image(work: BatchWork, task: BatchTask) -> MeasuredImage:
    """Measure all targets of an image that are not done.

    Parameters
    ----------
    work : BatchWork
    task : BatchTask
    """
    try:
        opened = _opened(task)
    except AcutanceError as error:
        return MeasuredImage([_unreadable(task, error)], None, None, 0.0)
    found = list(_rows(work, task, opened))
    day = None if opened.acquired is None else opened.acquired.isoformat()
    measuring_s = sum(seconds for _, seconds in found)
    entries = [entry for entry, _ in found]
    return MeasuredImage(
        entries, opened.bands, day, measuring_s, opened.by_rpc, opened.entry, opened.facts
    )


def _opened(task: BatchTask) -> _Opened:
    stated = task.stated
    if task.content is None:
        # The error of a missing file, or of one that may not be read, says which.
        open_bands(task.path)
        raise ImageError(f"{task.path} cannot be read: check that it is a file you may read")
    images = open_bands(
        task.path,
        gsd_m=None if stated.gsd_m is None else Gsd(*stated.gsd_m),
        nodata=stated.nodata,
        along_track=stated.along_track or "y",
        linearize=stated.linearize,
    )
    statement = read_statement(task.path, stated.metadata)
    names = stated.band_names
    if names is not None and len(names) != len(images):
        raise OptionError(
            f"{len(names)} band_names are stated for {task.path}, which has {len(images)} bands"
        )
    bands = tuple(
        Band(one.band, statement.band_name(one.band) if names is None else names[place])
        for place, one in enumerate(images)
    )
    images = tuple(
        replace(one, band_name=band.name) for one, band in zip(images, bands, strict=True)
    )
    entry = image_entry(task, statement)
    acquired = None if entry.acquired is None else entry.acquired.date()
    model = georeference_of(images[0])
    by_rpc = isinstance(model, SensorModel) and model.needs_height
    facts = image_facts(statement, images[0].states_gsd)
    return _Opened(images, bands, statement, entry, acquired, stated.height_m, by_rpc, facts)


def _unreadable(task: BatchTask, error: AcutanceError) -> Entry:
    # A link that leads nowhere is no file either.
    is_missing = task.content is None and not os.path.exists(task.path)
    why = NO_FILE if is_missing else UNREADABLE
    # Many folders have files of one name: where no content tells them apart, the folder does.
    path = path_as_text(task.place if task.content is None else task.path)
    rejected = Rejected("image", path_as_text(str(error)), {"why": why, "path": path})
    image = ImageEntry(path=path, content=task.content, sensor=task.stated.sensor)
    return Entry(rejected=rejected, image=image, key=unreadable_key(task.content, task.place))


def _rows(work: BatchWork, task: BatchTask, opened: _Opened) -> Iterator[tuple[Entry, float]]:
    """Rows that are not done, and the processor time of their measurements."""
    day = None if opened.acquired is None else opened.acquired.isoformat()
    for target, chosen, digest in zip(work.targets, work.chosen, work.digests, strict=True):
        described = None
        for place, band in enumerate(opened.bands):
            if not selected(band, work.bands, target.bands):
                continue
            reading = task.reading.of(target, opened.by_rpc)
            key = row_key(str(task.content), reading, digest, band.number, day_of(target, day))
            has_gsd_now = "gsd_m" in opened.facts and key in task.without_gsd
            if key in task.done and not has_gsd_now:
                continue
            if is_ending():
                # What was measured is kept, the next batch does the rest.
                return
            if described is None:
                described = target_entry(target)
            found, seconds = _row(target, chosen, opened, place, work.scan_workers)
            yield (
                Entry(
                    **found,
                    image=opened.entry,
                    target=described,
                    band=_kept_name(band, opened),
                    key=key,
                ),
                seconds,
            )


def _kept_name(band: Band, opened: _Opened) -> str | None:
    """The name of a band; the number of one of several without a name, so that it is told apart."""
    is_one_of_several = len(opened.bands) > 1
    return band.name or (str(band.number) if is_one_of_several else None)


def _row(
    target: SurveyedTarget, chosen: ChosenOptions, opened: _Opened, place: int, scan_workers: int
) -> tuple[dict[str, Any], float]:
    """A record or a rejection, and the processor time of the measurement."""
    # The rooms of the kinds are loaded where something is measured.
    from acutance.batch.measure_target import measure_target
    from acutance.batch.survey_distance import with_survey_distance

    image, begin = opened.images[place], None
    try:
        _require_valid(target, opened.acquired)
        placed = _placed(target, image, opened)
        begin = _processor_s()
        with interruptible():
            record = measure_target(placed, image, chosen, scan_workers).record
        return {"record": with_survey_distance(record, placed)}, _processor_s() - begin
    except NotHereError as error:
        rejected = _rejected(error.stage, str(error), error.why, chosen, image)
    except (BrokenExecutor, WorkerError):
        # The processes of a scene were killed: that says nothing about the image.
        raise
    except AcutanceError as error:
        rejected = _rejected(_stage(error), str(error), words_of(error), chosen, image)
    except Exception as error:  # one target that fails must not end a batch of thousands
        reason = f"the measurement failed, {type(error).__name__}: {str(error)[:200]}"
        rejected = _rejected("fit", reason, words_of(error), chosen, image)
    return {"rejected": rejected}, 0.0 if begin is None else _processor_s() - begin


def _processor_s() -> float:
    """Processor time of this thread, and of the processes it has started and that have ended."""
    times = os.times()
    return time.thread_time() + times.children_user + times.children_system


def _require_valid(target: SurveyedTarget, acquired: date | None) -> None:
    if target.valid_from is None and target.valid_to is None:
        return
    if acquired is None:
        raise NotHereError(
            "no date",
            "the target is there at times only, and the image states no date: state it in the "
            "plan (acquired)",
            "date",
        )
    begin, end = target.valid_from or date.min, target.valid_to or date.max
    if not begin <= acquired <= end:
        raise NotHereError(
            "not there then",
            f"the image is of {acquired}, and the target is there {_times_of(target)}",
            "date",
        )


def _times_of(target: SurveyedTarget) -> str:
    """When a target is there: from a day on, until another, or between both."""
    if target.valid_to is None:
        return f"from {target.valid_from} on"
    if target.valid_from is None:
        return f"until {target.valid_to}"
    return f"from {target.valid_from} to {target.valid_to}"


def _placed(target: SurveyedTarget, image: Image, opened: _Opened) -> PlacedTarget:
    height_m = opened.height_m if target.height_m is None else target.height_m
    georeference = None if target.in_pixels else georeference_of(image, height_m)
    if georeference is not None:
        _require_credible_gsd(image)
    stated = opened.entry.gsd_m
    gsd = None
    if not image.states_gsd and stated is not None:
        gsd = Gsd(*stated)
    return place_target(target, image, georeference, gsd)


def _require_credible_gsd(image: Image) -> None:
    """Refuse to look for a target by a map whose pixels are quite others than the stated ones.

    Raises
    ------
    RegionError
        As `NotHereError`, where the check `stated_gsd` would fail.
    """
    check = stated_gsd(image_info(image, Box.whole(image.shape), image.own_gsd), {})
    if not check.passed:
        raise NotHereError("stated GSD", check.message, "options")


def _stage(error: AcutanceError) -> str:
    kinds = (("image", ImageError), ("region", RegionError), ("options", OptionError))
    return next((stage for stage, kind in kinds if isinstance(error, kind)), "fit")


def _rejected(stage: str, reason: str, why: str, chosen: ChosenOptions, image: Image) -> Rejected:
    values = {"why": why, "band": image.band, "method": chosen.method, "path": image.path}
    return Rejected(stage, reason, values)
