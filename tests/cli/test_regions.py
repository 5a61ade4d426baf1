"""A GeoJSON of several polygons: each is measured, named, and written into files of its own."""

import json

import numpy as np
import pytest

from acutance import optics, simulate

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])
STEMS = ("north", "field-A-1")
PLACES = {"north": (2, 2, 40, 40), "field A/1": (50, 4, 38, 36), "grass": (50, 50, 40, 40)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two edges and a field of noise, side by side in one image, and polygons around them."""
    place = tmp_path_factory.mktemp("regions")
    rng = np.random.default_rng(11)
    image = rng.normal(500.0, 5.0, (96, 96))
    for top, angle in ((0, 6.0), (48, -8.0)):
        edge, _ = simulate.edge(SENSOR, angle_deg=angle, shape=(48, 48), snr=100, rng=rng)
        image[top : top + 48, :48] = edge
    np.save(place / "site.npy", image)
    write_polygons(place / "regions.geojson", PLACES)
    write_polygons(place / "targets.geojson", {name: PLACES[name] for name in list(PLACES)[:2]})
    return place


def write_polygons(path, places):
    """Rectangles in pixels, by name."""
    features = []
    for name, (row, col, height, width) in places.items():
        bottom, right = row + height - 1, col + width - 1
        ring = [[col, row], [right, row], [right, bottom], [col, bottom], [col, row]]
        geometry = {"type": "Polygon", "coordinates": [ring]}
        features.append({"type": "Feature", "properties": {"name": name}, "geometry": geometry})
    crs = {"type": "name", "properties": {"name": "pixel"}}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, "crs": crs}))


def measured(acutance, folder, *words, roi="regions.geojson"):
    return acutance("edge", folder / "site.npy", "--roi", folder / roi, *words)


def test_each_polygon_has_a_result_and_one_without_a_target_is_named(acutance, folder):
    result = measured(acutance, folder, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["schema"] == "acutance/regions/1"
    assert [one["region"] for one in document["results"]] == ["north", "field A/1"]
    for one in document["results"]:
        row, col, height, width = PLACES[one["region"]]
        top, left = one["image"]["roi"][:2]
        assert row <= top < row + height
        assert col <= left < col + width
        assert one["rer"]["value"] == pytest.approx(0.68, abs=0.03)
    ((stage, reason, values),) = (one.values() for one in document["rejected"])
    assert (stage, values) == ("measurement", {"region": "grass"})
    assert "edge" in reason
    assert result.stderr == f"acutance: region grass: {reason}\n"


def test_features_without_an_inside_are_rejected_and_polygons_measured(acutance, folder, tmp_path):
    file = tmp_path / "mixed.geojson"
    write_polygons(file, {"north": PLACES["north"]})
    document = json.loads(file.read_text())
    point = {"type": "Point", "coordinates": [3, 4]}
    document["features"] += [
        {"type": "Feature", "properties": {"name": "mast"}, "geometry": point},
        {"type": "Feature", "properties": {}, "geometry": None},
    ]
    file.write_text(json.dumps(document))
    result = measured(acutance, folder, "--json", roi=file)
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert [one["region"] for one in found["results"]] == ["north"]
    reasons = {one["values"]["region"]: one["reason"] for one in found["rejected"]}
    assert list(reasons) == ["mast", "feature 3"]
    assert reasons["mast"].startswith("it has a 'Point', which has no inside")
    assert reasons["feature 3"].startswith("it has no geometry")
    assert "acutance: region mast: it has a 'Point'" in result.stderr


def test_a_region_that_reaches_beyond_the_image_names_the_part(acutance, folder, tmp_path):
    places = {"north": (-5, -3, 47, 45), "whole": (0, 0, 96, 96)}
    write_polygons(tmp_path / "out.geojson", places)
    result = measured(acutance, folder, roi=tmp_path / "out.geojson")
    assert result.exit_code == 0, result.stderr
    (note,) = (line for line in result.stderr.splitlines() if "beyond" in line)
    assert note == (
        "acutance: region north reaches beyond the image: the part inside, 0,0,41,41 "
        "(row,col,height,width), is measured"
    )


def test_every_polygon_is_measured_as_it_would_be_alone(acutance, folder, tmp_path):
    write_polygons(tmp_path / "one.geojson", {"field A/1": PLACES["field A/1"]})
    alone = json.loads(measured(acutance, folder, "--json", roi=tmp_path / "one.geojson").stdout)
    both = json.loads(measured(acutance, folder, "--json", roi="targets.geojson").stdout)
    assert both["results"][1]["rer"] == alone["rer"]
    assert both["rejected"] == []


@pytest.mark.usefixtures("undrawn")
def test_the_name_of_a_region_is_in_its_page_and_its_document(acutance, folder, tmp_path):
    write_polygons(tmp_path / "one.geojson", {"field A/1": PLACES["field A/1"]})
    page = tmp_path / "edge.html"
    words = ("--json", "--report", page)
    alone = json.loads(measured(acutance, folder, *words, roi=tmp_path / "one.geojson").stdout)
    assert alone["region"] == alone["image"]["region"] == "field A/1"
    assert "<title>field A/1: Edge, method spline</title>" in page.read_text()
    assert "field A/1, rows 50" in page.read_text()
    several = json.loads(measured(acutance, folder, *words).stdout)
    assert [one["image"]["region"] for one in several["results"]] == ["north", "field A/1"]
    assert "<title>north: Edge" in (tmp_path / "edge-north.html").read_text()
    # A number in the file is no name.
    unnamed = json.loads((tmp_path / "one.geojson").read_text())
    unnamed["features"][0]["properties"] = {}
    (tmp_path / "one.geojson").write_text(json.dumps(unnamed))
    alone = json.loads(measured(acutance, folder, "--json", roi=tmp_path / "one.geojson").stdout)
    assert "region" not in alone
    assert alone["image"]["region"] is None


def test_texts_and_files_carry_the_names(acutance, folder, shown, tmp_path):
    result = measured(
        acutance, folder, "--csv", tmp_path / "edge.csv", "--figure", tmp_path / "edge.svg"
    )
    assert result.exit_code == 0, result.stderr
    first, second, grass = f"\n{result.stdout}".split("\nregion ")[1:]
    assert first.startswith("north: Edge, method spline")
    assert second.startswith("field A/1: Edge, method spline")
    assert grass.startswith("grass: not measured: no straight edge")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        f"edge-{name}.{end}" for name in ("north", "field-A-1") for end in ("csv", "svg")
    }
    assert len(shown) == 2


@pytest.mark.usefixtures("undrawn")
def test_a_page_stands_in_the_place_of_the_polygon_without_a_target(acutance, folder, tmp_path):
    page = tmp_path / "edge.html"
    result = measured(acutance, folder, "--report", page)
    assert result.exit_code == 0, result.stderr
    assert {one.name for one in tmp_path.iterdir()} == {
        f"edge-{name}.html" for name in (*STEMS, "grass")
    }
    refused = (tmp_path / "edge-grass.html").read_text(encoding="utf-8")
    assert "Not measured: no straight edge stands out" in refused
    assert "Region grass" in refused


def test_a_polygon_outside_the_image_leaves_the_others_their_results(acutance, folder, tmp_path):
    places = {"far": (500, 500, 30, 30), "north": PLACES["north"], "four pixels": (3, 3, 2, 2)}
    write_polygons(tmp_path / "some.geojson", places)
    result = measured(acutance, folder, "--json", roi=tmp_path / "some.geojson")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert [one["region"] for one in document["results"]] == ["north"]
    reasons = {one["values"]["region"]: one["reason"] for one in document["rejected"]}
    assert "lies outside the image" in reasons["far"]
    assert set(reasons) == {"far", "four pixels"}


def test_files_are_refused_before_anything_is_measured(acutance, folder, tmp_path):
    (tmp_path / "edge-field-A-1.csv").mkdir()
    result = measured(acutance, folder, "--csv", tmp_path / "edge.csv")
    assert result.exit_code == 2
    assert "edge-field-A-1.csv is a folder" in result.stderr


def test_strict_misses_the_polygon_without_a_target(acutance, folder):
    assert measured(acutance, folder, "--strict").exit_code == 3
    assert measured(acutance, folder, "--strict", roi="targets.geojson").exit_code == 0


def test_without_any_target_the_exit_code_is_4(acutance, folder, tmp_path):
    places = {"a b": PLACES["grass"], "a/b": (52, 52, 30, 30)}
    write_polygons(tmp_path / "none.geojson", places)
    result = measured(acutance, folder, "--csv", tmp_path / "e.csv", roi=tmp_path / "none.geojson")
    assert (result.exit_code, result.stdout) == (4, "")
    assert result.stderr.splitlines()[-1] == "acutance: none of the 2 regions could be measured"
    assert not list(tmp_path.glob("*.csv"))


def test_all_edges_of_every_polygon(acutance, folder):
    document = json.loads(
        measured(acutance, folder, "--all", "--json", roi="targets.geojson").stdout
    )
    assert [one["schema"] for one in document["results"]] == ["acutance/target/1"] * 2


def test_help_names_the_files_of_several_regions(acutance):
    shown = " ".join(acutance("edge", "--help").stdout.split())
    for ending in (".png", ".html", ".csv"):
        assert f"FILE-NAME{ending}" in shown
    assert "no FILE.html" in shown
    assert "Edges of every contrast: acutance scan." in shown
