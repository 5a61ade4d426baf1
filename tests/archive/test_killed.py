"""Processes that are killed while they write, and several that write at once."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from acutance.archive import Archive
from acutance.archive.exchange.entry_document import entry_document
from acutance.archive.packing import json_bytes

WRITER = """
import sys
from orjson import loads
from acutance.archive import Archive, adding
from acutance.archive.exchange.entry_document import entry_of_document

adding.CHUNK = 4
place, lines, first = sys.argv[1:]
entries = [entry_of_document(loads(line)) for line in open(lines, "rb")]
entries = entries[int(first):] + entries[: int(first)]
print("ready", flush=True)
sys.stdin.readline()
with Archive(place) as archive:
    for i in range(0, len(entries), 4):
        archive.add_entries(entries[i : i + 4])
        # What is printed was reported as kept.
        print(*(entry.key for entry in entries[i : i + 4]), flush=True)
"""
COUNT = 120


@pytest.fixture
def lines(entry_of, tmp_path):
    path = tmp_path / "lines.jsonl"
    path.write_bytes(
        b"".join(json_bytes(entry_document(entry_of(i))) + b"\n" for i in range(COUNT))
    )
    return path


def begin(place, lines, first=0):
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, place, str(lines), str(first)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout.readline() == "ready\n"
    return process


def let_go(process):
    process.stdin.write("\n")
    process.stdin.flush()


def test_what_was_reported_is_kept_whenever_a_process_is_killed(place, lines):
    """Killed six times at random moments; the archive is open for the next at once."""
    rng = np.random.default_rng(8)
    reported, finished = set(), False
    for _ in range(6):
        process = begin(place, lines)
        let_go(process)
        # The first words are those after the tables were made.
        heard = process.stdout.readline()
        time.sleep(float(rng.uniform(0.0, 0.08)))
        process.send_signal(signal.SIGKILL)
        said, _ = process.communicate()
        finished |= process.returncode == 0
        # A line that was cut was not reported.
        whole = (heard + said).rpartition("\n")[0]
        reported |= set(whole.split())
        with Archive(place) as archive:
            keys = archive.keys()
            found = archive.measurements()
        assert reported <= keys
        assert len(set(found["id"].tolist())) == len(found) == len(keys)
        assert len(keys) % 4 == 0
    assert reported
    process = begin(place, lines)
    let_go(process)
    process.communicate()
    with Archive(place) as archive:
        assert len(archive.keys()) == COUNT == len(archive.measurements().records())


def test_two_processes_add_the_same(place, lines):
    """From both ends; every entry is kept once, and neither fails."""
    processes = [begin(place, lines, first) for first in (0, COUNT // 2)]
    for process in processes:
        let_go(process)
    said = [process.communicate()[0] for process in processes]
    assert [process.returncode for process in processes] == [0, 0]
    assert all(len(text.split()) == COUNT for text in said)
    with Archive(place) as archive:
        found = archive.measurements()
        assert len(found) == COUNT == len(archive.keys())
        assert len(found.records()) == COUNT
