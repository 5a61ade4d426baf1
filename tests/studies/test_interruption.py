"""Ctrl-C, at any time and with any number of processes: one line, and nothing finished is lost."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from acutance.studies import Execution, run_trials

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals to a group of processes")

TOTAL = 200
PROGRAM = """
import sys
sys.path.insert(0, {tests!r})
from pathlib import Path
from test_interruption import TOTAL, dawdle
from acutance.studies import Execution, run_trials
how = Execution(seed=5, workers={workers}, folder=Path({folder!r}))
try:
    run_trials("t", {folder!r}, range(TOTAL), dawdle, how)
except KeyboardInterrupt as error:
    sys.exit(str(error))
"""


def dawdle(folder, trial, rng):
    """A random number, after a while; leaves a file that says it was finished."""
    time.sleep(0.1)
    Path(folder, f"finished-{trial}").touch()
    return {"value": float(rng.normal())}


def break_when(folder, workers, ready):
    """Run the program, interrupt its whole group as a terminal does once `ready`; its stderr."""
    program = PROGRAM.format(tests=str(Path(__file__).parent), workers=workers, folder=str(folder))
    running = subprocess.Popen(
        [sys.executable, "-c", program],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell that ignores interrupts in the background would have the program ignore them.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    deadline = time.monotonic() + 60
    while not ready() and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(running.pid, signal.SIGINT)
    return running.communicate(timeout=60)[1]


def kept_trials(folder):
    (journal,) = folder.glob("t-*.trials.jsonl")
    return journal, [json.loads(line)["trial"] for line in journal.read_text().splitlines()]


@pytest.mark.parametrize("workers", [1, 2])
def test_one_line_says_what_is_kept_and_all_that_was_finished_is(tmp_path, workers):
    said = break_when(tmp_path, workers, lambda: len(list(tmp_path.glob("finished-*"))) > 4)
    journal, kept = kept_trials(tmp_path)
    assert said == (
        f"interrupted: {len(kept)} of {TOTAL} trials are kept in {journal}; "
        "run the same command again to go on\n"
    )
    assert 4 <= len(kept) < TOTAL
    # In this process the trial under way is broken off, perhaps between its file and its line.
    finished = {int(path.name.split("-")[1]) for path in tmp_path.glob("finished-*")}
    assert len(finished - set(kept)) <= (1 if workers == 1 else 0)
    assert len(kept) == len(set(kept))


def test_processes_that_are_still_loading_say_nothing(tmp_path):
    said = break_when(tmp_path, 2, lambda: any(tmp_path.glob("t-*.trials.jsonl")))
    assert said.splitlines()[0].startswith("interrupted: ")
    assert len(said.splitlines()) == 1


def test_without_a_folder_there_is_nothing_to_name():
    def broken(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"^interrupted$"):
        run_trials("t", None, [0, 1], broken, Execution(workers=1))
