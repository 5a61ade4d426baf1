"""A damaged document is named by its row, and ends nothing that goes on without it."""

import pytest

from acutance.archive import Archive
from acutance.archive.tables import documents
from acutance.errors import ArchiveError


@pytest.fixture(params=[b"\x00\x11\x22\x33", b"", b"x\x9c\xb3\xcc\x03\x00\x00\xa0\x00o"])
def damaged(request, archive, entry_of):
    """An archive of four entries; the document of the third is damaged."""
    archive.add_entries(entry_of(i) for i in range(4))
    (number,) = [
        number for number in archive.measurements()["id"].tolist()
        if archive.entry(number).record.document["mtf_nyquist"]["value"] == pytest.approx(0.102)
    ]  # fmt: skip
    wrong = documents.update().where(documents.c.measurement_id == number)
    archive._database.write(lambda one: one.execute(wrong.values(document=request.param)))
    return archive, number


def test_the_row_is_named(damaged):
    archive, number = damaged
    words = f"the document of measurement {number} is damaged"
    rows = archive.measurements()
    assert len(rows) == 4
    for reading in (lambda: archive.entry(number), rows.records, archive.combine):
        with pytest.raises(ArchiveError, match=words):
            reading()


@pytest.mark.parametrize("to", ["jsonl", "stac", "csv"])
def test_exports_go_on(damaged, tmp_path, to):
    archive, number = damaged
    with pytest.warns(UserWarning, match=f"left out: the document of measurement {number} is"):
        assert archive.export(tmp_path / "out", to=to) == 3
    with pytest.warns(UserWarning, match="left out"):
        assert len(list(archive.entries())) == 3


def test_the_command_says_it_in_a_line(edge_record, tmp_path, capsys):
    from acutance.cli.app import app

    with Archive(tmp_path / "x.db") as archive:
        number = archive.add(edge_record, sensor="S").id
        wrong = documents.update().values(document=b"\x00")
        archive._database.write(lambda one: one.execute(wrong))
    for command, words in (
        (["show", str(tmp_path / "x.db"), str(number)], "acutance: the document of measurement"),
        (["export", str(tmp_path / "x.db"), str(tmp_path / "o.jsonl"), "--to", "jsonl"],
         f"acutance: left out: the document of measurement {number} is damaged"),
    ):  # fmt: skip
        with pytest.raises(SystemExit):
            app(["archive", *command])
        assert words in capsys.readouterr().err
