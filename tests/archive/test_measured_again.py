"""Targets that several runs measured in the same image."""

from __future__ import annotations

from typing import Any

import pytest

from acutance.archive import Archive


@pytest.fixture
def twice(archive: Archive, entry_of: Any) -> Archive:
    """Two targets in each of two images, by run 1; one of the four by run 2 with other options."""
    runs = [archive.start_run({}), archive.start_run({})]
    archive.add_entries([entry_of(i) for i in range(4)], run=runs[0])
    archive.add_entries([entry_of(2, key="again")], run=runs[1])
    return archive


def test_a_table_says_that_a_target_was_measured_again(twice: Archive) -> None:
    (note,) = (one for one in twice.table(("target",), ("rer",)).notes if "runs" in one)
    assert note.startswith("1 target of single images was measured more than once")
    assert "(runs 1, 2)" in note
    assert "and counts each time" in note


def test_a_table_of_one_run_does_not(twice: Archive) -> None:
    for number in (1, 2):
        notes = twice.table(("target",), ("rer",), run=number).notes
        assert not any("runs" in one for one in notes)


def test_what_no_run_wrote_is_no_other_run(archive: Archive, entry_of: Any) -> None:
    archive.add_entries([entry_of(0), entry_of(0, key="again")])
    assert not any("runs" in one for one in archive.table(("target",), ("rer",)).notes)
