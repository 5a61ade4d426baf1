"""``acutance demo``: a site rendered, measured and compared with its truth."""

import json
import re

import pytest

from acutance.measure import PULSE_METHODS


def test_the_demonstration_writes_a_site_its_truth_and_the_pages(acutance, tmp_path):
    folder = tmp_path / "out" / "demo"
    result = acutance("demo", folder)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.strip() == f"open {folder / 'index.html'}"
    index = (folder / "index.html").read_text(encoding="utf-8")
    pages = re.findall(r'href="([^"]+)"', index)
    assert len(pages) == 5
    assert "pulse-tarp.html" in pages
    for page in pages:
        assert "truth" in (folder / page).read_text(encoding="utf-8")
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    for edge in truth["edges"].values():
        assert f"{edge['truth']['mtf_nyquist']:.4f}" in index
    assert "spline" in index
    assert (folder / "site.tif").exists()


def test_the_demonstration_measures_a_tarp_by_every_method(acutance, tmp_path):
    result = acutance("demo", tmp_path, "--seed", 2)
    assert result.exit_code == 0, result.stderr
    truth = json.loads((tmp_path / "pulse.truth.json").read_text(encoding="utf-8"))
    assert truth["width_m"] == pytest.approx(8.83)
    page = (tmp_path / "pulse-tarp.html").read_text(encoding="utf-8")
    index = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert f"{truth['width_px']:.4f}" in page
    assert f"{truth['width_px']:.4f}" in index
    assert f"{truth['mtf_nyquist']:.4f}" in index
    for method in PULSE_METHODS:
        assert method in page
    assert (tmp_path / "pulse.tif").exists()


def test_a_folder_that_cannot_be_made_is_exit_2(acutance, tmp_path):
    (tmp_path / "file").write_text("")
    result = acutance("demo", tmp_path / "file")
    assert result.exit_code == 2
    assert "cannot be made" in result.stderr
