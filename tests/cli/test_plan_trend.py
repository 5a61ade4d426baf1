"""acutance plan trend: text, JSON, table and figure, with and without an archive."""

from __future__ import annotations

import csv
import json

import pytest


def test_a_watch_is_planned(acutance, tmp_path):
    table, drawing = tmp_path / "plan.csv", tmp_path / "plan.png"
    done = acutance("plan", "trend", "--images", "12,24", "--drift", "-1%", "--draws", "0",
                    "--csv", str(table), "--figure", str(drawing))  # fmt: skip
    assert done.exit_code == 0
    for part in ("scatter between images 4 %", "by theory alone",
                 "12 images a year do not notice -1 % a year within 5 years",
                 "24 images a year notice -1 % a year after about 4.3 years"):  # fmt: skip
        assert part in done.stdout
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [row["images"] for row in rows] == ["12", "24", "36", "60", "24", "48", "72", "120"]
    assert drawing.read_bytes().startswith(b"\x89PNG")


def test_trends_of_simulated_images_are_asked(acutance):
    done = acutance("plan", "trend", "--years", "2", "--scatter", ".01", "--std", "1%", "--drift",
                    "10%", "--draws", "10", "--workers", "1")  # fmt: skip
    assert done.exit_code == 0
    assert "by trends of 10 simulated series each" in done.stdout
    assert "12 images a year notice 10 % a year after 2 years or sooner" in done.stdout
    assert "100 %" in done.stdout


def test_a_deviation_below_the_best_of_a_line_is_explained(acutance):
    """Of six images a trend states less than a line can know: it expects small drifts."""
    words = "; of few images trends take a drift to be small, and state less"
    for images, is_told in (("6", True), ("48", False)):
        done = acutance("plan", "trend", "--images", images, "--years", "1", "--draws", "10",
                        "--drift", "12%", "--workers", "1")  # fmt: skip
        assert (words in done.stdout) is is_told


def test_an_archive_says_what_its_images_are_like(acutance, place):
    one = ["--archive", place, "--metric", "rer", "--sensor", "KOMPSAT-3", "--orientation",
           "across"]  # fmt: skip
    done = acutance("plan", "trend", *one, "--years", "2", "--draws", "0")
    assert "12 images of the last" in done.stdout
    done = acutance("plan", "trend", *one, "--scatter", "3%", "--draws", "0", "--json")
    document = json.loads(done.stdout)
    assert document["options"]["scatter"] == 0.03
    assert len(document["options"]["earlier"]) == 12
    assert document["designs"][0]["std"] is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--sensor", "QB02"], "need the archive: add --archive"),
        (["--metric", "rer"], "need the archive: add --archive"),
        (["--images", "many"], "--images many: write numbers with commas"),
        (["--scatter", "much"], "--scatter much: write a share of the level"),
        (["--years", "0.1"], "a pace of 12 a year over 0.1 years gives 1 image: a trend"),
        (["--draws", "5"], "draws is 5: give 10 or more"),
        (["--archive", "none.db"], "none.db"),
    ],
)
def test_what_cannot_be_planned_is_refused(refused, words, message):
    refused(["plan", "trend", *words], message)


def test_a_single_year_is_no_years(acutance):
    done = acutance("plan", "trend", "--years", "1", "--draws", 0)
    assert "do not notice 1 % a year within 1 year (the least is" in done.stdout
