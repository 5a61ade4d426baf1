"""Rows as columns: for notebooks, pandas and xarray, and what is refused."""

from __future__ import annotations

import csv
import io
import re
import sys
from datetime import datetime

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Entry, ImageEntry, TargetEntry
from acutance.errors import OptionError
from acutance.report.archive.sensor_tables import images_table
from acutance.targets import Rejected


@pytest.fixture
def filled(archive, entry_of):
    archive.add_entries([entry_of(i) for i in range(6)])
    archive.add_entries([entry_of(7, image=ImageEntry(path="<b>undated</b>.tif"))])
    return archive


def test_columns_are_written_as_csv(filled):
    rows = filled.measurements()
    table = filled.table(by=("sensor",), metrics=("rer",))
    read = list(csv.DictReader(io.StringIO(rows.to_csv())))
    assert tuple(read[0]) == rows.names
    assert [float(one["rer"]) for one in read] == rows["rer"].tolist()
    assert [int(one["id"]) for one in read] == rows["id"].tolist()
    known = [one["acquired"] or None for one in rows.rows()]
    written = [datetime.fromisoformat(one["acquired"]) if one["acquired"] else None for one in read]
    assert written == known
    # What is not known is empty, and so is what a row of means does not hold.
    for name in rows.names:
        for one, row in zip(read, rows.rows(), strict=True):
            assert (one[name] == "") == (row[name] is None or row[name] == "")
    mean, *_ = csv.DictReader(io.StringIO(table.to_csv()))
    row = table.rows[0]
    for (orientation, metric), estimate in row.cells.items():
        name = f"{metric}_{orientation}"
        assert float(mean[name]) == estimate.value
        assert float(mean[f"{name}_std"]) == estimate.std
        assert int(mean[f"{name}_count"]) == row.counts[orientation, metric]
    assert (mean["sensor"], mean["images"]) == (row.group[0], str(row.images))


def test_rows_are_the_oldest_first_and_what_has_no_date_last(filled):
    found = filled.measurements()
    assert np.isnat(found["acquired"]).tolist() == [False] * 6 + [True]
    assert (np.diff(found["acquired"][:6]) >= np.timedelta64(0)).all()
    assert sorted(found["mtf_nyquist"].tolist()[:2]) == [0.1, 0.101]
    assert found["mtf_nyquist"][-1] == pytest.approx(0.107)
    assert found["sensor"].tolist()[-1] is None
    assert len(set(found["image_id"].tolist())) == 4


def test_rows_of_one_content_are_one_image_whatever_is_selected(archive, entry_of):
    """Measured under one path and refused under another it was two images, and listed twice."""
    content = f"{5:064x}"
    first, second = (ImageEntry(path=f"/{one}/s.tif", content=content) for one in "ab")
    measured, other = entry_of(1, image=first), entry_of(2, image=second)
    refused = Entry(
        rejected=Rejected("fit", "no edge", {}), image=second,
        target=TargetEntry(name="u", kind="edge"), key="refused",
    )  # fmt: skip
    archive.add_entries([measured, refused, other])
    (number,) = set(archive.measurements()["image_id"].tolist())
    assert archive.rejected()["image_id"].tolist() == [number]
    assert archive.measurements(image="/b/s.tif")["image_id"].tolist() == [number]
    (row,) = images_table(archive.measurements(), archive.rejected()).rows
    assert row[-1] == "1"


def test_filters(filled):
    def count(**words):
        return len(filled.measurements(**words))

    assert count(sensor="K3") == 4
    assert count(sensor=["K3", "QB02"]) == 6
    assert count(sensor="k3") == count(sensor="K%") == count(sensor="_3") == count(sensor=[]) == 0
    assert count(target="tarp 1", site="Stennis", band="pan", kind="edge", method="spline") == 4
    assert count(image="0.tif") == count(image="/images/0.tif") == count(image=f"{0:064x}") == 2
    assert count(since="2026-01-02", until="2026-01-02") == 2
    assert count(limits={"mtf_nyquist": (0.101, 0.1035), "rer": (None, 2.0)}) == 3
    assert count(verdict="good") <= count(verdict="invalid") == 7
    assert count(sensor="K3' OR '1'='1") == 0
    assert count(sensor=[str(i) for i in range(40_000)]) == 0


def test_names_of_many_images_at_once(filled):
    assert len(filled.keys(images=[f"{i:064x}" for i in range(40_000)])) == 6


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"senser": "K3"}, "there are sensor, band"),
        ({"sensor": 5}, "as texts"),
        ({"sensor": [5]}, "as texts"),
        ({"verdict": "excellent"}, "one of good"),
        ({"orientation": "up"}, "across or along"),
        ({"limits": {"rer": 0.4}}, "least and the largest"),
        ({"limits": {"rer": ("a", None)}}, "least and the largest"),
        ({"limits": {"sharpness": (0, 1)}}, "no metric"),
        ({"since": "2026-02-01", "until": "2026-01-01"}, "later than"),
        ({"since": "spring"}, "no date"),
    ],
)
def test_filters_that_mean_nothing(filled, words, message):
    with pytest.raises(OptionError, match=message):
        filled.measurements(**words)


def test_frames_have_all_columns(filled):
    found = filled.measurements()
    frame, data = found.to_pandas(), found.to_xarray()
    assert list(frame.columns) == list(found.names)
    assert frame["mtf_nyquist"].tolist() == found["mtf_nyquist"].tolist()
    assert str(frame["acquired"].dtype) == "datetime64[us]"
    assert data["rer"].values.tolist() == found["rer"].tolist()
    assert data.sizes["row"] == 7
    assert filled.measurements(sensor="none").to_pandas().shape == (0, len(found.names))
    assert filled.rejected().to_pandas().empty


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_missing_libraries_are_asked_for(filled, monkeypatch, library):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(OptionError, match=rf"pip install 'acutance\[{library}\]'"):
        getattr(filled.measurements(), f"to_{library}")()


@pytest.mark.parametrize(("library", "to"), [("pyarrow", "parquet"), ("pystac", "stac")])
def test_missing_libraries_of_formats_are_asked_for(filled, monkeypatch, tmp_path, library, to):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(OptionError, match=rf"needs {library}, .*\[{to}\]"):
        filled.export(tmp_path / "out", to=to, since="2020-01-01")


def test_notebooks_show_a_table_without_markup_of_others(filled, entry_of):
    shown = filled.measurements()._repr_html_()
    assert shown.count("<tr>") == 8
    assert "7 measurements, 7 rows, K3, QB02" in shown
    assert "2026-01-01T10:00:00" in shown
    rejected = ac.Rejected("fit", "<script>", {})
    filled.add_entries([entry_of(0, record=None, rejected=rejected)])
    shown = filled.rejected()._repr_html_()
    assert "&lt;script&gt;" in shown
    assert "<script>" not in shown


def test_a_column_that_is_not_there(filled):
    with pytest.raises(OptionError, match="no column 'sharpness', only id, sensor"):
        filled.measurements()["sharpness"]


@pytest.mark.parametrize("row", [999, -8, "a", 1.5, slice(0, 1), None])
def test_a_row_that_is_not_there(filled, row):
    wanted = rf"row {re.escape(repr(row))} was requested of 7 rows, numbered from 0"
    with pytest.raises(OptionError, match=wanted):
        filled.measurements().record(row)
    assert filled.measurements().record(-1) == filled.measurements().record(6)


def test_one_entry_and_all(filled, entry_of):
    found = list(filled.entries(sensor="QB02"))
    assert len(found) == 2
    number = int(filled.measurements(sensor="QB02")["id"][0])
    assert filled.entry(number).record == filled.measurements(sensor="QB02").record(0)
    assert filled.entry(number).target == entry_of(2).target
    assert filled.entry(number).image == entry_of(2).image
    with pytest.raises(OptionError, match="no measurement 99"):
        filled.entry(99)


def test_names_have_to_be_texts(edge_record):
    for make in (
        lambda: ImageEntry(sensor=5),
        lambda: TargetEntry(name=3, kind="edge"),
        lambda: Entry(record=edge_record, band=4),
        lambda: Entry(record=edge_record, key=""),
    ):
        with pytest.raises(OptionError):
            make()


def test_numbers_of_numpy_are_kept_as_numbers(archive, entry_of, edge_record):
    values = {"one": np.float64(2.5), "two": np.int64(3), "many": np.array([1, 2]), "when": None}
    archive.add_entries([
        entry_of(0, record=None, rejected=ac.Rejected("fit", "why", values)),
        entry_of(1, record=ac.Record({**edge_record.document, "note": np.arange(2)})),
    ])  # fmt: skip
    assert archive.rejected()["values"][0] == {"one": 2.5, "two": 3, "many": [1, 2], "when": None}
    assert archive.measurements().record(0).document["note"] == [0, 1]
