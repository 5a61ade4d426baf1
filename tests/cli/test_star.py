"""``acutance star``: simulated on the command line, every face, limits and refusals."""

import csv
import json
import re

import pytest


@pytest.fixture(scope="module")
def star_image(tmp_path_factory):
    from typer.testing import CliRunner

    from acutance.cli.app import app

    path = tmp_path_factory.mktemp("star") / "star.tif"
    words = ["simulate", "star", "--sensor", "gaussian", "--wave", "square", "--radius", "40",
             "--size", "92,92", "--snr", "100", "--out", path]  # fmt: skip
    assert CliRunner().invoke(app, [str(word) for word in words]).exit_code == 0
    return path


LEVELS = ("--wave", "square", "--dark", 200, "--bright", 1200, "--level-std", 1)


def test_every_output(acutance, star_image, shown, tmp_path, keeps_to_schema):
    files = [tmp_path / name for name in ("star.png", "star.html", "star.csv")]
    result = acutance(
        "star", star_image, *LEVELS, "--gsd", 0.5, "--json",
        "--figure", files[0], "--report", files[1], "--csv", files[2],
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    assert document["mean"]["mtf_nyquist"]["value"] == pytest.approx(0.29, abs=0.01)
    assert document["options"]["wave"] == "square"
    assert [(name, found.kind) for name, found, _ in shown] == [("draw", "star"), ("page", "star")]
    rows = list(csv.DictReader(files[2].read_text().splitlines()))
    assert {row["direction"] for row in rows} == {"across", "along", "mean"}
    nyquist = next(r for r in rows if r["direction"] == "mean" and r["freq_cpp"] == "0.50")
    # Written with six digits.
    value = document["mean"]["mtf_nyquist"]["value"]
    assert float(nyquist["mtf"]) == pytest.approx(value, rel=2e-6)
    assert all(len(row) == 7 for row in rows)


def test_text_and_strict(acutance, star_image):
    result = acutance("star", star_image, "--wave", "square", "--cycles", "count", "--strict")
    assert result.exit_code == 3
    assert "36 cycles, a full turn" in result.stdout
    assert re.search(r"NOTE +level", result.stdout)
    loose = acutance("star", star_image, "--wave", "square", "--strict", "--limit", "level=0.2",
                     "--limit", "rim_cpp=0.2")  # fmt: skip
    assert loose.exit_code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--cycles", "many"), "write a whole number, or count"),
        (("--centre", "5"), "write ROW,COL"),
        (("--wave", "saw"), "'sine' or 'square'"),
        (("--dark", "3"), "dark and bright, or neither"),
        (("--limit", "colour=3"), "no check 'colour' to limit (limits, --limit), only "),
    ],
)
def test_refusals(refused, star_image, words, message):
    refused(("star", star_image, *words), message)


@pytest.mark.parametrize(
    ("words", "message"),
    [(("--cycles", "40", *LEVELS), "show 36"), (("--roi", "0,0,9,9"), "star")],
)
def test_pixels_without_such_a_star_are_exit_4(refused, star_image, words, message):
    refused(("star", star_image, *words), message, code=4)
