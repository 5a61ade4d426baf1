"""Images are corrected afterwards: noted, whole or not at all, and never measured twice."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, date, datetime
from typing import Any

import pytest
from sqlalchemy import event

from acutance.archive import Archive, ImageCorrection
from acutance.archive.exchange.correction_files import read_correction_file
from acutance.archive.image_corrections import CorrectedImage
from acutance.errors import ArchiveError, OptionError
from acutance.targets.record import Record

DAY = datetime(2025, 3, 1, 9, 30, tzinfo=UTC)


@pytest.fixture
def filled(archive: Archive, entry_of: Any) -> Archive:
    """Three images, 0.tif to 2.tif, with two measurements each."""
    archive.add_entries([entry_of(at) for at in range(6)])
    return archive


def test_a_date_and_a_sensor_are_corrected_and_noted(filled: Archive) -> None:
    wrong = ImageCorrection(image="1.tif", acquired=DAY, sensor="K3A", reason="clock")
    told = filled.correct_images([wrong], dry_run=True)
    assert list(filled.measurements(sensor="K3A")["id"]) == []
    done = filled.correct_images([wrong])
    assert done == told
    assert done[0].measurements == 2
    assert done[0].changes["sensor"] == ("QB02", "K3A")
    assert "sensor QB02 → K3A" in done[0].summary
    found = filled.measurements(sensor="K3A", since="2025-03-01", until="2025-03-01")
    assert len(found) == 2
    sources = next(iter(filled.entries(image="1.tif"))).image.sources
    assert sources["sensor"].startswith("corrected on ")
    note = {one["column"]: one for one in sources["corrections"]}["acquired"]
    assert (note["before"][:10], note["after"][:10]) == ("2026-01-02", "2025-03-01")
    assert note["reason"] == "clock"
    assert filled.correct_images([wrong]) == []


def test_what_is_corrected_is_not_added_again(filled: Archive, entry_of: Any) -> None:
    filled.correct_images([ImageCorrection(image="1.tif", sensor="K3A", view_zenith_deg=12.0)])
    assert filled.add_entries([entry_of(at) for at in range(6)]) == 0
    # More of the same image, known as it was before, and known otherwise.
    more = entry_of(2, key="more")
    other = replace(entry_of(3, key="other"), image=replace(more.image, path="/copy/1.tif"))
    assert filled.add_entries([more, other]) == 2
    found = filled.measurements(sensor="K3A")
    assert len(found) == 4
    assert len(set(found["image_id"].tolist())) == 1
    assert filled.overview().images == 4
    image = filled.entry(int(filled.measurements(image="/copy/1.tif")["id"][0])).image
    assert image.view_zenith_deg == 12.0
    assert [one["column"] for one in image.sources["corrections"]] == ["sensor", "view_zenith_deg"]


def test_corrected_images_are_exported_and_come_back(
    filled: Archive, tmp_path: Any, entry_of: Any
) -> None:
    filled.correct_images([ImageCorrection(image="*.tif", gsd_m=(0.61, 0.6))])
    lines = tmp_path / "all.jsonl"
    filled.export(lines, to="jsonl")
    with Archive(tmp_path / "other.db") as other:
        assert other.import_documents(lines).new == 6
        assert list(other.entries()) == list(filled.entries())
        assert other.add_entries([entry_of(at) for at in range(6)]) == 0


def test_numbers_in_metres_stay_as_they_were_measured(filled: Archive) -> None:
    before = filled.measurements()["fwhm_m"]
    done = filled.correct_images([ImageCorrection(image="0.tif", gsd_m=0.61)])
    assert done[0].other_gsd == 2
    same = filled.correct_images([ImageCorrection(image="2.tif", gsd_m=0.7)])
    assert same[0].other_gsd == 0
    assert list(filled.measurements()["fwhm_m"]) == list(before)


def test_directions_without_metres_have_no_other_gsd(
    archive: Archive, entry_of: Any, edge_record: Any
) -> None:
    bare = {**edge_record.document, "gsd_m": None, "fwhm_m": None}
    archive.add_entries([entry_of(0, record=Record(bare))])
    assert archive.correct_images([ImageCorrection(image="0.tif", gsd_m=0.61)])[0].other_gsd == 0


def test_all_are_corrected_or_none(filled: Archive, entry_of: Any) -> None:
    other = entry_of(9, key="x")
    filled.add_entries([replace(other, image=replace(other.image, path="/elsewhere/0.tif"))])
    several = [
        ImageCorrection(image="1.tif", sensor="K3A"),
        ImageCorrection(image="7.tif", sensor="K3A"),
        ImageCorrection(image="0.tif", sensor="K3A"),
    ]
    with pytest.raises(OptionError, match=r"no image 7\.tif; 0\.tif names several images"):
        filled.correct_images(several)
    assert len(filled.measurements(sensor="K3A")) == 0
    pattern = filled.correct_images([ImageCorrection(image="0.ti*", sensor="K3A")])
    assert len(pattern) == 2
    assert len(filled.correct_images([ImageCorrection(image=f"{1:064x}", level="L1")])) == 1


CONTENT = "c" * 64


@pytest.fixture
def copy_of(entry_of: Any) -> Any:
    """Makes the entry of target i in an image of one content, under a path."""

    def make(i: int, path: str, content: str | None = CONTENT) -> Any:
        entry = entry_of(i, key=f"{i} {path}")
        return replace(entry, image=replace(entry_of(0).image, path=path, content=content))

    return make


def sensors_of(archive: Archive) -> dict[str, str]:
    found = archive.measurements()
    return dict(zip(found["image"].tolist(), found["sensor"].tolist(), strict=True))


def test_all_rows_of_an_image_are_corrected_by_the_name_of_one(
    archive: Archive, copy_of: Any
) -> None:
    archive.add_entries([copy_of(0, "/data/a.tif"), copy_of(1, "/copy/b.tif")])
    wrong = ImageCorrection(image="a.tif", sensor="K3A", acquired=DAY)
    assert len(archive.correct_images([wrong], dry_run=True)) == 2
    assert [one.measurements for one in archive.correct_images([wrong])] == [1, 1]
    archive.add_entries([copy_of(2, "/third/c.tif")])
    assert sensors_of(archive) == {"a.tif": "K3A", "b.tif": "K3A", "c.tif": "K3A"}
    assert {entry.image.acquired for entry in archive.entries()} == {DAY}


def test_a_pattern_is_of_file_names_unless_it_has_a_slash(archive: Archive, copy_of: Any) -> None:
    paths = ["K3_2026/pan_01.tif", "K3_2026/QB02_17.tif", "img/K3_a.tif"]
    archive.add_entries([copy_of(at, path, f"{at:064x}") for at, path in enumerate(paths)])

    def images(pattern: str) -> list[str]:
        wanted = ImageCorrection(image=pattern, sensor="S")
        return [one.image for one in archive.correct_images([wanted], dry_run=True)]

    assert images("K3_*.tif") == ["img/K3_a.tif"]
    assert images("K3_*/*.tif") == paths[:2]


def test_the_latest_correction_of_a_content_is_carried_over(
    archive: Archive, copy_of: Any, tmp_path: Any
) -> None:
    """Rows that were corrected one by one, as in archives of before: the later one counts."""
    separate = [copy_of(0, "/a/a.tif"), copy_of(1, "/b/b.tif")]
    lines = tmp_path / "one.jsonl"
    for at, sensor in ((1, "OLD"), (0, "NEW")):
        with Archive(tmp_path / f"{at}.db") as other:
            other.add_entries([separate[at]])
            other.correct_images([ImageCorrection(image=CONTENT, sensor=sensor)])
            other.export(lines.with_stem(f"{at}"), to="jsonl")
    # The row of the older correction comes last, and has the higher number.
    archive.import_documents([lines.with_stem("0"), lines.with_stem("1")])
    archive.add_entries([copy_of(2, "/d/d.tif")])
    assert set(sensors_of(archive).values()) == {"NEW"}
    for entry in archive.entries():
        notes = entry.image.sources["corrections"]
        assert [one["after"] for one in notes] == ["OLD", "NEW"]


@pytest.mark.parametrize("newer_is_imported", [True, False])
def test_notes_of_two_archives_are_joined(
    archive: Archive, copy_of: Any, tmp_path: Any, newer_is_imported: bool
) -> None:
    archive.add_entries([copy_of(0, "/a/a.tif")])
    guess = ImageCorrection(image=CONTENT, acquired="2026-05-01", reason="guess")
    right = ImageCorrection(image=CONTENT, acquired="2026-05-02", sensor="K3A", reason="log book")
    with Archive(tmp_path / "other.db") as other:
        other.add_entries([copy_of(0, "/a/a.tif"), copy_of(1, "/a/a.tif")])
        for one in (archive, other) if newer_is_imported else (other, archive):
            one.correct_images(
                [guess if one is (archive if newer_is_imported else other) else right]
            )
        other.export(tmp_path / "other.jsonl", to="jsonl")
    assert archive.import_documents(tmp_path / "other.jsonl").new == 1
    for entry in archive.entries():
        assert entry.image.sensor == "K3A"
        assert entry.image.acquired == datetime(2026, 5, 2, tzinfo=UTC)
        reasons = {one["reason"] for one in entry.image.sources["corrections"]}
        assert reasons == {"guess", "log book"}
    assert archive.overview().measured == 2


def test_a_corrected_export_corrects_what_is_there(
    archive: Archive, copy_of: Any, tmp_path: Any
) -> None:
    """Keys that are known add nothing, but their corrections count."""
    entries = [copy_of(0, "/a/a.tif"), copy_of(1, "/a/a.tif")]
    archive.add_entries(entries[:1])
    lines = tmp_path / "other.jsonl"
    with Archive(tmp_path / "other.db") as other:
        other.add_entries(entries[:1])
        other.correct_images([ImageCorrection(image="a.tif", sensor="K3A", gsd_m=(0.7, 0.6))])
        other.export(lines, to="jsonl")
        assert archive.import_documents(lines).new == 0
        assert set(sensors_of(archive).values()) == {"K3A"}
        assert next(iter(archive.entries())).image.gsd_m == (0.7, 0.6)
        other.add_entries(entries)
        other.export(lines, to="jsonl")
    assert archive.import_documents(lines).new == 1
    assert {entry.image.sensor for entry in archive.entries()} == {"K3A"}


def test_many_images_are_corrected_by_as_many_statements_as_one(
    archive: Archive, entry_of: Any
) -> None:
    """An archive is locked for others while it is corrected."""
    archive.add_entries([entry_of(at) for at in range(60)])
    statements: list[str] = []

    def count(*executed: Any) -> None:
        statements.append(executed[2])

    def used(image: str) -> int:
        statements.clear()
        archive.correct_images([ImageCorrection(image=image, gsd_m=0.61)])
        return len(statements)

    event.listen(archive._database.engine, "before_cursor_execute", count)
    assert used("3.tif") == used("*.tif")


def test_a_correction_is_later_than_all_before(archive: Archive, copy_of: Any) -> None:
    """Also than one of another machine, whose clock is ahead."""
    ahead = {"column": "sensor", "after": "K3", "on": "2990-01-01T00:00:00+00:00"}
    entry = copy_of(0, "/a/a.tif")
    noted = replace(entry.image, sources={"corrections": [ahead]})
    archive.add_entries([replace(entry, image=noted)])
    archive.correct_images([ImageCorrection(image="a.tif", sensor="K3A")])
    archive.add_entries([replace(copy_of(1, "/b/b.tif"), image=replace(noted, path="/b/b.tif"))])
    assert set(sensors_of(archive).values()) == {"K3A"}


def test_sources_may_hold_what_is_no_correction(archive: Archive, copy_of: Any) -> None:
    entry = copy_of(0, "/a/a.tif")
    odd = [
        {"column": "moon", "after": 1, "on": "2026-01-01"},
        "v2",
        {"column": "sensor", "after": 5},
    ]
    noted = replace(entry.image, sources={"corrections": odd})
    archive.add_entries([replace(entry, image=noted)])
    archive.add_entries([copy_of(1, "/b/b.tif")])
    assert archive.correct_images([ImageCorrection(image="b.tif", sensor="K3A")])
    assert set(sensors_of(archive).values()) == {"K3A"}


def test_an_archive_that_is_read_only_tells_what_would_change(tmp_path: Any, entry_of: Any) -> None:
    with Archive(tmp_path / "a.db") as made:
        made.add_entries([entry_of(0)])
    wanted = [ImageCorrection(image="0.tif", sensor="S")]
    with Archive(tmp_path / "a.db", read_only=True) as archive:
        assert len(archive.correct_images(wanted, dry_run=True)) == 1
        with pytest.raises(ArchiveError, match="opened to be read"):
            archive.correct_images(wanted)


@pytest.mark.parametrize(
    ("values", "message"),
    [({}, "nothing is corrected"), ({"acquired": "soon"}, "no date"), ({"gsd_m": -1}, "metres"),
     ({"gsd_m": (1.0, 2.0, 3.0)}, "metres"), ({"view_zenith_deg": 91}, "from 0 to 90"),
     ({"sensor": ""}, "write a text"), ({"sun_azimuth_deg": "x"}, "degrees")],
)  # fmt: skip
def test_values_that_cannot_be_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        ImageCorrection(image="0.tif", **values)


def test_corrections_of_a_file(tmp_path: Any) -> None:
    table = tmp_path / "corrections.csv"
    table.write_text(
        "image, sensor,acquired,gsd_row_m,gsd_col_m,view_zenith_deg,band\n"
        "0.tif, K3A ,2026-05-01,0.72,0.7,\n\n1.tif, ,,,,12.5,8\n"
    )
    expected = [
        ImageCorrection(image="0.tif", sensor="K3A", acquired="2026-05-01", gsd_m=(0.72, 0.7)),
        ImageCorrection(image="1.tif", view_zenith_deg=12.5, band="8"),
    ]
    assert read_correction_file(table) == expected
    lines = tmp_path / "corrections.json"
    lines.write_text(json.dumps([
        {"image": "0.tif", "sensor": "K3A", "acquired": "2026-05-01", "gsd_m": [0.72, 0.7]},
        {"image": "1.tif", "view_zenith_deg": 12.5, "sensor": None, "band": "8"},
    ]))  # fmt: skip
    assert read_correction_file(lines) == expected
    assert expected[0].columns["acquired"].date() == date(2026, 5, 1)


def test_all_faults_of_a_file_are_named(tmp_path: Any) -> None:
    table = tmp_path / "corrections.csv"
    table.write_text("image,sensor,moon,gsd_row_m\n0.tif,K3,full,\n,K3,,\n1.tif,K3,,0.7\n")
    with pytest.raises(OptionError) as refused:
        read_correction_file(table)
    for part in (
        "line 2: there is no moon",
        "line 3: the image is not named",
        "line 4: give gsd_m",
    ):
        assert part in str(refused.value)
    table.write_text("image,sensor\n")
    with pytest.raises(OptionError, match="are empty"):
        read_correction_file(table)
    table.write_text("image;gsd_m\n0.tif;0,7\n")
    with pytest.raises(OptionError, match="save it with commas between columns"):
        read_correction_file(table)
    with pytest.raises(OptionError, match="cannot be read"):
        read_correction_file(tmp_path / "none.csv")
    (tmp_path / "bad.json").write_text("[1]")
    with pytest.raises(OptionError, match="entry 1 is no object"):
        read_correction_file(tmp_path / "bad.json")


@pytest.fixture
def in_band(entry_of: Any, edge_record: Record) -> Any:
    """Makes the entry of number i measured in a band, by its number, without a name."""

    def make(i: int, number: int = 1) -> Any:
        image = {**edge_record.document["image"], "band": number, "band_name": None}
        record = Record({**edge_record.document, "image": image})
        return entry_of(i, record=record, band=None, key=f"{i} {number}")

    return make


def test_rows_without_a_band_get_its_name(archive: Archive, in_band: Any, entry_of: Any) -> None:
    archive.add_entries([in_band(0), in_band(1), in_band(2), entry_of(3, band="red")])
    named = ImageCorrection(image="*.tif", band="pan", reason="one band")
    told = archive.correct_images([named], dry_run=True)
    assert set(archive.measurements()["band"].tolist()) == {None, "red"}
    done = archive.correct_images([named])
    assert done == told
    assert [one.changes for one in done] == [{"band": (None, "pan")}] * 2
    assert archive.measurements()["band"].tolist() == ["pan", "pan", "pan", "red"]
    # Noted, also after another correction, and neither made nor added twice.
    archive.correct_images([ImageCorrection(image="0.tif", level="L1")])
    sources = next(iter(archive.entries(image="0.tif"))).image.sources
    assert [one["column"] for one in sources["corrections"]] == ["band", "level"]
    assert archive.correct_images([named]) == []
    assert archive.add_entries([in_band(0), in_band(2)]) == 0


def test_two_bands_do_not_become_one(archive: Archive, in_band: Any) -> None:
    archive.add_entries([in_band(0, 1), in_band(1, 2), in_band(2)])
    with pytest.raises(OptionError, match=r"/images/0\.tif was measured in bands 1 and 2"):
        archive.correct_images([ImageCorrection(image="*.tif", band="pan")])
    assert archive.measurements()["band"].tolist() == [None] * 3


def test_a_clock_that_was_wrong_by_seconds_is_seen_to_change() -> None:
    before, after = (datetime(2026, 5, 1, 10, 20, second, tzinfo=UTC) for second in (0, 10))
    change = CorrectedImage(1, "a.tif", {"acquired": (before, after)}, 1, 0, 0)
    assert "2026-05-01 10:20 → 2026-05-01 10:20:10" in change.summary


def test_two_values_of_one_image_in_a_file_are_refused(tmp_path):
    table = tmp_path / "twice.csv"
    table.write_text(
        "image,acquired,sensor\na.tif,2021-01-01,S1\nb.tif,2021-01-01,\na.tif,2022-01-01,S1\n"
    )
    words = r"line 2 and line 4: acquired of a\.tif is 2021-01-01.* and 2022"
    with pytest.raises(OptionError, match=words):
        read_correction_file(table)
    # The same twice, parts of what is known, and a name below a pattern contradict nothing.
    table.write_text("image,acquired,sensor\n*.tif,,S1\na.tif,2021-01-01,S2\na.tif,2021-01-01,\n")
    assert len(read_correction_file(table)) == 3
