"""``acutance points`` and ``acutance plan mirrors``: files, answers, refusals."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from acutance import optics, simulate
from acutance.raster import write_geotiff

SENSOR = optics.Sensor([optics.Gaussian(0.45), optics.Detector()], gsd_m=0.7)


@pytest.fixture(scope="module")
def mirrors(tmp_path_factory):
    """20 mirrors at SNR 80 as a GeoTIFF, and their places as CSV and GeoJSON."""
    folder = tmp_path_factory.mktemp("mirrors")
    image, truth = simulate.points(SENSOR, snr=80, rng=np.random.default_rng(4))
    write_geotiff(folder / "mirrors.tif", image.astype(np.float32), gsd_m=0.7)
    rows = "".join(f"{row:.3f},{col:.3f}\n" for row, col in truth.positions)
    (folder / "mirrors.csv").write_text("row,col\n" + rows)
    points = [{"type": "Point", "coordinates": [c, r]} for r, c in truth.positions.tolist()]
    document = {
        "type": "GeometryCollection",
        "geometries": points,
        "crs": {"type": "name", "properties": {"name": "pixel"}},
    }
    (folder / "mirrors.geojson").write_text(json.dumps(document))
    return folder


def test_every_output_of_a_measurement(acutance, mirrors, shown, tmp_path, keeps_to_schema):
    done = acutance(
        "points", mirrors / "mirrors.tif", "--positions", mirrors / "mirrors.csv",
        "--surveyed", mirrors / "mirrors.geojson", "--figure", tmp_path / "m.png",
        "--report", tmp_path / "m.html", "--csv", tmp_path / "m.csv", "--json", "--strict",
    )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    keeps_to_schema(document)
    assert len(document["sources"]) == 20
    assert max(document["survey"]["rmse_cm"]) < 1.6
    assert [(name, len(found.sources)) for name, found, _ in shown] == [("draw", 20), ("page", 20)]
    rows = list(csv.DictReader((tmp_path / "m.csv").read_text().splitlines()))
    assert {row["direction"] for row in rows} == {"across", "along"}


def test_the_published_method_in_words(acutance, mirrors):
    done = acutance("points", mirrors / "mirrors.tif", "--method", "gaussian-2003")
    assert done.exit_code == 0, done.stderr
    assert "Point sources, method gaussian-2003" in done.stdout
    assert "phase_gap_px" in done.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--method", "best"), "there is no method 'best'"),
        (("--positions", "nowhere.csv"), "there is no such file"),
        (("--limit", "sources"), "write NAME=VALUE with a number"),
        (("--limit", "mirrors=3"), "no check 'mirrors' to limit (limits, --limit), only "),
        (("--min-snr", "0"), "--min-snr is 0"),
        (("--survey-reference", "last"), "mean or first"),
        (("--roi", "0,0,20,6"), "at least"),
    ],
)
def test_senseless_words_are_refused(acutance, mirrors, words, message):
    done = acutance("points", mirrors / "mirrors.tif", *words)
    assert done.exit_code == 2
    assert message in done.stderr


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("mirror,height\n1,2\n", "name two of them"),
        ("row,col\n3,four\n", "line 2"),
        ("", "holds no positions"),
        ('{"type": "Point"', "cannot be read as GeoJSON"),
        ('{"type": "Polygon", "coordinates": []}', "holds no positions"),
        ("lon,lat\n5,50\n", "the image has no CRS"),
    ],
)
def test_files_without_places_are_refused(acutance, mirrors, tmp_path, content, message):
    path = tmp_path / "places.csv"
    path.write_text(content)
    np.save(tmp_path / "bare.npy", np.zeros((40, 40)))
    done = acutance("points", tmp_path / "bare.npy", "--positions", path)
    assert done.exit_code == 2
    assert message in done.stderr


def test_strict_says_when_a_check_failed(acutance, mirrors):
    done = acutance("points", mirrors / "mirrors.tif", "--limit", "sources=30", "--strict")
    assert done.exit_code == 3


def test_mirrors_are_laid_out(acutance, tmp_path):
    done = acutance(
        "plan", "mirrors", "--gsd", 0.7, "--draws", 2, "--workers", 1,
        "--csv", tmp_path / "plan.csv", "--figure", tmp_path / "plan.png", "--json",
    )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    plan = json.loads(done.stdout)
    assert plan["step_px"] == pytest.approx([10.2, 1.25])
    assert plan["angle_deg"] == pytest.approx(7.0, abs=0.05)
    assert set(plan["std"]) == set(plan["scatter"])
    assert len((tmp_path / "plan.csv").read_text().splitlines()) == 21
    words = acutance("plan", "mirrors", "--gsd", 0.7, "--draws", 0, "--arrangement", "square",
                     "--count", 16)  # fmt: skip
    assert "pitch 5.25 px" in words.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--arrangement", "circle"), "columns or square"),
        (("--count", "0"), "--count is 0"),
        (("--spacing", "3"), "--spacing is 3"),
        (("--level", "0.05"), "--level is 0.05"),
        (("--sensor", "gaussian"), "need a ground sampling distance"),
    ],
)
def test_impossible_mirrors_are_refused(acutance, words, message):
    done = acutance("plan", "mirrors", "--draws", "0", *words)
    assert done.exit_code == 2
    assert message in done.stderr
