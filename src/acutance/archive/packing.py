"""Documents as the bytes an archive stores: JSON, compressed by zlib."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any

from pydantic_core import PydanticSerializationError, from_json, to_json

from acutance.errors import OptionError

__all__ = ["json_bytes", "packed", "plain_json", "unpacked"]

_LEVEL = 1
"""The quickest: a third of the JSON, where the slowest leaves a quarter at ten times the time."""


def json_bytes(document: Mapping[str, Any]) -> bytes:
    """A document as JSON; what is not a finite number becomes null.

    Raises
    ------
    OptionError
        If it holds what JSON cannot.
    """
    try:
        return to_json(document, inf_nan_mode="null", fallback=_plain)
    except (PydanticSerializationError, TypeError, ValueError) as error:
        raise OptionError(f"the document cannot be written as JSON: {error}") from error


def plain_json(value: Mapping[str, Any]) -> dict[str, Any]:
    """A mapping as JSON has it: numbers of numpy become Python's, dates and paths texts.

    Raises
    ------
    OptionError
        If it holds what JSON cannot.
    """
    found: dict[str, Any] = from_json(json_bytes(value))
    return found


def _plain(value: Any) -> Any:
    """Arrays and numbers of numpy; whatever else JSON does not know is refused."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"a {type(value).__name__} has no form in JSON")


def packed(text: bytes) -> bytes:
    """The bytes to store; other threads go on meanwhile."""
    return zlib.compress(text, _LEVEL)


def unpacked(stored: bytes) -> dict[str, Any]:
    """The document that was stored."""
    document: dict[str, Any] = from_json(zlib.decompress(stored))
    return document
