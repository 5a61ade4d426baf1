"""``acutance simulate edge``: the image and its truth."""

import json

import numpy as np
import pytest

from acutance.raster import open_image


def test_the_image_and_its_truth_are_written(acutance, tmp_path):
    out = tmp_path / "edge.tif"
    result = acutance(
        *("simulate", "edge", "--gaussian", 0.4, "--snr", 100, "--gsd", 0.7),
        *("--size", "50,30", "--seed", 5, "--out", out),
    )
    assert result.exit_code == 0, result.stderr
    image = open_image(out)
    assert image.shape == (50, 30)
    assert image.gsd().col_m == 0.7
    truth = json.loads((tmp_path / "edge.truth.json").read_text(encoding="utf-8"))
    assert truth["mtf_nyquist"] == pytest.approx(0.2891, abs=2e-3)
    assert truth["fwhm_m"] == pytest.approx(0.7 * truth["fwhm_px"])
    assert truth["seed"] == 5
    assert truth["noise"]["read"] == pytest.approx(10.0)
    assert "0.28" in result.stdout


def test_the_same_seed_gives_the_same_pixels(acutance, tmp_path):
    def pixels(seed, name):
        acutance("simulate", "edge", "--snr", 50, "--seed", seed, "--out", tmp_path / name)
        return open_image(tmp_path / name).read()

    assert np.array_equal(pixels(1, "a.tif"), pixels(1, "b.tif"))
    assert not np.array_equal(pixels(1, "c.tif"), pixels(2, "d.tif"))


def test_every_block_blurs_and_a_ready_system_can_be_named(acutance, tmp_path):
    def nyquist(*words):
        out = tmp_path / "edge.tif"
        result = acutance("simulate", "edge", *words, "--along", "--out", out)
        assert result.exit_code == 0, result.stderr
        truth = json.loads((tmp_path / "edge.truth.json").read_text(encoding="utf-8"))
        assert truth["orientation"] == "along"
        return truth["mtf_nyquist"]

    sharp = nyquist()
    for words in (
        ("--gaussian", 0.4),
        ("--smear", 0.5),
        ("--jitter", 0.3),
        ("--butterworth", 1.4),
        ("--diffraction", 1.2, "--obscuration", 0.3),
        ("--detector", 1.3),
        ("--sensor", "wide"),
    ):
        assert nyquist(*words) < sharp - 0.02, words


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--out", "edge.png"), "has to be .tif"),
        (("--out", "edge.tif", "--size", "60"), "write rows and columns"),
        (("--out", "edge.tif", "--size", "0,40"), "1 or more"),
        (("--out", "edge.tif", "--sensor", "gauss"), "none of generic-2005, ikonos-like"),
        (("--out", "edge.tif", "--sensor", "wide", "--smear", "1"), "leave out --smear"),
        (("--out", "edge.tif", "--obscuration", "0.3"), "add --diffraction"),
        (("--out", "edge.tif", "--angle", "50"), "cannot exceed 45"),
        (("--out", "edge.tif", "--gaussian", "-1"), "sigma_px"),
    ],
)
def test_what_means_nothing_is_refused(acutance, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    result = acutance("simulate", "edge", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_named_sensor_may_have_another_gsd(acutance, tmp_path):
    for name, gsd in (("gaussian", 0.7), ("ikonos-like", 2.0)):
        words = ("--sensor", name, "--gsd", gsd, "--out", tmp_path / "a.tif")
        result = acutance("simulate", "edge", *words)
        assert result.exit_code == 0, result.stderr
        assert open_image(str(tmp_path / "a.tif")).gsd().row_m == pytest.approx(gsd)


@pytest.mark.parametrize("words", [("edge",), ("pair", "--high", "high.tif")])
def test_levels_that_single_precision_does_not_hold_are_refused(acutance, tmp_path, words):
    """They would be infinite in the file."""
    words = [str(tmp_path / one) if one.endswith(".tif") else one for one in words]
    out = tmp_path / "huge.tif"
    done = acutance("simulate", *words, "--bright", "1e300", "--out", out)
    assert done.exit_code == 2
    assert "do not fit float32, which holds -3.40282e+38 to 3.40282e+38" in done.stderr
    assert not out.exists()
