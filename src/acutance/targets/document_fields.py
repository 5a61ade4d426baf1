"""Documents: what schema they have to be of, and fields that are written when first read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from acutance.errors import OptionError

__all__ = ["DocumentFields", "WrittenLater", "refuse_damaged", "require_document"]


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

    def __contains__(self, name: object) -> bool:
        return name in self._fields

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)


def require_document(
    document: Any, schema: str, required: Sequence[str], *, name: str, advice: str
) -> None:
    """Refuse what is no document of a schema, or lacks fields.

    Parameters
    ----------
    document : object
    schema : str
    required : sequence of str
        Names of fields.
    name : str
        What the document is called: "the filter".
    advice : str
        How one is made: "write one with ...".

    Raises
    ------
    OptionError
        If it is none, or fields are missing.
    """
    if isinstance(document, str | bytes):
        raise OptionError(
            f"{name} is text: read it first, json.loads(text), and give the mapping that returns"
        )
    found = document.get("schema") if isinstance(document, Mapping) else None
    if found != schema:
        raise OptionError(f"this is no document {schema} (its schema is {found!r}): {advice}")
    missing = [field for field in required if field not in document]
    if missing:
        raise OptionError(f"{name} lacks {', '.join(missing)}: it was cut or changed")


@contextmanager
def refuse_damaged(name: str, advice: str, of: str = "") -> Iterator[None]:
    """Say in words that a document could not be read, whatever its reader stumbled over.

    Parameters
    ----------
    name : str
        What the document is called: "the filter".
    advice : str
        What to give instead: "give one that ... wrote".
    of : str, optional
        What it is read as, where its name does not say so.

    Raises
    ------
    OptionError
        Names what was missing, or not as it has to be.
    """
    try:
        yield
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        missing = f"it has no {error}" if isinstance(error, KeyError) else str(error)
        read = f"read as {of}" if of else "read"
        raise OptionError(f"{name} cannot be {read} ({missing}): {advice}") from error
