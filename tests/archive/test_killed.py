"""Processes that are killed while they write, and several that write at once."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from orjson import loads

from acutance.archive import Archive, adding
from acutance.archive.exchange.entry_document import entry_document, entry_of_document
from acutance.archive.packing import json_bytes

COUNT = 120


@pytest.fixture
def lines(entry_of, tmp_path):
    path = tmp_path / "lines.jsonl"
    path.write_bytes(
        b"".join(json_bytes(entry_document(entry_of(i))) + b"\n" for i in range(COUNT))
    )
    return path


def write(place: str, lines: Path, first: int, heard: Any, said: Any) -> None:
    """Keep all entries, four at a time, and report every four that are kept."""
    adding.CHUNK = 4
    entries = [entry_of_document(loads(line)) for line in lines.read_bytes().splitlines()]
    entries = entries[first:] + entries[:first]
    said.send("ready")
    heard.recv()
    with Archive(place) as archive:
        for i in range(0, len(entries), 4):
            archive.add_entries(entries[i : i + 4])
            # What is sent was reported as kept.
            said.send([entry.key for entry in entries[i : i + 4]])


class Writer:
    """A process that writes once it is let go.

    Attributes
    ----------
    process : Process
    """

    def __init__(self, context: Any, place: str, lines: Path, first: int = 0) -> None:
        heard, self._mouth = context.Pipe(duplex=False)
        self._ear, said = context.Pipe(duplex=False)
        self.process = context.Process(target=write, args=(place, lines, first, heard, said))
        self.process.start()
        heard.close()
        said.close()
        assert self._ear.recv() == "ready"

    def let_go(self) -> None:
        """Let it write."""
        self._mouth.send("go")

    def reported(self) -> Iterator[list[str]]:
        """What it reports until it ends; a report that was cut is none."""
        try:
            while True:
                yield self._ear.recv()
        except (EOFError, OSError):
            self.process.join()


@pytest.fixture(scope="module")
def begin() -> Callable[..., Writer]:
    """Begin a process, forked from one that has loaded everything: loading takes a second."""
    context = multiprocessing.get_context("forkserver")
    own = (Archive.__module__, adding.__name__, entry_document.__module__, json_bytes.__module__)
    context.set_forkserver_preload(["pytest", "sqlalchemy.dialects.sqlite", "psycopg", *own])
    return lambda *words: Writer(context, *words)


def test_what_was_reported_is_kept_whenever_a_process_is_killed(place, lines, begin):
    """Killed six times at random moments; the archive is open for the next at once."""
    rng = np.random.default_rng(8)
    reported = set()
    for _ in range(6):
        writer = begin(place, lines)
        writer.let_go()
        # The first words are those after the tables were made.
        heard = writer.reported()
        reported |= set(next(heard, []))
        time.sleep(float(rng.uniform(0.0, 0.08)))
        writer.process.kill()
        for keys in heard:
            reported |= set(keys)
        assert writer.process.exitcode in (0, -signal.SIGKILL)
        with Archive(place) as archive:
            keys = archive.keys()
            found = archive.measurements()
        assert reported <= keys
        assert len(set(found["id"].tolist())) == len(found) == len(keys)
        assert len(keys) % 4 == 0
    assert reported
    writer = begin(place, lines)
    writer.let_go()
    assert len(list(writer.reported())) == COUNT // 4
    with Archive(place) as archive:
        assert len(archive.keys()) == COUNT == len(archive.measurements().records())


def test_two_processes_add_the_same(place, lines, begin):
    """From both ends; every entry is kept once, and neither fails."""
    writers = [begin(place, lines, first) for first in (0, COUNT // 2)]
    for writer in writers:
        writer.let_go()
    said = [[key for keys in writer.reported() for key in keys] for writer in writers]
    assert [writer.process.exitcode for writer in writers] == [0, 0]
    assert all(len(keys) == COUNT for keys in said)
    with Archive(place) as archive:
        found = archive.measurements()
        assert len(found) == COUNT == len(archive.keys())
        assert len(found.records()) == COUNT
