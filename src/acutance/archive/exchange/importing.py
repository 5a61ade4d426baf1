"""Documents of files are added to an archive; files that cannot be read stop no other."""

from __future__ import annotations

import os
from codecs import BOM_UTF8
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import orjson

from acutance.archive.adding import add_entries
from acutance.archive.connection import Database
from acutance.archive.contradictions import contradictions
from acutance.archive.entry import Entry, ImageEntry
from acutance.archive.exchange.csv_tables import read_csv
from acutance.archive.exchange.documents import Stated, entries_of
from acutance.archive.exchange.jsonl import read_jsonl
from acutance.archive.exchange.parquet import read_parquet
from acutance.archive.identity import keys_of
from acutance.archive.possible_values import require_possible
from acutance.errors import OptionError

__all__ = ["Imported", "import_files", "refused_files"]

_CATALOG = "catalog.json"

Read = Callable[[Path], Iterator[tuple[str, bytes | str]]]


@dataclass(frozen=True)
class Imported:
    """What an import did.

    Attributes
    ----------
    read : int
        Entries that were read.
    new : int
        Entries that were not there.
    refused : mapping of str to str
        By file (and line) why it could not be read, or what is stated of it and is not what the
        archive has.
    notes : tuple of str
        What has to be known of what was added.
    """

    read: int
    new: int
    refused: Mapping[str, str]
    notes: tuple[str, ...] = ()


def import_files(
    database: Database,
    paths: Iterable[str | os.PathLike[str]],
    stated: Stated,
    run: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Imported:
    """Add the documents of files.

    Parameters
    ----------
    database : Database
    paths : iterable of path
        JSON documents, JSON lines, CSV with documents, Parquet, and folders of them or of STAC.
    stated : Stated
    run : int, optional
    progress : callable, optional
        Called now and then with how many entries were read.

    Raises
    ------
    ArchiveError
        If the archive cannot keep them.
    """
    refused: dict[str, str] = {}
    described: dict[str, tuple[str, ImageEntry]] = {}
    unnamed: dict[str, set[int]] = {}
    count = 0

    def entries() -> Iterator[Entry]:
        nonlocal count
        for path in paths:
            for place, entry in _readable(Path(path), stated, refused):
                count += 1
                if entry.key is None:
                    for key in filter(None, keys_of(entry)):
                        described[key] = place, entry.image
                    if entry.record is not None and entry.band is None and entry.image.path:
                        own = unnamed.setdefault(entry.image.path, set())
                        own.add(entry.record.image.band)
                yield entry

    new = add_entries(database, entries(), run, progress)
    images = {key: image for key, (_, image) in described.items()}
    for key, reason in contradictions(database, images).items():
        refused[described[key][0]] = reason
    return Imported(count, new, refused, tuple(_band_notes(unnamed)))


def _band_notes(unnamed: Mapping[str, set[int]]) -> Iterator[str]:
    """Images of which several bands were added that nothing tells apart."""
    for path, bands in unnamed.items():
        if len(bands) > 1:
            listed = " and ".join(map(str, sorted(bands)))
            yield (
                f"{path}: bands {listed} are kept without a name, and means are of "
                f"{'both' if len(bands) == 2 else 'all'}: import each with its name (--band)"
            )


def refused_files(paths: Iterable[str | os.PathLike[str]], stated: Stated) -> dict[str, str] | None:
    """Why nothing of some files can be read; ``None`` where something can.

    Parameters
    ----------
    paths : iterable of path
    stated : Stated
    """
    refused: dict[str, str] = {}
    for path in paths:
        for _ in _readable(Path(path), stated, refused):
            return None
    return refused


def _readable(path: Path, stated: Stated, refused: dict[str, str]) -> Iterator[tuple[str, Entry]]:
    """Places and entries of a path; what cannot be read is put down instead."""
    where = str(path)
    try:
        for file in _files(path):
            where = str(file)
            for place, text in _reader(file)(file):
                yield from ((place, one) for one in _entries(place, text, stated, refused))
    except (OptionError, OSError, UnicodeDecodeError) as error:
        refused[where] = _reason(error, where)


def _entries(place: str, text: bytes | str, stated: Stated, refused: dict[str, str]) -> list[Entry]:
    """Entries of one text of JSON: all of them, or none."""
    try:
        found = list(entries_of(orjson.loads(text), stated))
        for one in found:
            require_possible(one)
        return found
    except OptionError as error:
        refused[place] = str(error)
    except ValueError as error:
        refused[place] = _no_json(text, error)
    return []


def _no_json(text: bytes | str, error: ValueError) -> str:
    begin = text.lstrip()[:1]
    if begin in (b"{", "{", b"[", "["):
        return f"it is no JSON ({error}): was it cut?"
    return (
        "it is no JSON: give what a measuring command printed with --json, or what acutance "
        "archive export wrote"
    )


def _files(path: Path) -> list[Path]:
    """The file, or those of a folder: of a STAC catalogue the lines beside its items."""
    if not path.is_dir():
        return [path]
    if (path / _CATALOG).is_file():
        found = sorted(path.rglob("*.jsonl"))
    else:
        found = sorted(one for one in path.iterdir() if one.suffix.lower() in _READERS)
    if not found:
        raise OptionError("the folder holds nothing that can be imported")
    return found


def _reader(path: Path) -> Read:
    return _READERS.get(path.suffix.lower(), _read_json)


def _read_json(path: Path) -> Iterator[tuple[str, bytes]]:
    # Editors on Windows write a byte order mark, which JSON has not.
    yield str(path), path.read_bytes().removeprefix(BOM_UTF8)


_READERS: Mapping[str, Read] = {
    ".json": _read_json,
    ".jsonl": read_jsonl,
    ".ndjson": read_jsonl,
    ".csv": read_csv,
    ".parquet": read_parquet,
}


def _reason(error: Exception, where: str) -> str:
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error).removeprefix(f"{where} ").removeprefix(": ")
