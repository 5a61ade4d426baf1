"""Times and days as documents write them, in UTC."""

from __future__ import annotations

import re
from calendar import isleap
from datetime import UTC, date, datetime, timedelta

__all__ = ["has_zone", "is_day", "is_possible", "possible_days", "time_or_day", "utc_time"]

_COMPACT = re.compile(r"^(\d{4})(\d\d)(\d\d)[T ]?(\d\d)(\d\d)(\d\d)(?:\.(\d+))?(Z?)$")
_DAY = re.compile(r"^(\d{4})([-:/]?)(\d\d)\2(\d\d)Z?$")
_COLONS = re.compile(r"^(\d{4}):(\d\d):(\d\d) ")
_ORDINAL = re.compile(r"^(\d{4})-(\d{3})(?=Z?$|[T ]\d)")
_LEAP_SECOND = re.compile(r"(?<=:[25]9):60(?!\d)")
_MIDNIGHT = re.compile(r"(?<=[T ])24(?=:00(?::00(?:\.0+)?)?(?:Z|[+-]|$))")
"""The end of a day."""
_YEARS = (1957, 2200)
"""Since there are satellites."""
_YEARS_AHEAD = 10


def utc_time(text: object) -> datetime | None:
    """The time of a text, aware, in UTC; one without a zone is taken as UTC.

    Parameters
    ----------
    text : object
        ISO 8601 ("2020-356T01:39:41Z", too), "20201221013941.14" or "2020:12:21 01:39:41"; a date
        alone is no time. A leap second (23:59:60) is the first of the next minute, 24:00 the
        beginning of the next day.

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
    plain, leap_s = _LEAP_SECOND.subn(":59", _of_month(plain))
    plain, days = _MIDNIGHT.subn("00", plain)
    try:
        found = datetime.fromisoformat(plain) + timedelta(days=days, seconds=leap_s)
        found = found.astimezone(UTC) if found.tzinfo else found.replace(tzinfo=UTC)
    except (ValueError, OverflowError):
        return None
    return found if _YEARS[0] <= found.year < _YEARS[1] else None


def _of_month(text: str) -> str:
    """A text that begins with a day of the year, with month and day instead; others as they are."""
    ordinal = _ORDINAL.match(text)
    if ordinal is None:
        return text
    year, number = int(ordinal[1]), int(ordinal[2])
    if not (_YEARS[0] <= year < _YEARS[1] and 1 <= number <= 365 + isleap(year)):
        return text
    day = date(year, 1, 1) + timedelta(days=number - 1)
    return day.isoformat() + text[ordinal.end() :]


def time_or_day(text: object) -> datetime | date | None:
    """The time of a text, or its day where no time stands beside it.

    Parameters
    ----------
    text : object
        As of `utc_time`, or "2020-12-21", "20201221", "2020:12:21", "2020/12/21", "2020-356".

    Returns
    -------
    datetime, date or None
        A plain date is known to the day; None if it is something else.
    """
    if isinstance(text, date) and not isinstance(text, datetime):
        return text
    found = utc_time(text)
    if found is not None or not isinstance(text, str):
        return found
    written = _DAY.match(_of_month(text.strip()))
    if written is None:
        return None
    try:
        day = date(int(written[1]), int(written[3]), int(written[4]))
    except ValueError:
        return None
    return day if _YEARS[0] <= day.year < _YEARS[1] else None


def is_day(when: datetime | date) -> bool:
    """Whether a moment is known to the day only."""
    return not isinstance(when, datetime)


def possible_days() -> tuple[date, date]:
    """First and last day an image can be of: since there are satellites, for ten years to come.

    Images that are simulated may be of days ahead.
    """
    return date(_YEARS[0], 1, 1), date(datetime.now(UTC).year + _YEARS_AHEAD, 12, 31)


def is_possible(when: datetime | date) -> bool:
    """Whether an image can be of a day, or of a moment in UTC (`possible_days`)."""
    first, last = possible_days()
    return first <= (when.date() if isinstance(when, datetime) else when) <= last


def has_zone(text: object) -> bool:
    """Whether a text that is a time names its zone."""
    return isinstance(text, str) and bool(re.search(r"(Z|[+-]\d\d:?\d\d)\s*$", text))
