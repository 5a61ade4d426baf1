"""``acutance archive``: what is measured is added, listed, shown and exported."""

from __future__ import annotations

import json
import os

import pytest

from acutance.archive import Archive, Entry, ImageEntry, TargetEntry
from acutance.targets import Rejected


@pytest.fixture(scope="module")
def measured(acutance, edge_image, tmp_path_factory):
    """A document as the command prints it."""
    path = tmp_path_factory.mktemp("documents") / "edge.json"
    path.write_text(acutance("edge", edge_image, "--json").stdout, encoding="utf-8")
    return path


@pytest.fixture
def campaign(acutance, measured, tmp_path):
    """An archive of a measurement of May and one of June, and a rejection."""
    place = tmp_path / "campaign.db"
    known = ("--sensor", "QB02", "--band", "pan", "--target", "A tarp [bold] with a long name")
    acutance("archive", "import", place, measured, *known, "--acquired", "2026-05-01")
    known = ("--sensor", "K3", "--acquired", "2026-06-01T10:00:00+09:00")
    acutance("archive", "import", place, measured, *known, "--target", "Another")
    with Archive(place) as archive:
        rejected = Rejected("fit", "no edge stands out of the noise, " * 4, {})
        target = TargetEntry(name="Third", kind="edge")
        archive.add_entries(
            [Entry(rejected=rejected, image=ImageEntry(sensor="K3"), target=target)]
        )
    return place


def test_a_measurement_is_imported_once(acutance, measured, tmp_path):
    first = acutance("archive", "import", tmp_path / "a.db", measured, "--sensor", "QB02")
    assert (first.exit_code, first.stdout) == (0, "1 read, 1 new, 0 there already\n")
    again = acutance("archive", "import", tmp_path / "a.db", measured, "--json")
    assert json.loads(again.stdout) == {
        "schema": "acutance/archive-import/1", "read": 1, "new": 0, "refused": {},
    }  # fmt: skip


@pytest.mark.parametrize("width", [80, 120])
def test_lists_fit_the_terminal(acutance, campaign, monkeypatch, width):
    monkeypatch.setenv("COLUMNS", str(width))
    for words in (("list", campaign), ("list", campaign, "--rejected"), ("info", campaign)):
        shown = acutance("archive", *words)
        assert shown.exit_code == 0
        lines = shown.stdout.splitlines()
        assert max(map(len, lines[1 if words[0] == "info" else 0 :])) <= width
    shown = acutance("archive", "list", campaign).stdout
    assert "2026-05-01" in shown
    assert "FWHM [px]" in shown
    assert ("±" in shown) == (width == 120)


def test_lists_are_selected(acutance, campaign):
    def rows(*words):
        found = acutance("archive", "list", campaign, "--json", *words)
        return json.loads(found.stdout)["rows"], found.exit_code

    everything, code = rows()
    assert (len(everything), code) == (2, 0)
    assert everything[1]["acquired"] == "2026-06-01T01:00:00"
    (quickbird,), _ = rows(
        "--sensor", "QB02", "--band", "pan", "--kind", "edge", "--since", "2026-01-01"
    )
    assert quickbird["target"] == "A tarp [bold] with a long name"
    assert quickbird["mtf_nyquist"] == pytest.approx(0.28, abs=0.03)
    assert len(rows("--sensor", "QB02", "--sensor", "K3")[0]) == 2
    assert len(rows("--until", "2026-05-01", "--orientation", "across")[0]) == 1
    assert len(rows("--min", "rer=0.1", "--max", "rer=0.9", "--verdict", "usable")[0]) == 2
    assert rows("--min", "rer=0.9") == ([], 4)
    assert rows("--orientation", "along") == ([], 4)
    (rejected,), _ = rows("--rejected")
    assert rejected["stage"] == "fit"


def test_old_rows_are_counted(acutance, campaign):
    shown = acutance("archive", "list", campaign, "--last", "1")
    assert "QB02" not in shown.stdout
    assert "1 older ones not shown" in shown.stderr


def test_one_is_shown(acutance, campaign, measured):
    shown = acutance("archive", "show", campaign, "1").stdout
    for part in ("MTF at Nyquist", "band 1, rows 0–", "GSD 0.7 m", "° to the grid, measured 20"):
        assert part in shown
    assert "acquired  2026-05-01\n" in shown
    document = json.loads(acutance("archive", "show", campaign, "1", "--json").stdout)
    assert document == json.loads(measured.read_text(encoding="utf-8"))
    shown = acutance("archive", "show", campaign, "3").stdout
    assert shown.startswith("not measured (fit): no edge")
    assert json.loads(acutance("archive", "show", campaign, "3", "--json").stdout)["rejected"]
    missing = acutance("archive", "show", campaign, "9")
    assert (missing.exit_code, missing.stdout) == (4, "")


def test_stac_is_no_file(refused, campaign, tmp_path):
    out = tmp_path / "stac.JSON"
    words = ("archive", "export", campaign, "--to", "stac", out)
    refused(words, 'stac.JSON ends in ".json" as a file does, and stac is a folder')
    assert not out.exists()


@pytest.mark.parametrize("ending", ["jsonl", "ndjson", "parquet", "CSV"])
def test_the_ending_names_the_format(acutance, refused, campaign, tmp_path, ending):
    out = tmp_path / f"out.{ending}"
    assert acutance("archive", "export", campaign, out).exit_code == 0
    word = {"ndjson": "jsonl"}.get(ending, ending.lower())
    stated = tmp_path / f"stated.{ending}"
    assert acutance("archive", "export", campaign, stated, "--to", word).exit_code == 0
    assert out.read_bytes() == stated.read_bytes()
    refused(
        ("archive", "export", campaign, tmp_path / "folder"),
        "state the format (--to; of a folder stac)",
    )


@pytest.mark.parametrize("to", ["jsonl", "parquet", "csv", "stac"])
def test_exports_are_imported(acutance, campaign, tmp_path, to):
    out = tmp_path / (to if to == "stac" else f"out.{to}")
    words = ("--since", "2020-01-01", *(("--documents",) if to == "csv" else ()))
    done = acutance("archive", "export", campaign, out, "--to", to, *words)
    assert done.exit_code == 0, done.stderr
    again = acutance("archive", "import", tmp_path / "again.db", out)
    assert again.stdout == "2 read, 2 new, 0 there already\n"
    counts = json.loads(acutance("archive", "info", tmp_path / "again.db", "--json").stdout)
    assert (counts["measured"], counts["rejected"], counts["schema_version"]) == (2, 0, 2)
    assert [one["sensor"] for one in counts["sensors"]] == ["K3", "QB02"]


@pytest.mark.parametrize(
    "words",
    [
        ("list", "none.db"),
        ("list", "campaign.db", "--verdict", "excellent"),
        ("list", "campaign.db", "--since", "spring"),
        ("list", "campaign.db", "--since", "2026-02-01", "--until", "2026-01-01"),
        ("list", "campaign.db", "--min", "rer"),
        ("list", "campaign.db", "--min", "sharpness=2"),
        ("list", "campaign.db", "--orientation", "up"),
        ("list", "campaign.db", "--rejected", "--verdict", "good"),
        ("show", "campaign.db", "first"),
        ("export", "campaign.db", "out.txt", "--to", "csv"),
        ("export", "campaign.db", "out.xls", "--to", "xls"),
        ("export", "campaign.db", "out.parquet", "--to", "parquet", "--documents"),
        ("export", "campaign.db", "campaign.db", "--to", "jsonl"),
        ("import", "campaign.db", "none.json"),
        ("import", "campaign.db", "campaign.db"),
        ("import", "none/campaign.db", "none.json"),
    ],
)
def test_bad_usage_is_2_and_changes_nothing(acutance, campaign, words, monkeypatch):
    monkeypatch.chdir(campaign.parent)
    before = sorted(campaign.parent.iterdir())
    done = acutance("archive", *words)
    assert done.exit_code == 2
    assert done.stderr
    assert "Traceback" not in done.stderr
    assert sorted(campaign.parent.iterdir()) == before


def test_nothing_there_is_4(acutance, campaign, tmp_path):
    (tmp_path / "nothing.json").write_text("[]", encoding="utf-8")
    for words in (
        ("list", campaign, "--sensor", "QB0%"),
        ("export", campaign, tmp_path / "o.csv", "--to", "csv", "--sensor", "_"),
        ("import", campaign, tmp_path / "nothing.json"),
    ):
        assert acutance("archive", *words).exit_code == 4
    assert not (tmp_path / "o.csv").exists()


def test_an_image_is_corrected(acutance, campaign, tmp_path):
    name = json.loads(acutance("archive", "list", campaign, "--json").stdout)["rows"][0]["image"]
    words = ("archive", "correct", campaign, "--image", f"{name[:-3]}*", "--level", "L1R")
    told = acutance(*words, "--gsd", ".72,.7", "--dry-run")
    assert told.exit_code == 0
    assert "2 images would be corrected" in told.stdout
    assert acutance("archive", "list", campaign, "--level", "L1R").exit_code == 4
    done = acutance(*words, "--gsd", ".72,.7", "--reason", "header", "--json")
    images = json.loads(done.stdout)["images"]
    assert [one["changes"]["gsd_row_m"][1] for one in images] == [0.72, 0.72]
    assert acutance("archive", "list", campaign, "--level", "L1R").exit_code == 0
    table = tmp_path / "corrections.csv"
    table.write_text(f"image,sensor\n{name[:-3]}*,K9\n")
    assert "level" not in acutance("archive", "correct", campaign, "--from", table).stdout
    assert acutance("archive", "list", campaign, "--sensor", "K9").exit_code == 0


def test_one_image_is_one_image(acutance, measured, tmp_path):
    acutance("archive", "import", tmp_path / "a.db", measured)
    done = acutance("archive", "correct", tmp_path / "a.db", "--image", "*", "--sensor", "K8")
    assert done.stdout.endswith("(1 measurement)\n1 image corrected\n")
    help_text = acutance("archive", "correct", "--help").stdout
    assert "of the view from the vertical" in " ".join(help_text.split())


def test_corrections_that_cannot_be(acutance, campaign):
    assert acutance("archive", "correct", campaign).exit_code == 2
    assert acutance("archive", "correct", campaign, "--image", "x.tif").exit_code == 2
    done = acutance("archive", "correct", campaign, "--image", "x.tif", "--sensor", "S")
    assert done.exit_code == 2
    assert "no image x.tif" in done.stderr
    done = acutance("archive", "correct", campaign, "--from", "x.csv", "--sensor", "S")
    assert "give it alone" in done.stderr
    done = acutance("archive", "correct", campaign, "--image", "x.tif", "--gsd", "a")
    assert "--gsd a" in done.stderr


def test_an_import_of_nothing_makes_no_archive(acutance, tmp_path):
    place, text = tmp_path / "new.db", tmp_path / "text.json"
    text.write_text("no JSON")
    done = acutance("archive", "import", place, text, tmp_path / "missing.csv")
    assert done.exit_code == 2
    assert "text.json: it is no JSON" in done.stderr
    assert "missing.csv: No such file" in done.stderr
    assert not place.exists()


def test_what_is_no_json_at_all_was_not_cut(acutance, tmp_path):
    image, cut = tmp_path / "image.tif", tmp_path / "cut.json"
    image.write_bytes(b"II*\x00\xff\xfe")
    cut.write_text('{"schema": "acutance/meas')
    done = acutance("archive", "import", tmp_path / "new.db", image, cut, tmp_path / "no.parquet")
    assert "image.tif: it is no JSON: give what a measuring command printed" in done.stderr
    assert "cut.json: it is no JSON (" in done.stderr
    assert "was it cut?" in done.stderr
    assert "no.parquet: No such file or directory" in done.stderr
    assert "is no Parquet" not in done.stderr


@pytest.mark.parametrize("words", [("list",), ("trend",), ("export", "out.csv")])
def test_an_empty_archive_is_called_empty(acutance, tmp_path, words):
    place = tmp_path / "empty.db"
    with Archive(place):
        pass
    done = acutance("archive", words[0], place, *words[1:])
    assert done.exit_code == 4
    assert "is empty: add measurements to it (acutance archive import" in done.stderr


def test_an_empty_file_is_no_archive(acutance, tmp_path):
    place = tmp_path / "image.tif"
    place.touch()
    os.utime(place, (1, 1))
    for words in (("info", place), ("import", place, tmp_path)):
        done = acutance("archive", *words)
        assert done.exit_code == 2
        assert "is no archive: the file is empty" in done.stderr
    assert place.stat().st_size == 0


def test_images_are_listed_and_reasons_are_not_cut(acutance, tmp_path, measured, monkeypatch):
    place = tmp_path / "undated.db"
    reason = "the target lies outside the image: " + ", ".join(f"word {i}" for i in range(40))
    image = ImageEntry(path="/images/field-of-may.tif")
    assert acutance("archive", "import", place, measured).exit_code == 0
    with Archive(place) as archive:
        archive.add_entries([Entry(rejected=Rejected("region", reason, {}), image=image, key="a")])
    for width in ("80", "130"):
        monkeypatch.setenv("COLUMNS", width)
        assert "edge.tif" in acutance("archive", "list", place).stdout
        shown = acutance("archive", "list", place, "--rejected").stdout
        assert "field-of-may.tif" in shown
        assert "word 39" in " ".join(shown.split())
