"""Moments in UTC: how dates without a zone, or without a time, are read.

A moment without a time zone is UTC, as files of images state it. A day without a time begins
with its midnight; where the end of a period is meant (`end_of`), it ends with the last
microsecond of the day.
"""

from __future__ import annotations

from datetime import UTC, date, datetime, time

from acutance.errors import OptionError

__all__ = ["When", "as_utc", "day_or_minute", "end_of"]

When = datetime | date | str
"""A moment, a day, or either in the notation of ISO 8601."""


def as_utc(when: When, name: str = "the date") -> datetime:
    """The moment in UTC; a day without a time is its first moment.

    Parameters
    ----------
    when : datetime, date or str
    name : str, optional
        What is dated, for the message.

    Raises
    ------
    OptionError
        If it is no date.
    """
    return _moment(when, name, time.min)


def end_of(when: When, name: str = "the date") -> datetime:
    """The moment in UTC; a day without a time is its last moment.

    Raises
    ------
    OptionError
        If it is no date.
    """
    return _moment(when, name, time.max)


def day_or_minute(when: datetime, zone: str = "") -> str:
    """A kept moment in words, to the minute.

    Days without a time are kept as their beginning, so that of a midnight only the day is written.

    Parameters
    ----------
    when : datetime
        In UTC.
    zone : str, optional
        What is written behind a time.
    """
    return f"{when:%Y-%m-%d}" if when.time() == time.min else f"{when:%Y-%m-%d %H:%M}{zone}"


def _moment(when: When, name: str, of_day: time) -> datetime:
    """In UTC; a day without a time is at this time of it."""
    found = _parsed(when, name)
    if not isinstance(found, datetime):
        found = datetime.combine(found, of_day)
    return _in_utc(found, name)


def _parsed(when: When, name: str) -> datetime | date:
    if isinstance(when, date):
        return when
    try:
        return date.fromisoformat(when)
    except (TypeError, ValueError):
        pass
    try:
        return datetime.fromisoformat(when)
    except (TypeError, ValueError) as error:
        raise OptionError(
            f"{name} is {when!r}, no date: write 2026-01-31, or 2026-01-31T10:20:00Z"
        ) from error


def _in_utc(when: datetime, name: str) -> datetime:
    if when.tzinfo is None:
        return when.replace(tzinfo=UTC)
    try:
        return when.astimezone(UTC)
    except OverflowError as error:
        raise OptionError(f"{name} is {when.isoformat()}, before year 1 or after 9999") from error
