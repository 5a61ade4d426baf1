"""What an archive exports comes back the same."""

from __future__ import annotations

import csv
import json
import math
import struct
from datetime import UTC, date, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

import acutance as ac
from acutance import report
from acutance.archive import Archive, Entry, ImageEntry, TargetEntry
from acutance.archive.exchange.entry_document import entry_document
from acutance.archive.exchange.stac_item import stac_schema
from acutance.archive.selection import Selection
from acutance.archive.stored_entries import select_ids, stored_entries
from acutance.errors import OptionError
from acutance.targets.record import strict_json

NAMES = {"jsonl": "out.jsonl", "parquet": "out.parquet", "csv-documents": "out.csv", "stac": "out"}


def content(archive, **selection):
    """Everything an archive holds of some entries, by key."""
    database = archive._database
    ids = select_ids(database, Selection.of(selection))
    found = [entry_document(entry) for entry in stored_entries(database, ids)]
    return {document["key"]: strict_json(document) for document in found}


@pytest.fixture
def several(archive, entry_of, bars_record):
    """An archive of measurements in one and two directions, and of rejections."""
    rejected = ac.Rejected("fit", 'no edge, "nothing"; – 100 %', {"row": 3, "nan": float("nan")})
    where = TargetEntry(
        name="Süd, 'a'", kind="star", definition={"type": "Feature", "id": [1, None, 2.5]},
        site="Baotou", valid_from=date(2020, 2, 29), valid_to=None, lon=109.6, lat=40.85,
    )  # fmt: skip
    image = ImageEntry(
        path="C:\\bilder\\ä b.tif", sensor="K3", level="1R", gsd_m=(0.7, 0.8),
        sun_azimuth_deg=170.5,
        acquired=datetime(2026, 5, 1, 23, 59, 59, 999999, UTC), sources={"sensor": "DIMAP"},
    )  # fmt: skip
    archive.add_entries([
        *(entry_of(i) for i in range(5)),
        Entry(record=bars_record, image=image, target=where, band="近赤外"),
        Entry(rejected=rejected, image=image, target=where),
        entry_of(9, record=None, rejected=rejected, band=None),
    ])  # fmt: skip
    return archive


@pytest.mark.parametrize("to", NAMES)
def test_what_goes_out_comes_back(several, tmp_path, to):
    place = tmp_path / NAMES[to]
    assert several.export(place, to=to) == 8
    with Archive(tmp_path / "again.db") as again:
        done = again.import_documents(place)
        assert (done.read, done.new, done.refused) == (8, 8, {})
        assert content(again) == content(several)
        assert again.import_documents([place, place]).new == 0


@pytest.mark.parametrize("to", NAMES)
def test_a_selection_goes_out(several, tmp_path, to):
    place = tmp_path / NAMES[to]
    count = several.export(place, to=to, sensor="QB02", since="2026-01-01")
    with Archive(tmp_path / "again.db") as again:
        again.import_documents(place)
        assert len(content(again)) == count == len(content(several, sensor="QB02")) == 2


texts = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\0"), max_size=12)
numbers = st.one_of(st.none(), st.floats(), st.integers(-(2**53), 2**53))
# No deviation is below 0: an `Estimate` of such a one is refused.
deviations = st.one_of(st.none(), st.just(math.nan), st.floats(0), st.integers(0, 2**53))
values = st.recursive(
    st.one_of(numbers, st.booleans(), texts),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(texts, inner, max_size=3)),
    max_leaves=6,
)
zeniths = st.one_of(st.none(), st.floats(0, 90))
azimuths = st.one_of(st.none(), st.floats(-180, 360))
moments = st.datetimes(
    datetime(1957, 10, 4), datetime(2026, 1, 1), timezones=st.just(UTC)
)  # fmt: skip
images = st.builds(
    ImageEntry,
    path=st.one_of(st.none(), texts), sensor=st.one_of(st.none(), texts),
    level=st.one_of(st.none(), texts), acquired=moments,
    gsd_m=st.one_of(st.none(), st.tuples(st.floats(0.1, 100), st.floats(0.1, 100))),
    view_zenith_deg=zeniths, sun_azimuth_deg=azimuths,
    sources=st.dictionaries(texts, values, max_size=3),
)  # fmt: skip
targets = st.builds(
    TargetEntry,
    name=texts, kind=st.sampled_from(["edge", "star"]), site=st.one_of(st.none(), texts),
    definition=st.dictionaries(texts, values, max_size=3),
    valid_from=st.one_of(st.none(), st.dates(date(1950, 1, 1))),
    lon=st.one_of(st.none(), st.floats(-180, 180)), lat=st.one_of(st.none(), st.floats(-90, 90)),
)  # fmt: skip


@st.composite
def entries(draw, record):
    """An entry of anything that may be known, or not."""
    number = record.document["mtf_nyquist"]
    changed = {"mtf_nyquist": {**number, "value": draw(st.floats(0, 1)), "std": draw(deviations)}}
    measured = ac.Record({**record.document, **changed, "note": draw(values)})
    rejected = ac.Rejected("fit", draw(texts), draw(st.dictionaries(texts, values, max_size=3)))
    is_measured = draw(st.booleans())
    return Entry(
        record=measured if is_measured else None,
        rejected=None if is_measured else rejected,
        image=draw(images),
        target=draw(st.one_of(st.none(), targets)),
        band=draw(st.one_of(st.none(), texts)),
    )


@given(data=st.data())
@settings(
    max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_nothing_is_lost_whatever_is_kept(data, edge_record, tmp_path_factory):
    kept = data.draw(st.lists(entries(edge_record), min_size=1, max_size=4))
    folder = tmp_path_factory.mktemp("any")
    with Archive(folder / "one.db") as archive:
        archive.add_entries(kept)
        stored = content(archive)
        # What is no finite number is null in documents; all else is as it was added.
        assert stored == {
            document["key"]: strict_json(document) for document in map(entry_document, kept)
        }
        for to, name in NAMES.items():
            archive.export(folder / name, to=to)
            with Archive(folder / f"{to}.db") as again:
                done = again.import_documents(folder / name)
                assert not done.refused
                assert content(again) == stored, to


def test_csv_has_all_numbers_and_says_that_it_has_no_documents(several, tmp_path, edge_record):
    place = tmp_path / "numbers.csv"
    several.export(place, to="csv")
    with place.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5 + 2 + 2
    measured = several.measurements(kind="edge")
    read = [float(row["mtf_nyquist"]) for row in rows if row["kind"] == "edge" and row["verdict"]]
    assert sorted(read) == sorted(measured["mtf_nyquist"].tolist())
    assert {row["reason"] for row in rows} - {""} == {'no edge, "nothing"; – 100 %'}
    assert "C:\\bilder\\ä b.tif" in {row["path"] for row in rows}
    done = several.import_documents(place)
    assert done.read == 0
    assert "--documents" in done.refused[str(place)]


def test_parquet_is_read_by_others(several, tmp_path):
    """Numbers as columns of their types, and the place of the target as GeoParquet."""
    from pyarrow import parquet

    place = tmp_path / "out.parquet"
    several.export(place, to="parquet")
    table = parquet.read_table(place)
    assert str(table.schema.field("acquired").type) == "timestamp[us, tz=UTC]"
    assert str(table.schema.field("rer_std").type) == "double"
    geo = json.loads(table.schema.metadata[b"geo"])
    assert geo["version"] == "1.1.0"
    assert geo["columns"]["geometry"]["encoding"] == "WKB"
    points = [one for one in table["geometry"].to_pylist() if one is not None]
    assert struct.unpack("<BIdd", points[0]) == (1, 1, 109.6, 40.85)
    assert sum(one is None for one in table["geometry"].to_pylist()) == 6


def test_stac_items_keep_to_the_schema(several, tmp_path, bars_record):
    several.export(tmp_path / "stac", to="stac")
    import pystac

    catalog = pystac.Catalog.from_file(str(tmp_path / "stac" / "catalog.json"))
    items = list(catalog.get_items())
    assert len(items) == 5
    schema = stac_schema()
    Draft202012Validator.check_schema(schema)
    check = Draft202012Validator(schema)
    for item in items:
        assert not list(check.iter_errors(item.to_dict()))
        assert Path(item.assets["mtf:documents"].get_absolute_href()).is_file()
    (star,) = (item for item in items if item.properties["platform"] == "K3" and item.geometry)
    assert star.geometry == {"type": "Point", "coordinates": [109.6, 40.85]}
    assert star.bbox == [109.6, 40.85, 109.6, 40.85]
    assert star.properties["view:sun_azimuth"] == 170.5
    assert star.properties["gsd"] == 0.7
    across, along = star.properties["mtf:measurements"]
    assert (across["orientation"], along["orientation"], across["band"]) == (
        "across", "along", "近赤外",
    )  # fmt: skip
    rer = bars_record.along.rer
    assert along["metrics"]["rer"] == {"value": rer.value, "std": rer.std}
    assert star.properties["mtf:rejected"][0]["stage"] == "fit"
    broken = star.to_dict()
    broken["properties"]["mtf:measurements"][0]["metrics"]["rer"] = 0.5
    assert list(check.iter_errors(broken))


@pytest.mark.parametrize(
    ("lons", "west", "east"),
    [
        ([179.999, -179.999], 179.999, -179.999),
        ([-179.5, 179.5, 178.0], 178.0, -179.5),
        ([180.5, 179.5], 179.5, -179.5),
        ([-70.0, 20.0, -10.0], -70.0, 20.0),
        ([5.0, 5.0], 5.0, 5.0),
    ],
)
def test_the_box_of_a_stac_item_is_narrow_beyond_the_antimeridian(
    entry_of, tmp_path, lons, west, east
):
    pystac = pytest.importorskip("pystac")
    targets = [
        TargetEntry(name=f"T{number}", kind="edge", lon=lon, lat=-17.0 + number)
        for number, lon in enumerate(lons)
    ]
    with Archive(tmp_path / "kept.db") as archive:
        archive.add_entries([entry_of(0, target=one) for one in targets])
        archive.export(tmp_path / "stac", to="stac")
    (item,) = pystac.Catalog.from_file(str(tmp_path / "stac" / "catalog.json")).get_items()
    assert item.bbox == [west, -17.0, east, -18.0 + len(lons)]


@pytest.mark.parametrize("why", ["outside", "not there then"])
def test_a_stac_item_has_no_targets_that_its_image_does_not_show(entry_of, tmp_path, why):
    pystac = pytest.importorskip("pystac")
    here, there = (
        TargetEntry(name=name, kind="edge", lon=lon, lat=51.9)
        for name, lon in (("brazil", -46.6), ("rotterdam", 4.4))
    )
    absent = ac.Rejected("region", "the target lies at row -348936", {"why": why})
    lost = ac.Rejected("find", "no straight edge is there", {"why": "not found"})
    with Archive(tmp_path / "kept.db") as archive:
        archive.add_entries([
            entry_of(0, target=here),
            entry_of(0, target=here, record=None, rejected=lost),
            entry_of(0, target=there, record=None, rejected=absent),
        ])  # fmt: skip
        assert archive.export(tmp_path / "stac", to="stac") == 3
    (item,) = pystac.Catalog.from_file(str(tmp_path / "stac" / "catalog.json")).get_items()
    assert item.bbox == [-46.6, 51.9, -46.6, 51.9]
    assert [one["target"] for one in item.properties["mtf:rejected"]] == ["brazil"]
    # The documents lose nothing.
    lines = (tmp_path / "stac").glob("*/measurements.jsonl")
    assert len(next(lines).read_text().splitlines()) == 3


def test_stac_needs_a_date_and_a_new_folder(archive, edge_record, entry_of, tmp_path):
    archive.add(edge_record)
    with pytest.raises(OptionError, match="has no date"):
        archive.export(tmp_path / "stac", to="stac")
    assert not list(tmp_path.glob("stac*"))
    archive.add_entries([entry_of(0)])
    assert archive.export(tmp_path / "stac", to="stac", since="2020-01-01") == 1
    with pytest.raises(OptionError, match="there already"):
        archive.export(tmp_path / "stac", to="stac", since="2020-01-01")


def test_documents_of_commands_are_imported(archive, edge_record, tmp_path):
    """One measurement, all edges of a target, several methods, several regions, lists of them."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)
    scene = ac.simulate.site(sensor, np.random.default_rng(3))
    every = ac.measure_edges(scene.image, gsd_m=0.7)
    target = report.document(every)
    regions = {
        "schema": "acutance/regions/1",
        "results": [{"region": "north", **edge_record.document}],
        "rejected": [{"stage": "measurement", "reason": "no edge", "values": {"region": "south"}}],
    }
    (tmp_path / "one.json").write_text(report.json_text(edge_record.document), encoding="utf-8")
    (tmp_path / "target.json").write_text(report.json_text(target), encoding="utf-8")
    (tmp_path / "regions.json").write_text(report.json_text(regions), encoding="utf-8")
    (tmp_path / "list.json").write_text(
        json.dumps([edge_record.document, every.measurements[0].record.document]), encoding="utf-8"
    )
    (tmp_path / "lines.jsonl").write_text(
        "\n".join(json.dumps(one.to_dict()) for one in every.measurements), encoding="utf-8"
    )
    done = archive.import_documents(tmp_path, sensor="K3", acquired="2026-01-01")
    assert not done.refused
    rejected = len(every.rejected) + 1
    measured = 1 + 4 + 1
    assert done.new == measured + rejected
    assert archive.measurements(target="north")["target"].tolist() == ["north"]
    assert archive.rejected(target="south")["reason"].tolist() == ["no edge"]
    assert set(archive.measurements()["sensor"].tolist()) == {"K3"}
    assert archive.import_documents(tmp_path, sensor="K3", acquired="2026-01-01").new == 0


def test_measurements_of_a_target_have_the_band_and_region_of_their_target(
    archive, edge_record, tmp_path
):
    """With --all a result is a target, and its measurements and rejections have no marks."""
    other = {**edge_record.document, "measured_at": "2020-01-01T00:00:00+00:00"}
    lost = {"stage": "measurement", "reason": "no edge", "values": {"row": 3}}
    target = {"schema": "acutance/target/1", "measurements": [other], "rejected": [lost]}
    compared = {"schema": "acutance/comparison/1", "measurements": [other], "rejected": []}
    bands = {
        "schema": "acutance/bands/1",
        "results": [
            {"band": "red", "region": "north", **target},
            {"band": "nir", "region": "south", **compared},
        ],
        "rejected": [],
    }
    (tmp_path / "bands.json").write_text(json.dumps(bands), encoding="utf-8")
    archive.import_documents(tmp_path / "bands.json")
    rows, rejected = archive.measurements(), archive.rejected()
    assert set(zip(rows["band"], rows["target"], strict=True)) == {
        ("red", "north"), ("nir", "south"),
    }  # fmt: skip
    assert (rejected["band"].tolist(), rejected["target"].tolist()) == (["red"], ["north"])


def test_bad_files_stop_no_other(archive, edge_record, tmp_path):
    good = tmp_path / "good.json"
    good.write_text(json.dumps(edge_record.document), encoding="utf-8")
    bad = {
        "empty.json": b"",
        "cut.json": good.read_bytes()[:500],
        "other.json": b'{"schema": "else/1"}',
        "number.json": b"3",
        "damaged.json": json.dumps({**edge_record.document, "checks": 3}).encode(),
        "lines.jsonl": good.read_bytes() + b"\n{",
        "table.csv": b"a,b\n1,2\n",
        "table.parquet": b"PAR1",
        "binary.csv": b"\xff\xfe\x00",
    }
    for name, written in bad.items():
        (tmp_path / name).write_bytes(written)
    paths = [*(tmp_path / name for name in bad), tmp_path / "missing.json", good]
    done = archive.import_documents(paths)
    assert (done.read, done.new) == (2, 1)
    assert len(done.refused) == len(bad) + 1
    assert "line 2" in next(one for one in done.refused if "lines.jsonl" in one)
    assert "else/1" in done.refused[str(tmp_path / "other.json")]


def test_places_that_cannot_be_written(several, tmp_path):
    with pytest.raises(OptionError, match="no folder"):
        several.export(tmp_path / "none" / "out.jsonl", to="jsonl")
    with pytest.raises(OptionError, match="only jsonl"):
        several.export(tmp_path / "out.xls", to="xls")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OptionError, match="cannot be written"):
        several.export(tmp_path / "folder", to="jsonl")
    assert not list(tmp_path.glob("*.part"))


@pytest.fixture(scope="module")
def scene(few_forms):
    """A scan of a small landscape."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    image, _ = ac.simulate.landscape(
        sensor, shape=(300, 300), snr=100, rng=np.random.default_rng(1)
    )
    with few_forms():
        return ac.scan_scene(image, workers=1)


def test_scenes_are_kept(archive, scene):
    """A scan of a whole scene is a measurement of its own kind."""
    archive.add(scene, sensor="K3", acquired=datetime(2026, 1, 1) + timedelta(days=1))
    found = archive.measurements(kind="scene")
    assert found["orientation"].tolist() == ["across", "along"]
    assert found.record(0) == scene.record
    assert found["mtf_nyquist"][0] == pytest.approx(scene.across.mtf_nyquist.value)
