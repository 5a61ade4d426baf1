"""Regions as texts and GeoJSON files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rasterio

from acutance.errors import RegionError
from acutance.raster import Box, open_image, parse_roi, parse_rois
from acutance.raster.positions import read_positions
from acutance.raster.roi import parse_features
from acutance.raster.site import find_site, site_region

SQUARE = [[9.5, 4.5], [29.5, 4.5], [29.5, 14.5], [9.5, 14.5], [9.5, 4.5]]
SQUARE_BOX = Box(5, 10, 10, 20)
PIXEL_CRS = {"type": "name", "properties": {"name": "pixel"}}


@pytest.fixture
def write_geojson(tmp_path):
    def write(document, name="roi.geojson"):
        path = tmp_path / name
        path.write_text(document if isinstance(document, str) else json.dumps(document))
        return str(path)

    return write


def polygon(ring=SQUARE, **more):
    return {"type": "Polygon", "coordinates": [ring], **more}


def feature(geometry, **properties):
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def collection(*features, **more):
    return {"type": "FeatureCollection", "features": list(features), **more}


def in_utm(ring):
    """Pixel coordinates (x, y) of the located image as its map coordinates."""
    return [[600000 + 0.5 * (x + 0.5), 5000000 - 0.5 * (y + 0.5)] for x, y in ring]


def in_lonlat(ring, image):
    x, y = np.array(ring).T
    return np.column_stack(image.geolocation.to_lonlat(y, x)).tolist()


def test_latitude_first_is_recognised_in_a_box_of_degrees(located):
    (west, north), _, (east, south), *_ = in_lonlat(SQUARE, located)
    assert parse_roi(f"lonlat:{west},{south},{east},{north}", located)
    with pytest.raises(RegionError, match=f"longitude comes first, write lonlat:{west},{south}"):
        parse_roi(f"lonlat:{south},{west},{north},{east}", located)
    with pytest.raises(RegionError, match=r"choose one inside it$"):
        parse_roi("lonlat:1,2,3,4", located)


def test_pixels_under_a_declared_crs_are_recognised(located, write_geojson):
    with pytest.raises(RegionError, match=r'if pixels are meant, write "crs": "pixel" in'):
        parse_roi(write_geojson(polygon(crs="EPSG:32631")), located)
    far = [[x + 5000, y] for x, y in in_utm(SQUARE)]
    with pytest.raises(RegionError, match=r"choose one inside it$"):
        parse_roi(write_geojson(polygon(far, crs="EPSG:32631")), located)


def test_four_numbers_are_whole_pixels(plain):
    for text in ("5,10,10,20", " 5, 10 ,10, 20 ", "5.0,10,10,20."):
        assert parse_roi(text, plain).box(plain.shape) == SQUARE_BOX
    assert parse_roi("0,0,40,50", plain).mask(Box(0, 0, 40, 50)).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("35,0,10,10", "part inside is 35,0,5,10 "),
        ("-1,0,10,10", "part inside is 0,0,9,10 "),
        ("40,0,10,10", "lies outside the image of 40 rows x 50 columns"),
        ("0,0,0,10", "empty"),
        ("1,2,3", "not four whole numbers of pixels.*ROW,COL,HEIGHT,WIDTH"),
        ("1.5,2,3,4", "not four whole numbers of pixels"),
        ("nowhere.geojson", "neither numbers nor a file"),
        ("", "neither numbers nor a file"),
        ("lonlat:1,2,3", "not four numbers"),
        ("lonlat:a,b,c,d", "not four numbers"),
        ("lonlat:4,50,3,51", "WEST < EAST"),
        ("lonlat:nan,50,3,51", "WEST < EAST"),
        ("lonlat:3,50,4,51", "no CRS .*ROW,COL,HEIGHT,WIDTH"),
    ],
)
def test_texts_that_name_no_region(plain, text, message):
    with pytest.raises(RegionError, match=message):
        parse_roi(text, plain)


@pytest.mark.parametrize("west", [180.0 - 2e-4, -180.0 - 2e-4])
def test_degrees_on_both_sides_of_the_antimeridian(pixels, write_raster, write_geojson, west):
    """An image over it has longitudes of one side only, files have those of both (RFC 7946)."""
    place = rasterio.Affine(1e-5, 0, west, 0, -1e-5, -17.0)
    image = open_image(write_raster("a.tif", pixels, crs="EPSG:4326", transform=place))
    row, col = np.array([[10, 25], [10, 45], [20, 45], [20, 25], [10, 25]]).T - 0.5
    lon, lat = image.geolocation.to_map(row, col)
    lon = np.mod(lon + 180.0, 360.0) - 180.0
    ring = np.column_stack([lon, lat]).tolist()
    text = f"lonlat:{lon.min():.9f},{lat.min():.9f},{lon.max():.9f},{lat.max():.9f}"
    for roi in (text, write_geojson(polygon(ring))):
        assert parse_roi(roi, image).box(image.shape) == Box(10, 25, 10, 20)
    (csv := Path(write_geojson("lon,lat\n", "a.csv"))).write_text(
        "lon,lat\n" + "\n".join(f"{x!r},{y!r}" for x, y in ring[:4])
    )
    places = np.column_stack([row, col])[:4]
    np.testing.assert_allclose(read_positions(str(csv), image), places, atol=1e-6)
    site = replace(find_site("Stennis"), longitude_deg=lon[0], latitude_deg=lat[0])
    middle = site_region(site, image, margin_m=0.0).vertices.mean(axis=0)
    assert middle == pytest.approx([9.5, 24.5], abs=1e-6)


def test_a_box_of_longitudes(located):
    corners = np.array(in_lonlat([[9.6, 4.6], [29.4, 14.4]], located))
    west, south = corners.min(axis=0)
    east, north = corners.max(axis=0)
    region = parse_roi(f"lonlat:{west:.8f},{south:.8f},{east:.8f},{north:.8f}", located)
    box = region.box(located.shape)
    assert abs(np.subtract(box.as_tuple(), SQUARE_BOX.as_tuple())).max() <= 1
    with pytest.raises(RegionError, match="outside the image"):
        parse_roi("lonlat:3,50,3.001,50.001", located)


@pytest.mark.parametrize(
    "document",
    [
        polygon(),
        polygon([[*corner, 12.5] for corner in SQUARE]),
        feature(polygon(), name="tarp"),
        {"type": "Feature", "geometry": polygon(), "properties": None},
        collection(feature(polygon())),
        collection(feature(None), feature(polygon())),
        {"type": "MultiPolygon", "coordinates": [[SQUARE]]},
        {"type": "GeometryCollection", "geometries": [polygon()]},
        polygon(crs=PIXEL_CRS),
        polygon(crs="pixel"),
        polygon(crs=None),
    ],
)
def test_every_way_to_write_a_polygon(plain, write_geojson, document):
    region = parse_roi(write_geojson(document), plain)
    assert region.box(plain.shape) == SQUARE_BOX
    assert region.mask(SQUARE_BOX).all()


def test_an_integer_is_a_pixel_centre(plain, write_geojson):
    ring = [[10.0, 5.0], [29.0, 5.0], [29.0, 14.0], [10.0, 14.0]]
    np.testing.assert_array_equal(
        parse_roi(write_geojson(polygon(ring)), plain).vertices,
        [[5.0, 10.0], [5.0, 29.0], [14.0, 29.0], [14.0, 10.0]],
    )


def test_a_polygon_with_a_hole(plain, write_geojson):
    hole = [[14.5, 6.5], [16.5, 6.5], [16.5, 9.5], [14.5, 9.5], [14.5, 6.5]]
    region = parse_roi(write_geojson({"type": "Polygon", "coordinates": [SQUARE, hole]}), plain)
    assert region.mask(SQUARE_BOX).sum() == 200 - 6


def test_a_polygon_may_reach_beyond_the_image(plain, write_geojson):
    ring = [[-10, -10], [9.5, -10], [9.5, 4.5], [-10, 4.5]]
    region = parse_roi(write_geojson(polygon(ring)), plain)
    assert region.box(plain.shape) == Box(0, 0, 5, 10)


@pytest.mark.parametrize("name", ["EPSG:32631", "urn:ogc:def:crs:EPSG::32631"])
@pytest.mark.parametrize("as_text", [True, False])
def test_coordinates_in_the_crs_of_the_file(located, write_geojson, name, as_text):
    crs = name if as_text else {"type": "name", "properties": {"name": name}}
    for document in (
        polygon(in_utm(SQUARE), crs=crs),
        collection(feature(polygon(in_utm(SQUARE)))),
    ):
        document["crs"] = crs
        assert parse_roi(write_geojson(document), located).box(located.shape) == SQUARE_BOX


@pytest.mark.parametrize("name", [None, "urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"])
def test_longitudes_and_latitudes(located, write_geojson, name):
    document = polygon(in_lonlat(SQUARE, located))
    if name is not None:
        document["crs"] = {"type": "name", "properties": {"name": name}}
    region = parse_roi(write_geojson(document), located)
    np.testing.assert_allclose(region.vertices, np.array(SQUARE)[:-1, ::-1], atol=1e-3)


def test_pixels_in_an_image_with_a_crs(located, write_geojson):
    path = write_geojson(polygon(crs=PIXEL_CRS), "roi.json")
    assert parse_roi(path, located).box(located.shape) == SQUARE_BOX


@pytest.mark.parametrize(
    ("ring", "as_degrees"),
    [
        (SQUARE, "is outside the image when read as longitude and latitude"),
        ([[x + 15, 3 * y + 60] for x, y in SQUARE], "is no longitude and latitude"),
    ],
)
def test_pixels_are_not_read_as_degrees_silently(
    write_raster, utm, write_geojson, ring, as_degrees
):
    located = open_image(write_raster("tall.tif", np.ones((200, 60), np.uint8), **utm))
    name = write_geojson(polygon(ring))
    with pytest.raises(RegionError, match=as_degrees) as refused:
        parse_roi(name, located)
    assert "inside when read as pixels (column, row)" in str(refused.value)
    assert 'add "crs": "pixel" to the file' in str(refused.value)
    declared = parse_roi(write_geojson(polygon(ring, crs="pixel")), located)
    np.testing.assert_array_equal(declared.vertices, np.array(ring)[:-1, ::-1])


def test_features_without_an_inside_leave_the_polygons_theirs(plain, write_geojson):
    point = {"type": "Point", "coordinates": [3, 4]}
    line = {"type": "LineString", "coordinates": [[3, 4], [5, 6]]}
    name = write_geojson(
        collection(feature(point), feature(polygon(), name="tarp"), feature(line), feature(None))
    )
    found = parse_features(name, plain)
    assert list(found) == ["feature 1", "tarp", "feature 3", "feature 4"]
    assert found["feature 1"].startswith("it has a 'Point', which has no inside: draw the target")
    assert "'LineString'" in found["feature 3"]
    assert found["feature 4"] == "it has no geometry: draw the target as a Polygon"
    assert list(parse_rois(name, plain)) == ["tarp"]
    assert parse_roi(name, plain).box(plain.shape) == SQUARE_BOX
    with pytest.raises(RegionError, match="holds a 'Point', which has no inside"):
        parse_rois(write_geojson(collection(feature(None), feature(point))), plain)
    with pytest.raises(RegionError, match="holds no polygon"):
        parse_rois(write_geojson(collection(feature(None))), plain)


def test_latitude_first_is_told_before_another_reading(write_raster, utm, write_geojson):
    located = open_image(write_raster("tall.tif", np.ones((200, 60), np.uint8), **utm))
    swapped = [[lat, lon] for lon, lat in in_lonlat(SQUARE, located)]
    # As pixels they lie in the image, too: both are numbers below 60.
    with pytest.raises(RegionError, match=r"latitude is read first: longitude comes first, write"):
        parse_roi(write_geojson(polygon(swapped)), located)


def test_degrees_and_pixels_both_inside_are_degrees(write_raster, write_geojson):
    world = {"crs": "EPSG:4326", "transform": rasterio.Affine(1, 0, -180, 0, -1, 90)}
    image = open_image(write_raster("world.tif", np.ones((180, 360), np.uint8), **world))
    region = parse_roi(write_geojson(polygon()), image)
    np.testing.assert_allclose(region.vertices[0], [85.0, 189.0])


def test_coordinates_outside_however_they_are_read(located, write_geojson):
    far = [[x + 100, y + 60] for x, y in SQUARE]
    with pytest.raises(RegionError, match=r"outside the image|too far") as refused:
        parse_roi(write_geojson(polygon(far)), located)
    assert "pixel" not in str(refused.value).split(":")[0]
    with pytest.raises(RegionError, match=r'no longitude and latitude: add the CRS .*"EPSG:32631"'):
        parse_roi(write_geojson(polygon([[1000 * x, y] for x, y in SQUARE])), located)


def test_coordinates_that_need_a_crs(plain, located, write_geojson):
    with pytest.raises(RegionError, match=r'image\'s own CRS: add "crs": "EPSG:32631"'):
        parse_roi(write_geojson(polygon(in_utm(SQUARE))), located)
    crs = {"type": "name", "properties": {"name": "EPSG:32631"}}
    with pytest.raises(RegionError, match="the image has no CRS"):
        parse_roi(write_geojson(polygon(in_utm(SQUARE), crs=crs)), plain)
    crs = {"type": "name", "properties": {"name": "EPSG:nonsense"}}
    with pytest.raises(RegionError, match="not known"):
        parse_roi(write_geojson(polygon(crs=crs)), located)
    with pytest.raises(RegionError, match='"crs" without a name'):
        parse_roi(write_geojson(polygon(crs={"type": "link"})), located)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ("{not json", "cannot be read as GeoJSON"),
        ("\xff\xfe", "cannot be read as GeoJSON"),
        ("[1, 2]", "a list, not a GeoJSON object"),
        ("{}", "is no GeoJSON: what it holds has no type"),
        ({"type": "Point", "coordinates": [1, 2]}, "'Point', which has no inside"),
        (collection(), "no polygon"),
        ({"type": "FeatureCollection"}, "without a list of features"),
        ({"type": "FeatureCollection", "features": [3]}, "where GeoJSON has an object"),
        ({"type": "Polygon", "coordinates": []}, "without coordinates"),
        ({"type": "Polygon"}, "without coordinates"),
        ({"type": "Polygon", "coordinates": [[[0, "a"], [1, 1], [2, 0]]]}, "pairs of numbers"),
        ({"type": "Polygon", "coordinates": [3]}, "pairs of numbers"),
        (polygon([[0, 0], [5, 5], [0, 0]]), "2 corners"),
        (polygon([[0, 0], [float("nan"), 5], [5, 0]]), "finite"),
        (polygon([[100, 100], [120, 100], [120, 120]]), "outside the image"),
        (
            collection(feature(polygon(), name="tarp"), feature(polygon())),
            r"2 polygons \(tarp, feature 2\).*keep one polygon .* parse_rois",
        ),
        ({"type": "MultiPolygon", "coordinates": [[SQUARE], [SQUARE]]}, "part 1, part 2"),
    ],
)
def test_files_that_hold_no_single_polygon(plain, write_geojson, document, message):
    with pytest.raises(RegionError, match=message):
        parse_roi(write_geojson(document), plain)


def test_every_polygon_of_a_file_by_its_name(plain, write_geojson):
    lower = [[x, y + 20] for x, y in SQUARE]
    document = collection(
        feature(polygon(), name="white"),
        feature(polygon(lower), name="white"),
        {**feature(polygon(lower)), "id": 7},
        feature(polygon(lower), id="tarp"),
        feature({"type": "MultiPolygon", "coordinates": [[SQUARE], [lower]]}, name="bars"),
        feature(polygon()),
    )
    regions = parse_rois(write_geojson(document), plain)
    assert list(regions) == [
        "white",
        "white (2)",
        "7",
        "tarp",
        "bars part 1",
        "bars part 2",
        "feature 6",
    ]
    assert regions["white"].box(plain.shape) == SQUARE_BOX
    assert regions["bars part 2"].box(plain.shape) == Box(25, 10, 10, 20)


def test_one_of_several_polygons_outside_the_image_is_refused_when_it_is_read(plain, write_geojson):
    away = [[x + 100, y] for x, y in SQUARE]
    document = collection(feature(polygon(), name="near"), feature(polygon(away), name="away"))
    regions = parse_rois(write_geojson(document), plain)
    assert list(regions) == ["near", "away"]
    assert regions["near"].box(plain.shape)
    with pytest.raises(RegionError, match=r"^the region lies outside the image"):
        regions["away"].box(plain.shape)


def test_several_polygons_of_which_none_lies_in_the_image_are_refused(plain, write_geojson):
    away = [[x + 100, y] for x, y in SQUARE]
    further = [[x, y + 200] for x, y in SQUARE]
    document = collection(feature(polygon(away), name="away"), feature(polygon(further), name="b"))
    with pytest.raises(RegionError, match=r"^away: the region lies outside the image"):
        parse_rois(write_geojson(document), plain)


def test_texts_name_their_only_region_themselves(located):
    assert list(parse_rois(" 5,10,10,20", located)) == ["5,10,10,20"]


def test_longitudes_taken_for_pixels_are_reported(plain, write_geojson):
    degrees = [[10.1, 51.9], [10.1001, 51.9], [10.1001, 51.9001], [10.1, 51.9001]]
    name = write_geojson(polygon(degrees))
    with pytest.raises(RegionError, match=r"rows 51.9 to 51.9.* were read as pixels .*has a CRS"):
        parse_roi(name, plain)
    said = write_geojson(polygon(degrees, crs=PIXEL_CRS), "said.geojson")
    with pytest.raises(RegionError, match=r"rows 51.9 to 51.9") as error:
        parse_roi(said, plain)
    assert "read as pixels" not in str(error.value)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
def test_corners_that_are_no_numbers_are_refused_without_warnings(
    plain, located, write_geojson, wrong
):
    name = write_geojson(polygon([[9.5, 4.5], [29.5, wrong], [29.5, 14.5], [9.5, 14.5]]))
    for image in (plain, located):
        with pytest.raises(RegionError, match=r"a corner that is NaN or infinite: draw it again"):
            parse_roi(name, image)
