"""Times as documents write them, in UTC."""

from __future__ import annotations

import re
from datetime import UTC, datetime

__all__ = ["has_zone", "utc_time"]

_COMPACT = re.compile(r"^(\d{4})(\d\d)(\d\d)[T ]?(\d\d)(\d\d)(\d\d)(?:\.(\d+))?(Z?)$")
_COLONS = re.compile(r"^(\d{4}):(\d\d):(\d\d) ")
_YEARS = (1957, 2200)
"""Since there are satellites."""


def utc_time(text: object) -> datetime | None:
    """The time of a text, aware, in UTC; one without a zone is taken as UTC.

    Parameters
    ----------
    text : object
        ISO 8601, "20201221013941.14" or "2020:12:21 01:39:41"; a date alone is no time.

    Returns
    -------
    datetime or None
        None if it is something else.
    """
    if isinstance(text, datetime):
        return text.astimezone(UTC) if text.tzinfo else text.replace(tzinfo=UTC)
    if not isinstance(text, str) or len(text) > 60:
        return None
    plain = _COLONS.sub(r"\1-\2-\3 ", text.strip())
    compact = _COMPACT.match(plain)
    if compact:
        year, month, day, hour, minute, second, part, zone = compact.groups()
        plain = f"{year}-{month}-{day}T{hour}:{minute}:{second}.{(part or '0')[:6]:0<6}{zone}"
    if not re.search(r"\d:\d", plain):
        return None
    try:
        found = datetime.fromisoformat(plain)
        found = found.astimezone(UTC) if found.tzinfo else found.replace(tzinfo=UTC)
    except (ValueError, OverflowError):
        return None
    return found if _YEARS[0] <= found.year < _YEARS[1] else None


def has_zone(text: object) -> bool:
    """Whether a text that is a time names its zone."""
    return isinstance(text, str) and bool(re.search(r"(Z|[+-]\d\d:?\d\d)\s*$", text))
