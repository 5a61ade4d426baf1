"""What goes to the terminal: results to stdout, everything said about them to stderr."""

from __future__ import annotations

import shlex
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

import typer

__all__ = ["FAILED_CHECK", "command_line", "fail", "say", "stop", "warnings_said"]

BAD_USAGE = 2
FAILED_CHECK = 3
INTERRUPTED = 130


def say(message: str) -> None:
    """Tell the user something that is not the result."""
    typer.echo(message, err=True)


def fail(message: str) -> NoReturn:
    """End with exit code 2 and one message."""
    say(f"acutance: {message}")
    raise typer.Exit(BAD_USAGE)


def stop(message: str) -> NoReturn:
    """End after Ctrl-C with one message and the exit code of shells for it."""
    say(f"acutance: {message or 'interrupted'}")
    raise typer.Exit(INTERRUPTED)


@contextmanager
def warnings_said() -> Iterator[None]:
    """Say warnings for the user in a line, without the place in the program."""

    def show(message: Any, category: type[Warning], *place: Any, **named: Any) -> None:
        if issubclass(category, UserWarning):
            say(f"acutance: {message}")
        else:
            shown_before(message, category, *place, **named)

    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        shown_before, warnings.showwarning = warnings.showwarning, show
        yield


def command_line() -> str:
    """The command as the user typed it, to be repeated."""
    return shlex.join(["acutance", *sys.argv[1:]])
