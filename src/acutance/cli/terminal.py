"""What goes to the terminal: results to stdout, everything said about them to stderr."""

from __future__ import annotations

import io
import os
import shlex
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, NoReturn

import typer

__all__ = [
    "BAD_USAGE",
    "EXIT_CODES",
    "FAILED_CHECK",
    "NOTHING_MEASURED",
    "command_line",
    "fail",
    "log_said",
    "replace_what_streams_lack",
    "say",
    "stop",
    "stop_printing",
    "warnings_said",
]

BAD_USAGE = 2
FAILED_CHECK = 3
NOTHING_MEASURED = 4
INTERRUPTED = 130
CLOSED_PIPE = 141
EXIT_CODES = (
    "Exit codes: 0 measured, 2 bad usage or input, 3 measured but a check failed under --strict, "
    "4 nothing there that can be measured, 130 interrupted."
)


def replace_what_streams_lack() -> None:
    """Print characters that the terminal's encoding has not as question marks.

    A result is not lost for a dash; halves of characters in names have no encoding at all.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def say(message: str) -> None:
    """Tell the user something that is not the result."""
    typer.echo(message, err=True)


def fail(message: str, code: int = BAD_USAGE) -> NoReturn:
    """End with one message and an exit code."""
    say(f"acutance: {message}")
    raise typer.Exit(code)


def stop(message: str) -> NoReturn:
    """End after Ctrl-C with one message and the exit code of shells for it."""
    fail(message or "interrupted", INTERRUPTED)


def stop_printing(error: OSError) -> NoReturn:
    """End because stdout takes no more: without a word where its reader has left.

    A reader that has seen enough (``| head``) ends other programs with the signal SIGPIPE, which
    shells report as 141.
    """
    _discard_stdout()
    if isinstance(error, BrokenPipeError):
        raise typer.Exit(CLOSED_PIPE)
    reason = error.strerror or str(error)
    fail(f"the result cannot be written to standard output ({reason}): send it elsewhere")


def _discard_stdout() -> None:
    """Lose what is still buffered: the interpreter would try to write it again at its end."""
    # Where stdout is no file (inside a test, in a notebook) nothing is written at the end.
    with suppress(OSError, ValueError, AttributeError):
        stdout, nowhere = sys.stdout.fileno(), os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stdout)
        os.close(nowhere)


@contextmanager
def log_said() -> Iterator[None]:
    """Say what the package logs in a line on stderr: that its loops are compiled first."""
    import logging

    class Said(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            say(f"acutance: {record.getMessage()}")

    logger, handler = logging.getLogger("acutance"), Said()
    before = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before)


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
