"""Names of files: the same in many folders, no UTF-8, links to what is not there."""

from __future__ import annotations

import hashlib
import os

import numpy as np
import pytest

from acutance.archive import Archive, Entry, ImageEntry
from acutance.errors import OptionError
from acutance.targets.target_result import Rejected


@pytest.fixture
def folders(tmp_path):
    """Two folders to stand in."""
    found = tmp_path / "a", tmp_path / "b"
    for one in found:
        one.mkdir()
    return found


def test_missing_files_of_two_folders_are_two_rows(
    folders, write_field, run, rows, monkeypatch, tmp_path
):
    for folder in folders:
        monkeypatch.chdir(folder)
        assert run("x.tif").missing == ("x.tif",)
        assert run("x.tif").kept == 0
    assert len(rows()[1]) == 2
    with Archive(tmp_path / "kept.db") as archive:
        paths = {entry.image.path for entry in archive.entries()}
    assert paths == {str(one / "x.tif") for one in folders}
    # One arrives: the other is still missing.
    write_field(0).rename(folders[1] / "x.tif")
    assert run("x.tif").measured
    with Archive(tmp_path / "kept.db") as archive:
        missing = [one.image.path for one in archive.entries() if one.rejected is not None]
    assert missing == [str(folders[0] / "x.tif")]


@pytest.mark.parametrize("arrives", [False, True])
def test_rows_of_missing_files_that_version_0_1_kept_are_replaced(
    folders, write_field, run, monkeypatch, tmp_path, arrives
):
    monkeypatch.chdir(folders[0])
    older = hashlib.sha256(b"unreadable/x.tif").hexdigest()
    rejected = Rejected("image", "does not exist", {"why": "no such file", "path": "x.tif"})
    with Archive(tmp_path / "kept.db") as archive:
        archive.add_entries([Entry(rejected=rejected, image=ImageEntry(path="x.tif"), key=older)])
    if arrives:
        write_field(0).rename("x.tif")
    run("x.tif")
    with Archive(tmp_path / "kept.db") as archive:
        paths = [one.image.path for one in archive.entries() if one.rejected is not None]
    assert paths == ([] if arrives else [str(folders[0] / "x.tif")])


def test_a_folder_that_is_called_an_image_is_one_row(write_field, run, rows, tmp_path):
    good, folder = write_field(0), tmp_path / "x.tif"
    folder.mkdir()
    # As a shell writes images/*.tif.
    found = run(good, folder)
    assert found.unreadable == (str(folder),)
    assert found.verdicts == run(good, targets=None).verdicts
    (reason,) = rows()[1]["reason"]
    assert "x.tif cannot be read" in reason
    assert reason.endswith("it is a directory; give the image file inside it")
    with pytest.raises(
        OptionError, match=r"no images but folders: .*x\.tif: write .*x\.tif/\*\.tif"
    ):
        run(folder)


def test_a_name_that_is_no_utf8_is_one_row(write_field, run, rows, tmp_path):
    good, other = write_field(0), write_field(1)
    strange = os.fsdecode(os.fsencode(tmp_path) + b"/field-\xe9.tif")
    try:
        other.rename(strange)
    except OSError:
        pytest.skip("the disk takes no such name")
    found = run(tmp_path / "*.tif")
    assert found.images == 2
    assert found.unreadable == (strange,)
    assert found.verdicts == run(good, targets=None).verdicts
    (reason,), (name,) = (rows()[1][column] for column in ("reason", "image"))
    assert name == "field-%E9.tif"
    assert reason.endswith("is no UTF-8: rename the file")
    assert run(strange).unreadable == (strange,)
    os.rename(strange, tmp_path / "gone.tif")
    assert run(strange).missing == (strange,)


def test_an_array_whose_name_is_no_utf8_is_one_row(write_field, run, rows, tmp_path):
    """It ended the whole batch: no JSON takes such a name."""
    good = write_field(0)
    strange = os.fsdecode(os.fsencode(tmp_path) + b"/field-\xe9.npy")
    try:
        with open(strange, "wb") as file:
            np.save(file, np.ones((40, 40)))
    except OSError:
        pytest.skip("the disk takes no such name")
    found = run(good, strange)
    assert (found.measured, found.unreadable) == (2, (strange,))
    (reason,) = rows()[1]["reason"]
    assert reason.endswith("is no UTF-8: rename the file")


def test_a_link_that_leads_nowhere_is_a_missing_file(write_field, run, rows, tmp_path):
    write_field(0)
    broken = tmp_path / "field-x.tif"
    broken.symlink_to("nowhere.tif")
    found = run(tmp_path / "*.tif")
    assert (found.images, found.missing) == (2, (str(broken),))
    assert run(broken).missing == (str(broken),)
    assert "is a link to nowhere.tif" in rows()[1]["reason"][0]
