"""Exports touch nothing that is not theirs."""

import os

import pytest

from acutance.archive import Archive
from acutance.errors import OptionError


@pytest.fixture
def kept(tmp_path, entry_of):
    """An archive in a file, of four entries."""
    with Archive(tmp_path / "kept.db") as archive:
        archive.add_entries(entry_of(i) for i in range(4))
        yield archive


@pytest.mark.parametrize(("to", "neighbour"), [("stac", "out-part"), ("jsonl", "out.part")])
def test_neighbours_of_like_names_stay(kept, tmp_path, to, neighbour):
    own = tmp_path / neighbour
    if to == "stac":
        own.mkdir()
        own /= "mine.txt"
    own.write_text("precious")
    before = sorted(tmp_path.iterdir())
    assert kept.export(tmp_path / "out", to=to) == 4
    assert own.read_text() == "precious"
    assert sorted(tmp_path.iterdir()) == sorted([*before, tmp_path / "out"])


@pytest.mark.parametrize("to", ["stac", "csv"])
def test_interrupted_exports_leave_nothing(kept, tmp_path, to):
    before = sorted(tmp_path.iterdir())

    def interrupt(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        kept.export(tmp_path / "out", to=to, progress=interrupt)
    assert sorted(tmp_path.iterdir()) == before


def test_the_folder_one_stands_in(kept, tmp_path, monkeypatch):
    folder = tmp_path / "empty"
    folder.mkdir()
    monkeypatch.chdir(folder)
    assert kept.export(".", to="stac") == 4
    assert "catalog.json" in os.listdir(".")
    assert len(os.listdir(folder)) == 3
    with pytest.raises(OptionError, match="new or empty"):
        kept.export(".", to="stac")


@pytest.mark.parametrize("ending", ["", "-wal", "-shm", "-journal"])
def test_an_archive_does_not_replace_itself(kept, tmp_path, ending):
    link = tmp_path / "link.csv"
    link.symlink_to(f"kept.db{ending}")
    for place in (tmp_path / f"kept.db{ending}", link):
        with pytest.raises(OptionError, match="archive itself"):
            kept.export(place, to="csv")
    assert len(kept.measurements()) == 4


def test_an_export_replaces_no_database(kept, tmp_path):
    with Archive(tmp_path / "other.db"):
        pass
    before = (tmp_path / "other.db").read_bytes()
    os.link(tmp_path / "kept.db", tmp_path / "same.db")
    for name in ("other.db", "same.db"):
        with pytest.raises(OptionError, match="is a database"):
            kept.export(tmp_path / name, to="jsonl")
    assert (tmp_path / "other.db").read_bytes() == before
    (tmp_path / "old.csv").write_text("of another day")
    assert kept.export(tmp_path / "old.csv", to="csv") == 4
