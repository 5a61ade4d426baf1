"""Trials in any number of processes, interrupted or not: always the same numbers."""

import json
import math
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from acutance import OptionError
from acutance.optics import RasterPsf
from acutance.studies import Execution, run_trials
from acutance.studies.journal import Journal, journal_key


@dataclass(frozen=True)
class Options:
    scale: float = 2.0
    diary: str = ""
    dies_at: int = -1


def draw(options, trial, rng):
    """A random number; leaves a line in the diary, and dies at one trial."""
    if options.diary:
        with open(options.diary, "a") as diary:
            diary.write(f"{trial}\n")
    if trial == int(os.environ.get("DIES_AT", "-1")):
        os.kill(os.getpid(), signal.SIGKILL)
    return {"value": options.scale * float(rng.normal()), "trial": trial, "nothing": math.nan}


def values(records):
    return [record["value"] for record in records]


TRIALS = list(range(12))


def test_processes_do_not_change_the_results():
    alone = run_trials("t", Options(), TRIALS, draw, Execution(seed=5, workers=1))
    together = run_trials("t", Options(), TRIALS, draw, Execution(seed=5, workers=2))
    other = run_trials("t", Options(), TRIALS, draw, Execution(seed=6, workers=1))
    assert values(alone) == values(together)
    assert [record["trial"] for record in alone] == TRIALS
    assert len({*values(alone), *values(other)}) == 24


def test_processes_keep_to_one_thread_and_the_environment_stays():
    before = dict(os.environ)
    found = run_trials("t", Options(), [0, 1], threads, Execution(workers=2))
    assert {record["threads"] for record in found} == {"1"}
    assert dict(os.environ) == before


def threads(options, trial, rng):
    return {"threads": os.environ["OPENBLAS_NUM_THREADS"]}


def test_progress_counts_up_to_the_end(tmp_path):
    calls = []
    how = Execution(workers=1, folder=tmp_path, progress=lambda *call: calls.append(call))
    run_trials("t", Options(), TRIALS[:3], draw, how)
    assert calls == [(0, 3), (1, 3), (2, 3), (3, 3)]
    calls.clear()
    run_trials("t", Options(), TRIALS[:3], draw, how)
    assert calls == [(3, 3)]


def test_a_killed_study_goes_on_where_it_was(tmp_path):
    """Killed without warning at the eighth trial: nothing is lost, nothing is done twice."""
    diary = tmp_path / "diary"
    options = Options(diary=str(diary))
    program = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "from pathlib import Path\n"
        "from test_trials import Options, TRIALS, draw\n"
        "from acutance.studies import Execution, run_trials\n"
        f"how = Execution(seed=5, workers=1, folder=Path({str(tmp_path)!r}))\n"
        f"run_trials('t', Options(diary={str(diary)!r}), TRIALS, draw, how)\n"
    )
    killed = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, "DIES_AT": "7"}, check=False
    )
    assert killed.returncode == -signal.SIGKILL
    assert diary.read_text().split() == [str(i) for i in range(8)]
    again = run_trials("t", options, TRIALS, draw, Execution(seed=5, workers=1, folder=tmp_path))
    assert diary.read_text().split()[8:] == [str(i) for i in range(7, 12)]
    whole = run_trials("t", Options(), TRIALS, draw, Execution(seed=5, workers=1))
    assert values(again) == values(whole)
    assert all(math.isnan(record["nothing"]) for record in again)


def test_trials_beyond_the_last_do_not_count(tmp_path):
    calls = []
    run_trials("t", Options(), TRIALS, draw, Execution(seed=5, workers=1, folder=tmp_path))
    how = Execution(seed=5, workers=1, folder=tmp_path, progress=lambda *call: calls.append(call))
    assert len(run_trials("t", Options(), TRIALS[:5], draw, how)) == 5
    assert calls == [(5, 5)]


def test_half_a_line_is_cut_off(tmp_path):
    with Journal(tmp_path, "t", "key") as journal:
        journal.append(0, {"value": 1.0})
        journal.append(1, {"value": math.nan})
        path = journal.path
    whole = path.read_bytes()
    path.write_bytes(whole + b'{"trial": 2, "val')
    with Journal(tmp_path, "t", "key") as journal:
        assert set(journal.done) == {0, 1}
        journal.append(2, {"value": 3.0})
    lines = path.read_text().splitlines()
    assert [json.loads(line)["trial"] for line in lines] == [0, 1, 2]


@pytest.mark.parametrize(
    "damage",
    [
        b"snow", b"", b"{}", b"[1]", b"7", b'{"trial": 1}', b'{"trial": null, "values": {}}',
        b'{"trial": 1, "values": 3}', b'\xff\xfe{"tri', b'{"trial": 1, "val\r{',
        b'{"trial": 1, "values": {}}', b'{"trial": 1, "values": {}, "check": "00000000"}',
        b'{"trial": 99, "values": {"value": 1.0, "trial": 99, "nothing": null}}',
    ],
)  # fmt: skip
def test_a_damaged_line_is_named_and_its_trial_run_again(tmp_path, damage):
    how = Execution(seed=5, workers=1, folder=tmp_path)
    whole = run_trials("t", Options(), TRIALS, draw, how)
    (path,) = tmp_path.glob("*.jsonl")
    lines = path.read_bytes().split(b"\n")
    lines[1] = lines[4] = damage
    path.write_bytes(b"\n".join(lines))
    with pytest.warns(UserWarning, match=r"t-.*\.trials\.jsonl, lines 2, 5: damaged") as warned:
        again = run_trials("t", Options(), TRIALS, draw, how)
    assert len(warned) == 1
    assert values(again) == values(whole)
    after = path.read_bytes().split(b"\n")
    assert after[: len(lines) - 1] == lines[:-1]
    assert [json.loads(line)["trial"] for line in after[len(lines) - 1 : -1]] == [1, 4]


@pytest.mark.parametrize(
    "other",
    [("u", Options(), 1, "0"), ("t", Options(3.0), 1, "0"), ("t", Options(), 2, "0"),
     ("t", Options(), 1, "1")],
)  # fmt: skip
def test_another_study_has_another_key(other):
    assert journal_key(*other) != journal_key("t", Options(), 1, "0")


def test_impossible_executions_are_refused(tmp_path):
    with pytest.raises(OptionError, match="there has to be a worker"):
        Execution(workers=0)
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(OptionError, match="cannot be written"):
        run_trials("t", Options(), TRIALS, draw, Execution(workers=1, folder=file))


def test_sensors_of_other_arrays_have_other_journals():
    """Of an array the repr shows its borders alone, where a PSF is 0."""

    def key(sigma_px):
        y, x = np.mgrid[-40:41, -40:41] * 0.1
        light = np.where(np.hypot(x, y) < 3.5, np.exp(-0.5 * (x**2 + y**2) / sigma_px**2), 0)
        return journal_key("t", RasterPsf(light / light.sum(), 0.1), 1, "0")

    assert key(0.4) != key(0.7)
    assert key(0.4) != key(0.4 * (1 + 1e-12))
