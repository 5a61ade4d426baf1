"""What long commands show while they work, and at Ctrl-C."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from acutance.cli.terminal import say

__all__ = ["progress_bar"]

Show = Callable[[int, int | None], None]

_LINE_S = 10.0
"""Between two lines, where stderr is no terminal."""


@contextmanager
def progress_bar(title: str) -> Iterator[Show]:
    """A bar of what is finished, of how much, on stderr; a line now and then in a file.

    Ctrl-C is answered at once, whatever has to be ended then.
    """
    from rich.console import Console

    console = Console(stderr=True)
    with _answered_interrupts():
        if not console.is_terminal:
            yield _lines(title)
            return
        with _bar(title, console) as show:
            yield show


def _lines(title: str) -> Show:
    last = time.monotonic()

    def show(done: int, total: int | None) -> None:
        nonlocal last
        if time.monotonic() - last >= _LINE_S:
            last = time.monotonic()
            say(f"{title}: {done}" + ("" if total is None else f" of {total}"))

    return show


@contextmanager
def _bar(title: str, console: Any) -> Iterator[Show]:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), Remaining())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)


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
