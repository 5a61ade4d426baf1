"""acutance archive trend, check, table: text, JSON and exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from acutance.archive.trends import Trend

ONE = ["--sensor", "KOMPSAT-3", "--orientation", "across"]


def spec_file(folder: Path, *requirements: str) -> str:
    path = folder / "spec.toml"
    path.write_text("".join(f'[[requirement]]\nmetric = "rer"\n{one}\n' for one in requirements))
    return str(path)


def test_a_trend_in_words(acutance, place):
    done = acutance("archive", "trend", place, "--metric", "rer", *ONE, "--limit", "0.35",
                    "--event", "2014-02-01=refocus")  # fmt: skip
    assert done.exit_code == 0
    for part in ("RER of KOMPSAT-3, across", "drift a year", "2014-02-01 refocus",
                 "The sensor's mean does not fall below 0.35"):  # fmt: skip
        assert part in done.stdout
    done = acutance("archive", "trend", place, "--metric", "rer", *ONE)
    assert "Bad days: 2014-01-17" in done.stdout


def test_a_trend_as_json_is_read_back(acutance, place):
    done = acutance("archive", "trend", place, "--metric", "rer", *ONE, "--limit", ".4", "--json")
    document = json.loads(done.stdout)
    assert document["crossing"]["limit"] == 0.4
    assert Trend.from_dict(document).images.images == 12


def test_what_is_to_know_of_the_images_stands_once_below_the_answers(acutance, place, tmp_path):
    spec = spec_file(tmp_path, "minimum = 0.35", "minimum = 0.36")
    done = acutance("archive", "check", place, "--spec", spec, "--sensor", "KOMPSAT-3")
    assert done.stdout.count("is met (") == 4
    assert done.stdout.count("No band is named") == 1
    assert "\nnote: No band is named" in done.stdout


def test_what_is_no_series_is_refused(acutance, place):
    done = acutance("archive", "trend", place, "--metric", "rer")
    assert done.exit_code == 2
    assert "of 2 orientations, across, along: select one" in done.stderr
    assert acutance("archive", "trend", place, "--sensor", "other").exit_code == 4
    done = acutance("archive", "trend", place, *ONE, "--event", "refocus")
    assert done.exit_code == 2
    assert "write DATE=NAME" in done.stderr
    done = acutance("archive", "trend", place, *ONE, "--event", "soon=refocus")
    assert done.exit_code == 2


@pytest.mark.parametrize(
    ("limit", "strict", "code"),
    [("minimum = 0.35", [], 0), ("minimum = 0.5", [], 3), ("minimum = 0.43", [], 0),
     ("minimum = 0.43", ["--strict"], 3)],
)  # fmt: skip
def test_exit_codes_of_a_specification(acutance, place, tmp_path, limit, strict, code):
    spec = spec_file(tmp_path, f'{limit}\norientation = "across"')
    done = acutance("archive", "check", place, "--spec", spec, *strict)
    assert done.exit_code == code
    assert "KOMPSAT-3, across: rer >= 0." in done.stdout


def test_a_specification_as_json(acutance, place, tmp_path):
    spec = spec_file(tmp_path, "minimum = 0.35", "maximum = 0.3")
    done = acutance("archive", "check", place, "--spec", spec, "--json")
    assert done.exit_code == 3
    document = json.loads(done.stdout)
    assert document["word"] == "not met"
    assert [one["word"] for one in document["answers"]] == ["met", "met", "not met", "not met"]


def test_a_wrong_specification_is_refused(acutance, place, tmp_path):
    spec = spec_file(tmp_path, "minimum = 0.3\nfoo = 1")
    done = acutance("archive", "check", place, "--spec", spec)
    assert done.exit_code == 2
    assert "requirement 1, foo: is no key" in done.stderr


def test_tables(acutance, place):
    done = acutance("archive", "table", place, "--by", "site,date,target")
    assert done.exit_code == 0
    assert "Salon    2013-06-25  checkerboard, edge 1" in done.stdout
    assert "average" in done.stdout
    done = acutance("archive", "table", place, "--by", "site", "--metric", "fwhm_m", "--json")
    rows = json.loads(done.stdout)["rows"]
    assert [row["site"] for row in rows] == ["Penghu", "Salon", "Stennis", "average"]
    assert rows[-1]["across"]["fwhm_m"]["value"] == pytest.approx(0.7 * 1.631, abs=1e-3)
    assert acutance("archive", "table", place, "--by", "moon").exit_code == 2


def test_across_and_along_are_compared(acutance, place):
    done = acutance("archive", "compare", place, "--metric", "rer", "--metric", "fwhm_px")
    assert done.exit_code == 0
    first, second = done.stdout.splitlines()
    assert first.startswith("KOMPSAT-3: across is sharper than along by ")
    assert "(FWHM, 95 %: " in second
    done = acutance("archive", "compare", place, "--metric", "rer", "--metric", "fwhm_px", "--json")
    assert [one["metric"] for one in json.loads(done.stdout)["comparisons"]] == ["rer", "fwhm_px"]
    done = acutance("archive", "compare", place, "--json", "--metric", "rer")
    answer = json.loads(done.stdout)["comparisons"][0]["differences"][0]
    assert answer["answer"] == "differ"
    assert answer["images"] == [12, 12]


def test_what_cannot_be_compared(acutance, place):
    done = acutance("archive", "compare", place, "--by", "method")
    assert done.exit_code == 4
    assert "acutance: there are no two methods to be compared: " in done.stderr
    assert "all measurements are of one method, edge published; add measurements" in done.stderr
    done = acutance("archive", "compare", place, "--by", "band", "--json")
    assert done.exit_code == 4
    assert json.loads(done.stdout)["comparisons"][0]["groups"] == []
    assert "no measurement has mtf_nyquist and a known band" in done.stderr
    assert acutance("archive", "compare", place, "--by", "moon").exit_code == 2
    assert acutance("archive", "compare", place, "--sensor", "other").exit_code == 4
