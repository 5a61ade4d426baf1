"""Targets of GeoJSON: what is read, and that all faults are named at once."""

from __future__ import annotations

import json
import pickle

import pytest

from acutance.errors import OptionError
from acutance.raster.surveyed_targets import read_targets, targets_of


def feature(shape="LineString", points=((5.0, 60.0), (5.001, 60.0)), **properties):
    geometry = None if shape is None else {"type": shape, "coordinates": points}
    return {"type": "Feature", "geometry": geometry, "properties": {"kind": "edge", **properties}}


def collection(*features, **members):
    return {"type": "FeatureCollection", "features": list(features), **members}


def refused(document, *messages):
    with pytest.raises(OptionError) as caught:
        targets_of(document, "targets.geojson")
    for message in messages:
        assert message in str(caught.value)


def test_a_file(tmp_path):
    path = tmp_path / "targets.geojson"
    polygon = [[[0, 0], [40, 0], [40, 40], [0, 40], [0, 0]]]
    document = collection(
        feature(name="north", valid_from="2026-01-01", bands=["pan", 3], position_std_m=2),
        feature("Polygon", polygon, name="star", kind="star", cycles=36, description="painted"),
        crs={"type": "name", "properties": {"name": "EPSG:32631"}},
    )
    path.write_text(json.dumps(document), encoding="utf-8-sig")
    north, star = read_targets(str(path))
    assert (north.name, north.kind, north.crs, north.shape) == (
        "north", "edge", "EPSG:32631", "LineString",
    )  # fmt: skip
    assert (north.valid_from.isoformat(), north.valid_to, north.bands) == (
        "2026-01-01", None, ("pan", 3),
    )  # fmt: skip
    assert (star.settings, len(star.points)) == ({"cycles": 36}, 4)
    assert star.definition["properties"]["description"] == "painted"
    assert pickle.loads(pickle.dumps(star)).definition == star.definition


def test_a_document_in_memory_declares_its_crs_as_a_file_does(tmp_path):
    path = tmp_path / "targets.geojson"
    for crs in ("EPSG:32631", {"type": "name", "properties": {"name": "EPSG:32631"}}):
        document = collection(feature(points=((5e5, 5e6), (500010, 5e6))), crs=crs)
        path.write_text(json.dumps(document))
        (kept,), (read,) = targets_of(document, "targets"), read_targets(str(path))
        assert (kept.crs, kept.definition) == ("EPSG:32631", read.definition)
    refused(collection(feature(), crs={"type": "name"}), '"crs" without a name')


def test_without_a_crs_coordinates_are_degrees():
    (target,) = targets_of(feature(), "targets")
    assert (target.crs, target.name, target.in_pixels) == ("OGC:CRS84", "1", False)
    refused(feature(points=((600000, 5000000), (600010, 5000000))), "no longitude and latitude")


def test_pixels():
    (target,) = targets_of(feature(points=((10, 20), (30, 20))), "targets", "pixel")
    assert target.in_pixels


@pytest.mark.parametrize("more", [{}, {"colour": 1}])
def test_metres_of_places_in_pixels_are_refused(more):
    """They would mean nothing: the place of such a target is uncertain by position_std_px."""
    known = feature(points=((10, 20), (30, 20)), position_std_m=40, **more)
    with pytest.raises(OptionError, match="its own is in pixels: give position_std_px"):
        targets_of(known, "targets", "pixel")
    site = feature(None, site="Salon de Provence", position_std_m=40)
    assert targets_of(site, "targets", "pixel")[0].position_std_m == 40


@pytest.mark.parametrize("more", [{}, {"colour": 1}])
def test_pixels_of_places_on_the_ground_are_refused(more):
    """They were ignored: the target was looked for within three times 5 m."""
    refused(feature(position_std_px=30, **more), "its own is on the ground: give position_std_m")
    site = feature(None, site="Salon de Provence", position_std_px=30)
    with pytest.raises(OptionError, match="give position_std_m"):
        targets_of(site, "targets", "pixel")
    known = feature(points=((10, 20), (30, 20)), position_std_px=3)
    assert targets_of(known, "targets", "pixel")[0].position_std_px == 3


def test_a_site_of_the_catalogue_needs_no_geometry():
    (target,) = targets_of(feature(None, site="Salon de Provence", orientation="across"), "targets")
    assert target.shape == "Point"
    assert target.points == ((5.120278, 43.605833),)
    assert (target.size_m, target.position_std_m) == (60.0, 15.0)
    assert target.settings == {"orientation": "across"}


def test_all_faults_of_all_features_at_once():
    document = collection(
        feature(name="a", kind="wires"),
        feature(name="b", colour="red", width_m=3, valid_from="soon"),
        feature("Point", [5.0, 60.0], name="c"),
        feature(None, name="d"),
        feature(None, name="e", site="atlantis"),
        feature(None, name="f", site="big-spring"),
        feature(name="g", valid_from="2026-02-01", valid_to="2026-01-01"),
        feature("Point", [5.0, 60.0], name="h", kind="points", size_m=10),
        feature("LineString", [[5, 60]], name="i"),
        feature("LineString", [[5, 60], [5, float("nan")]], name="j"),
        feature("LineString", "nowhere", name="k"),
        feature("Polygon", [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 0], [1, 1]]], name="l"),
        feature(name="m", kind="pulse", width_m=3, width_px=4),
        feature(name="n", position_std_m=-1),
        feature(name="o", valid_from=20260101),
        feature(name="same"),
        feature(name="same"),
        {"type": "Polygon"},
        "feature",
    )
    refused(
        document,
        "target 1 (a): kind is 'wires'",
        "target 2 (b): there is no property 'colour'",
        "target 2 (b): valid_from is 'soon'",
        "target 3 (c): a Point needs size_m",
        "target 4 (d): it has no geometry, and names no site",
        "target 5 (e): there is no site 'atlantis'",
        "target 6 (f): the coordinates of Big Spring",
        "target 7 (g): valid_to 2026-01-01 is before",
        "target 8 (h): its geometry is 'Point': the kind 'points' takes MultiPoint or Polygon",
        "target 9 (i): its LineString has 1 points",
        "target 10 (j): a coordinate is no finite number",
        "target 11 (k): its coordinates are not pairs",
        "target 12 (l): its Polygon has 2 rings",
        "target 13 (m): width_m and width_px are both given",
        "target 14 (n): position_std_m is -1",
        "target 15 (o): valid_from is 20260101",
        "2 features have the name 'same'",
        "target 18: it is no GeoJSON Feature",
        "target 19: it is no GeoJSON Feature",
    )


def test_no_fault_hides_another():
    document = collection(
        feature("LineString", [["x", 60], [5, 60]], name="a", kind="wires", size_px=-4),
        feature("Point", [5.0, 60.0], name="b", kind="star", width_m=3, colour="red"),
        feature("MultiPoint", [[5.0, 60.0]], name="b", kind="star", valid_from="soon"),
        feature("Circle", [5.0, 60.0], name="a", kind="wires"),
    )
    refused(
        document,
        "target 1 (a): kind is 'wires'",
        "target 1 (a): size_px is -4",
        "target 1 (a): its coordinates are not pairs",
        "target 2 (b): there is no property 'colour'",
        "target 2 (b): width_m is no property of the kind 'star'",
        "target 2 (b): a Point needs size_m",
        "target 3 (b): valid_from is 'soon'",
        "target 3 (b): its geometry is 'MultiPoint'",
        "target 4 (a): its geometry is 'Circle': targets take LineString or Polygon",
        "2 features have the name 'a'",
        "2 features have the name 'b'",
    )


def test_an_unknown_crs_is_named_with_all_else_and_gdal_is_silent(capfd):
    unknown = "the coordinate reference system 'EPSG:99999999' is not known"
    with pytest.raises(OptionError, match=rf"{unknown}(.|\n)*colour"):
        targets_of(collection(feature(name="a", colour=1)), "targets.geojson", "EPSG:99999999")
    assert "PROJ" not in capfd.readouterr().err


def test_properties_of_other_kinds():
    refused(feature(width_m=3.0), "width_m is no property of the kind 'edge'")
    refused(feature(kind="pulse", cycles=36), "cycles is no property of the kind 'pulse'")


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (collection(), "holds no features"),
        ({"type": "Polygon"}, "write the targets as a FeatureCollection"),
        ({}, "write the targets as a FeatureCollection"),
        ({"type": "FeatureCollection", "features": {}}, "FeatureCollection"),
        (feature(kind=None), "kind is None"),
        ({"type": "Feature", "geometry": None, "properties": None}, "'kind' is missing"),
    ],
)
def test_what_holds_no_targets(document, message):
    refused(document, message)


def test_files_that_are_none(tmp_path):
    with pytest.raises(OptionError, match=r"cannot be read .*No such file"):
        read_targets(str(tmp_path / "none.geojson"))
    path = tmp_path / "targets.geojson"
    path.write_text("[1, 2")
    with pytest.raises(OptionError, match="cannot be read as GeoJSON"):
        read_targets(str(path))
    path.write_text("[1, 2]")
    with pytest.raises(OptionError, match="not a GeoJSON object"):
        read_targets(str(path))
