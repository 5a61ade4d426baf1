"""Ground in images without a geotransform: rational polynomials, ground control points."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import rasterio
from rasterio.control import GroundControlPoint
from rasterio.rpc import RPC

from acutance.errors import RegionError
from acutance.raster import open_image
from acutance.raster.metadata.read_statement import read_statement
from acutance.raster.sensor_model import georeference_of


def linear_rpc(height_share=0.0):
    """Columns grow with longitude, rows against latitude, .01 degrees being 500 px; a height of
    100 m above 200 m moves columns by a share of 500 px."""
    zeros = [0.0] * 20
    one, lon, lat, height = 0, 1, 2, 3
    samp, line, unity = zeros.copy(), zeros.copy(), zeros.copy()
    samp[lon], samp[height], line[lat], unity[one] = 1.0, height_share, -1.0, 1.0
    return RPC(
        height_off=200.0, height_scale=100.0, lat_off=43.0, lat_scale=0.01, long_off=5.0,
        long_scale=0.01, line_off=50.0, line_scale=500.0, samp_off=40.0, samp_scale=500.0,
        line_num_coeff=line, line_den_coeff=unity, samp_num_coeff=samp, samp_den_coeff=unity,
        err_bias=None, err_rand=None,
    )  # fmt: skip


@pytest.fixture
def by_rpc(write_raster, pixels):
    def edit(dataset):
        dataset.rpcs = linear_rpc(0.2)

    return open_image(write_raster("rpc.tif", pixels, edit=edit))


def test_rpc_count_from_pixel_centres(by_rpc):
    model = georeference_of(by_rpc, 200.0)
    row, col = model.from_crs(5.0, 43.0, "OGC:CRS84")
    assert (float(row), float(col)) == pytest.approx((50.0, 40.0), abs=1e-6)
    rows, cols = model.from_crs([5.0, 5.0002], [43.0002, 43.0], "OGC:CRS84")
    assert rows == pytest.approx([40.0, 50.0], abs=1e-6)
    assert cols == pytest.approx([40.0, 50.0], abs=1e-6)


def test_to_and_fro(by_rpc):
    model = pickle.loads(pickle.dumps(georeference_of(by_rpc, 230.0)))
    lon, lat = model.to_lonlat([3.0, 20.5], [7.0, 30.25])
    row, col = model.from_crs(lon, lat, "OGC:CRS84")
    assert row == pytest.approx([3.0, 20.5], abs=1e-3)
    assert col == pytest.approx([7.0, 30.25], abs=1e-3)


def test_the_height_moves_the_view(by_rpc):
    _, low = georeference_of(by_rpc, 200.0).from_crs(5.0, 43.0, "OGC:CRS84")
    _, high = georeference_of(by_rpc, 250.0).from_crs(5.0, 43.0, "OGC:CRS84")
    assert float(high - low) == pytest.approx(50.0, abs=1e-6)


def test_without_a_height_rpc_have_no_answer(by_rpc):
    model = georeference_of(by_rpc)
    assert model.needs_height
    with pytest.raises(RegionError, match="height_m"):
        model.from_crs(5.0, 43.0, "OGC:CRS84")


def test_the_gsd_on_the_ground(by_rpc):
    gsd = georeference_of(by_rpc, 200.0).gsd(20.0, 20.0)
    assert gsd.row_m == pytest.approx(2e-5 * 111_107, rel=1e-3)
    assert gsd.col_m == pytest.approx(2e-5 * 111_320 * np.cos(np.radians(43.0)), rel=3e-3)


def test_an_image_in_sensor_geometry_has_the_gsd_of_its_middle(by_rpc):
    gsd = by_rpc.gsd()
    at_middle = georeference_of(by_rpc, 200.0).gsd(19.5, 24.5)
    assert (gsd.row_m, gsd.col_m) == pytest.approx((at_middle.row_m, at_middle.col_m), rel=1e-6)
    assert gsd == by_rpc.gsd(3.0, 4.0) == by_rpc.gsd_of_file()
    stated = read_statement(by_rpc.path).gsd_m
    assert stated.value == (gsd.row_m, gsd.col_m)
    assert stated.source == "rpc.tif: RPC or ground control points"
    assert not by_rpc.states_gsd
    other = open_image(by_rpc.path, gsd_m=2.0)
    assert other.gsd().row_m == 2.0
    assert other.states_gsd


def test_a_sensor_model_that_no_image_has_states_no_gsd(write_raster, pixels):
    def edit(dataset):
        rpc = linear_rpc()
        rpc.lat_scale = rpc.long_scale = 1e-9
        dataset.rpcs = rpc

    assert open_image(write_raster("broken.tif", pixels, edit=edit)).gsd() is None


def test_ground_control_points(write_raster, pixels):
    points = [
        GroundControlPoint(row, col, 600000 + 2.0 * col, 5000000 - 2.0 * row)
        for row, col in ((0, 0), (0, 50), (40, 0), (40, 50), (20, 25))
    ]

    def edit(dataset):
        dataset.gcps = points, rasterio.CRS.from_epsg(32631)

    image = open_image(write_raster("gcp.tif", pixels, edit=edit))
    assert image.geolocation is None
    model = georeference_of(image)
    row, col = model.from_crs(600021.0, 4999979.0, "EPSG:32631")
    assert (float(row), float(col)) == pytest.approx((10.0, 10.0), abs=1e-3)
    assert model.gsd(10.0, 10.0).along_normal(0.0) == pytest.approx(2.0, rel=1e-2)


def test_a_geotransform_goes_before(located):
    assert georeference_of(located) is located.geolocation


def test_images_that_are_nowhere(plain, write_raster, pixels, tmp_path):
    assert georeference_of(plain) is None
    assert georeference_of(open_image(write_raster("plain.tif", pixels))) is None
    for name in ("array.npy", "ARRAY.NPY"):
        with open(tmp_path / name, "wb") as file:
            np.save(file, pixels)
        assert georeference_of(open_image(tmp_path / name)) is None
