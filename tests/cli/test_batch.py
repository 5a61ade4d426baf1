"""``acutance batch``: words, files, exit codes."""

import json
import shlex
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from acutance import optics
from acutance.batch.summary import BatchSummary
from acutance.cli.batch import _kept_otherwise
from acutance.raster import write_geotiff

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=0.7)
LINE = {"type": "LineString", "coordinates": [[21.5, 8], [16.8, 52]]}


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def targets_file(tmp_path, *features):
    path = tmp_path / "targets.geojson"
    document = {"type": "FeatureCollection", "crs": "pixel", "features": list(features)}
    path.write_text(json.dumps(document))
    return path


def edge(name="edge", **properties):
    return {
        "type": "Feature",
        "geometry": LINE,
        "properties": {"kind": "edge", "name": name, "position_std_px": 1, **properties},
    }


@pytest.fixture
def flat_image(tmp_path):
    path = tmp_path / "flat.tif"
    noise = np.random.default_rng(1).normal(500.0, 5.0, (60, 44))
    write_geotiff(path, noise.astype(np.float32), gsd_m=0.7)
    return path


@pytest.fixture
def given(tmp_path, edge_image):
    """The words of a batch that measures one edge."""
    return (
        "batch", edge_image, "--targets", targets_file(tmp_path, edge()),
        "--archive", tmp_path / "kept.db", "--workers", 1,
    )  # fmt: skip


def test_a_batch_and_the_same_again(acutance, given):
    first = acutance(*given)
    assert first.exit_code == 0, first.output
    assert "1 image: 1 row added" in first.stdout
    assert "measured 1: 1 good" in first.stdout
    again = acutance(*given, "--json")
    document = json.loads(again.stdout)
    assert document["schema"] == "acutance/batch/1"
    assert (document["kept"], document["done_before"], document["measured"]) == (0, 1, 1)


def test_a_height_is_stated_of_all_images(acutance, given):
    """Images with a geotransform do without, and are not measured again because of it."""
    first = json.loads(acutance(*given, "--json").stdout)
    done = json.loads(acutance(*given, "--height", "120", "--json").stdout)
    assert first["kept"] > 0
    assert (done["kept"], done["done_before"]) == (0, first["kept"] + first["done_before"])
    assert acutance(*given, "--height", "120000").exit_code == 2


def test_a_sensor_that_is_stated_of_kept_images_is_told(acutance, given, edge_image, tmp_path):
    acutance(*given)
    told = acutance(*given, "--sensor", "OTHER")
    assert told.exit_code == 0
    assert f"not changed: {edge_image} is kept with sensor not known, not OTHER" in told.stdout
    (command,) = (line for line in told.stdout.splitlines() if "archive correct" in line)
    words = shlex.split(command.partition("where they are wrong: acutance ")[2])
    assert acutance(*words).exit_code == 0
    assert "not changed" not in acutance(*given, "--sensor", "OTHER").stdout
    document = json.loads(acutance(*given, "--sensor", "THIRD", "--json").stdout)
    assert document["kept_otherwise"] == {edge_image: {"sensor": ["OTHER", "THIRD"]}}


def test_a_log_has_a_line_for_every_row(acutance, given, tmp_path):
    acutance(*given, "--log", tmp_path / "log.jsonl", "--sensor", "QB02")
    (line,) = (tmp_path / "log.jsonl").read_text().splitlines()
    found = json.loads(line)
    assert (found["target"], found["verdict"], found["reason"]) == ("edge", "good", None)
    assert len(found["key"]) == 64
    age = datetime.now(UTC) - datetime.fromisoformat(found["time"])
    assert found["time"].endswith("Z")
    assert age < timedelta(minutes=10)


def test_a_plan(acutance, tmp_path, edge_image, refused):
    targets_file(tmp_path, edge())
    plan = tmp_path / "plan.toml"
    plan.write_text(f'images = "{edge_image}"\ntargets = "targets.geojson"\narchive = "kept.db"\n')
    found = acutance("batch", plan, "--workers", 1, "--json")
    assert json.loads(found.stdout)["kept"] == 1
    assert (tmp_path / "kept.db").exists()
    refused(("batch", plan, edge_image), "is a plan and names its images")
    plan.write_text('imges = "x"\ntargets = "t"\ncolour = 1\n')
    refused(("batch", plan), "there is no key 'imges' - there is no key 'colour'")


def test_nothing_that_can_be_measured(acutance, given, flat_image, tmp_path):
    words = [flat_image if one == given[1] else one for one in given]
    result = acutance(*words)
    assert result.exit_code == 4
    assert "rejected 1: 1 not found" in result.stdout
    assert "reasons in full: acutance archive list" in result.stdout
    assert result.stdout.count("acutance archive list") == 1
    assert "nothing could be measured" in result.stderr


def test_strict(acutance, given, flat_image):
    assert acutance(*given, "--strict").exit_code == 0
    result = acutance(*given, flat_image, "--strict")
    assert result.exit_code == 3
    assert "1 row is rejected" in result.stderr
    assert "rejected 1: 1 not found" in result.stdout
    assert acutance(*given, flat_image).exit_code == 0


def test_a_misspelt_image_is_told_with_the_nearest_name(acutance, given, tmp_path, edge_image):
    edge_image = Path(edge_image)
    wrong = edge_image.with_name(f"{edge_image.stem}0{edge_image.suffix}")
    done = acutance(*given, wrong)
    told = f"unreadable: {wrong} does not exist (its folder exists): is {edge_image} meant?"
    assert told in done.stdout
    assert "rejected 1: 1 missing file" in done.stdout
    document = json.loads(acutance(*given, wrong, "--json").stdout)
    assert document["reasons"] == {"no such file": 1}
    assert document["missing"] == [str(wrong)]
    listed = acutance("archive", "list", tmp_path / "kept.db", "--rejected", "--json").stdout
    assert f"is {edge_image} meant?" in listed


def test_a_copy_is_measured_once_and_told(acutance, given, tmp_path, edge_image):
    copy = tmp_path / "a copy é.tif"
    copy.write_bytes(Path(edge_image).read_bytes())
    done = acutance(*given, copy)
    assert "2 images: 1 row added" in done.stdout
    assert f"measured once: {copy} and {edge_image} have the same content" in done.stdout


def test_all_bands_are_asked_for_by_that_word(acutance, given):
    done = acutance(*given, "--band", "all")
    assert done.exit_code == 0, done.output
    assert "1 image: 1 row added" in done.stdout
    assert "no image has band" not in done.stdout


def test_unreadable_images_are_named(acutance, given, tmp_path):
    bad = tmp_path / "bad.tif"
    bad.write_bytes(b"II*\x00")
    result = acutance(*given, bad)
    assert result.exit_code == 0
    assert f"unreadable: {bad}" in result.stdout


def test_what_is_refused(refused, given, tmp_path, edge_image):
    refused(("batch", edge_image), "images need --targets FILE and --archive PLACE")
    refused((*given, "--dask", "tcp://x:1"), "--workers and --dask cannot be combined")
    refused((*given, "--band", "pan,,3"), "--band pan,,3")
    refused((*given, "--log", tmp_path), "--log")
    refused((*given[:-2], "--workers", 1, tmp_path / "x-*.tif"), "no file matches")
    (tmp_path / "kept.db").write_bytes(b"not a database, but long enough to be read as one" * 50)
    refused(given, "kept.db")


def test_a_folder_and_a_plan_among_images_are_refused_before_the_work(
    refused, given, tmp_path, edge_image
):
    folder = tmp_path / "im"
    folder.mkdir()
    (tmp_path / "plan.toml").write_text("")
    refused((*given, folder), f"no images but folders: {folder}: write {folder}/*.tif")
    refused((*given, tmp_path / "plan.toml"), "plan.toml is a plan and names its images: give it")
    assert not (tmp_path / "kept.db").exists()


def test_faults_of_targets_are_named_together(refused, given, tmp_path):
    targets_file(tmp_path, edge("a", kind="wires"), edge("b", colour=1))
    refused(given, "target 1 (a): kind is 'wires'")
    refused(given, "target 2 (b): there is no property 'colour'")


def test_ctrl_c(acutance, given, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("acutance.batch.whole_batch.run_tasks", interrupt)
    result = acutance(*given)
    assert result.exit_code == 130
    assert "the same command goes on" in result.stderr


def test_all_faults_of_options_are_named_and_no_archive_is_made(acutance, given, tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text(
        f'images = ["{given[1]}"]\ntargets = "{given[3]}"\narchive = "new.db"\n[edge]\nfoo = 1\n'
        "target_softness_m = {value = 1}\n[edge.limits]\nrowz = 3\ncolour = 2\n"
    )
    done = acutance("batch", plan)
    assert done.exit_code == 2
    for part in ("edge has no option 'foo'", "the plan: there is no check 'rowz'",
                 "there is no check 'colour'", "target_softness_m is {'value': 1}"):  # fmt: skip
        assert part in done.stderr
    assert not (tmp_path / "new.db").exists()


def test_rows_without_metres_are_told_how_they_get_them():
    found = BatchSummary(
        archive="kept.db", images=1,
        kept_otherwise={"a.tif": {"gsd_m": (None, (2.8, 2.8)), "sensor": (None, "QB02")}},
    )  # fmt: skip
    *_, advice = _kept_otherwise(found)
    assert "acutance archive correct kept.db --image a.tif --sensor QB02;" in advice
    assert "acutance archive remove kept.db --image a.tif, and the same batch again" in advice
