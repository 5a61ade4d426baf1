"""``acutance demo``: a campaign rendered, measured by every method, compared with its truth."""

import json
import re

import pytest

from acutance.measure import METHODS, POINTS_METHODS, PULSE_METHODS

TARGETS = ("vertical edge", "horizontal edge", "pulse tarp", "bars", "star", "mirrors")


@pytest.fixture(scope="module")
def folder(acutance, tmp_path_factory):
    """The demonstration, once for all tests."""
    place = tmp_path_factory.mktemp("out") / "demo"
    result = acutance("demo", place)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.strip() == f"open {place / 'index.html'}"
    return place


def test_one_image_holds_every_target_and_its_truth_lies_beside_it(folder):
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    assert set(truth["edges"]) == {"vertical", "horizontal"}
    assert {one["kind"] for one in truth["targets"].values()} == {
        "pulse", "bars", "star", "points",
    }  # fmt: skip
    assert [path.name for path in folder.glob("*.tif")] == ["site.tif"]


def test_the_report_names_every_method_and_its_pages_exist(folder):
    index = (folder / "index.html").read_text(encoding="utf-8")
    for name in (*METHODS, *PULSE_METHODS, *POINTS_METHODS, *TARGETS, "all combined"):
        assert name in index
    pages = re.findall(r'href="([^"]+)"', index)
    assert len(pages) == len(TARGETS) + 1
    for page in pages:
        assert "<svg" in (text := (folder / page).read_text(encoding="utf-8")) or "data:" in text
    assert "truth" in (folder / "pulse-tarp.html").read_text(encoding="utf-8")


def test_no_reference_method_is_far_from_the_truth(folder):
    """Fifteen numbers of one draw: none beyond 4 standard deviations, and none without one."""
    rows = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["rows"]
    own = ("spline", "joint", "psf-fit", "least-squares")
    checked = [row for row in rows if row["method"] in own]
    assert len(checked) == 10
    for row in checked:
        for name in ("mtf_nyquist", "rer", "fwhm_px"):
            assert abs(row[name]["off_in_std"]) < 4, (row["target"], name)


def test_the_combination_agrees_and_is_the_most_exact(folder):
    document = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))
    assert document["agreement"]["p_value"] > 0.01
    stds = {
        (row["target"], row["orientation"]): row["mtf_nyquist"]["std"]
        for row in document["rows"]
        if row["method"] in ("spline", "joint", "psf-fit", "least-squares")
    }
    for orientation in ("across", "along"):
        combined = stds.pop(("all combined", orientation))
        assert all(combined < std for (_, way), std in stds.items() if way == orientation)


def test_its_documents_can_be_combined_again(folder, acutance):
    names = ("vertical-edge", "horizontal-edge", "mirrors")
    result = acutance("combine", *(folder / f"{name}.json" for name in names), "--json")
    assert result.exit_code == 0, result.stderr
    assert len(json.loads(result.stdout)["parts"]) == len(names)


def test_a_folder_that_cannot_be_made_is_exit_2(acutance, tmp_path):
    (tmp_path / "file").write_text("")
    result = acutance("demo", tmp_path / "file")
    assert result.exit_code == 2
    assert "cannot be made" in result.stderr
