"""Results of a study: named columns of equal length."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["Cell", "Table"]

Cell = float | int | str


@dataclass(frozen=True)
class Table:
    """Named columns of equal length; their names end in the unit where there is one.

    Parameters
    ----------
    columns : mapping of str to sequence
        Numbers or texts; ``nan`` where there is no number.
    """

    columns: Mapping[str, Sequence[Cell]]

    def __post_init__(self) -> None:
        lengths = {name: len(values) for name, values in self.columns.items()}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"give columns of one length to a table, found {lengths}")

    @classmethod
    def of_rows(cls, rows: Iterable[Mapping[str, Cell]]) -> Table:
        """A table of rows that all have the same names."""
        listed = list(rows)
        names = list(listed[0]) if listed else []
        return cls({name: [row[name] for row in listed] for name in names})

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> Floats:
        """A column of numbers as an array, (n,)."""
        return np.asarray(self.columns[name], float)

    def where(self, **wanted: Cell) -> Table:
        """The rows in which the named columns have the wanted values."""
        kept = [
            i
            for i in range(len(self))
            if all(self.columns[name][i] == value for name, value in wanted.items())
        ]
        return Table({name: [values[i] for i in kept] for name, values in self.columns.items()})

    def rows(self) -> list[dict[str, Cell]]:
        """The rows, by column name."""
        return [
            {name: values[i] for name, values in self.columns.items()} for i in range(len(self))
        ]

    def to_csv(self) -> str:
        """The table as CSV with a header; numbers with six digits, nothing for ``nan``."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        for row in self.rows():
            writer.writerow([_written(cell) for cell in row.values()])
        return text.getvalue()

    def to_dict(self) -> dict[str, list[Any]]:
        """The columns as lists, ``None`` for ``nan``."""
        return {name: [_known(cell) for cell in values] for name, values in self.columns.items()}


def _written(cell: Cell) -> Cell:
    if not isinstance(cell, float):
        return cell
    return f"{cell:.6g}" if math.isfinite(cell) else ""


def _known(cell: Cell) -> Cell | None:
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell
