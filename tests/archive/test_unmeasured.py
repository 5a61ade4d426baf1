"""What a specification asks for and nobody measured is no part of what is met."""

from __future__ import annotations

from typing import Any

import pytest

from acutance.archive import Archive
from acutance.archive.specification import Specification
from acutance.errors import NothingSelectedError
from acutance.targets.record import Record


def specification(*several: dict[str, Any]) -> Specification:
    """Requirements of RER that any edge of these tests meets."""
    return Specification.of(
        {"requirement": [{"metric": "rer", "minimum": 0.01, **one} for one in several]}
    )


def along(entry_of: Any, i: int, **changes: Any) -> Any:
    """The entry of number i, of an edge that was measured along track."""
    shown = {"orientation": "along", "measured_directions": ["along"]} | changes
    return entry_of(i, key=f"along {i}", record=Record({**entry_of(i).record.document, **shown}))


def test_a_direction_that_was_not_measured_cannot_be_told(archive: Archive, entry_of: Any) -> None:
    archive.add_entries(entry_of(i) for i in range(12))
    found = archive.check(specification({"sensor": "QB02"}))
    across, missing = found.answers
    assert (across.what, across.word) == ("QB02, pan, across", "met")
    assert (missing.what, missing.word) == ("QB02, pan, along", "cannot be told yet")
    asked = archive.check(specification({"sensor": "QB02", "orientation": "along"})).answers[0]
    assert missing.reason.startswith(asked.reason)
    assert (missing.images, missing.more_images) == (asked.images, asked.more_images)
    assert 'state orientation = "across"' in missing.summary
    assert found.word == "cannot be told yet"
    for chosen in (
        archive.check(specification({"sensor": "QB02", "orientation": "across"})),
        archive.check(specification({"sensor": "QB02"}), orientation="across"),
    ):
        assert (chosen.word, len(chosen.answers)) == ("met", 1)


def test_directions_are_missed_where_they_are_missing(archive: Archive, entry_of: Any) -> None:
    """Of the sensor that has both nothing is, nor of pixels that are not square."""
    archive.add_entries(entry_of(i) for i in range(12))
    archive.add_entries(along(entry_of, i, gsd_m=1.4) for i in range(12) if i // 2 % 2)
    found = archive.check(specification({}))
    assert [(one.what, one.word) for one in found.answers] == [
        ("K3, pan, across", "met"), ("QB02, pan, across", "met"), ("QB02, pan, along", "met"),
        ("K3, pan, along", "cannot be told yet"),
    ]  # fmt: skip


def test_of_products_of_several_gsds_each_is_asked(archive: Archive, entry_of: Any) -> None:
    archive.add_entries(entry_of(i) for i in range(12))
    archive.add_entries(along(entry_of, i) for i in range(12))
    for i in range(12):
        coarse = Record({**entry_of(i).record.document, "gsd_m": 2.8})
        archive.add_entries([entry_of(i, key=f"coarse {i}", record=coarse)])
    found = archive.check(specification({"sensor": "K3"}))
    missing = [one.what for one in found.answers if one.word != "met"]
    assert missing == ["K3, pan, GSD 2.8 m, along"]


@pytest.mark.parametrize("mistyped", [{"sensor": "NOPE"}, {"band": "pam"}, {"site": "Stenis"}])
def test_a_mistyped_name_stops_no_other_requirement(
    archive: Archive, entry_of: Any, mistyped: dict[str, Any]
) -> None:
    archive.add_entries(entry_of(i) for i in range(12))
    good = {"sensor": "QB02", "orientation": "across"}
    found = archive.check(specification(mistyped, good))
    wrong, judged = found.answers
    ((filtered, name),) = mistyped.items()
    assert f"cannot be told yet: no {filtered} is called '{name}', only " in wrong.summary
    assert (wrong.word, wrong.more_images) == ("cannot be told yet", None)
    assert judged.word == "met"
    assert found.word == "cannot be told yet"
    with pytest.raises(NothingSelectedError, match=r"only .* \(requirement 1, 2\)"):
        archive.check(specification(mistyped, mistyped))


def test_of_several_names_those_that_occur_are_judged(archive: Archive, entry_of: Any) -> None:
    archive.add_entries(entry_of(i) for i in range(12))
    several = specification({"sensor": ["QB02", "NOPE"], "orientation": "across"})
    assert [(one.what, one.word) for one in archive.check(several).answers] == [
        ("QB02, pan, across", "met"), ("QB02 or NOPE, across", "cannot be told yet"),
    ]  # fmt: skip
