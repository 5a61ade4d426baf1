"""``acutance bars``: simulated on the command line, every face, groups given, refusals."""

import csv
import json
import re

import numpy as np
import pytest


@pytest.fixture(scope="module")
def bars_image(tmp_path_factory):
    from typer.testing import CliRunner

    from acutance.cli.app import app

    path = tmp_path_factory.mktemp("bars") / "bars.tif"
    words = ["simulate", "bars", "--sensor", "gaussian", "--periods", "8,4,2.3", "--angle", "6",
             "--snr", "100", "--out", path]  # fmt: skip
    assert CliRunner().invoke(app, [str(word) for word in words]).exit_code == 0
    return path


def test_every_output(acutance, bars_image, shown, tmp_path, keeps_to_schema):
    files = [tmp_path / name for name in ("bars.png", "bars.html", "bars.csv")]
    result = acutance(
        "bars", bars_image, "--gsd", 0.5, "--json",
        "--figure", files[0], "--report", files[1], "--csv", files[2],
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    assert document["normal"]["mtf_nyquist"]["value"] == pytest.approx(0.29, abs=0.01)
    assert [group["count"] for group in document["groups"]] == [5, 5, 5]
    assert [(name, found.kind) for name, found, _ in shown] == [("draw", "bars"), ("page", "bars")]
    rows = list(csv.DictReader(files[2].read_text().splitlines()))
    assert {row["direction"] for row in rows} == {"across", "normal"}
    assert float(rows[-1]["freq_cpm"]) == pytest.approx(2.0)


def test_groups_given_are_those_found(acutance, bars_image):
    truth = json.loads(bars_image.with_suffix(".truth.json").read_text())
    given = []
    for group in truth["groups"]:
        row, col = np.mean(group["region"], axis=0)
        parts = (row, col, truth["normal_deg"], group["period_px"], group["count"], 24)
        given += ["--group", ",".join(f"{part:.2f}" for part in parts)]
    stated = acutance("bars", bars_image, *given, "--json")
    found = acutance("bars", bars_image, "--count", 5, "--json")
    assert (stated.exit_code, found.exit_code) == (0, 0)
    one, two = (json.loads(each.stdout)["normal"]["mtf_nyquist"] for each in (stated, found))
    assert one["value"] == pytest.approx(two["value"], abs=one["std"])


def test_text_and_strict(acutance, bars_image):
    result = acutance("bars", bars_image, "--limit", "finest_cpp=0.6", "--strict")
    assert result.exit_code == 3
    assert "direction of the normal" in result.stdout
    assert re.search(r"NOTE +finest_cpp", result.stdout)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--group", "1,2,3"), "write ROW,COL,ANGLE,PERIOD,COUNT,LENGTH"),
        (("--group", "20,20,6,8,2.5,24"), "write ROW,COL"),
        (("--group", "20,20,6,8,1,24"), "a single bar is a pulse"),
        (("--count", "1"), "a single bar is a pulse"),
        (("--bright", "3"), "dark and bright, or neither"),
        (
            ("--limit", "colour=3"),
            "no check 'colour' to limit (limits, --limit), only bar_directions",
        ),
    ],
)
def test_refusals(refused, bars_image, words, message):
    refused(("bars", bars_image, *words), message)


def test_pixels_without_bars_are_exit_4(refused, bars_image):
    refused(("bars", bars_image, "--roi", "0,0,12,12"), "no whole group", code=4)
