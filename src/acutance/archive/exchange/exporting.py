"""Entries of an archive are written into files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path

from acutance.archive.connection import Database
from acutance.archive.entry import Entry
from acutance.archive.exchange.csv_tables import write_csv
from acutance.archive.exchange.files import refusals_in_words
from acutance.archive.exchange.jsonl import write_jsonl
from acutance.archive.exchange.parquet import write_parquet
from acutance.archive.exchange.stac import write_stac
from acutance.archive.runs import named_once
from acutance.archive.selection import Selection
from acutance.archive.stored_entries import select_ids, undamaged_entries
from acutance.arguments import require_function, require_path
from acutance.errors import OptionError

__all__ = ["FORMATS", "export_entries"]

Progress = Callable[[int, int], None]
_REPORT_EVERY = 500
_SQLITE = b"SQLite format 3\0"
_BESIDE = ("-wal", "-shm", "-journal")

FORMATS: Mapping[str, Callable[[Iterable[Entry], Path], int]] = {
    "jsonl": write_jsonl,
    "parquet": write_parquet,
    "csv": write_csv,
    "csv-documents": partial(write_csv, with_documents=True),
    "stac": write_stac,
}
"""Formats by name. All but "csv" can be imported again, and lose nothing."""


def export_entries(
    database: Database,
    selection: Selection,
    place: str | os.PathLike[str],
    to: str,
    progress: Progress | None = None,
) -> int:
    """Write what a selection means, and count it; a warning names damaged rows, left out.

    Parameters
    ----------
    database : Database
    selection : Selection
    place : path
        A file; of "stac" a folder.
    to : str
        A name of `FORMATS`.
    progress : callable, optional
        Called with how many of how many entries were read.

    Raises
    ------
    OptionError
        If there is no such format, its library is missing, the place cannot be written, or is
        that of an archive.
    """
    require_path(place=place)
    require_function(progress=progress)
    if not isinstance(to, str) or to not in FORMATS:
        raise OptionError(f"there is no format {to!r} to export to, only {', '.join(FORMATS)}")
    path = Path(place)
    if not path.absolute().parent.is_dir():
        raise OptionError(f"{path} cannot be written, there is no folder {path.parent}")
    _require_no_database(database, path)
    ids = select_ids(database, selection)
    entries = _reported(named_once(undamaged_entries(database, ids)), len(ids), progress)
    return FORMATS[to](entries, path)


def _require_no_database(database: Database, path: Path) -> None:
    """Refuse to replace the archive itself, what SQLite has beside it, or another database.

    Raises
    ------
    OptionError
        If that is what the place is.
    """
    place = os.path.realpath(path)
    own = os.path.realpath(database.place) if database.is_file else None
    if own is not None and place in [own + ending for ending in ("", *_BESIDE)]:
        raise OptionError(f"{path} is the archive itself, which would be lost: name another file")
    if not os.path.isfile(place):
        return
    with refusals_in_words(path), open(place, "rb") as file:
        if file.read(len(_SQLITE)) == _SQLITE:
            raise OptionError(
                f"{path} is a database, which would be lost: name another file, or remove it first"
            )


def _reported(entries: Iterator[Entry], total: int, progress: Progress | None) -> Iterator[Entry]:
    for number, entry in enumerate(entries, start=1):
        yield entry
        if progress is not None and (number % _REPORT_EVERY == 0 or number == total):
            progress(number, total)
