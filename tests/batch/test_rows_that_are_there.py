"""Rows of an archive that another batch finds there: what outlives its reason, what stays."""

from __future__ import annotations

import json

import pytest
from surveyed_field import EDGE, GSD_M, PULSE, feature, line_of, survey

from acutance.archive import Archive, ImageCorrection
from acutance.batch import BatchPlan
from acutance.batch.plan import StatedOfImages
from acutance.geometry import Line


@pytest.fixture
def overview(tmp_path):
    """Counts of the archive."""

    def read():
        with Archive(tmp_path / "kept.db", read_only=True) as archive:
            return archive.overview()

    return read


def test_an_image_that_arrives_late_is_missing_no_longer(write_field, run, rows, overview):
    there, late = write_field(0), write_field(1)
    pixels = late.read_bytes()
    late.unlink()
    assert run(there, late).reasons == {"no such file": 1}
    assert (overview().images, overview().rejected) == (2, 1)
    late.write_bytes(pixels)
    assert run(there, late).kept == 2
    assert len(rows()[1]) == 0
    assert (overview().images, overview().rejected) == (2, 0)
    # What is measured stays when the file goes, and is there when it comes back.
    late.unlink()
    assert run(late).missing == (str(late),)
    late.write_bytes(pixels)
    found = run(late)
    assert (found.kept, found.done_before) == (0, 2)
    assert (len(rows()[0]), len(rows()[1])) == (4, 0)


def test_a_file_that_arrives_and_is_no_image_has_the_row_of_its_content(run, rows, tmp_path):
    run(tmp_path / "late.tif")
    (tmp_path / "late.tif").write_text("no image")
    assert run(tmp_path / "late.tif").reasons == {"unreadable image": 1}
    assert [one["why"] for one in rows()[1]["values"]] == ["unreadable image"]


@pytest.fixture
def run_stated(run):
    """Run a batch of images of which something is stated."""

    def run_with(*images, targets=None, stated=(), **values):
        plan = BatchPlan((), {}, "", stated=(*stated, StatedOfImages(**values)))
        return run(*images, targets=targets, plan=plan)

    return run_with


@pytest.mark.parametrize("is_remembered", [True, False])
def test_what_is_stated_of_images_that_are_kept_is_named(
    write_field, run, run_stated, tmp_path, monkeypatch, is_remembered
):
    images = [write_field(number) for number in range(2)]
    assert run(*images).kept_otherwise == {}
    if not is_remembered:
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "another"))
    both = StatedOfImages(sensor="OTHER", level="L1")
    first = StatedOfImages(images=("field-0.tif",), sensor="SIM-1")
    found = run_stated(*images, stated=[both], images=("field-0.tif",), sensor="SIM-1")
    assert (found.kept, found.done_before) == (0, 4)
    assert found.kept_otherwise == {
        str(images[0]): {"level": (None, "L1")},
        str(images[1]): {"level": (None, "L1"), "sensor": ("SIM-1", "OTHER")},
    }
    assert found.to_dict()["kept_otherwise"][str(images[1])]["sensor"] == ["SIM-1", "OTHER"]
    assert found.summary().endswith("; 2 images kept otherwise than stated")
    with Archive(tmp_path / "kept.db") as archive:
        archive.correct_images([ImageCorrection(image="field-*.tif", level="L1")])
        archive.correct_images([ImageCorrection(image="field-1.tif", sensor="OTHER")])
    assert run_stated(*images, stated=[both, first]).kept_otherwise == {}


def test_what_a_plan_states_from_the_beginning_is_no_contradiction(
    write_field, run_stated, tmp_path
):
    bad = tmp_path / "bad.tif"
    bad.write_text("no image")
    given = {"sensor": "S", "level": "L1", "acquired": "2026-03-04", "view_zenith_deg": 20.3}
    for _ in range(2):
        assert run_stated(write_field(0), bad, **given).kept_otherwise == {}


def test_rows_of_a_new_target_have_what_is_stated_and_older_ones_are_named(
    write_field, run, run_stated, rows
):
    image = write_field(0)
    edge, pulse = survey()["features"]
    run(image, targets=survey(edge))
    assert run_stated(image, targets=survey(pulse), sensor="OTHER").kept_otherwise == {}
    found = run_stated(image, sensor="OTHER")
    assert (found.kept, found.done_before) == (0, 2)
    assert found.kept_otherwise == {str(image): {"sensor": ("SIM-1", "OTHER")}}
    assert sorted(rows()[0]["sensor"]) == ["OTHER", "SIM-1"]


def test_documents_that_are_stated_later_are_compared(write_field, run, run_stated, tmp_path):
    image, document = write_field(0), tmp_path / "elsewhere.json"
    document.write_text(json.dumps({
        "type": "Feature", "stac_version": "1.0.0", "id": "x", "links": [],
        "properties": {"datetime": "2026-01-01T10:00:00Z", "platform": "OTHER"},
        "assets": {"pan": {"href": "field-0.tif"}},
    }))  # fmt: skip
    run(image)
    found = run_stated(image, metadata=(str(document),))
    assert found.kept_otherwise == {str(image): {"sensor": ("SIM-1", "OTHER")}}


IMD = """version = "R";
bandId = "P";
BEGIN_GROUP = IMAGE_1
 satId = "QB02";
END_GROUP = IMAGE_1
BEGIN_GROUP = MAP_PROJECTED_PRODUCT
 productGSD = {};
END_GROUP = MAP_PROJECTED_PRODUCT
END;
"""


def pulse_in_pixels(name, **width):
    """The pulse of the field, for images without a map."""
    across = Line(PULSE.row, PULSE.col, PULSE.normal_deg)
    ends = [[end.col, end.row] for end in (across.slid(-20.0), across.slid(20.0))]
    return feature(name, "pulse", "LineString", ends, position_std_m=None, **width)


def test_a_document_that_arrives_later_counts_for_what_was_rejected_without_it(
    write_field, run, rows, tmp_path, monkeypatch
):
    image = write_field(0, crs=None, transform=None, tags={})
    targets = survey(
        pulse_in_pixels("in metres", width_m=3 * GSD_M),
        pulse_in_pixels("in pixels", width_px=3.0),
        crs="pixel",
    )
    found = run(image, targets=targets)
    assert (found.measured, found.kept_otherwise) == (1, {})
    assert "needs a GSD" in rows()[1]["reason"][0]
    assert run(image, targets=targets).run is None
    image.with_suffix(".IMD").write_text(IMD.format(GSD_M))
    found = run(image, targets=targets)
    assert (found.measured, found.rejected, found.kept, found.done_before) == (2, 0, 1, 1)
    told = {str(image): {"sensor": (None, "QB02"), "gsd_m": (None, (GSD_M, GSD_M))}}
    assert found.kept_otherwise == told
    measured, rejected = rows()
    assert len(rejected) == 0
    assert dict(zip(measured["target"], measured["sensor"], strict=True)) == {
        "in metres": "QB02", "in pixels": None,
    }  # fmt: skip
    # Whether or not the image is opened again, nothing more is done, and the same is told.
    found = run(image, targets=targets)
    assert (found.run, found.kept_otherwise) == (None, told)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "another"))
    found = run(image, targets=targets)
    assert (found.kept, found.done_before, found.kept_otherwise) == (0, 2, told)
    with Archive(tmp_path / "kept.db") as archive:
        archive.correct_images([ImageCorrection(image=str(image), sensor="X", gsd_m=GSD_M)])
    assert run(image, targets=targets).kept_otherwise == {}


def test_another_archive_has_its_rejections_done_again_too(write_field, run, tmp_path):
    """The image is known with its document by then, and is opened for them."""
    image = write_field(0, crs=None, transform=None, tags={})
    targets = survey(pulse_in_pixels("pulse", width_m=3 * GSD_M), crs="pixel")
    assert run(image, targets=targets).measured == 0
    image.with_suffix(".IMD").write_text(IMD.format(GSD_M))
    assert run(image, targets=targets, archive=tmp_path / "other.db").measured == 1
    found = run(image, targets=targets)
    assert (found.measured, found.rejected, found.kept) == (1, 0, 1)


def test_a_date_that_is_stated_later_counts(write_field, run, run_stated, rows):
    """What is remembered of an image is what was found out under another statement."""
    image = write_field(0, tags={})
    line = line_of(EDGE, 30.0)
    targets = survey(
        feature("at times", "edge", "LineString", line, valid_to="2030-01-01"),
        feature("later", "edge", "LineString", line, valid_from="2030-01-01"),
    )
    assert run(image, targets=targets).reasons == {"no date": 2}
    found = run_stated(image, targets=targets, acquired="2026-03-04")
    assert (found.measured, dict(found.reasons)) == (1, {"not there then": 1})
    # The rows without a date are gone: they said that the image states none.
    assert [one["why"] for one in rows()[1]["values"]] == ["not there then"]
    assert run_stated(image, targets=targets, acquired="2026-03-04").run is None


def test_band_names_that_are_stated_later_count(write_field, run, run_stated):
    image = write_field(0)
    only = survey(feature("edge", "edge", "LineString", line_of(EDGE, 30.0), bands=["pan"]))
    assert run(image, targets=only).missing_bands == ("pan",)
    found = run_stated(image, targets=only, band_names=("pan",))
    assert (found.measured, found.missing_bands) == (1, ())


def test_an_image_that_the_plan_made_unreadable_is_read_once_the_plan_is_right(
    write_field, run_stated, rows, overview
):
    image = write_field(0)
    edge = survey(feature("edge", "edge", "LineString", line_of(EDGE, 30.0)))

    def run_with(*names):
        return run_stated(image, targets=edge, band_names=names)

    for names in (("pan", "nir"), ("blue", "green", "red")):
        # Its one row says what is wrong now.
        assert run_with(*names).reasons == {"unreadable image": 1}
        (reason,) = rows()[1]["reason"]
        assert reason.startswith(f"{len(names)} band_names are stated")
    again = run_with("blue", "green", "red")
    assert (again.kept, again.done_before) == (0, 1)
    found = run_with("pan")
    assert (found.kept, found.measured, found.unreadable) == (1, 1, ())
    assert len(rows()[1]) == 0
    assert (overview().images, set(rows()[0]["sensor"])) == (1, {"SIM-1"})
    # A wrong plan takes nothing from what was measured before.
    assert run_with("pan", "nir").unreadable == (str(image),)
    assert run_with("pan").done_before == 1
    assert len(rows()[1]) == 0


def test_a_table_of_a_curve_counts_by_its_content(write_field, run_stated, tmp_path):
    image, table = write_field(0), tmp_path / "film.csv"

    def run_with(path, power):
        path.write_text("\n".join(f"{value},{value**power}" for value in range(0, 4000, 50)))
        return run_stated(image, linearize=str(path))

    assert run_with(table, 1.0).kept == 2
    assert run_with(tmp_path / "copy.csv", 1.0).done_before == 2
    # Another curve under the same name.
    assert run_with(table, 1.5).kept == 2
