"""Measure all targets of all images, and keep the results in an archive."""

from __future__ import annotations

import operator
import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from acutance.archive import Archive, Entry
from acutance.archive.connection import is_there
from acutance.archive.outcomes import Outcome
from acutance.arguments import require_path, require_paths
from acutance.batch.entries import entry_of_facts, stated_entry
from acutance.batch.image_list import (
    ImageFile,
    content_of,
    list_images,
    require_stated_images,
    stated_of,
)
from acutance.batch.measure_image import BatchTask, BatchWork, MeasuredImage
from acutance.batch.path_text import path_as_text
from acutance.batch.plan import BatchPlan, StatedOfImages, read_plan
from acutance.batch.plan_options import choose_options, require_options
from acutance.batch.remembered_images import KnownImage, RememberedImages
from acutance.batch.row_key import (
    Reading,
    day_of,
    reading_of,
    row_key,
    statement_digest,
    target_digest,
    unreadable_key,
)
from acutance.batch.selected_bands import Band, selected
from acutance.batch.spread_images import spread_images
from acutance.batch.summary import BatchSummary, Tally
from acutance.errors import ArchiveError, OptionError
from acutance.execution import require_workers, run_tasks
from acutance.raster.surveyed_targets import read_targets, targets_of

__all__ = ["run_batch"]

Progress = Callable[[int, int], None]
KeptEntries = Callable[[Sequence[Entry]], None]

_READING = ("gsd_m", "height_m", "nodata", "along_track", "linearize", "band_names")
_SAID = ("acquired", "band_names", "metadata")
"""What bands and day of an image are found out by."""
_MANY_BYTES = 2 * 10**9
"""So many are read for their checksums by all processes."""


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
    kept: KeptEntries | None = None,
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
        Paths, and patterns such as ``"images/*.tif"``.
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
    kept : function of (sequence of Entry), optional
        Called with the rows of an image, each with its key, once the archive has them.

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
    require_stated_images(files, wanted.stated)
    if not is_there(wanted.archive):
        # No new archive is made for a plan that cannot be done.
        require_options(work.targets, work.chosen, wanted.options)
    with Archive(wanted.archive) as place:
        known = _known_images(files, wanted)
        tally = Tally()
        there = place.outcomes({one.content for one in known.values()})
        todo = _tasks(files, known, wanted, work, there, tally)
        run = _run(todo, wanted, work, place, there, tally, progress, kept) if todo else None
        place.remove_rejections(tally.outlived)
        otherwise = place.kept_otherwise(tally.stated, tally.said)
        earlier = _earlier_contents(place, known)
    bands = [one for some in (work.bands, *(t.bands for t in work.targets)) for one in some or ()]
    elapsed_s = time.monotonic() - begin
    return tally.summary(wanted.archive, len(files), elapsed_s, run, bands, otherwise, earlier)


def _earlier_contents(archive: Archive, known: Mapping[str, KnownImage]) -> dict[str, list[str]]:
    """Contents that files had before and of which there still are rows, by path."""
    by_text = {path_as_text(path): path for path in known}
    now = {text: known[path].content for text, path in by_text.items()}
    return {by_text[text]: one for text, one in archive.earlier_contents(now).items()}


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
    if not isinstance(targets, Mapping | None):
        require_path(targets=targets)
    if archive is not None:
        require_path(archive=archive)
    given: dict[str, Any] = {
        "images": None if images is None else _texts(images),
        "targets": targets if isinstance(targets, Mapping | None) else os.fspath(targets),
        "archive": None if archive is None else os.fspath(archive),
        "bands": None if bands is None else _bands(bands),
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
    return tuple(os.fspath(one) for one in require_paths("images", images))


def _bands(bands: Sequence[str | int]) -> tuple[str | int, ...]:
    """Names and numbers, whatever kind of integers they were given as."""
    try:
        return tuple(one if isinstance(one, str) else operator.index(one) for one in bands)
    except TypeError:
        raise OptionError(f"bands are {bands!r:.80}: give a list of names or numbers") from None


def _work(plan: BatchPlan) -> BatchWork:
    """Targets with their options."""
    if isinstance(plan.targets, Mapping):
        targets = targets_of(plan.targets, "targets")
    else:
        targets = read_targets(plan.targets)
    chosen = choose_options(targets, plan.options)
    digests = [target_digest(one, how) for one, how in zip(targets, chosen, strict=True)]
    return BatchWork(targets, chosen, digests, plan.bands)


def _known_images(files: Sequence[ImageFile], plan: BatchPlan) -> dict[str, KnownImage]:
    """What identifies every image, by path: remembered, or found out from its bytes."""
    memory = RememberedImages()
    known = memory.known(files)
    unknown = [one for one in files if one.path not in known]
    learned: dict[ImageFile, KnownImage] = {}

    def keep(place: int, content: str | None) -> None:
        if content is not None:
            learned[unknown[place]] = KnownImage(content)

    many = sum(one.size for one in unknown) > _MANY_BYTES
    paths = [one.path for one in unknown]
    run_tasks(content_of, paths, keep, workers=plan.workers if many else 1)
    memory.remember(learned)
    return {**known, **{file.path: one for file, one in learned.items()}}


def _tasks(
    files: Sequence[ImageFile],
    known: Mapping[str, KnownImage],
    plan: BatchPlan,
    work: BatchWork,
    there: Mapping[str, Outcome],
    tally: Tally,
) -> list[tuple[ImageFile, BatchTask]]:
    """The images that have rows to do; what is there already is counted."""
    by_content: dict[str, set[str]] = {}
    for key, one in there.items():
        by_content.setdefault(str(one.content), set()).add(key)
    found, seen = [], dict[tuple[str, Reading], str]()
    for file in files:
        stated, image = stated_of(file.path, plan.stated), known.get(file.path)
        if image is not None:
            image = image.under(_statement(stated))
        place = os.path.abspath(file.path)
        reading = reading_of({name: getattr(stated, name) for name in _READING})
        content = None if image is None else image.content
        tally.outlived |= _outlived_by_path(file.path, place, is_there=content is not None)
        if content is not None and (content, reading) in seen:
            tally.copies[file.path] = seen[content, reading]
            continue
        seen[content or file.path, reading] = file.path
        if image is not None:
            tally.bands.update(Band(*one) for one in image.bands or ())
        done = by_content.get(content or "", set())
        wanted = None if image is None else _wanted_keys(image, reading, work)
        without_gsd = frozenset(key for key in done if _lacked_gsd(there[key]))
        again = without_gsd if image is not None and "gsd_m" in image.facts else frozenset()
        if image is not None and wanted is not None and wanted <= done - again:
            tally.add_earlier(file.path, [there[key] for key in wanted])
            tally.add_stated(wanted, stated_entry(stated))
            tally.add_said(wanted, entry_of_facts(image.facts))
            tally.outlived |= _outlived_keys(image, reading, work)
            tally.outlived |= {unreadable_key(content, place)} & done
            continue
        task = BatchTask(file.path, place, content, stated, reading, frozenset(done), without_gsd)
        found.append((file, task))
    return found


def _outlived_by_path(typed: str, place: str, is_there: bool) -> set[str]:
    """Keys of rows of a file that could not be read and can be, and those of version 0.1.

    Those had the path as it was typed, the same in every folder: what is still missing has a row
    of its own folder instead.
    """
    own, older = unreadable_key(None, place), unreadable_key(None, typed)
    return {own, older} if is_there else {older} - {own}


def _lacked_gsd(row: Outcome) -> bool:
    """Whether a row is a rejection from a time when no GSD of its image was known."""
    return row.verdict is None and not row.has_gsd


def _statement(stated: StatedOfImages) -> str:
    return statement_digest({name: getattr(stated, name) for name in _SAID})


def _wanted_keys(image: KnownImage, reading: Reading, work: BatchWork) -> set[str] | None:
    """The keys of all rows of an image; None while its bands are not known."""
    if image.bands is None:
        return None
    return {
        row_key(image.content, how, digest, band.number, day_of(target, image.day))
        for target, digest in zip(work.targets, work.digests, strict=True)
        for how in (reading.of(target, image.by_rpc),)
        for band in (Band(*one) for one in image.bands)
        if selected(band, work.bands, target.bands)
    }


def _outlived_keys(image: KnownImage, reading: Reading, work: BatchWork) -> set[str]:
    """Keys of rows that an image had while its date was not known, and has not with its date."""
    wanted, undated = (
        _wanted_keys(one, reading, work) or set() for one in (image, replace(image, day=None))
    )
    return undated - wanted


def _replaced(task: BatchTask, found: MeasuredImage, there: Mapping[str, Outcome]) -> set[str]:
    """Keys of rejections that are there and hold no longer, now that the image was opened.

    That it cannot be read may be due to the plan or to a document beside it, not to its content.
    """
    own = {unreadable_key(task.content, task.place)} & task.done
    if found.bands is None:
        reasons = {one.rejected.reason for one in found.entries if one.rejected is not None}
        return {key for key in own if there[key].reason not in reasons}
    return own | {entry.key for entry in found.entries if entry.key in task.without_gsd}


def _run(
    todo: Sequence[tuple[ImageFile, BatchTask]],
    plan: BatchPlan,
    work: BatchWork,
    archive: Archive,
    there: Mapping[str, Outcome],
    tally: Tally,
    progress: Progress | None,
    kept: KeptEntries | None,
) -> int:
    """Measure, and keep every image's rows in one transaction as soon as they are there."""
    require_options(work.targets, work.chosen, plan.options)
    number = archive.start_run(plan.to_dict())
    memory = RememberedImages()
    finished: set[int] = set()

    def keep(place: int, found: MeasuredImage) -> None:
        file, task = todo[place]
        if place in finished:
            return
        if task.content is not None and file.has_changed:
            # What was measured may be of another content than the one it would be kept under.
            found = replace(found, entries=[], bands=None)
        again = _replaced(task, found, there)
        archive.remove_rejections(again)
        new = archive.add_entries(found.entries, run=number)
        finished.add(place)
        if kept is not None:
            kept(found.entries)
        if task.content is not None and found.bands is not None:
            said = _statement(task.stated)
            image = KnownImage(
                task.content, found.bands, found.day, found.by_rpc, said, found.facts
            )
            memory.remember({file: image})
            wanted = _wanted_keys(image, task.reading, work) or set()
            tally.add_earlier(file.path, [there[key] for key in wanted & task.done - again])
            # What stated documents say is known once they were read.
            by_documents = task.stated.metadata is not None
            tally.add_stated(wanted, found.image if by_documents else stated_entry(task.stated))
            tally.add_said(wanted, entry_of_facts(found.facts))
            tally.outlived |= _outlived_keys(image, task.reading, work)
        tally.add_image(task.path, found, new)
        if progress is not None:
            progress(len(finished), len(todo))

    tasks = [task for _, task in todo]
    if progress is not None:
        progress(0, len(todo))
    try:
        spread_images(work, tasks, keep, workers=plan.workers, scheduler=plan.dask)
    except BaseException:
        # The error to report is the one that ended the run, not that this cannot be written down.
        with suppress(ArchiveError):
            archive.end_run(number, {**tally.to_dict(), "finished": False})
        raise
    archive.end_run(number, {**tally.to_dict(), "finished": True})
    return number
