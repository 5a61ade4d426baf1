"""Paths as text, whatever bytes they have."""

from __future__ import annotations

import re

__all__ = ["path_as_text"]

_BYTE = re.compile("[\udc80-\udcff]")
_FIRST = 0xDC00


def path_as_text(text: str) -> str:
    """A path, or a message that names one, as databases and JSON take it.

    Linux keeps names as bytes, of any encoding: those that are no UTF-8 are written as in URLs.
    """
    found = _BYTE.sub(lambda byte: f"%{ord(byte[0]) - _FIRST:02X}", text)
    return found.encode("utf-8", "replace").decode()
