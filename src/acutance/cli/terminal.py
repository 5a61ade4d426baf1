"""What goes to the terminal: results to stdout, everything said about them to stderr."""

from __future__ import annotations

import shlex
import sys
from typing import NoReturn

import typer

__all__ = ["FAILED_CHECK", "command_line", "fail", "say", "stop"]

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


def command_line() -> str:
    """The command as the user typed it, to be repeated."""
    return shlex.join(["acutance", *sys.argv[1:]])
