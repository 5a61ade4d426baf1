"""Places where no archive can be, and what happens to one under the hands of those who use it."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
import sys
import threading
import time

import pytest
from sqlalchemy import create_engine, text

from acutance.archive import Archive
from acutance.errors import ArchiveError, OptionError


@pytest.fixture
def short_patience(monkeypatch):
    monkeypatch.setattr("acutance.archive.connection.PATIENCE_S", 0.5)


def test_a_database_of_another_program_is_left_alone(tmp_path):
    path = tmp_path / "other.db"
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE images (a)")
    other.close()
    before = path.read_bytes()
    with pytest.raises(ArchiveError, match=r"another program \(images\)"):
        Archive(path)
    assert path.read_bytes() == before


def test_a_server_may_hold_tables_of_others_but_not_of_our_names(postgres_url):
    engine = create_engine(postgres_url)
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE spatial_ref_sys (a integer)"))
    Archive(postgres_url).close()
    with engine.begin() as connection:
        connection.execute(text("DROP TABLE acutance_archive"))
    engine.dispose()
    with pytest.raises(ArchiveError, match="tables of another program"):
        Archive(postgres_url)


def test_a_newer_archive_is_refused(place):
    with Archive(place) as archive:
        archive._database.write(
            lambda connection: connection.execute(
                text("UPDATE acutance_archive SET schema_version = 99")
            )
        )
    with pytest.raises(ArchiveError, match=r"newer version .*version 99"):
        Archive(place)


@pytest.mark.parametrize("content", [b"GIF89a, no database at all" * 50, b"\0" * 5000])
def test_what_is_no_database_is_refused(tmp_path, content):
    path = tmp_path / "image.gif"
    path.write_bytes(content)
    with pytest.raises(ArchiveError, match="not a database"):
        Archive(path)
    assert path.read_bytes() == content


def test_places_where_there_can_be_no_archive(tmp_path):
    with pytest.raises(ArchiveError, match="no folder"):
        Archive(tmp_path / "none" / "kept.db")
    with pytest.raises(ArchiveError, match="is a folder"):
        Archive(tmp_path)
    with pytest.raises(ArchiveError, match="is not there"):
        Archive(tmp_path / "kept.db", read_only=True)
    for url in ("mysql://user@host/a", "sqlite://", "postgresql+asyncpg://host/a", "no url://"):
        with pytest.raises(ArchiveError):
            Archive(url)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("place", [None, 3, {"path": "kept.db"}])
def test_what_is_no_place_is_refused(place):
    with pytest.raises(ArchiveError, match=f"archive {place} names no file: give the path"):
        Archive(place)


def test_a_password_is_not_told(short_patience):
    with pytest.raises(ArchiveError) as found:
        Archive("postgresql://user:secret@127.0.0.1:1/a")
    assert "secret" not in str(found.value)
    assert "cannot be reached for 0.5 s" in str(found.value)


def test_an_empty_file_is_no_archive(tmp_path):
    """It may be an image that was never written."""
    path = tmp_path / "image.tif"
    path.touch()
    os.utime(path, (1, 1))
    for read_only in (True, False):
        with pytest.raises(ArchiveError, match="is no archive: the file is empty"):
            Archive(path, read_only=read_only)
    assert path.stat().st_size == 0


def test_an_empty_file_that_another_process_makes_is_waited_for(tmp_path, edge_record):
    path = tmp_path / "kept.db"
    with Archive(tmp_path / "made.db") as archive:
        archive.add(edge_record)
    path.touch()
    threading.Timer(0.5, (tmp_path / "made.db").rename, [path]).start()
    with Archive(path) as archive:
        assert len(archive.measurements()) == 1


def test_names_with_signs(tmp_path, edge_record):
    path = tmp_path / "a name?with #signs%20.db"
    with Archive(path) as archive:
        assert archive.add(edge_record).new
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    with Archive(f"sqlite:///{tmp_path}/plain.db") as archive:
        assert archive.place == f"{tmp_path}/plain.db"


def test_an_archive_opened_to_be_read_is_not_written(place, edge_record):
    with Archive(place) as archive:
        archive.add(edge_record, sensor="K3")
    with Archive(place, read_only=True) as archive:
        assert len(archive.measurements()) == 1
        with pytest.raises(ArchiveError, match="opened to be read"):
            archive.add(edge_record, sensor="QB02")


def test_a_file_that_may_only_be_read(tmp_path, edge_record):
    """By reading it is an archive, by writing a clear error."""
    path = tmp_path / "kept.db"
    with Archive(path) as archive:
        archive.add(edge_record, sensor="K3")
    program = f"""
from acutance.archive import Archive
from acutance.errors import ArchiveError
with Archive({str(path)!r}, read_only=True) as archive:
    found = archive.measurements()
    print(len(found), found["sensor"][0])
    record = found.record(0)
try:
    Archive({str(path)!r}).add(record, sensor="QB02")
except ArchiveError as error:
    print(error)
"""
    words = [sys.executable, "-c", program]
    if os.geteuid() == 0:
        if shutil.which("setpriv") is None:
            pytest.skip("root may write everything, and setpriv is not installed")
        words = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", *words]
    path.chmod(0o444)
    tmp_path.chmod(0o555)
    done = subprocess.run(words, capture_output=True, text=True)
    tmp_path.chmod(0o755)
    assert done.stdout.startswith("1 K3\n"), done.stderr
    assert "read-only" in done.stdout or "right to read and write" in done.stdout


def test_a_full_disk_keeps_what_was_there(tmp_path, entry_of):
    """SQLite's own limit on pages fails as a full disk does."""
    with Archive(tmp_path / "kept.db") as archive:
        assert archive.add_entries([entry_of(0)]) == 1
        limited = []

        def limit(connection):
            pages = connection.exec_driver_sql("PRAGMA page_count").scalar_one()
            connection.exec_driver_sql(f"PRAGMA max_page_count = {pages + 4}")
            limited.append(pages)

        archive._database.read(limit)
        with pytest.raises(ArchiveError, match="the disk is full: nothing of this step was kept"):
            archive.add_entries(entry_of(i) for i in range(20))
        assert len(archive.measurements()) == 1
    with Archive(tmp_path / "kept.db") as archive:
        assert archive.add_entries(entry_of(i) for i in range(20)) == 19


def test_a_file_in_use_is_waited_for_then_refused(tmp_path, entry_of, short_patience):
    path = tmp_path / "kept.db"
    with Archive(path) as archive:
        other = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        other.execute("BEGIN IMMEDIATE")
        assert len(archive.measurements()) == 0
        with pytest.raises(ArchiveError, match="in use by another program"):
            archive.add_entries([entry_of(0)])
        released = threading.Timer(0.2, lambda: other.execute("COMMIT"))
        released.start()
        assert archive.add_entries([entry_of(0)]) == 1
        released.join()
        other.close()


def test_psycopg_is_asked_for(monkeypatch):
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(ArchiveError, match=r"acutance\[postgres\]"):
        Archive("postgresql://user@host/a")


def test_a_server_that_refuses_is_not_waited_for(postgres_server):
    begun = time.monotonic()
    with pytest.raises(ArchiveError, match="create the database first"):
        Archive(postgres_server.url("none"))
    assert time.monotonic() - begun < 10


def test_a_server_that_stops_and_starts_again(postgres_server, postgres_url, entry_of, monkeypatch):
    """While it is down: a wait, then a clear error. Once it is up: as if nothing had been."""
    with Archive(postgres_url) as archive:
        archive.add_entries([entry_of(0)])
        postgres_server.stop()
        monkeypatch.setattr("acutance.archive.connection.PATIENCE_S", 0.5)
        with pytest.raises(ArchiveError, match=r"cannot be reached .* start the server"):
            archive.add_entries([entry_of(1)])
        monkeypatch.setattr("acutance.archive.connection.PATIENCE_S", 30.0)
        again = threading.Timer(0.5, postgres_server.start)
        again.start()
        assert archive.add_entries([entry_of(i) for i in range(3)]) == 2
        again.join()
        assert len(archive.measurements()) == 3


def test_texts_no_database_can_hold(archive, entry_of):
    """Of whatever an entry holds: a clear error, and the archive goes on."""
    for text_of in ("\ud800", "a\0b"):
        try:
            archive.add_entries([entry_of(0, band=text_of)])
        except (ArchiveError, OptionError):
            continue
        assert archive.measurements()["band"][-1] == text_of
    assert archive.add_entries([entry_of(1)]) == 1


def test_values_beyond_reason(archive, entry_of, edge_record):
    import acutance as ac

    number = {"value": 1e308, "std": float("inf"), "interval95": None}
    record = ac.Record({**edge_record.document, "rer": number, "snr": None})
    archive.add_entries([entry_of(0, record=record)])
    found = archive.measurements()
    assert found["rer"][0] == 1e308
    assert found["rer_std"][0] != found["rer_std"][0]
    assert found["snr"][0] != found["snr"][0]
    assert len(archive.measurements(limits={"rer": (1e307, None)})) == 1
