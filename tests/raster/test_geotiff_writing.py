"""Writing GeoTIFF: what is written is read back, whole or not at all."""

import numpy as np
import pytest
import rasterio

from acutance.errors import ImageError, OptionError, RegionError
from acutance.raster import Box, Gsd, open_image, write_geotiff, write_geotiff_tiles


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "int16", "float32", "float64"])
def test_round_trip(tmp_path, pixels, dtype):
    path = tmp_path / "a.tif"
    array = (pixels % 200).astype(dtype)
    write_geotiff(path, array, gsd_m=Gsd(0.7, 0.6))
    image = open_image(path)
    assert np.array_equal(image.read(), array)
    assert image.dtype == dtype
    assert image.gsd() == Gsd(0.7, 0.6)
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.tif"]


def test_a_gsd_of_numpys_numbers_comes_back(tmp_path, pixels):
    path = tmp_path / "a.tif"
    gsd = Gsd(np.float64(0.7), np.float32(0.5))
    assert repr(gsd) == "Gsd(row_m=0.7, col_m=0.5)"
    write_geotiff(path, pixels, gsd_m=gsd)
    assert open_image(path).gsd() == Gsd(0.7, 0.5)


@pytest.mark.parametrize(
    ("crs", "step", "seen_m"),
    [("EPSG:32631", 1.4, 1.4), ("EPSG:4326", 1e-5, 1.11), (None, 1.4, 0.7)],
)
def test_the_map_of_an_image_goes_before_the_gsd_it_was_written_with(
    tmp_path, pixels, crs, step, seen_m
):
    """What resamples an image keeps its metadata: it would have the GSD it had before."""
    place = (step, 0.0, 3.0, 0.0, -step, 0.0)
    write_geotiff(tmp_path / "a.tif", pixels, gsd_m=0.7, crs=crs, transform=place)
    image = open_image(tmp_path / "a.tif")
    assert image.gsd().col_m == image.gsd_of_file().col_m == pytest.approx(seen_m, abs=0.004)


def test_tiles_and_compression(tmp_path):
    path = tmp_path / "a.tif"
    write_geotiff(path, np.zeros((1000, 900), np.uint16))
    assert path.stat().st_size < 20_000
    with rasterio.Env(), pytest.warns(rasterio.errors.NotGeoreferencedWarning):
        dataset = rasterio.open(path)
    with dataset:
        assert dataset.block_shapes == [(256, 256)]


def test_place_nodata_and_bands(tmp_path, pixels):
    path = tmp_path / "a.tif"
    transform = (0.5, 0.0, 600000.0, 0.0, -0.5, 5000000.0)
    write_geotiff(
        str(path), np.stack([pixels, pixels + 1]), transform=transform, crs="EPSG:32631", nodata=7
    )
    image = open_image(path, band=2)
    assert image.geolocation.transform == transform
    assert image.crs == "EPSG:32631"
    assert image.band_count == 2
    assert np.array_equal(np.isnan(image.read()), pixels == 6)


def test_an_existing_file_survives_a_failure(tmp_path, pixels):
    path = tmp_path / "a.tif"
    write_geotiff(path, pixels)
    before = path.read_bytes()
    with pytest.raises(ImageError, match="cannot be written"):
        write_geotiff(path, pixels, crs="nonsense")
    assert path.read_bytes() == before
    write_geotiff(path, pixels + 1)
    assert np.array_equal(open_image(path).read(), pixels + 1)
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.tif"]


@pytest.mark.parametrize("array", [np.zeros(5), np.zeros((2, 0)), np.zeros((2, 2), complex)])
def test_arrays_that_are_no_image(tmp_path, array):
    with pytest.raises(ImageError, match="cannot be written as an image"):
        write_geotiff(tmp_path / "a.tif", array)


def test_places_and_types_that_cannot_be_written(tmp_path, pixels):
    with pytest.raises(ImageError, match="check that the folder exists"):
        write_geotiff(tmp_path / "none" / "a.tif", pixels)
    with pytest.raises(ImageError, match=r"longdouble|float128"):
        write_geotiff(tmp_path / "a.tif", pixels.astype(np.longdouble))
    with pytest.raises(OptionError, match="GSD"):
        write_geotiff(tmp_path / "a.tif", pixels, gsd_m=0)
    assert list(tmp_path.iterdir()) == []


def in_tiles(array, side=100):
    for row in range(0, array.shape[0], side):
        for col in range(0, array.shape[1], side):
            box = Box(row, col, min(side, array.shape[0] - row), min(side, array.shape[1] - col))
            yield box, array[box.slices]


def test_an_image_in_parts(tmp_path):
    path = tmp_path / "a.tif"
    array = np.random.default_rng(1).normal(size=(530, 270)).astype(np.float32)
    write_geotiff_tiles(path, array.shape, in_tiles(array), gsd_m=0.5)
    write_geotiff(tmp_path / "b.tif", array, gsd_m=0.5)
    image = open_image(path)
    np.testing.assert_array_equal(image.read(), array)
    assert image.gsd() == Gsd(0.5, 0.5)
    write_geotiff_tiles(path, array.shape, in_tiles(array, 256), dtype=np.float64)
    assert open_image(path).dtype == "float64"
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.tif", "b.tif"]


def test_fractions_are_rounded_in_a_type_of_integers(tmp_path):
    array = np.random.default_rng(1).uniform(-0.4, 255.4, (100, 100)).astype(np.float32)
    write_geotiff_tiles(tmp_path / "a.tif", array.shape, in_tiles(array), dtype=np.uint8)
    np.testing.assert_array_equal(open_image(tmp_path / "a.tif").read(), np.rint(array))


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError, OSError])
def test_parts_that_stop_to_come_leave_nothing_behind(tmp_path, error):
    """The error is that of the parts, and an older file stays."""
    path = tmp_path / "a.tif"
    path.write_bytes(b"older")

    def parts():
        yield from in_tiles(np.ones((100, 300), np.float32))
        raise error("stopped")

    with pytest.raises(error, match="stopped"):
        write_geotiff_tiles(path, (200, 300), parts())
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.tif"]
    assert path.read_bytes() == b"older"


def test_parts_that_make_no_image_are_refused(tmp_path):
    array = np.ones((200, 300), np.float32)
    tiles = list(in_tiles(array))
    with pytest.raises(ImageError, match="parts hold 50000 pixels, the image of 200 by 300"):
        write_geotiff_tiles(tmp_path / "a.tif", array.shape, tiles[:-1])
    with pytest.raises(RegionError, match="image of 150 rows"):
        write_geotiff_tiles(tmp_path / "a.tif", (150, 300), tiles)
    with pytest.raises(ImageError, match="box of 100 by 100"):
        write_geotiff_tiles(tmp_path / "a.tif", array.shape, [(tiles[0][0], array)])
    assert list(tmp_path.iterdir()) == []
