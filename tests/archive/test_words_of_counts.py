"""Counts, averages and undated images in words and numbers that are true of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import acutance as ac
from acutance.archive import Archive, Entry, ImageCorrection
from acutance.targets import Rejected


def _rejection(entry: Entry) -> Entry:
    return replace(entry, record=None, rejected=Rejected("fit", "too dark", {}), key=None)


def test_run_numbers_are_whole(tmp_path: Path, entry_of: Any) -> None:
    with Archive(tmp_path / "a.db") as made:
        run = made.start_run({})
        made.add_entries([entry_of(0)], run=run)
        made.add_entries([entry_of(1), _rejection(entry_of(2))])
        runs = [row["run"] for row in made.measurements().rows()]
        assert json.dumps(runs) == f"[{run}, null]"
        assert [row["run"] for row in made.rejected().rows()] == [None]


def test_a_correction_counts_measurements_and_rejections(tmp_path: Path, entry_of: Any) -> None:
    with Archive(tmp_path / "a.db") as made:
        made.add_entries([entry_of(0), _rejection(entry_of(1))])
        (found,) = made.correct_images([ImageCorrection(image="0.tif", sensor="X")])
    assert found.summary.endswith("(1 measurement, 1 rejection)")


def test_an_average_of_one_target_is_left_out(
    tmp_path: Path, entry_of: Any, bars_record: ac.Record
) -> None:
    """Targets seen in one direction alone: its average repeated its only row."""
    with Archive(tmp_path / "a.db") as made:
        made.add_entries([entry_of(0), entry_of(1, record=bars_record)])
        table = made.table(("target",), ("rer",), verdict="invalid")
    assert [row.is_average for row in table.of_direction("along").rows] == [False]
    assert [row.is_average for row in table.of_direction("across").rows] == [False, False, True]


def test_a_catalogue_leaves_out_images_without_a_date(tmp_path: Path, entry_of: Any) -> None:
    undated = replace(entry_of(2).image, acquired=None)
    with Archive(tmp_path / "a.db") as made:
        made.add_entries([entry_of(0), entry_of(2, image=undated)])
        assert made.export(tmp_path / "stac", to="stac") == 1
