"""Texts of names and values in groups: MTL files of Landsat, IMD files of DigitalGlobe."""

from __future__ import annotations

import re
from typing import Any

__all__ = ["parse_odl"]

_LINE = re.compile(r"^\s*([A-Za-z_][\w.]*)\s*=\s*(.*?)\s*;?\s*$")
_MAX_BYTES = 16 * 2**20


def parse_odl(content: bytes) -> dict[str, Any]:
    """Groups as dicts inside one another, values as texts without their quotes.

    Names are in capitals. Lines that are no assignment (lists over several lines) are passed over.

    Raises
    ------
    ValueError
        If it holds no assignment, or is far larger than metadata are.
    """
    if len(content) > _MAX_BYTES:
        raise ValueError(f"it has {len(content)} bytes, far more than metadata have")
    root: dict[str, Any] = {}
    stack = [root]
    for line in content.decode("utf-8", errors="replace").splitlines():
        found = _LINE.match(line)
        if found is None:
            continue
        name, value = found[1].upper(), found[2].strip().strip('"').strip()
        if name in ("GROUP", "BEGIN_GROUP", "OBJECT"):
            inner = stack[-1].setdefault(value.upper(), {})
            stack.append(inner if isinstance(inner, dict) else {})
        elif name in ("END_GROUP", "END_OBJECT"):
            del stack[max(1, len(stack) - 1) :]
        else:
            stack[-1].setdefault(name, value)
    if not root:
        raise ValueError("it holds no line NAME = VALUE")
    return root
