"""Rows of an archive as columns: one array a name, for notebooks, pandas and xarray."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from html import escape
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from acutance.archive.counted import counted
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError

__all__ = ["Columns", "csv_text", "require_library"]

_SHOWN = 20


def require_library(name: str, extra: str) -> None:
    """Make sure that a library of an extra is installed.

    Raises
    ------
    OptionError
        If it is not.
    """
    from importlib.util import find_spec

    if find_spec(name) is None:
        raise OptionError(
            f"this needs {name}, which is not installed: pip install 'acutance[{extra}]'"
        )


def csv_text(header: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table as CSV: all digits of numbers, nothing for ``None``, moments in ISO 8601."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(
        [one.isoformat() if isinstance(one, datetime) else one for one in row] for row in rows
    )
    return text.getvalue()


@dataclass(frozen=True, eq=False)
class Columns(ShortRepr):
    """Columns of equal length.

    Parameters
    ----------
    columns : mapping of str to (n,) array
        Numbers with NaN, moments with NaT and texts with ``None`` where nothing is known.
    """

    columns: Mapping[str, NDArray[Any]]
    shown: ClassVar[tuple[str, ...]] = ()
    whole: ClassVar[tuple[str, ...]] = ()
    """Whole numbers that are not always known: arrays have them as floats, for NaN."""

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column.

        Raises
        ------
        OptionError
            If there is no such column.
        """
        if name not in self.columns:
            raise OptionError(f"there is no column {name!r}, only {', '.join(self.columns)}")
        return self.columns[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self.columns)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Row by row as Python's own types; ``None`` where nothing is known."""
        listed = {name: _plain(column) for name, column in self.columns.items()}
        for name in set(self.whole) & set(listed):
            listed[name] = [None if value is None else int(value) for value in listed[name]]
        for values in zip(*listed.values(), strict=True):
            yield dict(zip(listed, values, strict=True))

    def to_csv(self) -> str:
        """The text of a table with a header; empty where nothing is known, moments in ISO 8601."""
        return csv_text(self.names, (row.values() for row in self.rows()))

    def to_pandas(self) -> Any:
        """The columns as a `pandas.DataFrame`.

        Raises
        ------
        OptionError
            If pandas is not installed.
        """
        require_library("pandas", "pandas")
        import pandas

        return pandas.DataFrame(dict(self.columns))

    def to_xarray(self) -> Any:
        """The columns as an `xarray.Dataset` along the dimension "row".

        Raises
        ------
        OptionError
            If xarray is not installed.
        """
        require_library("xarray", "xarray")
        import xarray

        return xarray.Dataset({name: ("row", column) for name, column in self.columns.items()})

    def summary(self) -> str:
        """How many rows."""
        return counted(len(self), "row")

    def _repr_html_(self) -> str:
        names = [name for name in self.shown if name in self.columns]
        head = "".join(f"<th>{escape(name)}</th>" for name in names)
        shown = (
            [_cell(self.columns[name][i]) for name in names] for i in range(len(self))[:_SHOWN]
        )
        cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in shown)
        body = "".join(f"<tr>{row}</tr>" for row in cells)
        more = len(self) - _SHOWN
        left = f"<p>… and {more} more</p>" if more > 0 else ""
        caption = f"<caption>{escape(self.summary())}</caption>"
        return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{left}"


def _plain(column: NDArray[Any]) -> list[Any]:
    listed = column.tolist()
    if column.dtype.kind != "f":
        return list(listed)
    return [None if value != value else value for value in listed]


def _cell(value: Any) -> str:
    if value is None or value != value:
        return "–"
    if isinstance(value, np.datetime64):
        return str(value.astype("datetime64[s]"))
    return f"{value:.4g}" if isinstance(value, float | np.floating) else str(value)
