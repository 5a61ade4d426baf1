"""``acutance scan``: the answer, tables of the edges, and what is refused."""

import base64
import csv
import json
import re

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.raster import write_geotiff


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """Half a megapixel of ground without texture, with sharp objects on it."""
    image, _ = simulate.landscape(
        simulate.reference_systems()["gaussian"],
        shape=(500, 500),
        snr=100,
        options=simulate.LandscapeOptions(soft=0.0, texture=(0.0, 0.0), density_per_mpx=80),
        rng=np.random.default_rng(6),
    )
    path = tmp_path_factory.mktemp("scenes") / "scene.tif"
    write_geotiff(path, image.astype(np.float32), gsd_m=2.0)
    return path


@pytest.fixture(scope="module")
def kept(scene):
    """Words by which runs over the scene share its windows: the first one scans them."""
    return "--workers", 1, "--keep", scene.with_name("scene.parts")


def test_a_scene_is_measured_and_its_edges_are_written(
    acutance, scene, kept, tmp_path, keeps_to_schema, few_forms
):
    table = tmp_path / "edges.csv"
    with few_forms():
        done = acutance("scan", scene, *kept, "--json", "--edges", table, "--field", "2x4")
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    keeps_to_schema(document)
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert document["kind"] == "scene"
    assert len(document["field"]["places"]) == 8
    assert len(rows) == document["edges"]["found"]
    assert sum(row["used"] == "1" for row in rows) == document["edges"]["used"]


def test_edges_are_written_as_a_layer_and_may_be_long_ones_alone(
    acutance, scene, tmp_path, few_forms
):
    layer = tmp_path / "edges.geojson"
    with few_forms():
        done = acutance("scan", scene, "--min-length", 25, "--workers", 1, "--edges", layer)
    assert done.exit_code == 0, done.stderr
    assert "Edges of the scene" in done.stdout
    features = json.loads(layer.read_text())["features"]
    assert min(feature["properties"]["length_px"] for feature in features) >= 25


def test_the_help_has_the_lengths_that_are_taken(acutance, refused, scene):
    words = " ".join(acutance("scan", "--help").stdout.split())
    least, most = map(int, re.search(r"usable\. (\d+) to (\d+): long edges", words).groups())
    for length in (least, most):
        assert ac.ScanOptions(min_length_px=length).min_length_px == length
    for length in (least - 1, most + 1):
        refused(("scan", scene, "--min-length", length), f"is {length}")


@pytest.fixture(scope="module")
def colours(scene):
    """A part of the scene in two bands, the second of opposite contrast."""
    pixels = ac.open_image(scene).read()[:360, :360]
    noise = np.random.default_rng(1).normal(0, 2, pixels.shape)
    path = scene.with_name("colours.tif")
    write_geotiff(path, np.array([pixels, 2000 + noise - pixels], np.float32), gsd_m=2.0)
    return path


def test_a_softness_of_all_objects_is_stated(acutance, scene, kept, keeps_to_schema, few_forms):
    with few_forms():
        done = acutance("scan", scene, *kept, "--json", "--target-softness-m", "0.2+-0.1")
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    keeps_to_schema(document)
    assert document["options"]["target_softness_m"] == {"value": 0.2, "std": 0.1}
    assert {row["term"] for row in document["budget"]} >= {"fit", "target_softness"}


def test_several_bands_are_one_run(acutance, colours, tmp_path, shown, keeps_to_schema, few_forms):
    with few_forms():
        done = acutance(
            "scan", colours, "--band", "all", "--workers", 1, "--keep", tmp_path / "scan.parts",
            "--edges", tmp_path / "edges.csv", "--figure", tmp_path / "scan.png", "--json",
        )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["schema"] == "acutance/bands/1"
    assert [one["band"] for one in document["results"]] == ["1", "2"]
    for one in document["results"]:
        keeps_to_schema({name: value for name, value in one.items() if name != "band"})
    (shift,) = document["shifts"]
    assert (shift["band"], shift["relative_to"]) == ("2", "1")
    assert abs(shift["row_px"]["value"]) < 3 * shift["row_px"]["std"]
    rows = list(csv.DictReader((tmp_path / "edges.csv").read_text().splitlines()))
    assert len(rows) == 2 * document["results"][0]["edges"]["found"]
    assert [call[0] for call in shown] == ["draw", "draw"]
    assert sorted(path.name for path in tmp_path.glob("*.png")) == [
        "scan-band-1.png", "scan-band-2.png"
    ]  # fmt: skip
    # The windows are kept: text and page are a matter of seconds.
    with few_forms():
        done = acutance(
            "scan", colours, "--band", "1,2", "--workers", 1, "--keep", tmp_path / "scan.parts",
            "--report", tmp_path / "scan.html",
        )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    assert "scene in 2 bands" in done.stdout
    assert "Shifts relative to band 1" in done.stdout
    page = (tmp_path / "scan.html").read_text()
    assert "Band 2: result" in page
    assert "Shifts relative to band 1" in page
    # Drawings are images in the page; each map of edges has one more, its quick look.
    maps = [base64.b64decode(one) for one in re.findall(r"svg\+xml;base64,([^\"]+)", page)]
    assert sum(b"Edges of the scene" in one and b"<image" in one for one in maps) == 2


def test_edges_of_a_map_have_longitude_and_latitude(acutance, scene, tmp_path, few_forms):
    parquet = pytest.importorskip("pyarrow.parquet")
    placed = tmp_path / "placed.tif"
    write_geotiff(
        placed, ac.open_image(scene).read().astype(np.float32), crs="EPSG:32631",
        transform=(2.0, 0.0, 500000.0, 0.0, -2.0, 5400000.0),
    )  # fmt: skip
    kept = ("--keep", tmp_path / "scan.parts", "--workers", 1)
    for ending in ("csv", "parquet"):
        with few_forms():
            done = acutance("scan", placed, *kept, "--edges", tmp_path / f"edges.{ending}")
        assert done.exit_code == 0, done.stderr
    rows = list(csv.DictReader((tmp_path / "edges.csv").read_text().splitlines()))
    table = parquet.read_table(tmp_path / "edges.parquet")
    place = ac.open_image(placed).geolocation
    lon, lat = place.to_lonlat(table["row"].to_numpy(), table["col"].to_numpy())
    np.testing.assert_array_equal(table["lon_deg"].to_numpy(), lon)
    assert [float(row["lat_deg"]) for row in rows] == pytest.approx(lat.tolist(), abs=1e-8)


def test_a_page_is_of_the_scene(acutance, scene, kept, tmp_path, shown, few_forms):
    with few_forms():
        done = acutance("scan", scene, *kept, "--report", tmp_path / "scan.html")
    assert done.exit_code == 0, done.stderr
    ((name, result, _),) = [call for call in shown if call[0] == "page"]
    assert (name, result.kind) == ("page", "scene")


@pytest.mark.parametrize(
    ("words", "message", "code"),
    [
        (("--roi", "0,0,60,60"), "at least 8 are needed", 4),
        (("--edges", "edges.txt"), "--edges", 2),
        (("--roi", "0,0,1,1"), "1 x 1 pixels were to be scanned", 2),
        (("--min-length", "1"), "--min-length is 1: give 8 to 42", 2),
        (("--min-length", "60"), "(--min-length) is 60, and longer edges are cut", 2),
        (("--min-length", "60"), "give at most 42", 2),
        (("--workers", "0"), "workers", 2),
        (("--field", "3"), "--field 3 is no grid", 2),
        (("--field", "3x99"), "places (--field) is 3 x 99", 2),
        (("--band", "1,x"), "band 'x' is not the number of a band", 2),
        (("--band", "1,"), "(nothing) is not the number of a band", 2),
        (("--band", "1,1"), "give the number of every band once", 2),
        (("--band", "1,4"), "band 4 of", 2),
        (("--workers", "2", "--dask", "tcp://host:8786"), "--dask cannot be combined", 2),
        (("--keep", "nowhere/scan.parts"), "the folder nowhere does not exist, make it", 2),
        (("--limit", "rows=9"), "rows", 2),
        (("--roi", "500,0,60,60"), "outside", 2),
    ],
)
def test_what_cannot_be_done_is_refused(refused, scene, words, message, code):
    refused(("scan", scene, *words), message, code)


def test_several_regions_are_not_a_scene(refused, scene, tmp_path):
    fields = tmp_path / "fields.geojson"
    squares = [(0, 0), (200, 200)]
    fields.write_text(json.dumps({
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": {"name": f"field {row}"},
                "geometry": {"type": "Polygon", "coordinates": [[
                    [col, row], [col + 99, row], [col + 99, row + 99], [col, row + 99], [col, row],
                ]]},
            }
            for row, col in squares
        ],
    }))  # fmt: skip
    refused(("scan", scene, "--roi", fields), "--roi names 2 regions, and a scene is one")


def test_a_scene_that_is_refused_leaves_the_reasons(acutance, tmp_path):
    image = np.full((200, 200), 100.0, np.float32)
    image[60:140, 60:140] = 400.0
    image += np.random.default_rng(2).normal(0, 2, image.shape).astype(np.float32)
    path, table = tmp_path / "square.tif", tmp_path / "edges.csv"
    write_geotiff(path, image, gsd_m=2.0)
    for band in ((), ("--band", "all")):
        table.unlink(missing_ok=True)
        done = acutance("scan", path, "--workers", 1, "--edges", table, *band)
        assert done.exit_code == 4
        assert "--edges FILE" not in done.stderr
        assert "Edges left out" in done.stderr
        assert "to its angle" in done.stderr or "sample phases over" in done.stderr
        rows = list(csv.DictReader(table.read_text().splitlines()))
        assert rows
        assert all(row["reason"] for row in rows if row["used"] != "True")
    assert "the reason of each: --edges FILE" in acutance("scan", path, "--workers", 1).stderr


def test_an_image_without_data_is_named(refused, tmp_path):
    path = tmp_path / "nothing.npy"
    np.save(path, np.full((100, 100), np.nan))
    refused(("scan", path), "none of the 100 x 100 pixels holds data", 4)


def test_the_help_promises_no_more_than_one_region(acutance, scene, tmp_path):
    shown = " ".join(acutance("scan", "--help").stdout.split())
    assert "a GeoJSON file with one polygon" in shown
    assert "each polygon of which" not in shown
    assert "several regions" not in shown
    corners = [[[10, 10], [200, 10], [200, 200], [10, 10]], [[9, 9], [99, 9], [99, 99], [9, 9]]]
    polygons = [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [one]}}
        for one in corners
    ]
    places = tmp_path / "two.geojson"
    places.write_text(json.dumps({"type": "FeatureCollection", "features": polygons}))
    refused = acutance("scan", scene, "--roi", places)
    assert refused.exit_code == 2
    assert "a scene is one" in refused.stderr
