"""Filters by names that occur nowhere; series of what is not of one sensor or GSD."""

from __future__ import annotations

import re
from typing import Any

import pytest

from acutance.archive import Archive, Entry, ImageEntry
from acutance.archive.specification import Specification
from acutance.errors import NothingSelectedError, OptionError
from acutance.report.archive.sensor_page import sensor_page
from acutance.targets.record import Record


def specification(**words: Any) -> Specification:
    return Specification.of({"requirement": [{"metric": "rer", "minimum": 0.1, **words}]})


def test_names_of_a_requirement_that_occur_nowhere_are_refused(
    archive: Archive, entry_of: Any
) -> None:
    archive.add_entries(entry_of(i) for i in range(4))
    assert archive.check(specification(sensor="QB02", band="pan")).answers
    with pytest.raises(NothingSelectedError) as error:
        archive.check(specification(sensor=["QB02", "NOPE"], band="pam"), site="Stenis")
    for part in ("no sensor is called 'NOPE', only K3, QB02", "no band is called 'pam', only pan",
                 "no site is called 'Stenis', only Stennis"):  # fmt: skip
        assert part in str(error.value)


def test_an_empty_selection_names_what_there_is(archive: Archive, entry_of: Any) -> None:
    archive.add_entries(entry_of(i) for i in range(4))
    with pytest.raises(NothingSelectedError, match="no sensor is called 'K4', only K3, QB02"):
        archive.mean("rer", sensor="K4", orientation="across")
    with pytest.raises(NothingSelectedError, match="no target is called 'x', only tarp 0, tarp 1"):
        archive.table(target="x")
    # What occurs, but not together, is no misspelling.
    with pytest.raises(NothingSelectedError, match="holds nothing that is selected"):
        archive.table(sensor="K3", since="2030-01-01")


@pytest.mark.parametrize("ask", ["trend", "mean", "compare", "table", "page"])
def test_an_empty_archive_is_called_empty(archive: Archive, ask: str) -> None:
    """No filter is too narrow there, and no sensor misspelt."""
    asked: dict[str, Any] = {
        "trend": lambda: archive.trend("rer"), "mean": lambda: archive.mean("rer"),
        "compare": archive.compare, "table": lambda: archive.table(sensor="QB02"),
        "page": lambda: sensor_page(archive, "QB02"),
    }  # fmt: skip
    with pytest.raises(NothingSelectedError, match=r"is empty: add measurements to it"):
        asked[ask]()


def test_kinds_are_those_that_there_are(archive: Archive) -> None:
    with pytest.raises(OptionError, match="kind is 'egde': it is one of edge, pulse"):
        archive.measurements(kind="egde")
    with pytest.raises(OptionError, match="kind is 'egde'"):
        archive.rejected(kind=["edge", "egde"])


def of_gsd(entry_of: Any, i: int, gsd_m: float) -> Entry:
    """An entry of an image that tells neither its sensor nor its date."""
    changed = {**entry_of(i).record.document, "gsd_m": gsd_m}
    image = ImageEntry(path=f"/images/{i}.tif", content=f"{i:064x}")
    return entry_of(i, record=Record(changed), image=image, band=None)


def test_images_of_several_gsds_are_not_joined(archive: Archive, entry_of: Any) -> None:
    sizes = (10.0, 10.3, 20.0, 30.0)
    archive.add_entries(of_gsd(entry_of, i, sizes[i // 2]) for i in range(8))
    found = archive.check(specification(orientation="across"))
    begin = "images without a sensor, "
    assert all(one.what.startswith(begin) for one in found.answers)
    assert [(one.what.removeprefix(begin), one.images) for one in found.answers] == [
        ("GSD 10 to 10.3 m, across", 4), ("GSD 20 m, across", 2), ("GSD 30 m, across", 2),
    ]  # fmt: skip
    assert "No sensor and no band is named: 4 images are taken" in found.answers[0].summary
    refused = "of 3 GSDs, GSD 10 to 10.3 m, GSD 20 m, GSD 30 m: select one"
    with pytest.raises(OptionError, match=re.escape(refused)):
        archive.mean("rer")


def test_bands_without_a_name_are_selected_as_the_message_says(
    archive: Archive, entry_of: Any
) -> None:
    archive.add_entries(entry_of(i, band=None if i % 2 else "pan") for i in range(8))
    whole: dict[str, Any] = {"sensor": "QB02", "orientation": "across"}
    with pytest.raises(OptionError, match=r"of 2 bands, pan, '' \(of those without a name\)"):
        archive.trend("rer", **whole)
    assert set(archive.measurements(band="")["band"].tolist()) == {None}
    assert len(archive.measurements(band=["", "pan"])) == len(archive.measurements())
    with pytest.raises(NothingSelectedError, match="holds nothing that is selected"):
        archive.trend("rer", sensor="")
    unnamed = specification(band="", sensor="QB02", orientation="across")
    assert len(archive.check(unnamed).answers) == 1
