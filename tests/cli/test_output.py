"""Files are refused before the work, and written whole or not at all."""

import os

import pytest

from acutance.cli.output import check_output
from acutance.errors import OptionError
from acutance.raster import open_image


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


def test_a_link_stays_a_link_and_what_it_leads_to_is_written(tmp_path):
    (tmp_path / "real").mkdir()
    kept, link = tmp_path / "real" / "kept.csv", tmp_path / "a.csv"
    link.symlink_to(kept)
    for content in ("first", "second"):
        check_output("--csv", str(link), (".csv",)).write(content)
        assert link.is_symlink()
        assert kept.read_text() == content
    assert [one.name for one in (tmp_path / "real").iterdir()] == ["kept.csv"]


def test_an_image_is_written_where_a_link_leads(acutance, tmp_path):
    (tmp_path / "a.tif").symlink_to(tmp_path / "kept.tif")
    done = acutance("simulate", "edge", "--size", "20,20", "--out", tmp_path / "a.tif")
    assert done.exit_code == 0, done.stderr
    assert (tmp_path / "a.tif").is_symlink()
    assert open_image(str(tmp_path / "kept.tif")).shape == (20, 20)


def test_a_link_that_leads_nowhere_is_found_out_first(tmp_path):
    (tmp_path / "a.csv").symlink_to(tmp_path / "gone" / "a.csv")
    with pytest.raises(OptionError, match=r"a link into the folder .*gone, which does not exist"):
        check_output("--csv", str(tmp_path / "a.csv"), (".csv",))
    (tmp_path / "b.csv").symlink_to(os.devnull)
    with pytest.raises(OptionError, match="no ordinary file"):
        check_output("--csv", str(tmp_path / "b.csv"), (".csv",))


def test_a_neighbour_of_the_name_of_a_part_stays(tmp_path):
    own = tmp_path / f".a.csv.{os.getpid()}.part"
    own.write_text("precious")
    check_output("--csv", str(tmp_path / "a.csv"), (".csv",)).write("1")
    assert own.read_text() == "precious"
    assert sorted(one.name for one in tmp_path.iterdir()) == [own.name, "a.csv"]
