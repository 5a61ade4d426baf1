"""What is added is kept, once, whole."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from datetime import UTC, date, datetime, timedelta, timezone

import numpy as np
import pytest
from sqlalchemy import update

import acutance as ac
from acutance.archive import Archive, Entry, ImageCorrection, ImageEntry, TargetEntry
from acutance.archive.identity import keys_of
from acutance.archive.tables import measurements
from acutance.curves import METRICS
from acutance.errors import OptionError


def test_a_measurement_comes_back_whole(archive, edge_record):
    kept = archive.add(edge_record, sensor="QB02", acquired="2026-05-01", target="Stennis tarp")
    assert kept.new
    found = archive.measurements(sensor="QB02", kind="edge")
    assert len(found) == 1
    assert found["id"][0] == kept.id
    assert found.record(0) == edge_record
    assert found["acquired"][0] == np.datetime64("2026-05-01T00:00:00")
    for metric in METRICS:
        number = edge_record.across.numbers[metric]
        assert found[metric][0] == number.value
        assert found[f"{metric}_std"][0] == number.std
    assert found["gsd_m"][0] == 0.7
    assert found["normal_deg"][0] == edge_record.document["line"]["normal_deg"]
    assert found["angle_deg"][0] == found["normal_deg"][0]
    assert found["verdict"][0] == edge_record.verdict.word
    assert found["snr"][0] == edge_record.snr


def test_both_directions_are_rows(archive, bars_record):
    archive.add(bars_record)
    found = archive.measurements()
    assert found["orientation"].tolist() == ["across", "along"]
    assert found["angle_deg"].tolist() == [0.0, 90.0]
    assert found["mtf_nyquist"][1] == bars_record.along.mtf_nyquist.value
    assert archive.measurements(orientation="along")["angle_deg"].tolist() == [90.0]


def test_adding_twice_adds_once(archive, edge_record):
    first = archive.add(edge_record, sensor="QB02", target="tarp")
    second = archive.add(edge_record, sensor="QB02", target="tarp")
    assert (first.new, second.new, first.id) == (True, False, second.id)
    later = {**edge_record.document, "measured_at": "2030-01-01T00:00:00+00:00"}
    assert not archive.add(ac.Record(later), sensor="QB02", target="tarp").new
    assert archive.add(edge_record, sensor="QB02", target="another").new
    assert archive.add(edge_record, sensor="QB02", target="tarp", band="green").new
    assert len(archive.measurements()) == 3


def test_what_is_stated_anew_is_not_kept_in_silence(archive, edge_record):
    document = edge_record.document
    edge_record = ac.Record({**document, "image": {**document["image"], "path": "/new/B4.tif"}})
    archive.add(edge_record, sensor="QB02")
    with pytest.raises(OptionError, match=r"number 1, with sensor QB02, not K3, and keeps"):
        archive.add(edge_record, sensor="K3")
    with pytest.raises(OptionError, match="acquired not known, not 2026-05-01T00:00:00"):
        archive.add(edge_record, sensor="QB02", acquired="2026-05-01")
    assert not archive.add(edge_record).new
    assert archive.measurements()["sensor"].tolist() == ["QB02"]
    archive.correct_images([ImageCorrection(image="B4.tif", sensor="K3", acquired="2026-05-01")])
    assert not archive.add(edge_record, sensor="K3", acquired="2026-05-01").new
    archive.correct_images([ImageCorrection(image="B4.tif", acquired="2026-05-01T10:00Z")])
    assert not archive.add(edge_record, acquired="2026-05-01").new
    for other in ("2026-05-02", "2026-05-01T11:00Z"):
        with pytest.raises(OptionError, match=r"acquired 2026-05-01T10:00:00.*, not 2026-05"):
            archive.add(edge_record, acquired=other)
    archive.add(ac.Record(document))
    with pytest.raises(OptionError, match="give it a key of its own"):
        archive.add(ac.Record(document), sensor="K3")


def test_an_import_refuses_what_contradicts_as_add_does(archive, edge_record, tmp_path):
    file = tmp_path / "edge.json"
    file.write_text(json.dumps(edge_record.to_dict()))
    assert archive.import_documents(file, sensor="QB02").new == 1
    assert archive.import_documents(file, sensor="QB02").refused == {}
    done = archive.import_documents(file, sensor="K3")
    assert (done.read, done.new) == (1, 0)
    assert "sensor QB02, not K3" in done.refused[str(file)]


def test_images_of_one_name_are_not_one_image(archive, edge_record):
    """Without the content of the file, the numbers tell measurements of equal names apart."""
    number = edge_record.document["mtf_nyquist"]
    other = ac.Record({**edge_record.document, "mtf_nyquist": {**number, "value": 0.5}})
    january, february = ImageEntry(path="/01/B4.tif"), ImageEntry(path="/02/B4.tif")
    assert archive.add(edge_record, image=january).new
    assert archive.add(other, image=february).new
    assert not archive.add(edge_record, image=february).new


def test_the_content_is_the_image_whatever_its_folder(archive, entry_of):
    entry = entry_of(0)
    moved = ImageEntry(path="/elsewhere/new.tif", content=entry.image.content)
    assert archive.add_entries([entry, entry_of(0, image=moved)]) == 1


def test_edges_of_one_region_are_several(archive, entry_of, edge_record):
    line = {**edge_record.document["line"], "row": 50.0}
    second = ac.Record({**edge_record.document, "line": line})
    assert archive.add_entries([entry_of(0, record=edge_record), entry_of(0, record=second)]) == 2


@pytest.mark.parametrize(
    "changed",
    [
        {"image": {"along_track": "x"}},
        {"image": {"pixel_gsd_m": [0.5, 0.7]}},
        {"image": {"pixel_gsd_m": None, "gsd_m": None}},
        {"image": {"linearized": "square root"}},
        {"stated_width_px": 2.9, "width_px": {"value": 2.9, "std": 0.0}},
    ],
)
@pytest.mark.parametrize("content", [None, "ab" * 32])
def test_what_is_stated_otherwise_is_another_measurement(archive, edge_record, content, changed):
    """It has other numbers, or another direction: it was passed over in silence."""
    image = ImageEntry(path="B4.tif", content=content)
    other = {**edge_record.document, **changed}
    other["image"] = {**edge_record.document["image"], **changed.get("image", {})}
    assert archive.add(edge_record, image=image).new
    assert archive.add(ac.Record(other), image=image).new
    assert not archive.add(ac.Record(other), image=image).new
    assert not archive.add(edge_record, image=image).new


def test_sources_in_other_places_are_another_measurement(archive, bars_record):
    """Two groups of mirrors of one image, about one middle, too."""

    def measured(places):
        sources = [{"row": {"value": row}, "col": {"value": col}} for row, col in places]
        return ac.Record({**bars_record.document, "kind": "points", "sources": sources})

    image = ImageEntry(content="ab" * 32)
    square = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    groups = [50 + 10 * square, 50 + 20 * square, 52 + 10 * square, 50 + 10 * square[:3]]
    assert [archive.add(measured(one), image=image).new for one in groups] == [True] * 4
    assert not archive.add(measured(groups[1] + 0.01), image=image).new


def test_pairs_of_one_image_with_two_references_are_two(archive, bars_record):
    image = ImageEntry(content="ab" * 32)
    across = bars_record.document["across"]
    other = {**across, "mtf_nyquist": {**across["mtf_nyquist"], "value": 0.3}}
    for document in ({}, {"across": other}):
        pair = ac.Record({**bars_record.document, "kind": "biresolution", **document})
        assert archive.add(pair, image=image).new
        assert not archive.add(pair, image=image).new


def older_key(entry):
    """The key that version 0.1 gave to an entry."""
    return keys_of(entry).older


def test_what_an_older_version_kept_is_there(archive, entry_of):
    kept = [entry_of(i) for i in range(4)]
    archive.add_entries([replace(one, key=f"{i}") for i, one in enumerate(kept)])

    def write_older_keys(connection):
        for i, one in enumerate(kept):
            row = measurements.c.key == f"{i}"
            connection.execute(update(measurements).where(row).values(key=older_key(one)))

    archive._database.write(write_older_keys)
    assert archive.keys() == {older_key(one) for one in kept}
    assert archive.add_entries(kept) == 0
    again = archive.add(kept[1].record, image=kept[1].image, target=kept[1].target, band="pan")
    assert (again.new, again.id, again.key) == (False, 2, older_key(kept[1]))
    image = replace(kept[0].image, sensor="K9")
    with pytest.raises(OptionError, match="with sensor K3, not K9"):
        archive.add(kept[0].record, image=image, target=kept[0].target, band="pan")
    document = kept[0].record.document
    turned = ac.Record({**document, "image": {**document["image"], "along_track": "x"}})
    assert archive.add_entries([replace(kept[0], record=turned), *kept]) == 1


@pytest.mark.parametrize(
    ("content", "key"),
    [
        (None, "825be51623057c0f8a502300682c300a27be1d18a1b642617611c2f90ece57e4"),
        ("ab" * 32, "3a64c98ba8910f86b640048851191dcb1926132258c68b23ea3fc6f46b234f30"),
    ],
)
def test_the_key_of_an_older_version_is_what_it_was(content, key):
    """Computed by version 0.1."""
    record = ac.Record({
        "schema": "acutance/measurement/1", "kind": "edge", "method": "spline",
        "orientation": "across", "snr": 100.0, "checks": [],
        "image": {"path": "/a/B4.tif", "band": 2, "roi": [1, 2, 60, 44]},
        "line": {"row": 30.2, "col": 21.7, "normal_deg": 6.01},
        "options": {"robust": True, "limits": {}}, "measured_at": "2026-01-01T00:00:00+00:00",
        "mtf_nyquist": {"value": 0.1234567, "std": 0.01},
    })  # fmt: skip
    image = ImageEntry(path="/b/B4.tif", content=content)
    target = TargetEntry(name="tarp", kind="edge")
    entry = Entry(record=record, image=image, target=target, band="pan")
    assert older_key(entry) == key


def test_documents_of_an_older_version_are_what_is_there(archive, entry_of):
    """They state the key that was derived without what is stated of the measurement."""
    entry = entry_of(0)
    assert archive.add_entries([entry]) == 1
    assert archive.add_entries([replace(entry, key=older_key(entry))]) == 0
    later = entry_of(1)
    assert archive.add_entries([replace(later, key=older_key(later))]) == 1
    assert archive.add_entries([later]) == 0


def test_a_key_of_ones_own(archive, entry_of):
    assert archive.add_entries([entry_of(0, key="a"), entry_of(1, key="a")]) == 1
    assert archive.keys() == {"a"}


def test_rejections_are_rows(archive, entry_of):
    rejected = ac.Rejected("region", "too small", {"place": 3, "value": float("nan")})
    entry = entry_of(0, record=None, rejected=rejected)
    assert archive.add_entries([entry, entry]) == 1
    found = archive.rejected(sensor="K3", target="tarp 0")
    assert found["stage"].tolist() == ["region"]
    assert found["values"].tolist() == [{"place": 3, "value": None}]
    assert found["kind"].tolist() == ["edge"]
    assert len(archive.measurements()) == 0
    with pytest.raises(OptionError, match="no verdict"):
        archive.rejected(verdict="good")


def test_chunks_count_what_is_new(archive, entry_of, monkeypatch):
    monkeypatch.setattr("acutance.archive.adding.CHUNK", 4)
    told = []
    assert archive.add_entries((entry_of(i) for i in range(10)), progress=told.append) == 10
    assert told == [4, 8, 10]
    assert archive.add_entries(entry_of(i) for i in range(12)) == 2
    assert len(archive.measurements()) == 12
    assert len(set(archive.measurements()["image_id"].tolist())) == 6


def test_keys_of_runs_and_images(archive, entry_of):
    run = archive.start_run({"images": ["*.tif"], "limit": float("inf")})
    archive.add_entries([entry_of(0), entry_of(1)], run=run)
    archive.add_entries([entry_of(2)])
    archive.end_run(run, {"measured": 2})
    assert len(archive.keys()) == 3
    assert len(archive.keys(run=run)) == 2
    assert archive.keys(images=[entry_of(2).image.content]) == archive.keys() - archive.keys(
        run=run
    )
    assert set(archive.measurements(run=run)["run"].tolist()) == {run}
    with pytest.raises(OptionError, match="no run 99"):
        archive.add_entries([entry_of(5)], run=99)
    with pytest.raises(OptionError, match="no run 99"):
        archive.end_run(99, {})


def test_dates_without_a_zone_are_utc(archive, entry_of, edge_record):
    """A day is its midnight, and as the end of a period all of it."""
    naive = datetime(2026, 3, 1, 12)
    east = datetime(2026, 3, 2, 1, tzinfo=timezone(timedelta(hours=9)))
    for i, when in enumerate((naive, east, date(2026, 3, 3), "2026-03-04T10:00:00Z")):
        archive.add(edge_record, acquired=when, target=f"{i}")
    found = archive.measurements()["acquired"].astype("datetime64[h]").astype(str).tolist()
    assert found == ["2026-03-01T12", "2026-03-01T16", "2026-03-03T00", "2026-03-04T10"]
    assert len(archive.measurements(since="2026-03-01", until="2026-03-01")) == 2
    assert len(archive.measurements(since=datetime(2026, 3, 1, 16, tzinfo=UTC))) == 3
    assert len(archive.measurements(until=date(2026, 3, 3))) == 3
    with pytest.raises(OptionError, match="no date"):
        archive.add(edge_record, acquired="last week")


def test_what_is_no_measurement_is_refused(archive, edge_record):
    with pytest.raises(OptionError, match="dict was given"):
        archive.add(dict(edge_record.document))
    with pytest.raises(OptionError, match="neither"):
        Entry()
    with pytest.raises(OptionError, match="part of image"):
        archive.add(edge_record, sensor="QB02", image=ImageEntry())
    with pytest.raises(OptionError, match="written as JSON"):
        archive.add(ac.Record({**edge_record.document, "note": "\ud800"}))


@pytest.fixture(scope="module")
def combined(edge_record, bars_record):
    """An edge and a star, combined as they were measured."""
    return ac.combine([bars_record, edge_record])


def test_old_measurements_are_combined(archive, edge_record, bars_record, combined):
    """The covariance is kept: combining what came out is combining what went in."""
    archive.add_entries([Entry(record=edge_record), Entry(record=bars_record)])
    kept = archive.combine(verdict="invalid").across.mtf_nyquist
    assert kept.value == pytest.approx(combined.across.mtf_nyquist.value, rel=1e-6)
    assert kept.std == pytest.approx(combined.across.mtf_nyquist.std, rel=1e-3)
    with pytest.raises(OptionError, match="no measurement to combine"):
        archive.combine(sensor="none")


def test_threads_add_the_same_once(place, entry_of):
    """Every process or thread has its own archive; together they keep each entry once."""
    entries = [entry_of(i) for i in range(40)]
    Archive(place).close()
    added = []

    def add(order):
        with Archive(place) as own:
            added.append(sum(own.add_entries(entries[i : i + 5]) for i in order))

    orders = range(0, 40, 5), range(35, -1, -5)
    threads = [threading.Thread(target=add, args=(order,)) for order in orders]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sum(added) == 40
    with Archive(place) as own:
        assert len(own.measurements()) == 40


def test_a_target_with_all_that_is_known(archive, edge_record):
    target = TargetEntry(
        name="O'Neil's 100 % tarp; --", kind="edge", site='"Süd"', valid_from=date(2025, 1, 1),
        lon=-89.6, lat=30.4, definition={"type": "Feature", "geometry": None},
    )  # fmt: skip
    archive.add(edge_record, target=target, band="近赤外")
    assert archive.measurements(target=target.name, site='"Süd"', band="近赤外")["id"].size == 1
    assert archive.measurements(target="O'Neil's%").columns["id"].size == 0
