"""Runs go with what they wrote: out of one archive and into another."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from acutance.archive import Archive, RunEntry
from acutance.errors import OptionError

NAMES = {"jsonl": "out.jsonl", "parquet": "out.parquet", "csv-documents": "out.csv", "stac": "out"}
PLAN = {"images": ["ä/*.tif"], "targets": {"features": [1, None, 2.5]}, "bands": None}
SUMMARY = {"kept": 4, "finished": True}


@pytest.fixture
def written(archive, entry_of):
    """Four entries of a run that ended, two of one that did not, one of none."""
    first = archive.start_run(PLAN)
    archive.add_entries([entry_of(at) for at in range(4)], run=first)
    archive.end_run(first, SUMMARY)
    second = archive.start_run({"images": ["b.tif"]})
    archive.add_entries([entry_of(at) for at in (4, 5)], run=second)
    archive.add_entries([entry_of(6)])
    return archive


def runs_of(archive):
    return {entry.key: entry.run for entry in archive.entries()}


@pytest.mark.parametrize("to", NAMES)
def test_runs_come_back(written, tmp_path, to):
    out = tmp_path / NAMES[to]
    assert written.export(out, to=to) == 7
    with Archive(tmp_path / "other.db") as other:
        assert other.import_documents(out).new == 7
        assert runs_of(other) == runs_of(written)
        assert other.overview().runs == 2
        run = next(iter(other.entries(image="0.tif"))).run
        assert (run.plan, run.summary) == (PLAN, SUMMARY)
        assert run.ended >= run.started
        assert len(set(other.measurements()["run"][:4].tolist())) == 1
        assert other.import_documents(out).new == 0
        assert other.overview().runs == 2


def test_a_plan_is_written_once(written, tmp_path):
    out = tmp_path / "out.jsonl"
    written.export(out, to="jsonl")
    runs = [json.loads(line)["run"] for line in out.read_text(encoding="utf-8").splitlines()]
    assert [bool(run and run["plan"]) for run in runs] == [
        True, False, False, False, True, False, False,
    ]  # fmt: skip
    assert runs[1]["uid"] == runs[0]["uid"]


def test_a_part_of_a_file_names_its_run_and_the_rest_completes_it(written, tmp_path):
    out = tmp_path / "out.jsonl"
    written.export(out, to="jsonl")
    lines = out.read_text(encoding="utf-8").splitlines(keepends=True)
    (tmp_path / "end.jsonl").write_text("".join(lines[2:]), encoding="utf-8")
    with Archive(tmp_path / "other.db") as other:
        other.import_documents(tmp_path / "end.jsonl")
        partial = runs_of(other)
        uids = {run.uid for run in runs_of(written).values() if run is not None}
        assert {run.uid for run in partial.values() if run is not None} == uids
        other.import_documents(out)
        assert runs_of(other) == runs_of(written)


def test_an_entry_that_is_there_still_tells_the_run_of_the_next(written, tmp_path, entry_of):
    out = tmp_path / "out.jsonl"
    written.export(out, to="jsonl")
    with Archive(tmp_path / "other.db") as other:
        other.add_entries([entry_of(0)])
        assert other.import_documents(out).new == 6
        assert [run.plan for run in runs_of(other).values() if run].count(PLAN) == 3


def test_a_run_that_went_on_is_completed(archive, entry_of):
    begun = RunEntry(uid="u", started=datetime(2026, 1, 1, tzinfo=UTC), software="1", plan={"a": 1})
    archive.add_entries([replace(entry_of(0), run=begun)])
    ended = replace(begun, ended=datetime(2026, 1, 2, tzinfo=UTC), summary={"kept": 2})
    archive.add_entries([replace(entry_of(1), run=ended)])
    archive.add_entries([replace(entry_of(2), run=begun.named_only)])
    assert [entry.run for entry in archive.entries()] == [ended] * 3


@pytest.mark.parametrize("to", NAMES)
def test_a_run_without_a_plan_keeps_its_end_and_summary(archive, entry_of, tmp_path, to):
    run = archive.start_run({})
    for at, key in ((1, "9"), (0, "1")):
        archive.add_entries([entry_of(at, key=key)], run=run)
    archive.end_run(run, SUMMARY)
    out = tmp_path / NAMES[to]
    archive.export(out, to=to)
    with Archive(tmp_path / "other.db") as other:
        other.import_documents(out)
        assert runs_of(other) == runs_of(archive)
        assert {run.summary["kept"] for run in runs_of(other).values()} == {SUMMARY["kept"]}


def test_a_run_that_was_exported_while_it_ran_is_completed(archive, entry_of, tmp_path):
    out, run = tmp_path / "out.jsonl", archive.start_run(PLAN)
    archive.add_entries([entry_of(at) for at in range(4)], run=run)
    archive.export(out, to="jsonl")
    with Archive(tmp_path / "other.db") as other:
        other.import_documents(out)
        archive.end_run(run, SUMMARY)
        archive.export(out, to="jsonl")
        assert other.import_documents(out).new == 0
        assert runs_of(other) == runs_of(archive)


def test_entries_that_are_there_bring_no_run_of_their_own(archive, entry_of, tmp_path):
    out = tmp_path / "out.jsonl"
    archive.add_entries([entry_of(0)], run=archive.start_run(PLAN))
    archive.export(out, to="jsonl")
    with Archive(tmp_path / "other.db") as other:
        other.add_entries([entry_of(0)])
        other.import_documents(out)
        assert other.overview().runs == 0


@pytest.mark.parametrize(
    ("changed", "message"),
    [({"uid": None}, "has no uid"), ({"uid": 5}, "uid is 5, a int: give a text"),
     ({"started": "2026"}, "started is '2026', a str: give a datetime"),
     ({"ended": "2026"}, "ended is"), ({"plan": None}, "plan is None"), ({"summary": 1}, "summary"),
     ({"software": None}, "software is None")],
)  # fmt: skip
def test_a_run_that_cannot_be_is_refused(changed, message):
    values = {"uid": "u", "started": datetime(2026, 1, 1, tzinfo=UTC), "software": "1"}
    with pytest.raises(OptionError, match=message):
        RunEntry(**values | changed)


@pytest.fixture
def in_seoul():
    """A machine whose zone is not UTC."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TZ", "Asia/Seoul")
        time.tzset()
        yield
    time.tzset()


def test_moments_of_runs_without_a_zone_are_utc(in_seoul, archive, entry_of):
    run = RunEntry(uid="u", started=datetime(2026, 1, 1, 5), software="1")
    archive.add_entries([replace(entry_of(0), run=run)])
    assert next(archive.entries()).run.started == datetime(2026, 1, 1, 5, tzinfo=UTC)


def test_the_run_of_an_import_goes_before(written, tmp_path):
    out = tmp_path / "out.jsonl"
    written.export(out, to="jsonl")
    with Archive(tmp_path / "other.db") as other:
        number = other.start_run({"why": "moved"})
        other.import_documents(out, run=number)
        assert set(other.measurements()["run"].tolist()) == {number}
        assert other.overview().runs == 1


def test_an_older_export_has_no_run(written, tmp_path):
    out = tmp_path / "out.jsonl"
    written.export(out, to="jsonl")
    documents = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    for document in documents:
        del document["run"]
    out.write_text("\n".join(map(json.dumps, documents)), encoding="utf-8")
    with Archive(tmp_path / "other.db") as other:
        assert other.import_documents(out).new == 7
        assert set(runs_of(other).values()) == {None}
