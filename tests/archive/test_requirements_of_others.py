"""A requirement of one sensor asks nothing of another."""

from __future__ import annotations

import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from acutance.archive import Archive, ImageEntry
from acutance.archive.requirement_selection import asked_of
from acutance.archive.specification import Specification
from acutance.errors import NothingSelectedError
from acutance.report.archive import sensor_page

K3_ALONE = {"metric": "mtf_nyquist", "minimum": 0.0123, "sensor": "K3", "name": "of K3"}
BOTH = {"metric": "rer", "minimum": 0.1, "sensor": ["K3", "QB02"], "name": "of both"}


@pytest.fixture
def kept(tmp_path: Path, entry_of: Any) -> Archive:
    """Six images of each of two sensors."""
    made = Archive(tmp_path / "kept.db")
    for at in range(12):
        day = datetime(2024, 1, 1, 10, tzinfo=UTC) + timedelta(days=20 * at)
        sensor = "QB02" if at % 2 else "K3"
        image = ImageEntry(path=f"{at}.tif", content=f"{at:064x}", sensor=sensor, acquired=day)
        made.add_entries([entry_of(at, image=image)])
    return made


def specification(*requirements: dict[str, Any]) -> Specification:
    return Specification.of({"requirement": list(requirements)})


def test_names_of_requirement_and_selection_are_those_of_both() -> None:
    stated = specification(K3_ALONE, BOTH, {"metric": "rer", "minimum": 0.1})
    found = asked_of(stated, {"sensor": ["QB02", "X"], "verdict": "good"})
    assert [(one.name, words["sensor"]) for one, words in found] == [
        ("of both", "QB02"), ("", ["QB02", "X"]),
    ]  # fmt: skip
    assert [words["verdict"] for _, words in found] == ["usable", "usable"]


def test_a_check_of_a_sensor_leaves_out_requirements_of_others(kept: Archive) -> None:
    found = kept.check(specification(K3_ALONE, BOTH), sensor="QB02")
    assert {answer.requirement.name for answer in found.answers} == {"of both"}
    assert all(answer.what.startswith("QB02") for answer in found.answers)


def test_a_specification_that_asks_nothing_of_a_sensor_says_so(kept: Archive) -> None:
    with pytest.raises(NothingSelectedError, match=r"asks nothing of sensor 'QB02'.* of sensor K3"):
        kept.check(specification(K3_ALONE), sensor="QB02")
    with pytest.raises(NothingSelectedError, match="no sensor is called 'QB2'"):
        kept.check(specification(K3_ALONE), sensor="QB2")


def test_the_page_of_a_sensor_has_no_requirement_of_another(
    kept: Archive, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "spec.toml"
    path.write_text('[[requirement]]\nmetric = "mtf_nyquist"\nminimum = 0.0123\nsensor = "K3"\n')
    module = sys.modules["acutance.report.archive.sensor_page"]
    drawn: list[list[float]] = []
    plate = module.trend_plate
    monkeypatch.setattr(
        module, "trend_plate", lambda trend, limit: drawn.append(limit) or plate(trend, limit)
    )
    page = sensor_page(kept, "QB02", specification=path)
    assert "The specification asks nothing of sensor" in page
    assert "0.0123" not in page
    assert "0.0123" in sensor_page(kept, "K3", specification=path)
    assert drawn == [[], [0.0123]]
