"""Archives of older versions are brought forward, whole or not at all."""

from __future__ import annotations

import pytest
from sqlalchemy import inspect, text

from acutance.archive import Archive
from acutance.archive import migrations as steps
from acutance.archive.tables import SCHEMA_VERSION, systematic_columns
from acutance.errors import ArchiveError


def make_first_version(place, entries):
    """An archive as version 1 had it: nothing of what does not average out."""
    with Archive(place) as archive:
        archive.add_entries(entries)

        def undo(connection):
            for name in systematic_columns():
                connection.execute(text(f"ALTER TABLE directions DROP COLUMN {name}"))
            connection.execute(text("UPDATE acutance_archive SET schema_version = 1"))

        archive._database.write(undo)


def columns_of(archive):
    return archive._database.read(
        lambda connection: {one["name"] for one in inspect(connection).get_columns("directions")}
    )


def test_the_first_version_is_brought_forward(place, entry_of, monkeypatch):
    monkeypatch.setattr(steps, "_SOME", 2)
    entries = [entry_of(i) for i in range(5)]
    make_first_version(place, entries)
    with pytest.raises(ArchiveError, match="open it once to be written"):
        Archive(place, read_only=True)
    with Archive(place) as archive:
        assert archive.overview().schema_version == SCHEMA_VERSION
        assert set(systematic_columns()) <= columns_of(archive)
        found = archive.measurements()
        budget = [
            term
            for term in entries[0].record.budget
            if term.name in ("prior_shape", "target_softness", "level_uncertainty")
        ]
        expected = sum(term.std["rer"] ** 2 for term in budget) ** 0.5
        assert expected > 0
        assert found["rer_systematic_std"] == pytest.approx([expected] * 5)
        assert archive.add_entries([*entries, entry_of(7)]) == 1
    with Archive(place, read_only=True) as archive:
        assert len(archive.measurements()) == 6


def test_a_step_that_fails_leaves_the_older_version(place, entry_of, monkeypatch):
    make_first_version(place, [entry_of(0)])

    def broken(connection):
        connection.execute(text("ALTER TABLE directions ADD COLUMN half_done INTEGER"))
        raise ArchiveError("the power went off")

    monkeypatch.setattr(steps, "STEPS", {1: broken})
    with pytest.raises(ArchiveError, match="power"):
        Archive(place)
    monkeypatch.undo()
    with Archive(place) as archive:
        assert "half_done" not in columns_of(archive)
        assert len(archive.measurements()) == 1


def test_steps_follow_one_another(place, monkeypatch):
    done = []
    Archive(place).close()
    monkeypatch.setattr(steps, "SCHEMA_VERSION", SCHEMA_VERSION + 2)
    following = {SCHEMA_VERSION + i: lambda _, i=i: done.append(i) for i in range(2)}
    monkeypatch.setattr(steps, "STEPS", following)
    Archive(place).close()
    Archive(place).close()
    assert done == [0, 1]


def test_every_version_has_a_step():
    assert set(steps.STEPS) == set(range(1, SCHEMA_VERSION))
