"""``acutance simulate pair`` and ``acutance biresolution``: files, faces, limits and refusals."""

import csv
import json

import numpy as np
import pytest

from acutance import optics
from acutance.optics import write_sensor
from acutance.raster import open_image, write_geotiff


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pair")


@pytest.fixture(scope="module")
def pair(folder):
    """84 x 80 low pixels of 20 m at SNR 100, displaced by a fraction of a pixel."""
    from typer.testing import CliRunner

    from acutance.cli.app import app

    low, high = folder / "low.tif", folder / "high.tif"
    words = ["simulate", "pair", "--sensor", "smeared", "--size", "84,80", "--snr", "100",
             "--shift", "0.4,-1.2", "--out", low, "--high", high, "--seed", "3"]  # fmt: skip
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.stderr
    assert "true MTF at Nyquist 0.2060" in result.stdout
    return low, high


def test_the_pair_is_georeferenced_with_its_truth(pair):
    low, high = (open_image(path) for path in pair)
    assert (low.shape, high.shape) == ((84, 80), (168, 160))
    assert low.gsd().col_m == 2 * high.gsd().col_m == 20
    truth = json.loads(pair[0].with_suffix(".truth.json").read_text())
    assert truth["kind"] == "biresolution"
    assert truth["across"]["mtf_nyquist"] == pytest.approx(0.2060, abs=1e-4)
    assert truth["shift_px"] == [0.4, -1.2]


def test_text(acutance, pair):
    result = acutance("biresolution", *pair, "--reference", 0.2891)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.startswith("Pair of images, fit of the blur between them")
    assert "2, by the geotransforms" in result.stdout
    assert "px down" in result.stdout


def test_a_reference_may_be_the_name_of_a_sensor(acutance, pair, refused):
    named = json.loads(acutance("biresolution", *pair, "--reference", "gaussian", "--json").stdout)
    assert named["quantity"] == "mtf_low"
    assert named["across"]["mtf_nyquist"]["value"] == pytest.approx(0.206, abs=0.02)
    refused(("biresolution", *pair, "--reference", "gauss"), "none of generic-2005")


def test_json_keeps_to_the_schema_and_holds_the_truth(acutance, pair, keeps_to_schema):
    result = acutance("biresolution", *pair, "--reference", 0.2891, "--json", "--covariance")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    assert document["kind"] == "biresolution"
    assert document["quantity"] == "mtf_low"
    assert document["ratio"]["from"] == "geotransform"
    assert document["across"]["mtf_nyquist"]["value"] == pytest.approx(0.206, abs=0.02)
    assert document["shift_px"]["columns"]["value"] == pytest.approx(-1.2, abs=0.02)
    assert len(document["iterations"]) > 2
    assert np.shape(document["map"]["residual"]) == (2, 2)


def test_files(acutance, pair, shown, folder):
    figure, report, table = (folder / f"m.{ending}" for ending in ("png", "html", "csv"))
    result = acutance(
        "biresolution", *pair, "--method", "spectral-ratio", "--figure", figure, "--report",
        report, "--csv", table,
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert [(name, found.method) for name, found, _ in shown] == [
        ("draw", "spectral-ratio"), ("page", "spectral-ratio"),
    ]  # fmt: skip
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert {row["direction"] for row in rows} == {"across", "along"}


def test_a_measurement_as_the_reference(acutance, pair, folder):
    document = acutance("biresolution", *pair, "--reference", 0.2891, "--json").stdout
    path = folder / "reference.json"
    path.write_text(document)
    refused = acutance("biresolution", *pair, "--reference", path)
    assert refused.exit_code == 2
    assert "pixels of 20 m" in refused.stderr
    of_the_high = json.loads(document)
    of_the_high["image"] |= {"gsd_m": 10.0, "pixel_gsd_m": [10.0, 10.0]}
    path.write_text(json.dumps(of_the_high))
    result = acutance("biresolution", *pair, "--reference", path, "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)["across"]["mtf_nyquist"]
    assert found["std"] > json.loads(document)["across"]["mtf_nyquist"]["std"] * 0.5
    sensor = folder / "sensor.toml"
    write_sensor(optics.Sensor([optics.Gaussian(0.4), optics.Detector()]), sensor)
    assert acutance("biresolution", *pair, "--reference", sensor).exit_code == 0


def test_strict_and_limits(acutance, pair):
    assert acutance("biresolution", *pair, "--strict").exit_code == 3
    eased = ("--limit", "reference_mtf=0", "--limit", "coherence=0")
    assert acutance("biresolution", *pair, "--strict", *eased).exit_code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--ratio", 3), "the geotransforms have 2 by 2"),
        (("--reference", "nothing.json"), "cannot be read"),
        (("--reference", "sharp"), "give a sensor"),
        (("--reference", "0.8"), "between 0 and 0.637"),
        (("--method", "magic"), "kernel-fit, spectral-ratio"),
        (("--stop", 2), "between 0 and 1"),
        (("--limit", "edges=3"), "no check 'edges' to limit (limits, --limit), only "),
        (("--high-band", 2), "band 2"),
        (("--high-band", "B8"), "band 'B8' is not the number of a band, from 1 to 1"),
        (("--roi", "0,0,12,12"), "larger"),
        (("--covariance",), "add --json"),
    ],
)
def test_refusals(refused, pair, words, message):
    refused(("biresolution", *pair, *words), message)


def test_images_the_wrong_way_round(refused, pair):
    refused(("biresolution", *pair[::-1]), "the low image comes first")


def test_uniform_images_are_exit_4(refused, folder):
    path = folder / "flat.tif"
    write_geotiff(path, np.full((42, 40), 7, np.uint16))
    plain = folder / "plain.tif"
    write_geotiff(plain, np.full((84, 80), 9, np.uint16))
    refused(("biresolution", path, plain), "no structure in common", code=4)


def test_a_pair_is_seen_by_sensors_of_its_own_gsds(acutance, folder):
    sensor = folder / "in-metres.toml"
    blocks = '[[block]]\nkind = "Gaussian"\nsigma_m = 4.0\n\n[[block]]\nkind = "Detector"\n'
    sensor.write_text(f"gsd_m = 0.5\n\n{blocks}")
    words = ("simulate", "pair", "--sensor", sensor, "--high-sensor", sensor, "--gsd", 10)
    files = ("--size", "40,40", "--out", folder / "own.tif", "--high", folder / "finer.tif")
    assert acutance(*words, *files).exit_code == 0
    truth = json.loads((folder / "own.truth.json").read_text())
    for key, gsd_m in (("sensor", 10.0), ("high_sensor", 5.0)):
        assert truth[key]["gsd_m"] == gsd_m
        assert truth[key]["blocks"][0]["sigma_px"] == pytest.approx(4.0 / gsd_m)
    across = truth["across"]
    assert across["fwhm_m"] == pytest.approx(10.0 * across["fwhm_px"])


def test_simulate_refuses(acutance, folder):
    words = ("simulate", "pair", "--out", folder / "a.tif")
    assert acutance(*words, "--high", folder / "a.tif").exit_code == 2
    assert acutance(*words, "--high", folder / "b.tif", "--shift", "1").exit_code == 2
    for ratio in ("2.1", "0", "-2"):
        assert acutance(*words, "--high", folder / "b.tif", "--ratio", ratio).exit_code == 2
