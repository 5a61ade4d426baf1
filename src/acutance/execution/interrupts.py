"""Ctrl-C, wherever it comes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["interruptible", "was_interrupted"]


def was_interrupted(error: SystemError) -> bool:
    """Whether this is Ctrl-C inside a compiled loop: a result was found beside the interrupt.

    A compiled loop that says so itself, by Python of its own, hands on one SystemError as the
    cause of another.
    """
    cause: BaseException | None = error
    while isinstance(cause, SystemError):
        cause = cause.__cause__
    return isinstance(cause, KeyboardInterrupt)


@contextmanager
def interruptible() -> Iterator[None]:
    """Ctrl-C inside a compiled loop is Ctrl-C, not an error of the work."""
    try:
        yield
    except SystemError as error:
        if was_interrupted(error):
            raise KeyboardInterrupt from None
        raise
