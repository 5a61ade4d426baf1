"""Plans: what they may hold, and that all faults are named at once."""

from __future__ import annotations

import os
from datetime import UTC, date, datetime
from pathlib import Path

import pytest

from acutance.batch.image_list import list_images, require_stated_images, stated_of
from acutance.batch.plan import StatedOfImages, plan_of, read_plan
from acutance.errors import OptionError

NEEDED = {"images": "*.tif", "targets": "targets.geojson", "archive": "kept.db"}


def test_paths_are_relative_to_the_plan(tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text(
        """
images = ["images/*.tif", "/data/a.tif"]
targets = "targets.geojson"
archive = "campaign.db"
bands = ["pan", 3]
workers = 2

[[stated]]
sensor = "QB02"
acquired = 2026-01-05T10:00:00Z
gsd_m = [0.72, 0.70]

[[stated]]
images = "K3_*.tif"
sensor = "K3"
gsd_m = 0.7
metadata = "documents/K3_Aux.xml"
linearize = "film.csv"

[edge]
method = "spline"
target_softness_m = {value = 0.05, std = 0.02}
[edge.limits]
rows = 12
"""
    )
    plan = read_plan(path)
    assert plan.images == (str(tmp_path / "images/*.tif"), "/data/a.tif")
    assert plan.archive == str(tmp_path / "campaign.db")
    assert (plan.bands, plan.workers, plan.dask) == (("pan", 3), 2, None)
    first, second = plan.stated
    assert (first.acquired, first.gsd_m) == (
        datetime(2026, 1, 5, 10, tzinfo=UTC), (0.72, 0.70),
    )  # fmt: skip
    assert second.gsd_m == (0.7, 0.7)
    assert second.metadata == (str(tmp_path / "documents/K3_Aux.xml"),)
    assert second.linearize == str(tmp_path / "film.csv")
    assert plan.options["edge"]["limits"] == {"rows": 12}


@pytest.mark.parametrize("curve", ["sRGB", "sRGB:255", "LOG:85", "2.2", 2.2])
def test_a_curve_that_is_no_table_stays_as_it_is(tmp_path, curve):
    (stated,) = plan_of({**NEEDED, "stated": {"linearize": curve}}, "plan", tmp_path).stated
    assert stated.linearize == curve


def test_a_server_stays_as_it_is(tmp_path):
    plan = plan_of({**NEEDED, "archive": "postgresql+psycopg://user@host/db"}, "plan", tmp_path)
    assert plan.archive == "postgresql+psycopg://user@host/db"


@pytest.mark.parametrize("acquired", ["2150-01-01", date(1900, 1, 1), datetime(9999, 12, 31)])
def test_a_stated_date_of_no_image_is_refused(acquired):
    stated = {"acquired": acquired}
    with pytest.raises(OptionError, match=r"1957-01-01 to 20.* are the days of images"):
        plan_of({**NEEDED, "stated": stated}, "plan.toml")


def test_all_faults_at_once():
    document = {
        "images": "*.tif",
        "target": "targets.geojson",
        "colour": 1,
        "workers": 0,
        "stated": {"sensr": "QB02", "acquired": 20260105, "gsd_m": -1.0, "height_m": 1e5},
        "edge": "spline",
        "pulse": {"metod": "spline", "limits": {"rowz": 3}},
        "scene": {"method": "magic"},
    }
    with pytest.raises(OptionError) as caught:
        plan_of(document, "plan.toml")
    for words in (
        "- pulse has no option 'metod'",
        "- there is no check 'rowz'",
        "- there is no scene method 'magic'",
        "the plan plan.toml cannot be used",
        "there is no key 'target'",
        "there is no key 'colour'",
        "the key 'targets' is missing",
        "the key 'archive' is missing",
        "workers is 0",
        "there is no key 'sensr' in stated 1",
        "stated 1, acquired is 20260105",
        "stated 1, gsd_m is -1.0",
        "stated 1, height_m is 100000.0",
        "edge is 'spline'",
    ):
        assert words in str(caught.value)


@pytest.mark.parametrize("text", ["images = ", "\x00", "a = 1\na = 2"])
def test_files_that_are_no_plan(tmp_path, text):
    path = tmp_path / "plan.toml"
    path.write_text(text)
    with pytest.raises(OptionError, match="cannot be read"):
        read_plan(path)
    with pytest.raises(OptionError, match="cannot be read"):
        read_plan(tmp_path / "none.toml")


@pytest.mark.parametrize("day", ["2026-01-05", date(2026, 1, 5)])
def test_a_day_is_a_date_to_the_day(day):
    (stated,) = plan_of({**NEEDED, "stated": {"acquired": day}}, "plan").stated
    assert stated.acquired == date(2026, 1, 5)
    assert type(stated.acquired) is date
    with pytest.raises(OptionError, match="or a day, 2026-01-05"):
        plan_of({**NEEDED, "stated": {"acquired": "last week"}}, "plan")


def test_later_statements_go_before_earlier_ones(tmp_path):
    stated = (
        StatedOfImages(sensor="A", level="L1", gsd_m=(1.0, 1.0)),
        StatedOfImages(images=("K3_*.tif",), sensor="B"),
        StatedOfImages(images=(str(tmp_path / "deep" / "*.tif"),), sensor="C"),
    )
    assert stated_of("x.tif", stated).sensor == "A"
    found = stated_of("images/K3_1.tif", stated)
    assert (found.sensor, found.level) == ("B", "L1")
    assert stated_of(str(tmp_path / "deep" / "K3_1.tif"), stated).sensor == "C"


def test_what_is_stated_of_no_image_is_refused(tmp_path):
    (tmp_path / "K3_1.tif").write_bytes(b"x")
    files = list_images([str(tmp_path / "*.tif")])
    right = StatedOfImages(images=("K3_*.tif",), sensor="B")
    require_stated_images(files, (StatedOfImages(sensor="A"), right))
    wrong = StatedOfImages(images=("K3_*.tif", "K4_*.tif"), sensor="C")
    with pytest.raises(OptionError, match=r"stated 2 is of images that match K4_\*\.tif"):
        require_stated_images(files, (right, wrong))


@pytest.mark.parametrize(
    "pattern", ["K3_*.tif", "*K3*.tif", "**/K3_*.tif", "images/**/K3_*.tif", "images/deep/K3_1.tif"]
)
@pytest.mark.parametrize("place", [".", "plans", "elsewhere"])
def test_patterns_mean_the_same_from_every_folder(tmp_path, monkeypatch, pattern, place):
    image = tmp_path / "plans" / "images" / "deep" / "K3_1.tif"
    for folder in (image.parent, tmp_path / "elsewhere"):
        folder.mkdir(parents=True)
    for one in (image, image.with_name("other.tif")):
        one.write_bytes(b"x")
    monkeypatch.chdir(tmp_path / place)
    plan = os.path.relpath(tmp_path / "plans")
    stated = {"images": pattern, "sensor": "K3"}
    found = plan_of({**NEEDED, "images": "images/**/*.tif", "stated": stated}, "p", Path(plan))
    files = list_images(found.images)
    require_stated_images(files, found.stated)
    assert [stated_of(one.path, found.stated).sensor for one in files] == ["K3", None]


def test_images_are_listed_once(tmp_path):
    for name in ("b.tif", "a.tif", "a.tif.aux.xml", "c[1].tif"):
        (tmp_path / name).write_bytes(b"x")
    (tmp_path / "folder.tif").mkdir()
    os.symlink(tmp_path / "a.tif", tmp_path / "link.tif")
    found = list_images([str(tmp_path / "b.tif"), str(tmp_path / "*.tif")])
    assert [os.path.basename(one.path) for one in found] == ["b.tif", "a.tif", "c[1].tif"]
    (exact,) = list_images([str(tmp_path / "c[1].tif")])
    assert exact.size == 1
    (missing,) = list_images([str(tmp_path / "missing.tif")])
    assert (missing.stamp, missing.size) == ("", 0)


def test_folders_and_plans_are_no_images(tmp_path):
    """All of them are named at once; folders that a pattern matches are passed over."""
    (tmp_path / "im").mkdir()
    for name in ("a.tif", "plan.TOML", "im/b.tif"):
        (tmp_path / name).write_bytes(b"x")
    given = [str(tmp_path / name) for name in ("a.tif", "im", "none-*", "plan.TOML")]
    with pytest.raises(OptionError) as caught:
        list_images(given)
    for words in (
        f"no file matches {given[2]}: correct",
        f"no images but folders: {given[1]}: write {tmp_path}/im/*.tif",
        f"no images but plans: {given[3]}: give a plan alone",
    ):
        assert words in str(caught.value)
    with pytest.raises(OptionError, match="no images but plans"):
        list_images([str(tmp_path / "*")])
    (tmp_path / "plan.TOML").unlink()
    assert [one.path for one in list_images([str(tmp_path / "*")])] == [given[0]]


def test_a_document_beside_an_image_changes_its_stamp(tmp_path):
    image = tmp_path / "a.tif"
    image.write_bytes(b"x")
    (before,) = list_images([str(image)])
    (tmp_path / "a.IMD").write_text("A = 1")
    (after,) = list_images([str(image)])
    assert before.stamp != after.stamp


@pytest.mark.parametrize("gsd_m", [1e9, [0.5, 1e9], [0.5, 0.5, 0.5], -1.0])
def test_a_gsd_that_no_image_has(gsd_m):
    with pytest.raises(OptionError, match="stated 1, gsd_m is"):
        plan_of({**NEEDED, "stated": {"gsd_m": gsd_m}}, "plan")
