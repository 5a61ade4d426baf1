"""Documents as the bytes an archive stores: JSON, compressed in the format of zlib."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any

import orjson
from isal import isal_zlib

from acutance.errors import ArchiveError, OptionError

__all__ = ["json_bytes", "packed", "plain_json", "unpacked"]

_LEVEL = 1
"""A third of the JSON, where the slowest of zlib leaves a quarter at fifty times the time."""


def json_bytes(document: Mapping[str, Any]) -> bytes:
    """A document as JSON; what is not a finite number becomes null.

    Raises
    ------
    OptionError
        If it holds what JSON cannot.
    """
    try:
        return orjson.dumps(document, default=_plain, option=orjson.OPT_NON_STR_KEYS)
    except (TypeError, ValueError) as error:
        raise OptionError(f"the document cannot be written as JSON: {error}") from error


def plain_json(value: Mapping[str, Any]) -> dict[str, Any]:
    """A mapping as JSON has it: numbers of numpy become Python's, dates and paths texts.

    Raises
    ------
    OptionError
        If it holds what JSON cannot.
    """
    found: dict[str, Any] = orjson.loads(json_bytes(value))
    return found


def _plain(value: Any) -> Any:
    """Arrays and numbers of numpy; whatever else JSON does not know is refused."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"a {type(value).__name__} has no form in JSON")


def packed(document: Mapping[str, Any]) -> bytes:
    """The bytes to store of a document.

    Raises
    ------
    OptionError
        If it holds what JSON cannot.
    """
    stored: bytes = isal_zlib.compress(json_bytes(document), _LEVEL)
    return stored


def unpacked(stored: bytes, number: int) -> dict[str, Any]:
    """The document that was stored.

    Parameters
    ----------
    stored : bytes
    number : int
        Of the measurement, for the message.

    Raises
    ------
    ArchiveError
        If it is damaged.
    """
    try:
        document = orjson.loads(zlib.decompress(stored))
        if not isinstance(document, dict):
            raise ValueError(f"it is a {type(document).__name__}")
    except (zlib.error, TypeError, ValueError) as error:
        raise ArchiveError(
            f"the document of measurement {number} is damaged ({error}): take the archive from a "
            "copy, or remove the image of the measurement and measure it again"
        ) from error
    return document
