"""Rows of an archive that another batch finds there: what outlives its reason, what stays."""

from __future__ import annotations

import pytest

from acutance.archive import Archive


@pytest.fixture
def overview(tmp_path):
    """Counts of the archive."""

    def read():
        with Archive(tmp_path / "kept.db", read_only=True) as archive:
            return archive.overview()

    return read


def test_an_image_that_arrives_late_is_missing_no_longer(write_field, run, rows, overview):
    there, late = write_field(0), write_field(1)
    pixels = late.read_bytes()
    late.unlink()
    assert run(there, late).reasons == {"no such file": 1}
    assert (overview().images, overview().rejected) == (2, 1)
    late.write_bytes(pixels)
    assert run(there, late).kept == 2
    assert len(rows()[1]) == 0
    assert (overview().images, overview().rejected) == (2, 0)
    # What is measured stays when the file goes, and is there when it comes back.
    late.unlink()
    assert run(late).missing == (str(late),)
    late.write_bytes(pixels)
    found = run(late)
    assert (found.kept, found.done_before) == (0, 2)
    assert (len(rows()[0]), len(rows()[1])) == (4, 0)


def test_a_file_that_arrives_and_is_no_image_has_the_row_of_its_content(run, rows, tmp_path):
    run(tmp_path / "late.tif")
    (tmp_path / "late.tif").write_text("no image")
    assert run(tmp_path / "late.tif").reasons == {"unreadable image": 1}
    assert [one["why"] for one in rows()[1]["values"]] == ["unreadable image"]
