"""JSON lines: one document ``acutance/archived/1`` a line; nothing is lost."""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator
from pathlib import Path

from acutance.archive.entry import Entry
from acutance.archive.exchange.entry_document import entry_document
from acutance.archive.exchange.files import whole_file
from acutance.archive.packing import json_bytes

__all__ = ["read_jsonl", "write_jsonl"]


def write_jsonl(entries: Iterable[Entry], place: Path) -> int:
    """Write entries, and count them.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    count = 0
    with whole_file(place) as part, part.open("wb") as file:
        for entry in entries:
            file.write(json_bytes(entry_document(entry)) + b"\n")
            count += 1
    return count


def read_jsonl(place: Path) -> Iterator[tuple[str, bytes]]:
    """Documents of a file as JSON, each with the line it stands in."""
    with place.open("rb") as file:
        for number, line in enumerate(file, start=1):
            if number == 1:
                # Editors on Windows write a byte order mark, which JSON has not.
                line = line.removeprefix(BOM_UTF8)
            if line.strip():
                yield f"{place}, line {number}", line
