"""Means over images of which some were restored say so."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import acutance as ac
from acutance.archive import Archive, Entry
from acutance.archive.tables_by import table_by
from acutance.archive.trends.measured_series import all_series

NOTE = "DIM_1.XML: PAN_RESTORATION is true: the MTF is that of the restored product"


@pytest.fixture
def restored_of(entry_of: Any) -> Any:
    """Makes the entry of number i, in an image whose documents say that it was restored."""

    def make(i: int) -> Entry:
        entry: Entry = entry_of(i)
        return replace(entry, image=replace(entry.image, sensor="K3", sources={"notes": [NOTE]}))

    return make


@pytest.mark.parametrize(
    ("restored", "words"),
    [((), None), ((4,), "1 image of 2 was restored"), ((0, 4), "The images were restored")],
)
def test_means_over_restored_images_say_so(
    archive: Archive, entry_of: Any, restored_of: Any, restored: tuple[int, ...], words: str | None
) -> None:
    archive.add_entries([(restored_of if i in restored else entry_of)(i) for i in (0, 4)])
    rows = archive.measurements()
    (series,) = all_series(rows, "mtf_nyquist")
    for notes in (series.notes, table_by(rows, ["sensor"]).notes):
        found = [one for one in notes if "restored" in one]
        assert len(found) == (words is not None)
        assert words is None or found[0].startswith(words)


def test_a_document_of_a_restored_image_is_kept_with_a_note(
    archive: Archive, edge_record: ac.Record
) -> None:
    image = {**edge_record.document["image"], "restored": "wiener kernel"}
    document = {**edge_record.document, "image": image}
    archive.add(ac.Record(document), sensor="S")
    archive.add(edge_record, sensor="S", band="other")
    assert archive.measurements()["restored"].tolist() == [True, False]
    notes = [entry.image.sources.get("notes") for entry in archive.entries()]
    assert notes == [["restored by wiener kernel: the MTF is that of the restored product"], None]
