"""Files whose content changes, and files that are cut off: both are named, each time."""

from __future__ import annotations

import re

from acutance.archive import Archive


def test_an_earlier_content_is_named_until_it_is_removed(write_field, run, tmp_path):
    changing, other = write_field(0), write_field(1)
    first = run(changing)
    assert first.earlier_contents == {}
    changing.write_bytes(other.read_bytes())
    for found in (run(changing), run(changing)):
        (before,) = found.earlier_contents[str(changing)]
        assert re.fullmatch("[0-9a-f]{64}", before)
        assert found.to_dict()["earlier_contents"] == {str(changing): [before]}
    with Archive(tmp_path / "kept.db") as archive:
        rows = len(archive.measurements())
        there = archive.remove_images([before], dry_run=True)
        assert len(archive.measurements()) == rows
        assert archive.remove_images([before]) == there > 0
        assert len(archive.measurements()) < rows
    assert run(changing).earlier_contents == {}


def test_files_that_exchange_their_names_are_no_earlier_contents(write_field, run):
    one, two = write_field(0), write_field(1)
    run(one, two)
    first, second = one.read_bytes(), two.read_bytes()
    one.write_bytes(second)
    two.write_bytes(first)
    assert run(one, two).earlier_contents == {}


def test_an_image_whose_pixels_are_cut_off_is_named_each_time(write_field, run):
    """Its header can be read: the run that measured, and the next, named none."""
    cut = write_field(0)
    whole = cut.read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    for _ in range(2):
        found = run(cut)
        assert found.reasons.get("unreadable image", 0) >= 1
        assert found.unreadable == (str(cut),)
        assert found.faults[str(cut)]


def test_nothing_is_kept_of_a_file_that_changes_while_the_batch_runs(write_field, run, rows):
    """It would be kept under the content that the file had before."""
    changing, other = write_field(0), write_field(1)
    new = other.read_bytes()

    def copy_over(done, total):
        if done == 0 and changing.read_bytes() != new:
            changing.write_bytes(new)

    found = run(changing, progress=copy_over)
    assert (found.kept, found.measured, found.unreadable) == (0, 0, (str(changing),))
    assert "changed while the batch ran" in found.faults[str(changing)]
    again = run(changing)
    assert (again.kept, again.unreadable, again.earlier_contents) == (2, (), {})
    assert len(rows()[0]) == 2
