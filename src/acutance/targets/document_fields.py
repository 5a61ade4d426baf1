"""Fields of a document that are written when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["DocumentFields", "WrittenLater"]


@dataclass(frozen=True)
class WrittenLater:
    """A field of a document that is written when it is first read.

    Parameters
    ----------
    write : function
        Returns the field.
    """

    write: Callable[[], Any]


class DocumentFields(Mapping[str, Any]):
    """The fields of a document by name.

    Curves and covariances are nine tenths of a document. Who reads numbers, checks and verdict of
    thousands of records needs none of them, and to write them takes a quarter of a measurement.

    Parameters
    ----------
    fields : mapping
        Strict JSON types, or `WrittenLater`.
    """

    def __init__(self, fields: Mapping[str, Any]) -> None:
        self._fields = dict(fields)

    def __getitem__(self, name: str) -> Any:
        field = self._fields[name]
        if isinstance(field, WrittenLater):
            field = self._fields[name] = field.write()
        return field

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)
