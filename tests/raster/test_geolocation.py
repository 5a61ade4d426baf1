"""Pixels on the Earth: positions and the ground sampling distance."""

import math

import numpy as np
import pytest
import rasterio
from rasterio.control import GroundControlPoint
from rasterio.rpc import RPC

from acutance.errors import RegionError
from acutance.raster import Geolocation, Gsd, open_image

# Lengths of one degree on WGS 84, from tables: along the meridian, along the parallel.
DEGREE_M = {0.0: (110574.3, 111319.5), 45.0: (111131.8, 78846.8), 60.0: (111412.2, 55800.0)}


def test_an_integer_is_a_pixel_centre():
    place = Geolocation((0.5, 0.0, 600000.0, 0.0, -0.5, 5000000.0), "EPSG:32631")
    assert place.to_map(0, 0) == (600000.25, 4999999.75)
    row, col = place.from_map(600000.25, 4999999.75)
    assert (float(row), float(col)) == (0.0, 0.0)


@pytest.mark.parametrize(
    "geolocation",
    [
        Geolocation((0.5, 0.0, 600000.0, 0.0, -0.5, 5000000.0), "EPSG:32631"),
        Geolocation((0.4, 0.3, 600000.0, 0.3, -0.4, 5000000.0), "EPSG:32631"),
        Geolocation((1e-5, 2e-6, 5.0, 1e-6, -1e-5, 43.0), "EPSG:4326"),
        Geolocation((2.0, 0.0, 2e6, 0.0, -2.0, 6e5), "EPSG:2264"),
    ],
)
def test_lonlat_and_back(geolocation):
    rows, cols = np.array([[0.0, 100.5], [7.0, -3.0]]), np.array([[3.0, 99.0], [0.25, 4.0]])
    lon, lat = geolocation.to_lonlat(rows, cols)
    again = geolocation.from_lonlat(lon, lat)
    assert lon.shape == (2, 2)
    np.testing.assert_allclose(again, (rows, cols), atol=1e-3)


def test_known_position():
    # The central meridian of zone 31 at the equator.
    place = Geolocation((10.0, 0.0, 500000.0, 0.0, -10.0, 0.0), "EPSG:32631")
    lon, lat = place.to_lonlat(-0.5, -0.5)
    assert float(lon) == pytest.approx(3.0, abs=1e-9)
    assert float(lat) == pytest.approx(0.0, abs=1e-9)


def test_projected(pixels, write_raster, utm):
    assert open_image(write_raster("a.tif", pixels, **utm)).gsd() == Gsd(0.5, 0.5)


def test_rotated_and_with_rows_of_another_size(pixels, write_raster):
    turn = math.radians(30.0)
    transform = rasterio.Affine(
        0.7 * math.cos(turn),
        0.9 * math.sin(turn),
        6e5,
        0.7 * math.sin(turn),
        -0.9 * math.cos(turn),
        5e6,
    )
    image = open_image(write_raster("a.tif", pixels, crs="EPSG:32631", transform=transform))
    assert image.gsd().col_m == pytest.approx(0.7)
    assert image.gsd().row_m == pytest.approx(0.9)


def test_feet():
    gsd = Geolocation((2.0, 0.0, 2e6, 0.0, -2.0, 6e5), "EPSG:2264").gsd(0, 0)
    assert gsd.row_m == pytest.approx(2 * 0.3048006096)
    assert gsd.col_m == pytest.approx(2 * 0.3048006096)


@pytest.mark.parametrize("latitude", sorted(DEGREE_M))
def test_geographic_at_its_latitude(latitude):
    step_deg = 1e-5
    place = Geolocation((step_deg, 0.0, 5.0, 0.0, -step_deg, latitude), "EPSG:4326")
    gsd = place.gsd(-0.5, 0)
    meridian_m, parallel_m = DEGREE_M[latitude]
    assert gsd.row_m == pytest.approx(meridian_m * step_deg, rel=2e-5)
    assert gsd.col_m == pytest.approx(parallel_m * step_deg, rel=2e-5)


def test_geographic_changes_along_the_image(pixels, write_raster, lonlat):
    image = open_image(write_raster("a.tif", pixels, **lonlat))
    assert image.gsd().col_m == pytest.approx(0.558, abs=1e-3)
    assert image.gsd(-1_000_000, 0).col_m < 0.7 * image.gsd().col_m


def test_geographic_across_the_date_line():
    gsd = Geolocation((1e-5, 0.0, 180.0 - 5e-6, 0.0, -1e-5, 0.0), "EPSG:4326").gsd(0, 0)
    assert gsd.col_m == pytest.approx(1.113, abs=1e-3)


def test_web_mercator_is_measured_on_the_ground():
    y = 6378137.0 * math.log(math.tan(math.pi / 4 + math.radians(60.0) / 2))
    gsd = Geolocation((1.0, 0.0, 0.0, 0.0, -1.0, y), "EPSG:3857").gsd(0, 0)
    assert gsd.col_m == pytest.approx(0.5, rel=5e-3)
    assert gsd.row_m == pytest.approx(0.5, rel=5e-3)


def test_a_local_crs_still_has_a_unit():
    feet = 'LOCAL_CS["site",UNIT["foot",0.3048]]'
    place = Geolocation((1.0, 0.0, 0.0, 0.0, -1.0, 0.0), feet)
    assert place.gsd(0, 0).row_m == pytest.approx(0.3048)
    with pytest.raises(RegionError, match="give the region in pixels"):
        place.to_lonlat(0, 0)


def test_no_crs_no_gsd(pixels, write_raster, tmp_path, utm):
    path = write_raster("a.tif", pixels, transform=utm["transform"])
    image = open_image(path)
    assert (image.crs, image.geolocation, image.gsd()) == (None, None, None)


def test_control_points_give_the_gsd_in_the_middle(pixels, write_raster):
    points = [
        GroundControlPoint(row, col, 5.0 + col * 1e-5, 43.0 - row * 1e-5)
        for row, col in [(0, 0), (0, 50), (40, 0), (40, 50)]
    ]
    image = open_image(write_raster("gcps.tif", pixels, gcps=points, crs="EPSG:4326"))
    assert image.geolocation is None
    assert image.gsd().row_m == pytest.approx(1e-5 * 111_107, rel=1e-3)
    assert image.gsd().col_m == pytest.approx(1e-5 * 81_490, rel=1e-3)


def test_rational_functions_without_an_inverse_give_none(pixels, write_raster):
    ones = [1.0] + [0.0] * 19
    rpcs = RPC(0, 100, 43, 0.1, ones, ones, 20, 20, 5, 0.1, ones, ones, 25, 25)
    path = write_raster("rpcs.tif", pixels, rpcs=rpcs)
    assert open_image(path).gsd() is None
