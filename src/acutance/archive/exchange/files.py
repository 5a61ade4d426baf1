"""Files that are whole or not there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from acutance.errors import AcutanceError, OptionError
from acutance.execution import partial_folder

__all__ = ["refusals_in_words", "whole_file"]


@contextmanager
def whole_file(place: Path) -> Iterator[Path]:
    """A name to write under; at the end the file is renamed, or removed after an error.

    The name is in a hidden folder of its own: no file of the user's is touched before the end.

    Raises
    ------
    OptionError
        If the file system refuses.
    """
    with refusals_in_words(place), partial_folder.whole_file(place) as part:
        yield part


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
