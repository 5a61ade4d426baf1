"""However a batch ends, what was reported as kept is kept, and the next one goes on."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading

import pytest
from surveyed_field import survey, written

import acutance as ac
from acutance.archive import Archive

IMAGES = 4


@pytest.fixture
def words(write_field, tmp_path):
    """The command line of a batch of four images."""
    images = [str(write_field(number)) for number in range(IMAGES)]
    targets = written(tmp_path / "targets.geojson", survey())
    return [
        sys.executable, "-m", "acutance", "batch", *images, "--targets", str(targets),
        "--log", str(tmp_path / "log.jsonl"), "--json", "--archive",
    ]  # fmt: skip


def reported(tmp_path):
    """Keys that were reported as kept, whole lines only."""
    text = (tmp_path / "log.jsonl").read_text() if (tmp_path / "log.jsonl").exists() else ""
    return [json.loads(line)["key"] for line in text.splitlines(keepends=True) if line[-1] == "\n"]


def wait_for_lines(tmp_path, running, count):
    """Wait until so many rows were reported, or the process has ended."""
    while running.poll() is None and len(reported(tmp_path)) < count:
        threading.Event().wait(0.02)


@pytest.mark.parametrize(
    ("how", "workers"), [(signal.SIGKILL, "2"), (signal.SIGINT, "2"), (signal.SIGINT, "1")]
)
def test_a_batch_that_is_ended_goes_on(acutance, words, tmp_path, how, workers):
    kept = str(tmp_path / "kept.db")
    running = subprocess.Popen(
        [*words, kept, "--workers", workers], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    wait_for_lines(tmp_path, running, 3)
    os.kill(running.pid, how)
    _, said = running.communicate()
    if how == signal.SIGINT:
        assert running.returncode in (130, 0)
        assert running.returncode == 0 or b"the same command goes on" in said
    before = set(reported(tmp_path))
    assert before
    with Archive(kept) as archive:
        assert before <= archive.keys()
        there = archive.keys()
    # The loops of this process are loaded: another would take seconds to be ready.
    done = acutance(*words[3:], kept, "--workers", "1")
    assert done.exit_code == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["done_before"], found["kept"]) == (len(there), 2 * IMAGES - len(there))
    with Archive(kept) as archive:
        # What was kept at the very moment may be without its line.
        assert archive.keys() - set(reported(tmp_path)) <= there - before
        assert len(archive.measurements()) == 2 * IMAGES


def test_two_batches_at_once_keep_nothing_twice(words, tmp_path):
    kept = str(tmp_path / "kept.db")
    both = [
        subprocess.Popen([*words, kept, "--workers", "1"], stdout=subprocess.PIPE) for _ in range(2)
    ]
    found = [json.loads(one.communicate()[0]) for one in both]
    assert [one.returncode for one in both] == [0, 0]
    assert sum(one["kept"] for one in found) == 2 * IMAGES
    assert all(one["measured"] == 2 * IMAGES for one in found)
    with Archive(kept) as archive:
        assert len(archive.keys()) == len(archive.measurements()) == 2 * IMAGES


@pytest.mark.parametrize("errors", [1, 2])
def test_an_interrupt_inside_a_compiled_loop_rejects_nothing(
    write_field, run, rows, monkeypatch, errors
):
    """The interpreter finds a result beside the interrupt, and says SystemError, once or twice."""
    images = [write_field(number) for number in range(2)]

    def interrupted(*_):
        error = KeyboardInterrupt()
        for _ in range(errors):
            outer = SystemError("a function returned a result with an error set")
            outer.__cause__ = error
            error = outer
        raise error

    monkeypatch.setattr("acutance.batch.measure_target.measure_target", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(*images)
    monkeypatch.undo()
    assert run(*images).measured == 4
    _, rejected = rows()
    assert len(rejected) == 0


def test_an_error_of_the_archive_ends_the_run_and_the_next_goes_on(write_field, run, monkeypatch):
    images = [write_field(number) for number in range(3)]
    whole = Archive.add_entries
    calls = []

    def fail_once(self, entries, **how):
        calls.append(entries)
        if len(calls) == 2:
            raise ac.ArchiveError("the disk is full")
        return whole(self, entries, **how)

    monkeypatch.setattr(Archive, "add_entries", fail_once)
    with pytest.raises(ac.ArchiveError, match="the disk is full"):
        run(*images)
    found = run(*images)
    assert (found.done_before, found.kept) == (2, 4)


def test_a_server_that_stops_and_starts_again(write_field, postgres_server, postgres_url):
    images = [str(write_field(number)) for number in range(IMAGES)]
    stopped = threading.Event()

    def stop_and_start(_):
        if not stopped.is_set():
            stopped.set()
            postgres_server.stop()
            threading.Timer(1.0, postgres_server.start).start()

    found = ac.run_batch(
        images=images, targets=survey(), archive=postgres_url, workers=1, kept=stop_and_start
    )
    assert stopped.is_set()
    assert (found.kept, found.measured) == (2 * IMAGES, 2 * IMAGES)
    with Archive(postgres_url) as archive:
        assert len(archive.keys()) == 2 * IMAGES
