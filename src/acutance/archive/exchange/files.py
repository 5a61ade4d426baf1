"""Files that are whole or not there."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from acutance.errors import AcutanceError, OptionError

__all__ = ["refusals_in_words", "whole_file"]


@contextmanager
def whole_file(place: Path) -> Iterator[Path]:
    """A name to write under; at the end the file is renamed, or removed after an error.

    Raises
    ------
    OptionError
        If the file system refuses.
    """
    part = place.with_name(f"{place.name}.part")
    try:
        with refusals_in_words(place):
            yield part
            os.replace(part, place)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def refusals_in_words(place: Path) -> Iterator[None]:
    """What the file system refuses, as an error that tells what to do.

    Raises
    ------
    OptionError
        If it refuses something.
    """
    try:
        yield
    except OSError as error:
        if isinstance(error, AcutanceError):
            raise
        reason = error.strerror or str(error)
        raise OptionError(f"{place} cannot be written ({reason}): choose another place") from error
