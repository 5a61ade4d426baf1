"""Arrays as images, in memory and in .npy files."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
import xarray

from acutance.errors import ImageError, OptionError, RegionError
from acutance.raster import Box, Gsd, Image, open_image

DTYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "float16", "float32", "float64"]


@pytest.mark.parametrize("dtype", DTYPES)
def test_an_array_reads_as_float64(dtype):
    array = np.arange(1, 101).reshape(10, 10).astype(dtype)
    image = Image.from_array(array, gsd_m=0.7)
    cut = image.read(Box(2, 3, 4, 5))
    assert cut.dtype == np.float64
    assert np.array_equal(cut, array[2:6, 3:8].astype(float))
    assert np.array_equal(image.read(), array.astype(float))
    assert (image.path, image.band, image.band_count, image.crs) == (None, 1, 1, None)
    assert image.shape == (10, 10)
    assert image.dtype == dtype
    assert image.gsd() == Gsd(0.7, 0.7)
    expected = np.iinfo(dtype).max if np.dtype(dtype).kind in "iu" else None
    assert image.saturation_level == expected


def test_a_reading_is_a_copy():
    array = np.zeros((4, 4))
    Image.from_array(array).read()[:] = 7
    assert not array.any()


def test_unusable_pixels_are_nan():
    array = np.array([[1.0, np.nan], [np.inf, -9999.0]])
    assert np.isnan(Image.from_array(array, nodata=-9999).read()).tolist() == [
        [False, True],
        [True, True],
    ]
    masked = np.ma.array(np.arange(4).reshape(2, 2), mask=[[False, True], [False, False]])
    assert np.isnan(Image.from_array(masked).read()).tolist() == [[False, True], [False, False]]


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((3, 10, 10)), r"shape \(3, 10, 10\).*choose one band"),
        (np.zeros((1, 3, 10, 10)), r"shape \(1, 3, 10, 10\).*array\[0, 0\]"),
        (np.zeros(10), r"reshape it to \(rows, columns\)"),
        (np.float64(3.0), "a single number"),
        (np.zeros((0, 10)), "empty"),
        (np.zeros((4, 4), complex), "modulus"),
        (np.zeros((4, 4), bool), "mask holds no grey levels"),
        (np.array([[object(), 1]]), "not real numbers"),
        (np.array([["a", "b"]]), "not real numbers"),
        ({"band": 1}, "a dict is no array.*acutance.open_image"),
        (xarray.DataArray(np.zeros((4, 5)), dims=("x", "y")), "axes .* are x and y.*transpose"),
    ],
)
def test_an_array_that_is_no_image_is_refused(array, message):
    with pytest.raises(ImageError, match=message):
        Image.from_array(array)


def test_an_array_with_named_axes_has_rows_first():
    array = xarray.DataArray(np.arange(6.0).reshape(2, 3), dims=("y", "x"))
    assert Image.from_array(array).read().tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize("gsd_m", [0.0, -1.0, np.nan, np.inf])
def test_a_gsd_that_means_nothing_is_refused(gsd_m):
    with pytest.raises(OptionError, match="GSD"):
        Image.from_array(np.zeros((4, 4)), gsd_m=gsd_m)


@pytest.mark.parametrize("nodata", ["x", [1], 1 + 2j])
def test_a_nodata_value_is_a_number(tmp_path, nodata):
    np.save(tmp_path / "a.npy", np.zeros((4, 4)))
    for opened in (
        lambda: Image.from_array(np.zeros((4, 4)), nodata=nodata),
        lambda: open_image(tmp_path / "a.npy", nodata=nodata),
    ):
        with pytest.raises(OptionError, match=r"nodata is .*: give the number that unusable"):
            opened()


def test_no_gsd_given_is_no_gsd():
    assert Image.from_array(np.zeros((4, 4))).gsd() is None


def test_a_box_beyond_the_array_is_refused():
    image = Image.from_array(np.zeros((4, 4)))
    with pytest.raises(RegionError, match="part inside is 0,0,2,2"):
        image.read(Box(-2, -2, 4, 4))


def test_the_gsd_along_a_normal():
    gsd = Gsd(row_m=0.7, col_m=0.5)
    assert gsd.along_normal(0.0) == pytest.approx(0.5)
    assert gsd.along_normal(90.0) == pytest.approx(0.7)
    assert gsd.along_normal(180.0) == pytest.approx(0.5)
    # The edge through (0, 1 px) and (1 px, 0): its distance from the origin on the ground.
    on_ground = 0.7 * 0.5 / np.hypot(0.7, 0.5)
    assert gsd.along_normal(45.0) * np.sqrt(0.5) == pytest.approx(on_ground)
    assert Gsd.square(2).along_normal(33.0) == pytest.approx(2.0)


def test_an_npy_file_reads_like_its_array(tmp_path):
    for order in ("C", "F"):
        array = np.asarray(np.arange(600, dtype=">i2").reshape(20, 30), order=order)
        np.save(tmp_path / "image.npy", array)
        image = pickle.loads(pickle.dumps(open_image(tmp_path / "image.npy", gsd_m=2, nodata=96)))
        cut = image.read(Box(3, 4, 5, 6))
        assert np.isnan(cut[0, 2])
        cut[0, 2] = 96
        assert np.array_equal(cut, array[3:8, 4:10])
        assert image.saturation_level == 32767
        assert image.gsd() == Gsd(2, 2)
        assert image.path == str(tmp_path / "image.npy")


@pytest.mark.parametrize("order", ["C", "F"])
def test_a_box_of_an_npy_file_is_read_line_by_line(tmp_path, order):
    array = np.asarray(np.arange(6000.0).reshape(60, 100), order=order)
    np.save(tmp_path / "image.npy", array)
    image = open_image(tmp_path / "image.npy")
    assert np.array_equal(image.read(), array)
    assert np.array_equal(image.read(Box(7, 9, 41, 33)), array[7:48, 9:42])


def test_an_npy_file_that_is_no_image_is_refused(tmp_path):
    path = tmp_path / "image.npy"
    np.save(path, np.zeros((2, 3, 4, 5)))
    with pytest.raises(ImageError, match=r"image\.npy has shape \(2, 3, 4, 5\)"):
        open_image(path)
    np.save(path, np.array([{}], dtype=object), allow_pickle=True)
    with pytest.raises(ImageError, match="cannot be read as a NumPy file"):
        open_image(path)
    np.save(path, np.zeros((20, 30)))
    with pytest.raises(ImageError, match=r"one band, band 2 .* use band 1"):
        open_image(path, band=2)
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(ImageError, match="cannot be read as a NumPy file"):
        open_image(path)
    path.write_bytes(b"not an array")
    with pytest.raises(ImageError, match="first bytes"):
        open_image(path)


def test_arrays_need_no_rasterio():
    script = (
        "import sys, numpy as np, acutance.raster as r;"
        "image = r.Image.from_array(np.ones((9, 9)), gsd_m=1);"
        "r.parse_roi('1,1,4,4', image).mask(r.Box(0, 0, 9, 9)); image.read(); r.sites();"
        "sys.exit('rasterio' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
