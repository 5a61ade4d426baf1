"""``acutance demo``: a campaign rendered, measured by every method, compared with its truth."""

import html
import json
import re
from datetime import timedelta

import numpy as np
import pytest

import acutance as ac
from acutance.cli.demo_folder import FILES, demo_folder, file_of
from acutance.cli.demo_year import BEGIN, IMAGES, REFOCUS, measure_year, true_nyquist
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

TARGETS = ("vertical edge", "horizontal edge", "pulse tarp", "bars", "star", "mirrors")
PAGES = (*TARGETS, "combined", "landscape")


@pytest.fixture(scope="module")
def years():
    """Every year that was measured, with its trends."""
    return []


@pytest.fixture(scope="module")
def folder(acutance, tmp_path_factory, years):
    """The demonstration, once for all tests."""
    place = tmp_path_factory.mktemp("out") / "demo"

    def measured(*words):
        years.append(measure_year(*words))
        return years[-1]

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("acutance.cli.demo.measure_year", measured)
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
    assert sorted(path.name for path in folder.glob("*.tif")) == [
        "landscape.tif", "site-restored.tif", "site.tif",
    ]  # fmt: skip


def test_the_report_names_every_method_and_its_pages_exist(folder):
    index = (folder / "index.html").read_text(encoding="utf-8")
    methods = [name for kind in ("edge", "pulse", "points") for name in KINDS[kind].methods]
    for name in (*methods, *TARGETS, "all combined"):
        assert name in index
    pages = re.findall(r'href="([^"]+)"', index)
    assert set(pages) == {f"{file_of(name)}.html" for name in (*PAGES, "restoration", "year")}
    for page in pages:
        assert "<svg" in (text := (folder / page).read_text(encoding="utf-8")) or "data:" in text
    assert "truth" in (folder / "pulse-tarp.html").read_text(encoding="utf-8")


def test_the_index_shows_the_verdict_of_every_page_and_what_it_flags(folder):
    index = html.unescape((folder / "index.html").read_text(encoding="utf-8"))
    for name in PAGES:
        document = json.loads((folder / f"{file_of(name)}.json").read_text(encoding="utf-8"))
        words = "All methods combined" if name == "combined" else f"The {name}"
        word = document["verdict"]["word"]
        shown = re.search(rf'<div class="verdict {word}"><p>{words}.*?</div>', index, re.DOTALL)
        assert shown, name
        for check in document["checks"]:
            flagged = f"<b>{check['name']}</b>" in shown[0]
            assert flagged != check["passed"], (name, check["name"])


def test_no_reference_method_is_far_from_the_truth(folder):
    """Fifteen numbers of one draw: none beyond 4 standard deviations, and none without one."""
    rows = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["rows"]
    own = ("spline", "joint", "psf-fit", "least-squares")
    checked = [row for row in rows if row["method"] in own]
    assert len(checked) == 10
    for row in checked:
        for name in ("mtf_nyquist", "rer", "fwhm_px"):
            assert abs(row[name]["off_in_std"]) < 4, (row["target"], name)


def test_a_landscape_is_scanned_and_compared_with_its_truth(folder):
    found = json.loads((folder / "landscape.json").read_text(encoding="utf-8"))
    edges = json.loads((folder / "landscape.truth.geojson").read_text(encoding="utf-8"))["features"]
    assert found["edges"]["used"] > 100 < len(edges)
    rows = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["rows"]
    index = (folder / "index.html").read_text(encoding="utf-8")
    section = index[index.index("Without a target") :]
    for row in (row for row in rows if row["target"] == "all combined"):
        direction = row["orientation"]
        for name in ("mtf_nyquist", "rer", "fwhm_px"):
            one, true = found[direction][name], row[name]["truth"]
            assert abs(one["value"] - true) < 3.5 * one["std"], (direction, name)
        assert f"truth {row['mtf_nyquist']['truth']:.4f}" in section


def test_a_year_is_measured_as_a_batch_and_its_loss_and_refocusing_are_found(folder, years):
    with ac.Archive(folder / "year.db", read_only=True) as archive:
        assert len(archive.measurements()) == 4 * IMAGES
        assert not len(archive.rejected())
    (year,) = years
    assert set(year.trends) == {"across", "along"}
    for trend in year.trends.values():
        assert trend.images.size == IMAGES
        for day in (BEGIN, REFOCUS - timedelta(days=1), REFOCUS + timedelta(days=1)):
            found = trend.at(day)
            assert abs(found.value - true_nyquist(day)) < 3.5 * found.std
        assert trend.rate_per_year.interval(0.95)[1] < 0 < trend.events[0].size.interval()[0]
    page = (folder / "year.html").read_text(encoding="utf-8")
    assert page.count(".tif</td>") == IMAGES
    assert "refocus of 2026-09-01" in page


def test_the_site_is_restored_as_predicted(folder):
    filter = ac.RestorationFilter.read(folder / "restoration.json")
    assert filter.noise_gain == pytest.approx(1.8)
    index = (folder / "index.html").read_text(encoding="utf-8")
    assert "The star before and after" in index
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    regions = [ac.Region(np.array(one["region"])) for one in truth["edges"].values()]
    images = (ac.open_image(folder / name) for name in ("site.tif", "site-restored.tif"))
    for edge in ac.verify_restoration(*images, filter, regions).edges:
        assert abs(edge.off) < 3 * edge.after.std
        assert edge.noise_gain == pytest.approx(1.8, rel=0.05)


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


def test_the_folder_holds_what_was_announced_and_may_be_written_again(folder):
    assert {path.name for path in folder.iterdir()} == {*FILES, "images"}
    assert demo_folder(str(folder)) == folder
    (folder / "index.html").unlink()
    assert demo_folder(str(folder)) == folder


@pytest.mark.parametrize("name", ["index.html", "bars.json", "site.tif", "truth.json"])
def test_files_that_no_demonstration_wrote_are_kept(acutance, tmp_path, name):
    (tmp_path / name).write_text('{"schema": "mine"}')
    result = acutance("demo", tmp_path)
    assert result.exit_code == 2
    assert f"holds {name}, which would be overwritten and which no demonst" in result.stderr
    assert (tmp_path / name).read_text() == '{"schema": "mine"}'
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_other_files_in_the_folder_do_not_matter(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "sub").mkdir()
    assert demo_folder(str(tmp_path)) == tmp_path
    assert len(list(tmp_path.iterdir())) == 2


def test_a_folder_where_a_file_should_be_is_found_out_first(tmp_path):
    (tmp_path / "truth.json").write_text('{"schema": "acutance/scene/1"}')
    (tmp_path / "star.html").mkdir()
    with pytest.raises(OptionError, match=r"star\.html is a folder"):
        demo_folder(str(tmp_path))
