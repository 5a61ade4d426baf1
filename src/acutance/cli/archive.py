"""``acutance archive``: measurements kept over years, listed, shown, added and exported."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any
from warnings import catch_warnings

import typer

from acutance.cli import (
    archive_check,
    archive_compare,
    archive_correct,
    archive_remove,
    archive_report,
    archive_table,
    archive_trend,
)
from acutance.cli.archive_selection import PlaceArgument, SelectionOptions
from acutance.cli.archive_tables import (
    entry_text,
    print_measurements,
    print_rejections,
    print_sensors,
)
from acutance.cli.option_groups import with_groups
from acutance.cli.options import JsonOption
from acutance.cli.output import check_output
from acutance.cli.progress import progress_bar
from acutance.cli.terminal import BAD_USAGE, NOTHING_MEASURED, fail, say, warnings_said
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.archive import Entry, Measurements, Rejections

__all__ = ["EXAMPLE", "app", "export", "import_documents", "info", "list_rows", "show"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive import campaign.db results/*.json --sensor QB02\n"
    "  acutance archive list campaign.db --sensor QB02 --band pan --since 2026-01-01\n"
    "  acutance archive export campaign.db all.parquet"
)
LIST_EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive list campaign.db --kind edge --orientation across --verdict usable\n"
    "  acutance archive list campaign.db --min rer=0.4 --json\n"
    "  acutance archive list campaign.db --rejected --since 2026-01-01"
)
SHOW_EXAMPLE = "\b\nExample:\n  acutance archive show campaign.db 17 --json > measurement.json"
IMPORT_EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive import campaign.db edge.json --sensor QB02 --acquired 2026-05-01\n"
    "  acutance archive import campaign.db other.parquet lines.jsonl folder"
)
EXPORT_EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance archive export campaign.db all.jsonl\n"
    "  acutance archive export campaign.db table.csv --sensor QB02\n"
    "  acutance archive export campaign.db catalogue --to stac --since 2026-01-01"
)
INFO_EXAMPLE = "\b\nExample:\n  acutance archive info campaign.db --json"

_ENDINGS = {"jsonl": (".jsonl", ".ndjson"), "parquet": (".parquet",), "csv": (".csv",)}

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Keep measurements over years.",
    epilog=EXAMPLE,
)


@app.callback()
def _archive() -> None:
    """Keep measurements over years, in a file or in PostgreSQL, and ask questions of them."""


@app.command("list", epilog=LIST_EXAMPLE)
@with_groups
def list_rows(
    *,
    place: PlaceArgument,
    selected: SelectionOptions,
    rejected: Annotated[
        bool, typer.Option("--rejected", help="List what was not measured, and why.")
    ] = False,
    last: Annotated[
        int, typer.Option(metavar="N", min=1, help="Print the latest N rows; --json prints all.")
    ] = 50,
    as_json: JsonOption = False,
) -> None:
    """List measurements, a row for each direction, oldest first.

    Dates are those of the acquisition, UTC.
    """
    from acutance.archive import Archive
    from acutance.report import json_text

    with Archive(place, read_only=True) as archive:
        found: Measurements | Rejections
        if rejected:
            found = archive.rejected(**selected.words)
        else:
            found = archive.measurements(**selected.words)
        if not len(found):
            archive.require_known_names(selected.words)
    if as_json:
        document = {"schema": "acutance/archive-list/1", "rows": list(map(_dated, found.rows()))}
        typer.echo(json_text(document))
    if not len(found):
        fail(f"archive {place} holds nothing that is selected", NOTHING_MEASURED)
    if not as_json:
        (print_rejections if rejected else print_measurements)(list(found.rows())[-last:])
        left = len(found) - last
        more = f", {left} older ones not shown (--last N)" if left > 0 else ""
        say(f"{found.summary()}{more}")


@app.command("show", epilog=SHOW_EXAMPLE)
def show(
    place: PlaceArgument,
    number: Annotated[int, typer.Argument(metavar="ID", help="As acutance archive list has it.")],
    as_json: JsonOption = False,
) -> None:
    """Show one measurement: its numbers, its image and its target; or why there is none."""
    from acutance.archive import Archive
    from acutance.archive.exchange.entry_document import entry_document
    from acutance.report import json_text

    with Archive(place, read_only=True) as archive:
        try:
            entry = archive.entry(number)
        except OptionError as error:
            fail(str(error), NOTHING_MEASURED)
    if not as_json:
        typer.echo(entry_text(entry))
    elif entry.record is not None:
        typer.echo(json_text(entry.record.document))
    else:
        typer.echo(json_text(entry_document(entry)))


def import_documents(
    place: PlaceArgument,
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="What measuring commands print with --json, what acutance archive export wrote, "
            "and folders of them.",
        ),
    ],
    sensor: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of documents: which sensor it is.")
    ] = None,
    level: Annotated[
        str | None, typer.Option(metavar="LEVEL", help="Of documents: the product's level.")
    ] = None,
    band: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of documents: the band's name.")
    ] = None,
    target: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of documents: the target's name.")
    ] = None,
    acquired: Annotated[
        str | None,
        typer.Option(metavar="DATE", help="Of documents: when the image was taken; UTC."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Add measurements to an archive, each once. It is made where something can be read.

    What was exported has its own image and target; the options are for documents of measuring
    commands, which do not know them. A file that cannot be read stops no other; exit code 2 tells
    of it.
    """
    from acutance.archive import Archive
    from acutance.archive.connection import is_there
    from acutance.archive.dates import as_utc
    from acutance.archive.exchange.documents import Stated
    from acutance.archive.exchange.importing import Imported, refused_files
    from acutance.report import json_text

    day = None if acquired is None else as_utc(acquired, "acquired")
    stated = Stated(sensor=sensor, level=level, band=band, target=target, acquired=day)
    refused = None if is_there(place) else refused_files(files, stated)
    if refused is not None:
        done = Imported(0, 0, refused)
    else:
        with Archive(place) as archive, progress_bar(f"import {Path(place).name}") as progress:
            done = archive.import_documents(
                files, **vars(stated), progress=lambda read: progress(read, None)
            )
    if as_json:
        numbers = {"read": done.read, "new": done.new, "refused": dict(done.refused)}
        numbers |= {"notes": list(done.notes)} if done.notes else {}
        typer.echo(json_text({"schema": "acutance/archive-import/1", **numbers}))
    else:
        typer.echo(f"{done.read} read, {done.new} new, {done.read - done.new} there already")
    for note in done.notes:
        say(f"acutance: {note}")
    for name, reason in done.refused.items():
        say(f"acutance: {name}: {reason}")
    if done.refused:
        raise typer.Exit(BAD_USAGE)
    if not done.read:
        fail("the files hold no measurement", NOTHING_MEASURED)


app.command("import", epilog=IMPORT_EXAMPLE)(import_documents)


def _format_of(out: str) -> str:
    """The format that the ending of a file names; a folder may be of any."""
    ending = Path(out).suffix.lower()
    for name, endings in _ENDINGS.items():
        if ending in endings:
            return name
    known = ", ".join(one for endings in _ENDINGS.values() for one in endings)
    raise OptionError(f"{out} ends in none of {known}: state the format (--to; of a folder stac)")


@app.command("export", epilog=EXPORT_EXAMPLE)
@with_groups
def export(
    *,
    place: PlaceArgument,
    out: Annotated[
        str, typer.Argument(metavar="OUT", help="A file; of stac a folder that is new or empty.")
    ],
    to: Annotated[
        str | None,
        typer.Option(
            metavar="FORMAT",
            help="jsonl and parquet lose nothing, nor does stac of images with dates, which it "
            "needs; csv has the numbers without curves. Without it the ending of OUT says which.",
        ),
    ] = None,
    documents: Annotated[
        bool,
        typer.Option(
            "--documents", help="With csv: a column of whole documents, so that nothing is lost."
        ),
    ] = False,
    selected: SelectionOptions,
) -> None:
    """Write measurements and rejections into a file, for other programs or other archives."""
    if to is None:
        to = _format_of(out)
    if documents and to != "csv":
        raise OptionError(f"--documents belongs to --to csv: {to} has them in any case")
    if to not in (*_ENDINGS, "stac"):
        raise OptionError(f"--to {to}: the formats are {', '.join(_ENDINGS)}, stac")
    if to in _ENDINGS:
        check_output("OUT", out, _ENDINGS[to], keep=[place])
    from acutance.archive import Archive

    with Archive(place, read_only=True) as archive, warnings_said():
        if not any(True for _ in archive.entries(**selected.words)):
            archive.require_known_names(selected.words)
            fail(f"archive {place} holds nothing that is selected", NOTHING_MEASURED)
        with progress_bar(f"export {Path(out).name}") as progress:
            count = archive.export(
                out, to="csv-documents" if documents else to, progress=progress, **selected.words
            )
        with catch_warnings(action="ignore"):
            # What is damaged was said by the export.
            left = _undated(archive.entries(**selected.words)) if to == "stac" else ""
    say(f"wrote {out}, {count} {'entry' if count == 1 else 'entries'}{left}")


app.command("trend", epilog=archive_trend.EXAMPLE)(archive_trend.trend)
app.command("correct", epilog=archive_correct.EXAMPLE)(archive_correct.correct)
app.command("remove", epilog=archive_remove.EXAMPLE)(archive_remove.remove)
app.command("check", epilog=archive_check.EXAMPLE)(archive_check.check)
app.command("compare", epilog=archive_compare.EXAMPLE)(archive_compare.compare)
app.command("table", epilog=archive_table.EXAMPLE)(archive_table.table)
app.command("report", epilog=archive_report.EXAMPLE)(archive_report.report)


@app.command("info", epilog=INFO_EXAMPLE)
def info(place: PlaceArgument, as_json: JsonOption = False) -> None:
    """Tell what an archive holds, by sensor."""
    from acutance.archive import Archive
    from acutance.archive.counted import counted
    from acutance.report import json_text

    with Archive(place, read_only=True) as archive:
        found = archive.overview()
    if as_json:
        typer.echo(json_text({"schema": "acutance/archive-info/1", **found.to_dict()}))
        return
    typer.echo(
        f"{found.place}: {counted(found.measured, 'measurement')}, {found.rejected} rejected, "
        f"{counted(found.images, 'image')}, {counted(found.targets, 'target')}, "
        f"{counted(found.runs, 'run')}; tables of version {found.schema_version}"
    )
    print_sensors(found.sensors)


def _undated(entries: Iterable[Entry]) -> str:
    """How many entries a catalogue leaves out, and of how many images; "" if none."""
    from acutance.archive.counted import counted

    images = [entry.image.content or entry.image.path for entry in entries
              if entry.image.acquired is None]  # fmt: skip
    if not images:
        return ""
    of = counted(len(set(images)), "image")
    return f"; {len(images)} left out, of {of} without a date (acutance archive correct states it)"


def _dated(row: dict[str, Any]) -> dict[str, Any]:
    return {
        name: value.isoformat() if hasattr(value, "isoformat") else value
        for name, value in row.items()
    }
