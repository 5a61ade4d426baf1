"""Files are refused before the work, and written whole or not at all."""

import os

import pytest

from acutance.cli.output import check_output
from acutance.errors import OptionError


def test_an_unknown_ending_is_refused_with_those_allowed(tmp_path):
    with pytest.raises(OptionError, match=r'"\.doc", it has to be \.png or \.svg'):
        check_output("--figure", str(tmp_path / "a.doc"), (".png", ".svg"))
    with pytest.raises(OptionError, match="ends in nothing"):
        check_output("--figure", str(tmp_path / "a"), (".png",))


def test_a_missing_folder_a_folder_and_the_input_are_refused(tmp_path):
    with pytest.raises(OptionError, match="does not exist, make it first"):
        check_output("--csv", str(tmp_path / "no" / "a.csv"), (".csv",))
    (tmp_path / "b.csv").mkdir()
    with pytest.raises(OptionError, match="is a folder"):
        check_output("--csv", str(tmp_path / "b.csv"), (".csv",))
    image = tmp_path / "scene.png"
    image.write_bytes(b"pixels")
    with pytest.raises(OptionError, match=r"is the input .*scene\.png, which it would"):
        check_output("--figure", str(image), (".png",), keep=(None, "10,20,30,40", str(image)))


def test_a_folder_that_may_not_be_written_to_is_found_out_first(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.write_bytes", refuse)
    with pytest.raises(OptionError, match=r"cannot be written \(Permission denied\)"):
        check_output("--csv", str(tmp_path / "a.csv"), (".csv",))


def test_a_write_that_fails_leaves_the_old_file_and_no_part(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_text("old")
    target = check_output("--csv", str(path), (".csv",))

    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(OptionError, match="No space left"):
        target.write("new")
    assert path.read_text() == "old"
    assert [one.name for one in tmp_path.iterdir()] == ["a.csv"]


def test_text_and_bytes_are_written(tmp_path):
    target = check_output("--csv", str(tmp_path / "A.CSV"), (".csv",))
    assert target.ending == ".csv"
    target.write("±")
    assert (tmp_path / "A.CSV").read_text(encoding="utf-8") == "±"
    assert [one.name for one in tmp_path.iterdir()] == ["A.CSV"]
