"""``acutance simulate`` beyond the edge: images, truths, sensors by name and file, budgets."""

import json

import numpy as np
import pytest

from acutance.optics import preset, read_sensor, write_sensor
from acutance.raster import open_image


@pytest.fixture
def render(acutance, tmp_path):
    """Render a target: its pixels, its truth and what was printed."""

    def run(kind, *words, name="target.tif"):
        out = tmp_path / name
        result = acutance("simulate", kind, *words, "--out", out)
        assert result.exit_code == 0, result.stderr
        truth = json.loads(out.with_suffix(".truth.json").read_text(encoding="utf-8"))
        return open_image(out), truth, result

    return run


def test_a_pulse(render):
    image, truth, result = render(
        "pulse", "--width-px", 3.2, "--snr", 70, "--right-dark", 150, "--seed", 4
    )
    assert image.shape == (60, 40)
    assert image.gsd().col_m == 1.0
    assert truth["schema"] == "acutance/truth/1"
    assert (truth["kind"], truth["width_px"], truth["seed"]) == ("pulse", 3.2, 4)
    assert (truth["left"], truth["right"]) == (100.0, 150.0)
    assert truth["mtf_nyquist"] == pytest.approx(0.2667, abs=1e-4)
    assert truth["noise"]["read"] == pytest.approx(1075 / 70)
    assert truth["sensor"]["blocks"][0] == {
        "block": "Gaussian",
        "sigma_px": 0.39,
        "sigma_along_px": None,
    }
    assert "true width 3.2" in result.stdout


def test_a_pulse_in_metres_from_a_file(render, tmp_path):
    path = tmp_path / "sensor.toml"
    write_sensor(preset("quickbird-like"), path)
    _, truth, _ = render("pulse", "--sensor", path, "--width-m", 2.1, "--ground-noise")
    assert truth["width_px"] == pytest.approx(3.0)
    assert truth["width_m"] == pytest.approx(2.1)


@pytest.mark.parametrize("target", ["pulse", "bars", "star", "points", "checkerboard"])
def test_every_target_has_the_gsd_that_is_given(render, target):
    image, *_ = render(target, "--gsd", 0.5)
    assert image.gsd().col_m == 0.5


def test_the_same_seed_gives_the_same_pixels(render):
    words = ("pulse", "--snr", 50, "--ground-noise", "--seed")
    images = [render(*words, seed)[0].read() for seed in (1, 1, 2)]
    assert np.array_equal(images[0], images[1])
    assert not np.array_equal(images[0], images[2])


def test_bars(render):
    _, truth, result = render("bars", "--periods", "6,3", "--along", "--count", 4)
    assert [group["period_px"] for group in truth["groups"]] == [6.0, 3.0]
    assert truth["groups"][0]["mtf"] > truth["groups"][1]["mtf"]
    assert result.stdout.count("true MTF at") == 2


def test_a_star(render):
    image, truth, _ = render("star", "--wave", "square", "--radius", 40, "--size", "90,100")
    assert image.shape == (90, 100)
    assert (truth["wave"], truth["cycles"]) == ("square", 36)
    assert truth["mtf"]["value"][0] == pytest.approx(1.0)


@pytest.mark.parametrize(("layout", "count"), [("columns", 20), ("square", 16)])
def test_mirrors(render, layout, count):
    _, truth, result = render("points", "--layout", layout, "--snr", 80)
    assert len(truth["positions"]) == count
    assert truth["across"]["mtf_nyquist"] > truth["along"]["mtf_nyquist"]
    assert f"{count} mirrors" in result.stdout


def test_a_campaign(render):
    image, truth, _ = render("site", "--sensor", "ikonos-like")
    assert image.shape == (300, 260)
    assert truth["schema"] == "acutance/scene/1"
    assert set(truth["edges"]) == {"vertical", "horizontal"}
    assert {one["kind"] for one in truth["targets"].values()} == {"pulse", "bars", "star", "points"}
    assert np.array(truth["edges"]["vertical"]["region"]).shape == (4, 2)


def test_a_checkerboard(render, acutance):
    image, truth, result = render(
        "checkerboard",
        "--tile",
        30,
        "--angle",
        -5,
        "--size",
        "130,120",
        "--snr",
        100,
        "--quantum",
        1,
    )
    assert image.shape == (130, 120)
    assert truth["schema"] == "acutance/scene/1"
    assert set(truth["edges"]) == {"upper", "lower", "left", "right"}
    assert truth["edges"]["left"]["truth"]["noise"]["read"] == pytest.approx(10.0)
    assert np.array_equal(image.read(), np.round(image.read()))
    assert result.stdout.count("true MTF at Nyquist") == 4
    refused = acutance("simulate", "checkerboard", "--tile", 90, "--out", "board.tif")
    assert refused.exit_code == 2
    assert "use smaller tiles" in refused.stderr


@pytest.mark.parametrize("kind", ["edge", "pulse", "bars", "star", "points", "site"])
def test_every_target_can_have_shot_noise_steps_and_a_limit(render, kind):
    words = ("--read-noise", 3, "--shot-gain", 0.5, "--quantum", 4, "--saturation", 900)
    image, truth, _ = render(kind, *words, "--sensor", "generic-2005")
    pixels = image.read()
    assert pixels.max() <= 900
    assert np.array_equal(pixels % 4, np.zeros_like(pixels))
    if kind != "site":
        expected = {"read": 3.0, "shot_gain": 0.5, "quantum": 4.0, "saturation": 900.0}
        assert truth["noise"] == expected


def test_shot_noise_grows_with_the_signal(render):
    image, _, _ = render("edge", "--shot-gain", 1, "--size", "200,60", "--sensor", "generic-2005")
    pixels = image.read()
    # 200 and 1200 DN at one DN an electron: 14.1 and 34.6 DN.
    assert pixels[:, :15].std() == pytest.approx(200**0.5, rel=0.06)
    assert pixels[:, -15:].std() == pytest.approx(1200**0.5, rel=0.06)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("pulse", "--width-px", 200), "use a larger image (--size)"),
        (("pulse", "--size", "1,1"), "use a larger image (--size)"),
        (("edge", "--snr", 50, "--read-noise", 3), "give one of them"),
        (("edge", "--read-noise", -3), "read is -3"),
    ],
)
def test_what_shows_no_target_or_contradicts_itself_is_refused(acutance, tmp_path, words, message):
    result = acutance("simulate", *words, "--out", tmp_path / "a.tif")
    assert result.exit_code == 2
    assert message in result.stderr
    assert not list(tmp_path.iterdir())


def test_a_field_of_tarps(render):
    image, truth, result = render("site", "--targets", 9, "--size", "300,310", "--texture", 0)
    assert image.shape == (300, 310)
    assert (len(truth["edges"]), len(truth["targets"])) == (6, 3)
    assert "6 edges, 3 other targets" in result.stdout


def test_an_edge_by_a_named_sensor(render):
    image, truth, _ = render("edge", "--sensor", "generic-2005")
    assert image.gsd().row_m == 1.0
    assert truth["mtf_nyquist"] == pytest.approx(0.2667, abs=1e-4)


def test_an_image_narrower_than_the_blur_is_told(render):
    _, _, result = render("edge", "--gaussian", 50)
    assert "FWHM" in result.stdout
    assert "no FWHM within 32 px" in result.stdout
    assert "31 % of the edge's rise: 40 px across it are narrower than the blur" in result.stderr
    _, _, result = render("edge", "--gaussian", 2)
    assert "narrower than" not in result.stderr


def test_a_gsd_leaves_metres_of_a_sensor_file(render, tmp_path):
    path = tmp_path / "metres.toml"
    path.write_text("gsd_m = 0.5\n[[block]]\nkind = 'Gaussian'\nsigma_m = 0.2\n", encoding="utf-8")
    image, truth, _ = render("edge", "--sensor", path, "--gsd", 1)
    assert image.gsd().row_m == 1.0
    assert truth["sensor"]["blocks"][0]["sigma_px"] == pytest.approx(0.2)
    _, truth, _ = render("edge", "--sensor", "generic-2005", "--gsd", 2)
    assert truth["sensor"]["blocks"][0]["sigma_px"] == 0.39


def test_the_budget_of_a_sensor(acutance, tmp_path):
    figure, toml = tmp_path / "budget.svg", tmp_path / "sensor.toml"
    result = acutance(
        *("simulate", "sensor-budget", "generic-2005", "--figure", figure, "--toml", toml)
    )
    assert result.exit_code == 0, result.stderr
    assert "MTF at 0.5 cycles per pixel (0.5 cycles per metre)" in result.stdout
    assert "Butterworth cutoff 1.4 c/px       0.8869  0.8869" in result.stdout
    assert result.stdout.splitlines()[-1].split() == ["all", "0.2665", "0.2597"]
    assert figure.read_text(encoding="utf-8").startswith("<?xml")
    assert read_sensor(toml) == preset("generic-2005")
    document = json.loads(
        acutance("simulate", "sensor-budget", str(toml), "--freq", 0.25, "--json").stdout
    )
    assert document["freq_cpp"] == 0.25
    product = np.prod([row["along"] for row in document["rows"]])
    assert product == pytest.approx(document["total"]["along"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("pulse", "--out", "a.png"), "has to be .tif"),
        (("pulse", "--out", "a.tif", "--sensor", "spot"), "is no .toml file and none of"),
        (("pulse", "--out", "a.tif", "--sensor", "no.toml"), "cannot be read"),
        (("pulse", "--out", "a.tif", "--width-px", "3", "--width-m", "3"), "use one"),
        (("pulse", "--out", "a.tif", "--sensor", "wide", "--width-m", "3"), "a sensor with a GSD"),
        (("bars", "--out", "a.tif", "--periods", "a"), "write numbers"),
        (("points", "--out", "a.tif", "--layout", "ring"), "columns, square"),
        (("star", "--out", "a.tif", "--wave", "saw"), "it has to be sine or square"),
        (("site", "--out", "a.tif", "--targets", "500"), "90 are needed"),
        (("site", "--out", "a.tif", "--angle", "40"), "2 to 14"),
        (("edge", "--out", "a.tif", "--sensor", "wide", "--smear", "1"), "stands alone"),
    ],
)
def test_what_means_nothing_is_refused(acutance, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    result = acutance("simulate", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["pulse", "bars", "star", "points", "site", "sensor-budget"])
def test_help_shows_an_example(acutance, kind):
    result = acutance("simulate", kind, "--help")
    assert result.exit_code == 0
    assert f"acutance simulate {kind}" in result.stdout.split("Example", 1)[1]
