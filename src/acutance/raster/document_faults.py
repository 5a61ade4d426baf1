"""What is wrong with a document that was checked by a model, with places as its author counts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from pydantic import ValidationError

__all__ = ["DocumentFault", "document_faults"]

Place = tuple[str | int, ...]

_SCALARS = ("str", "int", "float", "bool")


@dataclass(frozen=True)
class DocumentFault:
    """One fault.

    Attributes
    ----------
    place : str
        Entries of lists count from 1 and have their names: "requirement 2 (pan), minimum".
    key : str
        Its last part.
    within : str
        The place without it; "" at the top.
    kind : str
        As pydantic calls it: "missing", "extra_forbidden", ...
    found : object
        The value that is there.
    message : str
    """

    place: str
    key: str
    within: str
    kind: str
    found: Any
    message: str

    def in_words(self, part: str) -> str:
        """A sentence without its full stop.

        Parameters
        ----------
        part : str
            What the document calls its parts: "key", "property".
        """
        if self.kind == "extra_forbidden":
            where = f" in {self.within}" if self.within else ""
            return f"there is no {part} {self.key!r}{where}"
        if self.kind == "missing":
            return f"the {part} {self.place!r} is missing"
        return f"{self.place} is {self.found!r:.60}: {self.message}"


def document_faults(error: ValidationError, document: Any) -> list[DocumentFault]:
    """The faults of a document, each place once.

    Of a value that may be of several types the complaints of all are joined, and a list that has a
    wrong entry is not said to be none.

    Parameters
    ----------
    error : ValidationError
    document : mapping
        What was checked.
    """
    faults: dict[Place, DocumentFault] = {}
    for one in error.errors():
        place = tuple(part for part in one["loc"] if not _is_branch(part))
        message = one["msg"].removeprefix("Value error, ")
        if place in faults:
            earlier = faults[place]
            faults[place] = replace(earlier, message=f"{earlier.message}, or {message}")
        else:
            faults[place] = DocumentFault(
                _words(place, document), str(place[-1]) if place else "",
                _words(place[:-1], document), one["type"], one["input"], message,
            )  # fmt: skip
    return [fault for place, fault in faults.items() if not _has_deeper(place, faults)]


def _is_branch(part: str | int) -> bool:
    """Whether a part of a place names a type that was tried, and no key."""
    return isinstance(part, str) and (part in _SCALARS or part.startswith("list["))


def _has_deeper(place: Place, faults: Mapping[Place, DocumentFault]) -> bool:
    return any(other != place and other[: len(place)] == place for other in faults)


def _words(place: Place, document: Any) -> str:
    words: list[str] = []
    node = document
    for part in place:
        node = _child(node, part)
        if isinstance(part, str):
            words.append(part)
        else:
            name = node.get("name") if isinstance(node, Mapping) else None
            named = f" ({name})" if isinstance(name, str) and name else ""
            words.append(f"{words.pop() if words else 'entry'} {part + 1}{named}")
    return ", ".join(words)


def _child(node: Any, part: str | int) -> Any:
    try:
        return node[part]
    except (KeyError, IndexError, TypeError):
        return None
