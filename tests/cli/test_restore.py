"""``acutance restore design | apply`` and ``acutance niirs``."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.raster import open_image, write_geotiff

SENSOR = optics.Sensor([optics.Gaussian(0.5), optics.Detector()], gsd_m=0.7)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, acutance):
    """Two edges, their measurements, and a filter made from them."""
    place = tmp_path_factory.mktemp("restore")
    for number, name in enumerate(("across", "along")):
        pixels, _ = simulate.edge(
            SENSOR, angle_deg=6.0, shape=(70, 70), snr=100, orientation=name,
            rng=np.random.default_rng(number),
        )  # fmt: skip
        write_geotiff(place / f"{name}.tif", pixels.astype(np.float32), gsd_m=0.7)
        result = acutance("edge", place / f"{name}.tif", "--json")
        (place / f"{name}.json").write_text(result.stdout)
    result = acutance(
        "restore", "design", place / "across.json", place / "along.json", "--noise-gain", 1.7,
        "--size", 9, "--out", place / "filter.json", "--report", place / "filter.html",
        "--figure", place / "filter.png",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    (place / "told.txt").write_text(result.stdout)
    return place


def test_a_design_is_written_and_told(folder):
    document = json.loads((folder / "filter.json").read_text())
    assert document["schema"] == "acutance/restoration/1"
    assert np.sum(document["kernel"]) == pytest.approx(1)
    assert document["noise_gain"] == pytest.approx(1.7)
    assert "noise gain 1.7 asked for" in (folder / "told.txt").read_text()
    assert (folder / "filter.html").read_text().startswith("<!DOCTYPE html>")
    assert (folder / "filter.png").read_bytes().startswith(b"\x89PNG")


def test_an_image_is_filtered_and_verified(acutance, folder):
    out = folder / "sharp.tif"
    result = acutance(
        "restore", "apply", folder / "across.tif", "--filter", folder / "filter.json", "--out", out,
        "--verify", "--roi", "5,5,60,60", "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["bands"]["1"]["pixels"] == 4900
    (edge,) = document["proof"]["edges"]
    off = edge["mtf_nyquist_after"]["value"] - edge["mtf_nyquist_predicted"]["value"]
    assert abs(off) < 0.05
    assert open_image(out).gsd().col_m == pytest.approx(0.7)


def test_edges_are_verified_by_a_method_that_expects_no_sensor(acutance, folder, tmp_path):
    words = ["restore", "apply", folder / "across.tif", "--filter", folder / "filter.json"]
    words += ["--out", tmp_path / "sharp.tif", "--method", "iso12233"]
    result = acutance(*words, "--verify", "--roi", "5,5,60,60", "--json")
    assert result.exit_code == 0, result.stderr
    proof = json.loads(result.stdout)["proof"]
    (edge,) = proof["edges"]
    before = ac.measure_edge(open_image(folder / "across.tif"), (5, 5, 60, 60), method="iso12233")
    assert edge["mtf_nyquist_before"]["value"] == pytest.approx(before.mtf_nyquist.value)
    result = acutance(*words)
    assert result.exit_code == 2
    assert "--method measures edges for --verify" in result.stderr


def test_a_described_sensor_and_an_image_make_a_filter(acutance, folder, tmp_path):
    result = acutance(
        "restore", "design", "--sensor", "gaussian", "--target", "generic-2005", "--snr", 100,
        "--size", 7, "--out", tmp_path / "f.json", "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["method"] == "target"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--noise-gain", "1.5"], "give the JSON files"),
        (["across.json", "--sensor", "gaussian"], "one of them"),
        (["across.json", "--noise-gain", "1.5"], "shows one direction"),
        (["across.json", "along.json", "--noise-gain", "70"], "reach"),
        (["across.json", "along.json", "--overshoot", "0.05", "--mtf-nyquist", "0.3"], "each of"),
        (["across.tif", "--noise-gain", "1.5"], "holds no JSON"),
        (["none.json", "--noise-gain", "1.5"], "cannot be read"),
    ],
)
def test_designs_that_cannot_be_are_refused(
    acutance, folder, tmp_path, monkeypatch, words, message
):
    monkeypatch.chdir(folder)
    result = acutance("restore", "design", *words, "--out", tmp_path / "f.json")
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (tmp_path / "f.json").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["across.tif", "--filter", "across.json", "--out", "b.tif"], "no document"),
        (["across.tif", "--filter", "filter.json", "--out", "across.tif"], "overwrite"),
        (["across.tif", "--filter", "filter.json", "--out", "b.png"], "ends in"),
        (["across.tif", "--filter", "filter.json", "--out", "b.tif", "--roi", "1,1,9,9"], "add it"),
        (["none.tif", "--filter", "filter.json", "--out", "b.tif"], "none.tif"),
        (["across.tif", "--filter", "filter.json", "--out", "b.tif", "--band", "x"], "band"),
    ],
)
def test_applications_that_cannot_be_are_refused(acutance, folder, monkeypatch, words, message):
    monkeypatch.chdir(folder)
    result = acutance("restore", "apply", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (folder / "b.tif").exists()


def test_niirs_of_a_measurement_and_of_numbers(acutance, folder):
    result = acutance(
        "niirs",
        folder / "across.json",
        "--gsd-m",
        0.7,
        "--snr",
        80,
        "--elevation-deg",
        70,
        "--json",
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["version"] == 5
    assert document["inputs_std"] > 0
    stated = acutance("niirs", "--rer", "0.45,0.42", "--gsd-m", "0.7", "--snr", "80",
                      "--elevation-deg", "70")  # fmt: skip
    assert "4.68 ± 0.30" in stated.stdout
    assert acutance("niirs", "--gsd-m", "0.7", "--snr", "80").exit_code == 2
    assert acutance("niirs", "--rer", "0.4", "--gsd-m", "0.7").exit_code == 2
