"""``acutance pulse``: width, text, JSON, files, checks and refusals."""

import json

import numpy as np
import pytest

from acutance import optics, simulate
from acutance.raster import write_geotiff
from acutance.targets.kinds import KINDS

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=2.8)
WIDTH_M = 8.83


@pytest.fixture(scope="module")
def pulse_image(tmp_path_factory):
    """60 x 40 pixels of 2.8 m, a tarp of 8.83 m at 6 degrees, SNR 80."""
    pixels, _ = simulate.pulse(
        SENSOR, width_px=WIDTH_M / 2.8, snr=80, rng=np.random.default_rng(5), right_dark=130.0
    )
    path = tmp_path_factory.mktemp("images") / "pulse.tif"
    write_geotiff(path, pixels.astype(np.float32), gsd_m=2.8)
    return str(path)


@pytest.fixture(scope="module")
def bare_image(tmp_path_factory):
    """The same kind of pulse as an array without a GSD."""
    pixels, _ = simulate.pulse(SENSOR, snr=80, rng=np.random.default_rng(5))
    path = tmp_path_factory.mktemp("images") / "pulse.npy"
    np.save(path, pixels)
    return str(path)


def test_the_text_report_has_the_width_and_goes_to_stdout(acutance, pulse_image):
    result = acutance("pulse", pulse_image, "--width-m", WIDTH_M)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.startswith("Pulse, method spline: across track")
    assert "Width on the ground" in result.stdout


@pytest.mark.parametrize("width", [("--width-m", WIDTH_M), ("--width-px", 3.1), ()])
def test_json_keeps_to_the_schema_and_holds_the_true_width(
    acutance, pulse_image, keeps_to_schema, width
):
    result = acutance("pulse", pulse_image, *width, "--json", "--covariance")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    assert document["kind"] == "pulse"
    assert document["width_px"]["std"] > 0
    assert document["width_px"]["value"] == pytest.approx(WIDTH_M / 2.8, abs=0.03)
    stated = {"--width-m": WIDTH_M / 2.8, "--width-px": 3.1}[width[0]] if width else None
    assert document["stated_width_px"] == (stated and pytest.approx(stated, abs=1e-3))
    assert document["mtf_nyquist"]["value"] == pytest.approx(0.289, abs=0.03)
    assert "factor_real" in document["mtf"]


def test_a_held_width_has_no_deviation(acutance, pulse_image):
    result = acutance("pulse", pulse_image, "--width-px", 3.15, "--hold-width", "--json")
    assert result.exit_code == 0, result.stderr
    width = json.loads(result.stdout)["width_px"]
    assert (width["value"], width["std"]) == (3.15, 0.0)


def test_region_gsd_and_limits_reach_the_measurement(acutance, pulse_image):
    result = acutance(
        *("pulse", pulse_image, "--roi", "5,4,48,32", "--gsd", 2.4, "--width-px", 3.15, "--json"),
        *(
            "--limit",
            "plateau_before_px=3",
            "--limit",
            "background_step=0.5",
            "--rer-centre",
            "peak",
        ),
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["image"]["roi"][0] >= 5
    assert document["image"]["gsd_m"] == pytest.approx(2.4)
    assert document["options"]["limits"] == {"plateau_before_px": 3.0, "background_step": 0.5}
    limits = {one["name"]: one["limit_value"] for one in document["checks"]}
    assert (limits["plateau_before_px"], limits["background_step"]) == (3.0, 0.5)
    assert document["rer_centre"] == "peak"


@pytest.mark.parametrize("method", KINDS["pulse"].methods)
def test_every_method_is_named_in_the_help_and_writes_its_files(
    acutance, pulse_image, shown, tmp_path, method
):
    assert method in acutance("pulse", "--help").stdout
    result = acutance(
        *("pulse", pulse_image, "--width-m", WIDTH_M, "--method", method),
        *("--figure", tmp_path / "p.png", "--report", tmp_path / "p.html"),
        *("--csv", tmp_path / "p.csv"),
    )
    assert result.exit_code == 0, result.stderr
    assert [(name, found.method) for name, found, _ in shown] == [
        ("draw", method),
        ("page", method),
    ]
    assert len((tmp_path / "p.csv").read_text().splitlines()) == 52


def test_methods_are_compared(acutance, pulse_image, shown, tmp_path):
    others = ",".join(KINDS["pulse"].methods)
    words = ("pulse", pulse_image, "--width-m", WIDTH_M, "--compare", others)
    result = acutance(*words, "--json", "--report", tmp_path / "c.html")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    found = document.get("measurements", [document])
    assert [one["method"] for one in found] == list(KINDS["pulse"].methods)


def test_strict_is_exit_3_after_the_result(acutance, pulse_image):
    words = ("pulse", pulse_image, "--width-px", 3.6, "--strict", "--json")
    result = acutance(*words)
    assert result.exit_code == 3
    failed = [one for one in json.loads(result.stdout)["checks"] if not one["passed"]]
    assert [one["name"] for one in failed] == ["width_sigmas"]
    assert "check failed" in result.stderr
    assert acutance(*words, "--limit", "width_sigmas=1000").exit_code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--width-m", "8.83", "--width-px", "3"), "give one of them"),
        (("--width-m", "8.83"), "add --gsd or --width-px"),
        (("--hold-width",), "needs a width"),
        (("--width-px", "-3"), "cannot be measured"),
        (("--width-px", "wide"), "--width-px"),
        (("--covariance",), "add --json"),
        (("--method", "magic"), "magic"),
        (("--compare", "magic"), "magic"),
        (("--limit", "nonsense=1"), "width_sigmas"),
        (("--limit", "background_step=much"), "with a number"),
        (("--rer-centre", "middle"), "half or peak"),
        (("--figure", "pulse.doc"), "has to be .png or .svg or .pdf"),
    ],
)
def test_what_means_nothing_is_exit_2_with_a_message(
    refused, bare_image, tmp_path, monkeypatch, words, message
):
    monkeypatch.chdir(tmp_path)
    refused(("pulse", bare_image, *words), message)
    assert list(tmp_path.iterdir()) == []


def test_pixels_without_a_pulse_are_exit_4(refused, bare_image):
    refused(("pulse", bare_image, "--roi", "0,0,60,9"), "pulse", code=4)
