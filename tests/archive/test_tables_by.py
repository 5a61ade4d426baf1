"""Tables of means: what they count, and whose deviations stand in a column."""

from __future__ import annotations

from typing import Any

import pytest

import acutance as ac
from acutance.archive import Archive, ImageEntry

BY_TARGET = (("target",), ("mtf_nyquist",))


@pytest.fixture
def filled(archive: Archive, edge_record: ac.Record, entry_of: Any) -> Archive:
    """Of one sensor: tarp 0 across in two images and along in a third; tarp 1 in one of the two."""
    turned = ac.Record(
        {**edge_record.document, "orientation": "along", "measured_directions": ["along"]}
    )
    archive.add_entries([entry_of(0), entry_of(4), entry_of(8, record=turned), entry_of(5)])
    return archive


def test_images_are_those_of_the_direction(filled: Archive) -> None:
    """The mean across of all is one of two images, not of the three of both directions."""
    table = filled.table(*BY_TARGET)
    assert [row.images for row in table.rows] == [3, 1, 3]
    assert table.rows[-1].images_by == {"across": 2, "along": 1}
    assert table.header[:4] == ("target", "images across", "images along", "GSD [m]")
    assert [text[1:3] for text in table.texts()] == [("2", "1"), ("1", "0"), ("2", "1")]
    across = table.of_direction("across")
    assert across.header == ("target", "images", "GSD [m]", "mtf_nyquist across")
    assert [text[1] for text in across.texts()] == ["2", "1", "2"]
    assert table.to_dict()["rows"][0]["images_by_direction"] == {"across": 2, "along": 1}


def test_deviations_of_single_measurements_are_marked_among_those_of_means(filled: Archive) -> None:
    across = filled.table(*BY_TARGET).of_direction("across")
    mean, single, average = (text[-1] for text in across.texts())
    assert single.startswith("*")
    assert not mean.startswith("*")
    assert not average.startswith("*")
    assert "Student's t" in across.notes[0]
    assert across.notes[1].startswith("* one measurement")
    assert [row["across"]["mtf_nyquist"]["count"] for row in across.to_dict()["rows"]] == [2, 1, 3]


def test_a_column_of_one_kind_has_no_marks(filled: Archive) -> None:
    singles = filled.table(("image", "target"), ("mtf_nyquist",), target="tarp 1")
    assert singles.notes == ()
    assert not any("*" in cell for text in singles.texts() for cell in text)
    means = filled.table(("sensor",), ("mtf_nyquist",), target="tarp 0", orientation="across")
    assert len(means.notes) == 1
    assert not any("*" in cell for text in means.texts() for cell in text)


def test_means_of_several_methods_are_told_to_be_that(
    filled: Archive, edge_record: ac.Record, entry_of: Any
) -> None:
    """Methods differ by what they are, which stands in the mean of both and in its scatter."""
    other = ac.Record({**edge_record.document, "method": "sdsu-2005"})
    filled.add_entries([entry_of(12, record=other)])
    mixed = filled.table()
    (note,) = (one for one in mixed.notes if "methods" in one)
    assert "by 2 methods stand in these means together (edge sdsu-2005, edge spline)" in note
    assert "--by site,date,method" in note
    assert note in mixed.to_dict()["notes"]
    for parted in (filled.table(("target", "method")), filled.table(method="spline")):
        assert not any("methods" in one for one in parted.notes)


def test_the_gsd_of_a_direction_is_its_own(
    archive: Archive, edge_record: ac.Record, entry_of: Any
) -> None:
    """Pixels that are 0.7 m across and 0.8 m along: no table across says 0.7 to 0.8 m."""
    sides_m = {"across": 0.7, "along": 0.8}
    for number, (direction, gsd_m) in enumerate(sides_m.items()):
        edge = {"orientation": direction, "measured_directions": [direction], "gsd_m": gsd_m}
        record = ac.Record({**edge_record.document, **edge})
        archive.add_entries([entry_of(number, record=record)])
    table = archive.table(("sensor",), ("mtf_nyquist",))
    assert table.rows[0].gsd_m == (0.7, 0.8)
    for direction, gsd_m in sides_m.items():
        (row,) = table.of_direction(direction).rows
        assert row.gsd_m == (gsd_m, gsd_m)
        assert [text[2] for text in table.of_direction(direction).texts()] == [f"{gsd_m}"]


def test_images_of_one_file_name_are_rows_of_their_own(filled: Archive, entry_of: Any) -> None:
    other = ImageEntry(path="/images/elsewhere/0.tif", content="f" * 64, sensor="K3")
    filled.add_entries([entry_of(0, image=other)])
    rows = filled.measurements(sensor="K3")
    numbers = sorted(set(rows["image_id"][rows["image"] == "0.tif"].tolist()))
    table = filled.table(("image",), ("mtf_nyquist",), sensor="K3")
    own = [row for row in table.rows if not row.is_average]
    assert [row.group for row in own[:2]] == [(f"0.tif (image_id {one})",) for one in numbers]
    assert [row.images for row in own] == [1] * len(own)
