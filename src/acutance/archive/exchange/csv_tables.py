"""CSV: all numbers, a row for each measurement and direction.

The numbers have all their digits. Curves, covariances and checks are in the whole document, which
no spreadsheet can hold in a cell: it is a column only where it is asked for, and only such a file
can be read into an archive again.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

from acutance.archive.entry import Entry
from acutance.archive.exchange.files import whole_file
from acutance.archive.exchange.flat_rows import flat_columns, flat_rows
from acutance.errors import OptionError

__all__ = ["read_csv", "write_csv"]


def write_csv(entries: Iterable[Entry], place: Path, with_documents: bool = False) -> int:
    """Write entries as rows, and count the entries.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    columns, count = flat_columns(with_documents), 0
    with whole_file(place) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore")
        writer.writeheader()
        for entry in entries:
            writer.writerows(map(_as_text, flat_rows(entry)))
            count += 1
    return count


def read_csv(place: Path) -> Iterator[tuple[str, str]]:
    """Documents of a file as JSON, each with the line its row ends in.

    Raises
    ------
    OptionError
        If it has no column of documents.
    """
    csv.field_size_limit(min(sys.maxsize, 2**31 - 1))
    with place.open(encoding="utf-8-sig", newline="") as file:
        rows = csv.DictReader(file)
        if "document" not in (rows.fieldnames or ()):
            raise OptionError(
                f"{place} has no column of documents, so curves and covariances are not in it: "
                "export it with documents (--documents), or as jsonl or parquet"
            )
        for row in rows:
            if row["document"]:
                yield f"{place}, line {rows.line_num}", row["document"]


def _as_text(row: dict[str, Any]) -> dict[str, Any]:
    return {
        name: value.isoformat() if isinstance(value, datetime) else value
        for name, value in row.items()
    }
