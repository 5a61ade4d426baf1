"""Every target of every image once: measured, or rejected with its reason."""

from __future__ import annotations

import shutil
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest
import rasterio
from rasterio.rpc import RPC
from surveyed_field import EDGE, PULSE, SENSOR, feature, line_of, on_map, survey, written

import acutance as ac
from acutance import errors
from acutance.archive import Archive, ImageCorrection
from acutance.batch import BatchPlan
from acutance.batch.image_list import content_of
from acutance.batch.plan import StatedOfImages
from acutance.batch.reason_words import in_words, words_of
from acutance.cli.batch import _text
from acutance.errors import (
    ArchiveError,
    FewEdgesError,
    NoEdgeError,
    OptionError,
    PhaseError,
    WorkerError,
)
from acutance.geometry import Line


def test_targets_are_found_where_the_map_is_metres_off(write_field, run, rows):
    images = [
        write_field(number, off_m) for number, off_m in enumerate([(0, 0), (3.1, -2.2), (-1, 4)])
    ]
    found = run(*images)
    assert (found.images, found.kept, found.measured, found.rejected) == (3, 6, 6, 0)
    measured, _ = rows()
    truth = SENSOR.response(EDGE.normal_deg).mtf_nyquist.value
    away = (measured["mtf_nyquist"] - truth) / measured["mtf_nyquist_std"]
    assert (np.abs(away) < 4).all()
    assert set(measured["sensor"]) == {"SIM-1"}
    assert sorted({str(one)[:10] for one in measured["acquired"]}) == [
        "2026-01-01", "2026-01-02", "2026-01-03",
    ]  # fmt: skip
    for number in range(len(measured)):
        line = measured.record(number).document["line"]
        tarp = EDGE if measured["target"][number] == "edge" else PULSE
        assert abs(line["col"] - tarp.col) < 4
        assert line["normal_deg"] % 180 == pytest.approx(tarp.normal_deg, abs=1)


def test_the_distance_from_the_survey_is_kept(write_field, run, rows, tmp_path):
    """The map of the second image is 3.1 m off across the lines, 2.2 m along them."""
    run(write_field(0), write_field(1, (3.1, -2.2)))
    measured, _ = rows()
    for at in range(len(measured)):
        found = measured.record(at).document["survey_line"]
        off_m = (0.0, 0.0) if "field-0" in measured["image"][at] else (3.1, -2.2)
        angle = np.radians(EDGE.normal_deg)
        true_m = abs(off_m[0] * np.cos(angle) - off_m[1] * np.sin(angle))
        assert found["distance_m"] == pytest.approx(true_m, abs=0.05)
        assert found["distance_px"] == pytest.approx(2 * true_m, abs=0.1)
        assert found["turn_deg"] < 0.6
        assert found["search_px"] == 9.0
    outline = feature("place", "edge", "Polygon", [[on_map(30, 25), on_map(80, 25),
                      on_map(80, 75), on_map(30, 75), on_map(30, 25)]])  # fmt: skip
    run(write_field(0), targets=survey(outline), archive=tmp_path / "outline.db")
    with Archive(tmp_path / "outline.db") as archive:
        assert "survey_line" not in archive.measurements().record(0).document


def test_a_gsd_in_centimetres_is_named_for_every_target(write_field, run, rows):
    image = write_field(0)
    plan = BatchPlan((), {}, "", stated=(StatedOfImages(gsd_m=(50.0, 50.0)),))
    found = run(image, plan=plan)
    assert dict(found.reasons) == {"stated GSD": 2}
    _, rejected = rows()
    assert "the stated GSD is 50 m, the image's own 0.5 m" in rejected["reason"][0]
    assert run(image).measured == 2


def test_a_date_to_the_day_dates_the_rows(write_field, run, rows):
    run(write_field(0, tags={"SENSOR": "S", "ACQUISITION_DATE": "2026-01-05"}))
    measured, _ = rows()
    assert {str(one)[:16] for one in measured["acquired"]} == {"2026-01-05T00:00"}


def test_restored_images_are_named_and_noted(write_field, run, rows):
    tags = {"SENSOR": "SIM-1", "ACUTANCE_RESTORATION": "wiener kernel 11x11; bands 1; gain 1.8"}
    paths = [write_field(0), write_field(1, tags=tags)]
    done = run(*paths)
    assert done.restored == (str(paths[1]),)
    assert f"restored: {paths[1]}" in _text(done)
    measured, _ = rows()
    assert set(measured["image"][measured["restored"]].tolist()) == {"field-1.tif"}


def test_what_is_done_is_not_done_again_and_not_even_opened(write_field, run, monkeypatch):
    images = [write_field(number) for number in range(2)]
    first = run(*images)

    def refuse(*_, **__):
        raise AssertionError("an image that is done was opened")

    monkeypatch.setattr("acutance.batch.measure_image.open_bands", refuse)
    monkeypatch.setattr("acutance.batch.whole_batch.content_of", refuse)
    again = run(*images)
    assert (again.kept, again.done_before, again.run) == (0, 4, None)
    assert again.verdicts == first.verdicts
    monkeypatch.undo()


def test_a_corrected_image_is_not_measured_again(write_field, run, rows, tmp_path):
    images = [write_field(number) for number in range(2)]
    edge, pulse = survey()["features"]
    run(*images, targets=survey(edge))
    wrong = ImageCorrection(image="field-0.tif", sensor="SIM-2", acquired="2025-07-01")
    with Archive(tmp_path / "kept.db") as archive:
        assert len(archive.correct_images([wrong])) == 1
    again = run(*images, targets=survey(edge))
    assert (again.kept, again.done_before) == (0, 2)
    # Another target of the same image is measured, and belongs to the corrected one.
    assert run(*images, targets=survey(pulse)).kept == 2
    measured, _ = rows()
    assert sorted(measured["sensor"]) == ["SIM-1", "SIM-1", "SIM-2", "SIM-2"]
    assert str(measured["acquired"].min())[:10] == "2025-07-01"
    assert len(set(measured["image_id"].tolist())) == 2


def test_what_is_not_remembered_is_found_out_again(write_field, run, monkeypatch, tmp_path):
    image = write_field(0)
    run(image)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "another"))
    again = run(image)
    assert (again.kept, again.done_before) == (0, 2)
    (tmp_path / "another" / "acutance" / "images.db").write_bytes(b"not a database" * 100)
    assert run(image).done_before == 2
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    assert run(image).done_before == 2


def test_a_copy_is_the_same_image_and_a_changed_file_another(write_field, run, tmp_path):
    image = write_field(0)
    run(image)
    copy = tmp_path / "copy.tif"
    shutil.copy(image, copy)
    assert (run(copy).kept, run(image, copy).kept) == (0, 0)
    write_field(0, edit=lambda pixels: pixels + np.uint16(1))
    assert run(image).kept == 2


def test_other_options_are_other_rows(write_field, run, rows, tmp_path):
    image = write_field(0)
    run(image)
    plan = tmp_path / "plan.toml"
    written(tmp_path / "targets.geojson", survey())
    plan.write_text(
        'images = "field-*.tif"\ntargets = "targets.geojson"\narchive = "kept.db"\n'
        '[edge]\nmethod = "iso12233"\n[pulse]\nrobust = false\n'
        "[[stated]]\nsensor = 'QB02'\nalong_track = 'x'\n"
    )
    found = ac.run_batch(plan, workers=1)
    assert (found.kept, found.done_before) == (2, 0)
    measured, _ = rows()
    assert sorted(set(measured["method"])) == ["iso12233", "spline"]
    assert set(measured["sensor"]) == {"SIM-1", "QB02"}
    other = measured["sensor"] == "QB02"
    assert set(measured["orientation"][other]) == {"along"}
    assert ac.run_batch(plan, workers=1).kept == 0


def test_a_new_target_is_measured_in_old_images(write_field, run):
    image = write_field(0)
    run(image, targets=survey(feature("edge", "edge", "LineString", line_of(EDGE, 30.0))))
    found = run(image)
    assert (found.kept, found.done_before, found.measured) == (1, 1, 2)


def test_reasons(write_field, run, rows):
    middle = on_map(EDGE.row, EDGE.col)
    line = line_of(EDGE, 30.0)
    targets = survey(
        feature("there", "edge", "LineString", line),
        feature("outside", "edge", "LineString", [[x + 500, y] for x, y in line]),
        feature("clipped", "edge", "Polygon", [[on_map(*c) for c in
                ((40, -60), (40, 20), (70, 20), (70, -60))]]),
        feature("one pixel", "edge", "LineString", line_of(EDGE, 1.0)),
        feature("small", "star", "Point", middle, size_m=2.0, cycles=36),
        feature("flat", "edge", "LineString", [on_map(5, 40), on_map(8, 80)]),
        feature("turned", "edge", "LineString", [on_map(55, 35), on_map(56, 65)]),
        feature("later", "edge", "LineString", line, valid_from="2026-06-01"),
        feature("other band", "edge", "LineString", line, bands=["nir"]),
        feature("anywhere", "edge", "LineString", line, position_std_m=30.0),
        feature("no points", "points", "MultiPoint", [on_map(20, 20), on_map(90, 90)]),
        feature("no star", "star", "Point", middle, size_m=20.0),
        feature("no bars", "bars", "Point", middle, size_m=20.0, count=4),
    )  # fmt: skip
    found = run(write_field(0), targets=targets)
    assert (found.measured, found.kept) == (1, 12)
    _, rejected = rows()
    why = dict(zip(rejected["target"], (one["why"] for one in rejected["values"]), strict=True))
    assert {name: why.get(name) for name in why if name[:3] != "no "} == {
        "outside": "outside",
        "clipped": "clipped",
        "one pixel": "too small",
        "small": "too small",
        "flat": "not found",
        "turned": "not found",
        "later": "not there then",
        "anywhere": "not located",
    }
    assert {"no points", "no star", "no bars"} <= set(why)
    stage = dict(zip(rejected["target"], rejected["stage"], strict=True))
    assert (stage["outside"], stage["flat"], stage["later"]) == ("region", "find", "date")
    assert found.failed == 9


def test_nodata_on_the_target(write_field, run, rows):
    def cover(pixels):
        pixels[:, :100] = 0
        return pixels

    found = run(write_field(0, edit=cover, nodata=0))
    assert (found.measured, found.reasons) == (1, {"no data": 1})
    _, rejected = rows()
    assert (rejected["target"][0], rejected["stage"][0]) == ("edge", "region")


def test_nodata_on_the_target_and_ground_beside_it(write_field, run, rows):
    def cover(pixels):
        pixels[:, :66] = 0
        return pixels

    found = run(write_field(0, edit=cover, nodata=0))
    assert (found.measured, found.reasons) == (1, {"no data": 1})
    _, rejected = rows()
    assert "100 % of the surveyed line lie on pixels without data" in rejected["reason"][0]


def test_an_image_that_cannot_be_read_stops_no_other(write_field, run, rows, tmp_path):
    whole = write_field(0)
    cut = tmp_path / "cut.tif"
    cut.write_bytes(whole.read_bytes()[:3000])
    none = tmp_path / "none.tif"
    none.write_bytes(b"no image")
    found = run(none, cut, whole, tmp_path / "missing.tif")
    assert found.measured == 2
    assert str(none) in found.unreadable
    assert found.reasons["unreadable image"] >= 2
    assert found.reasons["no such file"] == 1
    assert found.missing == (str(tmp_path / "missing.tif"),)
    again = run(none, cut, whole, tmp_path / "missing.tif")
    assert again.kept == 0
    _, rejected = rows()
    assert sum(one == "image" for one in rejected["stage"]) >= 2


def test_an_image_without_georeference_and_date(write_field, run, rows):
    plain = write_field(0, crs=None, transform=None, tags={})
    targets = survey(
        feature("edge", "edge", "LineString", line_of(EDGE, 30.0)),
        feature("at times", "edge", "LineString", line_of(EDGE, 30.0), valid_to="2030-01-01"),
    )
    found = run(plain, targets=targets)
    assert found.reasons == {"no georeference": 1, "no date": 1}
    _, rejected = rows()
    assert "neither a geotransform with a CRS, RPC nor" in " ".join(rejected["reason"])
    turned = [[one.col + s, one.row + t] for one, s, t in ((EDGE, 1.5, -14), (EDGE, -1.5, 14))]
    pixels = survey(
        feature("pixels", "edge", "LineString", turned, position_std_m=None), crs="pixel"
    )
    assert run(plain, targets=pixels).measured == 1
    measured, _ = rows()
    assert measured["acquired"][0] is None or str(measured["acquired"][0]) == "NaT"


def test_bands_by_name_and_number(field_pixels, tmp_path, run, rows, write_field):
    def three(pixels):
        return np.stack([pixels, pixels + np.uint16(3), pixels + np.uint16(5)])

    image = write_field(0, edit=three)
    line = line_of(EDGE, 30.0)
    targets = survey(
        feature("all", "edge", "LineString", line),
        feature("second", "edge", "LineString", line, bands=[2]),
        feature("named", "edge", "LineString", line, bands=["NIR"]),
    )
    plan = ac.BatchPlan(
        images=(str(image),), targets=targets, archive=str(tmp_path / "kept.db"), workers=1,
        stated=(ac.batch.plan.StatedOfImages(band_names=("pan", "red", "nir")),),
    )  # fmt: skip
    assert ac.run_batch(plan).measured == 5
    measured, _ = rows()
    seen = sorted(zip(measured["target"], measured["band"], strict=True))
    assert seen == [
        ("all", "nir"), ("all", "pan"), ("all", "red"), ("named", "nir"), ("second", "red"),
    ]  # fmt: skip
    assert ac.run_batch(plan, bands=["red"]).kept == 0
    assert ac.run_batch(plan, bands=[np.int64(2), "nir"]).to_dict()["missing_bands"] == []
    with pytest.raises(OptionError, match="list of names or numbers"):
        ac.run_batch(plan, bands=[2.5])
    named = ac.run_batch(plan, bands=["red", "blue", 4])
    assert named.measured == 2
    assert named.missing_bands == ("blue", 4)
    assert named.bands == ("1 (pan)", "2 (red)", "3 (nir)")
    assert named.to_dict()["missing_bands"] == ["blue", 4]


def test_bands_without_names_are_not_one(tmp_path, run, rows, write_field):
    """Their numbers tell them apart: pooled, two bands look like one sensor that is neither."""
    image = write_field(0, edit=lambda pixels: np.stack([pixels, pixels // 2]))
    assert run(image).measured == 4
    measured, _ = rows()
    assert sorted(measured["band"]) == ["1", "1", "2", "2"]
    with Archive(tmp_path / "kept.db", read_only=True) as archive:
        assert len(archive.measurements(band="2")) == 2
    # Of a file with one band the number says nothing.
    run(write_field(1))
    assert None in set(rows()[0]["band"])


def test_workers_give_the_same_rows(write_field, run, rows, tmp_path):
    images = [write_field(number) for number in range(3)]
    run(*images)
    numbers, _ = rows()
    seen = []
    found = run(
        *images, archive=tmp_path / "other.db", workers=2,
        progress=lambda done, total: seen.append((done, total)), kept=seen.append,
    )  # fmt: skip
    assert found.kept == 6
    assert [one for one in seen if isinstance(one, tuple)] == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert sum(len(one) for one in seen if isinstance(one, list)) == 6
    with Archive(tmp_path / "other.db") as archive:
        others = archive.measurements()
        assert archive.keys() == {
            entry.key for some in seen if isinstance(some, list) for entry in some
        }
    assert sorted(others["mtf_nyquist"]) == sorted(numbers["mtf_nyquist"])


def test_a_measurement_that_fails_is_a_row(write_field, run, monkeypatch, rows):
    def fail(*_):
        raise np.linalg.LinAlgError("singular")

    monkeypatch.setattr("acutance.batch.measure_target.measure_target", fail)
    found = run(write_field(0))
    assert found.reasons == {"measurement failed": 2}
    _, rejected = rows()
    assert "LinAlgError: singular" in rejected["reason"][0]


def test_reasons_of_all_errors_are_words(write_field, run, rows, monkeypatch):
    """Kept in words, as the summary has them; older rows with the name of an error are read."""
    several = [FewEdgesError("too few", None), NoEdgeError("none"), PhaseError("aligned")]
    for name in errors.__all__:
        kind = getattr(errors, name)
        words = words_of(kind("x", None) if kind is FewEdgesError else kind("x"))
        assert words
        assert words not in errors.__all__
        assert in_words(name) in (words, name)

    def fail(*_):
        raise several.pop(0)

    monkeypatch.setattr("acutance.batch.measure_target.measure_target", fail)
    lines = (feature(name, "edge", "LineString", line_of(EDGE, 30.0)) for name in "abc")
    found = run(write_field(0), targets=survey(*lines))
    words = {"few edges", "no edge found", "aligned with the pixel grid"}
    assert set(found.reasons) == words
    assert {one["why"] for one in rows()[1]["values"]} == words


def test_a_scene_with_few_edges_names_no_option_of_a_scan(tmp_path, run, rows):
    image = np.full((200, 200), 100.0, np.float32)
    image[60:140, 60:140] = 400.0
    image += np.random.default_rng(2).normal(0, 2, image.shape).astype(np.float32)
    ac.raster.write_geotiff(tmp_path / "square.tif", image, gsd_m=2.0)
    scene = survey(feature("scene", "scene", None, None))
    assert run(tmp_path / "square.tif", targets=scene).reasons == {"few edges": 1}
    (reason,) = rows()[1]["reason"]
    assert "at least" in reason
    assert "measure single edges" in reason
    assert "--" not in reason
    assert "error." not in reason


def test_a_scene_is_kept_with_its_summary(tmp_path, run, rows, few_forms):
    from acutance.simulate import landscape

    pixels, _ = landscape(SENSOR, shape=(300, 300), snr=100, rng=np.random.default_rng(1))
    path = tmp_path / "scene.tif"
    ac.raster.write_geotiff(path, pixels.astype(np.float32), gsd_m=0.5)
    with few_forms():
        found = run(path, targets=survey(feature("scene", "scene", None, None)))
    assert (found.measured, found.rejected) == (1, 0)
    measured, _ = rows()
    assert set(measured["kind"]) == {"scene"}
    assert sorted(measured["orientation"]) == ["across", "along"]


def by_rpc(path):
    """Locate an image by RPC: at a height of 200 m row 50 and column 40 lie at 43 N, 5 E.

    100 m more move columns by 100.
    """
    one, lon, lat, height = (np.eye(20)[at].tolist() for at in (0, 1, 2, 3))
    columns = [a + 0.2 * b for a, b in zip(lon, height, strict=True)]
    with rasterio.open(path, "r+") as dataset:
        dataset.rpcs = RPC(
            height_off=200.0, height_scale=100.0, lat_off=43.0, lat_scale=0.01, long_off=5.0,
            long_scale=0.01, line_off=50.0, line_scale=500.0, samp_off=40.0, samp_scale=500.0,
            line_num_coeff=[-a for a in lat], line_den_coeff=one, samp_num_coeff=columns,
            samp_den_coeff=one, err_bias=None, err_rand=None,
        )  # fmt: skip
    return path


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_heights_of_images_located_by_rpc(write_field, run, rows, tmp_path):
    image = by_rpc(write_field(0, crs=None, transform=None))
    edge = Line(EDGE.row, EDGE.col, EDGE.normal_deg)
    ends = edge.slid(-15.0), edge.slid(15.0)
    points = [[5 + 2e-5 * (end.col - 40), 43 - 2e-5 * (end.row - 50)] for end in ends]
    one = feature("eave", "edge", "LineString", points)
    found = run(image, targets=survey(one, crs="OGC:CRS84"))
    assert found.reasons == {"no height": 1}
    assert "eave states none: give the target height_m" in rows()[1]["reason"][0]

    def run_plan(height_m, target):
        targets = written(tmp_path / "targets.geojson", survey(target, crs="OGC:CRS84"))
        stated = (StatedOfImages(height_m=height_m),)
        plan = BatchPlan((str(image),), str(targets), str(tmp_path / "kept.db"), stated=stated,
                         workers=1)  # fmt: skip
        return ac.run_batch(plan)

    assert run_plan(200.0, one).measured == 1
    assert run_plan(200.0, one).done_before == 1
    assert run_plan(230.0, one).reasons == {"not found": 1}
    own = feature("eave", "edge", "LineString", points, height_m=200)
    assert run_plan(230.0, own).measured == 1
    assert run_plan(None, own).done_before == 1
    assert run_plan(100.0, own).done_before == 1


def test_a_height_counts_only_where_targets_are_placed_by_it(write_field, run, rows, tmp_path):
    images = [write_field(0), write_field(1)]
    first = run(*images)
    stated = BatchPlan(tuple(map(str, images)), survey(), str(tmp_path / "kept.db"),
                       stated=(StatedOfImages(height_m=120.0),), workers=1)  # fmt: skip
    again = ac.run_batch(stated)
    assert (again.kept, again.done_before, again.run) == (0, first.kept, None)
    # Also where nothing is remembered of the images, and they are opened again.
    (tmp_path / "cache").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
        assert ac.run_batch(stated).kept == 0
    assert len(rows()[0]) == first.measured


def test_scenes_that_are_left_over_use_all_processes(tmp_path, run, monkeypatch):
    """Three images and two processes: two side by side, then one over both."""
    tried = []

    def spread(work, tasks, keep, **how):
        tried.append(([task.path for task in tasks], how["workers"]))
        for place, task in enumerate(tasks):
            keep(place, work(task))

    def scan(image, *_, workers, **__):
        tried.append((image.path, workers))
        raise NoEdgeError("no scan here")

    monkeypatch.setattr("acutance.batch.spread_images.run_tasks", spread)
    monkeypatch.setattr("acutance.scan.scan_scene", scan)
    paths = [tmp_path / f"{at}.tif" for at in range(3)]
    for at, path in enumerate(paths):
        ac.raster.write_geotiff(path, np.full((40, 40), at, np.float32), gsd_m=0.5)
    first, second, third = map(str, paths)
    scene = survey(feature("scene", "scene", None, None))
    found = run(*paths, targets=scene, workers=2)
    spread_over_both = ([first, second], 2)
    assert tried == [spread_over_both, (first, 1), (second, 1), ([third], 1), (third, 2)]
    assert found.rejected == 3
    # Other targets of an image that is left over need no more than one process each.
    tried.clear()
    both = survey(feature("scene", "scene", None, None),
                  feature("edge", "edge", "LineString", line_of(EDGE, 30.0)))  # fmt: skip
    again = run(first, targets=both, workers=2, archive=tmp_path / "both.db")
    assert tried == [([], 2), ([first], 2), ([first], 1), (first, 2)]
    assert (again.images, again.kept, again.rejected) == (1, 2, 2)


def test_targets_that_are_measured_before_a_scene_fails_are_kept(
    write_field, run, rows, monkeypatch
):
    def broken(*_, **__):
        raise BrokenProcessPool("killed")

    monkeypatch.setattr("acutance.scan.scan_scene", broken)
    one, other = survey()["features"]
    targets = survey(feature("scene", "scene", None, None), one, other)
    image = write_field(0)
    with pytest.raises(BrokenProcessPool):
        run(image, targets=targets, workers=2)
    assert len(rows()[0]) == 2


def test_an_image_that_cannot_be_read_is_one_row_also_with_scenes(tmp_path, run):
    (tmp_path / "text.tif").write_text("no image")
    edge = survey()["features"][0]
    targets = survey(feature("scene", "scene", None, None), edge)
    found = run(tmp_path / "text.tif", targets=targets, workers=2)
    assert (found.kept, found.rejected, len(found.unreadable)) == (1, 1, 1)


def test_a_scene_is_the_same_over_several_processes(tmp_path, run, few_forms):
    from acutance.simulate import landscape

    pixels, _ = landscape(SENSOR, shape=(300, 700), snr=100, rng=np.random.default_rng(1))
    path = tmp_path / "scene.tif"
    ac.raster.write_geotiff(path, pixels.astype(np.float32), gsd_m=0.5)
    scene = survey(feature("scene", "scene", None, None))
    records = []
    for workers in (1, 2):
        with few_forms():
            found = run(path, targets=scene, workers=workers, archive=tmp_path / f"{workers}.db")
        assert found.measured == 1
        assert found.measuring_s > 0
        with Archive(tmp_path / f"{workers}.db") as archive:
            records.append(archive.measurements().records()[0])
            assert set(archive.keys()) == set(archive.keys(images=[content_of(path)]))
    assert records[0].across.mtf_nyquist == records[1].across.mtf_nyquist


@pytest.mark.parametrize(
    "error", [BrokenProcessPool("killed"), WorkerError("a worker process was killed")]
)
def test_killed_processes_of_a_scene_are_no_rejection(tmp_path, run, rows, monkeypatch, error):
    def killed(*_, **__):
        raise error

    path = tmp_path / "scene.tif"
    ac.raster.write_geotiff(path, np.ones((40, 40), np.float32), gsd_m=0.5)
    monkeypatch.setattr("acutance.scan.scan_scene", killed)
    with pytest.raises(type(error)):
        run(path, targets=survey(feature("scene", "scene", None, None)), workers=2)
    assert len(rows()[1]) == 0


def test_bad_input(write_field, run, tmp_path):
    image = write_field(0)
    with pytest.raises(OptionError, match=r"no file matches .*other-\*\.tif"):
        run(tmp_path / "other-*.tif", image)
    with pytest.raises(OptionError, match="there are no images"):
        run()
    with pytest.raises(OptionError, match="holds no features"):
        run(image, targets={"type": "FeatureCollection", "features": []})
    with pytest.raises(OptionError, match="images, archive: give them"):
        ac.run_batch(targets=survey())
    with pytest.raises(OptionError, match="workers is 0"):
        run(image, workers=0)
    with pytest.raises(OptionError, match="both given"):
        run(image, scheduler="tcp://nowhere:1")
    with pytest.raises(ArchiveError):
        run(image, archive=tmp_path / "no" / "folder.db")


def test_options_of_plan_and_targets_are_refused_together(write_field, tmp_path):
    line = line_of(EDGE, 30.0)
    targets = survey(
        feature("a", "edge", "LineString", line, options={"colour": 1, "robust": True}),
        feature("b", "edge", "LineString", line, method="magic"),
        feature("c", "edge", "LineString", line, options={"limits": {"beauty": 1}}),
        feature("d", "edge", "LineString", line, options={"target_softness_m": {"value": 1}}),
    )
    plan = ac.BatchPlan(
        images=(str(write_field(0)),), targets=targets, archive=str(tmp_path / "kept.db"),
        options={"pulse": {"width": 3}}, workers=1,
    )  # fmt: skip
    with pytest.raises(OptionError) as caught:
        ac.run_batch(plan)
    for words in (
        "the plan: pulse has no option 'width'",
        "target 1 (a): edge has no option 'colour'",
        "target 2 (b): there is no edge method 'magic'",
        "target 3 (c): ",
        "target 4 (d): target_softness_m is",
    ):
        assert words in str(caught.value)


def test_stated_options_enter_the_measurement(write_field, run, rows):
    soft = {"target_softness_m": {"value": 0.1, "std": 0.02}, "level_uncertainty": 0.01}
    line = line_of(EDGE, 30.0)
    targets = survey(
        feature("ideal", "edge", "LineString", line),
        feature("soft", "edge", "LineString", line, options=soft),
    )
    run(write_field(0), targets=targets)
    measured, _ = rows()
    by_name = dict(zip(measured["target"], measured["mtf_nyquist"], strict=True))
    expected = np.exp(0.5 * (2 * np.pi * 0.5 * 0.1 / 0.5) ** 2)
    assert by_name["soft"] / by_name["ideal"] == pytest.approx(expected, rel=2e-2)


def test_an_image_is_left_between_two_targets_when_its_run_ends(write_field, run, monkeypatch):
    """What was measured by then is kept, and the next batch does the rest."""
    path, asked = write_field(0), []
    monkeypatch.setattr(
        "acutance.batch.measure_image.is_ending", lambda: asked.append(1) or len(asked) > 1
    )
    assert run(path).kept == 1
    monkeypatch.undo()
    found = run(path)
    assert (found.done_before, found.kept) == (1, 1)
