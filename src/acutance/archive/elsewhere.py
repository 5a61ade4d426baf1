"""Rejections of targets that their image does not show: nothing went wrong with them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

__all__ = ["ELSEWHERE", "elsewhere"]

ELSEWHERE: Final = {
    "outside": "outside the image",
    "not there then": "not there at the time of the image",
}
"""By the word of their reason, in full."""


def elsewhere(values: Mapping[str, Any] | None) -> str | None:
    """Why an image does not show a target, in full; None of any other rejection.

    Parameters
    ----------
    values : mapping or None
        Of the rejection.
    """
    return ELSEWHERE.get(str((values or {}).get("why")))
