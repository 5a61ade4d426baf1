"""What long commands show while they work, and at Ctrl-C."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from acutance.cli.terminal import say

__all__ = ["ProgressBar", "progress_bar"]

_LINE_S = 10.0
"""Between two lines, where stderr is no terminal."""


class ProgressBar(Protocol):
    """How far a long command has come, where it is shown."""

    def __call__(self, done: int, total: int | None) -> None:
        """So much is finished, of how much."""

    def tell(self, words: str) -> None:
        """What was found so far, or is done now."""


@contextmanager
def progress_bar(title: str) -> Iterator[ProgressBar]:
    """A bar of what is finished, of how much, on stderr; a line now and then in a file.

    Ctrl-C is answered at once, whatever has to be ended then.
    """
    from rich.console import Console

    console = Console(stderr=True)
    with _answered_interrupts():
        if not console.is_terminal:
            yield _Lines(title)
            return
        with _bar(title, console) as shown:
            yield shown


class _Lines:
    """A line now and then."""

    def __init__(self, title: str) -> None:
        self.title, self.words, self.last = title, "", time.monotonic()

    def __call__(self, done: int, total: int | None) -> None:
        if time.monotonic() - self.last >= _LINE_S:
            self.last = time.monotonic()
            count = f"{done}" if total is None else f"{done} of {total}"
            say(f"{self.title}: {count}{self.words}")

    def tell(self, words: str) -> None:
        self.words = f" ({words})"


class _Bar:
    """A task of rich's bar."""

    def __init__(self, progress: Any) -> None:
        self.progress, self.task = progress, progress.add_task("", total=None)

    def __call__(self, done: int, total: int | None) -> None:
        self.progress.update(self.task, completed=done, total=total)

    def tell(self, words: str) -> None:
        self.progress.update(self.task, description=words)


@contextmanager
def _bar(title: str, console: Any) -> Iterator[ProgressBar]:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    told = TextColumn("{task.description}")
    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), Remaining(), told)
    with Progress(*columns, console=console, transient=True) as progress:
        yield _Bar(progress)


@contextmanager
def _answered_interrupts() -> Iterator[None]:
    """Say that Ctrl-C was received: processes end their last work before the command ends."""
    usual = signal.getsignal(signal.SIGINT)
    if usual is not signal.default_int_handler or (
        threading.current_thread() is not threading.main_thread()
    ):
        yield
        return

    def answer(number: int, frame: Any) -> None:
        say("stopping ...")
        signal.default_int_handler(number, frame)

    signal.signal(signal.SIGINT, answer)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
