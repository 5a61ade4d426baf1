"""``acutance batch``: all targets of many images into an archive."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.options import JsonOption
from acutance.cli.output import require_own_file
from acutance.cli.progress import progress_bar
from acutance.cli.study import WorkersOption, dask_option
from acutance.cli.terminal import FAILED_CHECK, NOTHING_MEASURED, say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.archive import Entry
    from acutance.batch import BatchPlan, BatchSummary

__all__ = ["EXAMPLE", "batch"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance batch images/*.tif --targets targets.geojson --archive campaign.db\n"
    "  acutance batch plan.toml --workers 8\n"
    "  acutance batch plan.toml --dask tcp://host:8786 --json\n"
    "  acutance batch images/*.tif --targets targets.geojson --archive campaign.db --band pan,3"
)


def batch(
    images: Annotated[
        list[str],
        typer.Argument(metavar="IMAGE...|PLAN.toml", help="Images, or the file of a plan."),
    ],
    targets: Annotated[
        str | None, typer.Option(metavar="FILE", help="The targets: features of a GeoJSON file.")
    ] = None,
    archive: Annotated[
        str | None,
        typer.Option(
            metavar="PLACE", help="Where results are kept: a file, or the URL of a database."
        ),
    ] = None,
    band: Annotated[
        str | None,
        typer.Option(
            metavar="BAND,...", help="Names or numbers of the bands; all (as without it)."
        ),
    ] = None,
    sensor: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="The sensor of all images, whatever they say."),
    ] = None,
    height: Annotated[
        float | None,
        typer.Option(
            metavar="METRES",
            min=-1000,
            max=10000,
            help="Of the ground above the ellipsoid, at targets that state none; for images "
            "located by RPC.",
        ),
    ] = None,
    workers: WorkersOption = None,
    dask: Annotated[str | None, dask_option("the images under the same names")] = None,
    log: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="Add a line of JSON to this file for every row once it is kept."
        ),
    ] = None,
    as_json: JsonOption = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict", help="Exit with code 3 when a row is rejected, doubtful or invalid."
        ),
    ] = False,
) -> None:
    """Measure every target in every image, and keep the results in an archive.

    There is one row for every image, target and band: a measurement, or the reason why there is
    none. What is done is not done again: a batch that was interrupted goes on when it is called
    again. An image that cannot be read stops no other.
    """
    plan = _plan(images, targets, archive, band, sensor, height, workers, dask)
    if log is not None:
        require_own_file("--log", log, keep=_files_of(images, plan))

    from acutance.archive.counted import counted
    from acutance.batch import run_batch

    try:
        with _logged(log) as kept, progress_bar("batch") as progress:
            found = run_batch(plan, progress=progress, kept=kept)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "interrupted: what was kept is kept, the same command goes on"
        ) from None
    typer.echo(json.dumps(found.to_dict(), indent=2) if as_json else _text(found))
    if found.measured == 0:
        say("acutance: nothing could be measured")
        raise typer.Exit(NOTHING_MEASURED)
    if strict and found.failed:
        verb = "is" if found.failed == 1 else "are"
        say(f"acutance: {counted(found.failed, 'row')} {verb} rejected, doubtful or invalid")
        raise typer.Exit(FAILED_CHECK)


def _plan(
    images: Sequence[str],
    targets: str | None,
    archive: str | None,
    band: str | None,
    sensor: str | None,
    height: float | None,
    workers: int | None,
    dask: str | None,
) -> BatchPlan:
    """The plan of the file or of the words, with what the options say."""
    if workers is not None and dask is not None:
        raise OptionError("--workers and --dask cannot be combined: the cluster has its own")

    from acutance.batch.plan import BatchPlan, StatedOfImages, is_plan_file, read_plan

    given_plan = next(filter(is_plan_file, images), None)
    is_plan = given_plan is not None
    if is_plan and len(images) > 1:
        raise OptionError(f"{given_plan} is a plan and names its images: give it alone")
    if not is_plan and (targets is None or archive is None):
        raise OptionError("images need --targets FILE and --archive PLACE, or give a plan.toml")
    words = {"targets": targets, "archive": archive, "workers": workers, "dask": dask}
    given: dict[str, Any] = {name: one for name, one in words.items() if one is not None}
    if band is not None:
        given["bands"] = None if band.strip().lower() == "all" else _bands(band)
    plan = (
        read_plan(images[0]) if is_plan else BatchPlan(images=tuple(images), targets="", archive="")
    )
    plan = replace(plan, **given)
    if workers is not None:
        plan = replace(plan, dask=None)
    if dask is not None:
        plan = replace(plan, workers=None)
    if sensor is not None:
        plan = replace(plan, stated=(*plan.stated, StatedOfImages(sensor=sensor)))
    if height is not None:
        # Heights of the plan are of some images, and go before.
        plan = replace(plan, stated=(StatedOfImages(height_m=height), *plan.stated))
    return plan


def _files_of(words: Sequence[str], plan: BatchPlan) -> Iterator[str]:
    """Every file that the batch reads or keeps results in, by the words it was called with."""
    from acutance.archive.connection import file_of
    from acutance.batch.image_list import list_images
    from acutance.batch.plan import is_plan_file
    from acutance.raster.metadata.files_beside import files_beside

    archive = file_of(plan.archive)
    if archive is not None:
        # SQLite keeps what is new in files beside it.
        yield from (f"{archive}{ending}" for ending in ("", "-wal", "-shm", "-journal"))
    yield str(plan.targets)
    for stated in plan.stated:
        yield from stated.metadata or ()
    yield from filter(is_plan_file, words)
    for image in list_images(plan.images):
        yield image.path
        yield from map(str, files_beside(image.path))


def _bands(text: str) -> tuple[str | int, ...]:
    """Names and numbers of bands, typed as ``pan,3``."""
    parts = [part.strip() for part in text.split(",")]
    if not all(parts):
        raise OptionError(f"--band {text}: write names or numbers, as in pan,3")
    return tuple(int(part) if part.isdecimal() else part for part in parts)


@contextmanager
def _logged(name: str | None) -> Iterator[Callable[[Sequence[Entry]], None] | None]:
    """Writes a line for every row; nothing where there is no file to write to."""
    if name is None:
        yield None
        return
    try:
        file = open(name, "a", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        reason = error.strerror or str(error)
        raise OptionError(
            f"--log {name} cannot be written ({reason}): name another file"
        ) from error

    def write(entries: Sequence[Entry]) -> None:
        file.writelines(f"{json.dumps(_line(one), ensure_ascii=False)}\n" for one in entries)
        file.flush()

    with file:
        yield write


def _line(entry: Entry) -> dict[str, Any]:
    record, rejected = entry.record, entry.rejected
    return {
        "time": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}",
        "key": entry.key,
        "image": entry.image.path,
        "target": None if entry.target is None else entry.target.name,
        "band": entry.band,
        "verdict": None if record is None else record.verdict.word,
        "reason": None if rejected is None else rejected.reason,
    }


def _text(found: BatchSummary) -> str:
    """Counts, then verdicts and reasons, and where to read on."""
    from acutance.archive.counted import counted

    there = f"{found.done_before} {'was' if found.done_before == 1 else 'were'} there"
    lines = [
        f"{counted(found.images, 'image')}: {counted(found.kept, 'row')} added to "
        f"{found.archive}, {there}",
        _counts("measured", found.measured, found.verdicts),
        _counts("rejected", found.rejected, found.reasons, _of_images(found)),
        *_named(f"unreadable: {_fault(*one)}" for one in found.faults.items()),
        *_named(f"measured once: {path} and {other} have the same content"
                for path, other in found.copies.items()),
        *_named(f"restored: {path}, by its own word: numbers are those of the restored product"
                for path in found.restored),
    ]  # fmt: skip
    if found.rejected:
        lines.append(
            f"reasons in full: acutance archive list {shlex.quote(found.archive)} --rejected"
        )
    lines += [*_kept_otherwise(found), *_earlier_contents(found)]
    if found.missing_bands:
        asked = ", ".join(map(str, found.missing_bands))
        lines.append(f"no image has band {asked}: choose from {', '.join(found.bands)}")
    return "\n".join(lines)


def _kept_otherwise(found: BatchSummary) -> list[str]:
    """Images that the archive knows otherwise than was stated, and the command that corrects it."""
    from acutance.archive.contradictions import in_words, written

    if not found.kept_otherwise:
        return []
    several = found.kept_otherwise.values()
    image = next(iter(found.kept_otherwise)) if len(several) == 1 else "NAME"
    words = ["acutance", "archive", "correct", found.archive, "--image", image]
    every = dict.fromkeys(name for one in several for name in one)
    lines = [f"not changed: {path} is kept with {in_words(one)}"
             for path, one in found.kept_otherwise.items()]  # fmt: skip
    # A GSD that is corrected makes no metres of what was measured without one.
    names = [name for name in every if name != "gsd_m"]
    for name in names:
        stated = {written(one[name][1]) for one in several if name in one}
        words += [f"--{name.replace('_', '-')}", stated.pop() if len(stated) == 1 else "VALUE"]
    advice = []
    if names:
        advice.append(f"where they are wrong: {shlex.join(words)}")
    if "gsd_m" in every:
        remove = shlex.join(["acutance", "archive", "remove", found.archive, "--image", image])
        advice.append(f"to have them measured in metres: {remove}, and the same batch again")
    return [*_named(lines), f"rows that are there stay as they are; {'; '.join(advice)}"]


def _named(lines: Iterable[str]) -> list[str]:
    """The first lines, and how many more there are."""
    every = list(lines)
    more = len(every) - _NAMED
    return [*every[:_NAMED], *([f"and {more} more of these"] if more > 0 else [])]


def _fault(path: str, reason: str) -> str:
    """Why an image cannot be read, with its name."""
    return reason if path in reason else f"{path}: {reason}"


_NAMED = 5
"""Images that are named in the summary; all are rows of the archive."""


def _of_images(found: BatchSummary) -> dict[str, str]:
    """Reasons that are those of whole images, with how many these are."""
    from acutance.archive.counted import counted
    from acutance.batch.reason_words import UNREADABLE
    from acutance.batch.summary import NO_FILE

    broken = len(found.unreadable) - len(found.missing)
    rows = found.reasons.get(UNREADABLE, 0)
    images = counted(broken, UNREADABLE)
    return {
        NO_FILE: counted(len(found.missing), "missing file"),
        UNREADABLE: images if rows == broken else f"{rows} in {images}",
    }


def _earlier_contents(found: BatchSummary) -> list[str]:
    """Files that have changed and whose earlier contents still count, and how to remove these."""
    if not found.earlier_contents:
        return []
    several = [one for contents in found.earlier_contents.values() for one in contents]
    words = ["acutance", "archive", "remove", found.archive]
    words += [word for one in several[:_NAMED] for word in ("--image", one)]
    return [
        *_named(f"changed: {path} was kept with other content before, which still counts"
                for path in found.earlier_contents),
        f"to remove rows of earlier contents: {shlex.join(words)}",
    ]  # fmt: skip


def _counts(word: str, total: int, parts: Any, named: Mapping[str, str] | None = None) -> str:
    of = named or {}
    listed = ", ".join(of.get(name, f"{count} {name}") for name, count in parts.items())
    return f"{word} {total}" + (f": {listed}" if listed else "")
