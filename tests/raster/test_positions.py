"""Files of positions: CSV and GeoJSON, in pixels, degrees and on the map."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance.errors import RegionError
from acutance.raster import read_positions

PLACES = np.array([[5.25, 10.5], [14.0, 29.75]])


@pytest.fixture
def write(tmp_path):
    def write(text, name="places.csv"):
        path = tmp_path / name
        path.write_text(text if isinstance(text, str) else json.dumps(text))
        return str(path)

    return write


def lines(header, pairs):
    rows = [header] if header else []
    return "\n".join(rows + [f"{one!r},{other!r}" for one, other in np.asarray(pairs).tolist()])


def features(pairs, **more):
    return {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "geometry": {"type": "Point", "coordinates": list(pair)}}
            for pair in pairs
        ],
        **more,
    }


@pytest.mark.parametrize("header", [None, "row,col", "Row, Column", "y_px,x_px"])
def test_rows_and_columns(plain, located, write, header):
    path = write(lines(header, PLACES))
    for image in (plain, located):
        np.testing.assert_array_equal(read_positions(path, image), PLACES)


def test_columns_in_any_order_among_others(plain, write):
    path = write("name,col,row\nwest,10.5,5.25\neast,29.75,14\n")
    np.testing.assert_array_equal(read_positions(path, plain), PLACES)


def test_places_on_the_ground(located, write):
    lon, lat = located.geolocation.to_lonlat(*PLACES.T)
    x, y = located.geolocation.to_map(*PLACES.T)
    for text in (
        lines("lon,lat", np.column_stack([lon, lat])),
        lines("easting,northing", np.column_stack([x, y])),
        features(np.column_stack([lon, lat]).tolist()),
        features(np.column_stack([x, y]).tolist(), crs="EPSG:32631"),
        {"type": "MultiPoint", "coordinates": np.column_stack([lon, lat]).tolist()},
    ):
        np.testing.assert_allclose(read_positions(write(text), located), PLACES, atol=1e-3)


def test_pixels_in_geojson(plain, located, write):
    path = write(features(PLACES[:, ::-1].tolist()))
    np.testing.assert_array_equal(read_positions(path, plain), PLACES)
    with pytest.raises(RegionError, match=r'inside when read as pixels .* "crs": "pixel"'):
        read_positions(path, located)
    declared = write(features(PLACES[:, ::-1].tolist(), crs="pixel"))
    np.testing.assert_array_equal(read_positions(declared, located), PLACES)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no positions"),
        ("row,col\n", "holds no positions"),
        (features([]), "holds no positions"),
        ("a,b\n1,2\n", "name two of them row,col"),
        ("row,col\n1,2\n3,x\n", "line 3: 3,x holds no two numbers"),
        ("lon,lat\n3,50\n", "the image has no CRS: give row and column"),
        ("row,col\n1,nan\n", "not finite"),
        ("{not json", "cannot be read as GeoJSON"),
        (features([[1]]), "a Point without two numbers"),
        (features([[1, float("nan")]]), "a Point that is NaN or infinite"),
    ],
)
def test_files_that_hold_no_positions(plain, write, text, message):
    with pytest.raises(RegionError, match=message):
        read_positions(write(text), plain)


def test_no_file(plain):
    with pytest.raises(RegionError, match="there is no such file"):
        read_positions("nowhere.csv", plain)


def test_the_truth_of_simulated_points_holds_their_places(write):
    image = ac.raster.Image.from_array(np.zeros((20, 40)))
    truth = {"schema": "acutance/truth/1", "kind": "points", "positions": PLACES.tolist()}
    np.testing.assert_array_equal(read_positions(write(truth, "truth.json"), image), PLACES)
    for other, words in (({"positions": ["a"]}, "no rows and columns"), ({}, "no positions")):
        path = write({"schema": "acutance/truth/1", **other}, "other.json")
        with pytest.raises(RegionError, match=words):
            read_positions(path, image)
