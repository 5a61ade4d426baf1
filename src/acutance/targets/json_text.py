"""The text of a document: strict JSON that a person can scroll through."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from acutance.targets.record import strict_json

__all__ = ["json_text"]


def json_text(document: Mapping[str, Any]) -> str:
    """Strict JSON, indented by one: what is not a finite number becomes null.

    Lists of numbers stay on one line each, so that a reader can scroll.
    """
    return _render(strict_json(document), 0)


def _render(value: Any, depth: int) -> str:
    nested = isinstance(value, list) and any(isinstance(item, dict | list) for item in value)
    if not value or not (isinstance(value, dict) or nested):
        return json.dumps(value, ensure_ascii=False, allow_nan=False)
    inner, outer = " " * (depth + 1), " " * depth
    if isinstance(value, dict):
        items = [
            f"{json.dumps(key, ensure_ascii=False)}: {_render(item, depth + 1)}"
            for key, item in value.items()
        ]
        opening, closing = "{", "}"
    else:
        items = [_render(item, depth + 1) for item in value]
        opening, closing = "[", "]"
    body = f",\n{inner}".join(items)
    return f"{opening}\n{inner}{body}\n{outer}{closing}"
