"""Parquet: all numbers as columns, and whole documents; GeoParquet 1.1 with the targets' places."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from acutance.archive.columns import require_library
from acutance.archive.entry import Entry
from acutance.archive.exchange.files import whole_file
from acutance.archive.exchange.flat_rows import (
    FLAGS,
    MOMENTS,
    NUMBERS,
    TEXTS,
    flat_columns,
    flat_rows,
)
from acutance.errors import OptionError

__all__ = ["read_parquet", "write_parquet"]

_SOME = 1000
_GEO = {
    "version": "1.1.0",
    "primary_column": "geometry",
    "columns": {"geometry": {"encoding": "WKB", "geometry_types": ["Point"]}},
}
"""Metadata of GeoParquet; without a CRS it is longitude and latitude (OGC:CRS84)."""


def write_parquet(entries: Iterable[Entry], place: Path) -> int:
    """Write entries as rows, and count the entries.

    Raises
    ------
    OptionError
        If pyarrow is not installed, or the file cannot be written.
    """
    require_library("pyarrow", "parquet")
    from pyarrow import Table, parquet

    count, left, schema = 0, iter(entries), _schema()
    with whole_file(place) as part, parquet.ParquetWriter(part, schema, compression="zstd") as file:
        while some := list(islice(left, _SOME)):
            rows = [row | _geometry(row) for entry in some for row in flat_rows(entry)]
            columns = {name: [row.get(name) for row in rows] for name in schema.names}
            file.write_table(Table.from_pydict(columns, schema))
            count += len(some)
    return count


def read_parquet(place: Path) -> Iterator[tuple[str, str]]:
    """Documents of a file as JSON, each with its row.

    Raises
    ------
    OptionError
        If pyarrow is not installed, or the file is not what `write_parquet` wrote.
    """
    require_library("pyarrow", "parquet")
    from pyarrow import ArrowException, parquet

    with place.open("rb") as stream:
        try:
            file = parquet.ParquetFile(stream)
        except ArrowException as error:
            raise OptionError(f"{place} is no Parquet file ({error})") from error
        if "document" not in file.schema_arrow.names:
            raise OptionError(
                f"{place} has no column of documents: give a Parquet file that acutance archive "
                "export wrote"
            )
        number = 0
        for batch in file.iter_batches(batch_size=_SOME, columns=["document"]):
            for text in batch.column(0).to_pylist():
                number += 1
                if text is not None:
                    yield f"{place}, row {number}", text


def _schema() -> Any:
    import pyarrow

    types: dict[str, Any] = dict.fromkeys(TEXTS, pyarrow.string())
    types |= dict.fromkeys(MOMENTS, pyarrow.timestamp("us", "UTC"))
    types |= dict.fromkeys(FLAGS, pyarrow.bool_())
    types |= dict.fromkeys(NUMBERS, pyarrow.float64())
    types |= {"document": pyarrow.string()}
    fields = [(name, types[name]) for name in flat_columns(with_documents=True)]
    schema = pyarrow.schema([*fields, ("geometry", pyarrow.binary())])
    return schema.with_metadata({"geo": json.dumps(_GEO)})


def _geometry(row: dict[str, Any]) -> dict[str, bytes | None]:
    """The target's place as a point in well-known binary."""
    place: Sequence[float | None] = row["lon"], row["lat"]
    return {"geometry": None if None in place else struct.pack("<BIdd", 1, 1, *place)}
