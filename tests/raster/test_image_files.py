"""Raster files as images: every kind of pixel, mask and format."""

import os
import pickle
import re
import shutil
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import rasterio
import rasterio.shutil
from rasterio.enums import ColorInterp

from acutance.errors import ImageError, OptionError, RegionError
from acutance.raster import Box, Gsd, open_bands, open_image

BOX = Box(7, 11, 20, 30)
DTYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"]


DIMAP = """<?xml version="1.0"?>
<Dimap_Document>
<Metadata_Id><METADATA_FORMAT version="1.1">DIMAP</METADATA_FORMAT></Metadata_Id>
<Coordinate_Reference_System><Horizontal_CS>
<HORIZONTAL_CS_CODE>EPSG:32631</HORIZONTAL_CS_CODE>
</Horizontal_CS></Coordinate_Reference_System>
<Geoposition><Geoposition_Insert>
<ULXMAP>600000</ULXMAP><ULYMAP>5000000</ULYMAP><XDIM>0.7</XDIM><YDIM>0.7</YDIM>
</Geoposition_Insert></Geoposition>
<Raster_Dimensions><NCOLS>50</NCOLS><NROWS>40</NROWS><NBANDS>1</NBANDS></Raster_Dimensions>
<Data_Access><DATA_FILE_FORMAT>GEOTIFF</DATA_FILE_FORMAT>
<Data_File><DATA_FILE_PATH href="IMAGERY.TIF"/></Data_File></Data_Access>
</Dimap_Document>
"""


def cut(array, box=BOX):
    return array[box.slices].astype(float)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", [{}, {"tiled": True, "blockxsize": 16, "blockysize": 16}])
def test_every_type_of_pixel(pixels, write_raster, dtype, layout, utm):
    array = (pixels % 127).astype(dtype)
    image = open_image(write_raster("a.tif", array, **layout, **utm))
    assert np.array_equal(image.read(BOX), cut(array))
    assert image.read(BOX).dtype == np.float64
    assert (image.shape, image.dtype, image.band_count) == ((40, 50), dtype, 1)
    expected = np.iinfo(dtype).max if np.dtype(dtype).kind in "iu" else None
    assert image.saturation_level == expected


@pytest.mark.parametrize(
    ("name", "driver", "options", "level"),
    [
        ("a.jp2", "JP2OpenJPEG", {"QUALITY": "100", "REVERSIBLE": "YES", "NBITS": 11}, 2047),
        ("a.ntf", "NITF", {}, 65535),
        ("b.ntf", "NITF", {"NBITS": 12}, 4095),
        ("a.png", "PNG", {}, 65535),
        ("cog.tif", "COG", {}, 65535),
        ("bits.tif", "GTiff", {"NBITS": 11}, 2047),
        ("a.img", "HFA", {}, 65535),
        ("a.bsq", "ENVI", {}, 65535),
    ],
)
def test_formats(pixels, write_raster, name, driver, options, level):
    image = open_image(write_raster(name, pixels, driver, **options))
    assert np.array_equal(image.read(BOX), cut(pixels))
    assert image.saturation_level == level
    assert (image.crs, image.gsd()) == (None, None)


def test_a_jpeg(pixels, write_raster):
    flat = np.full((40, 50), 117, np.uint8)
    image = open_image(write_raster("a.jpg", flat, "JPEG"))
    assert np.array_equal(image.read(BOX), cut(flat))


def test_a_container_lists_the_images_inside(pixels, write_raster, tmp_path):
    source = write_raster("two.tif", np.stack([pixels, pixels[::-1]]).astype(np.int16))
    container = str(tmp_path / "two.nc")
    rasterio.shutil.copy(source, container, driver="netCDF", FORMAT="NC4")
    with pytest.raises(ImageError, match=r"the images inside are: .*Band1, .*Band2"):
        open_image(container)
    image = open_image(f"NETCDF:{container}:Band2")
    assert np.array_equal(image.read(BOX), cut(pixels[::-1]))
    as_hdf5 = str(shutil.copy(container, tmp_path / "two.h5"))
    assert open_image(f"HDF5:{as_hdf5}://Band1").shape == (40, 50)


def test_a_dimap_product(pixels, write_raster, tmp_path):
    write_raster("IMAGERY.TIF", pixels)
    (tmp_path / "METADATA.DIM").write_text(DIMAP)
    for path in (tmp_path / "METADATA.DIM", tmp_path):
        image = open_image(path)
        assert np.array_equal(image.read(BOX), cut(pixels))
        assert image.gsd() == Gsd(0.7, 0.7)


def test_a_zipped_image(pixels, write_raster, tmp_path):
    folder = tmp_path / "product"
    folder.mkdir()
    os.replace(write_raster("a.tif", pixels), folder / "a.tif")
    shutil.make_archive(str(folder), "zip", folder)
    image = open_image(f"/vsizip/{folder}.zip/a.tif")
    assert np.array_equal(image.read(BOX), cut(pixels))


@pytest.mark.parametrize(
    ("kind", "prefix"), [("zip", "/vsizip/"), ("tar", "/vsitar/"), ("gztar", "/vsitar/")]
)
def test_a_packed_image_is_opened_by_the_name_its_error_gives(
    pixels, write_raster, tmp_path, kind, prefix
):
    folder = tmp_path / "product"
    (folder / "pan").mkdir(parents=True)
    (folder / "read me.txt").write_text("not an image" * 1000)
    os.replace(write_raster("a.tif", pixels), folder / "pan" / "a.tif")
    packed = shutil.make_archive(str(folder), kind, folder)
    with pytest.raises(ImageError, match="it is a packed file; open /vsi") as refused:
        open_image(packed)
    name = str(refused.value).rsplit(" ", 1)[1]
    assert name.startswith(prefix)
    assert np.array_equal(open_image(name).read(BOX), cut(pixels))


def test_packed_files_of_several_images_and_of_none(pixels, write_raster, tmp_path):
    folder = tmp_path / "two"
    folder.mkdir()
    for name in ("a.tif", "b.tif"):
        os.replace(write_raster(name, pixels), folder / name)
    packed = shutil.make_archive(str(folder), "zip", folder)
    with pytest.raises(ImageError, match=r"open one of /vsizip/\S+, /vsizip/\S+$"):
        open_image(packed)
    for name in ("a.tif", "b.tif"):
        (folder / name).write_text("words")
    packed = shutil.make_archive(str(folder), "zip", folder)
    with pytest.raises(ImageError, match="no image was found in the packed file; unpack it"):
        open_image(packed)


def test_bands_are_chosen_from_one(pixels, write_raster):
    bands = np.stack([pixels, pixels + 1, pixels + 2])
    path = write_raster("rgb.tif", bands, interleave="pixel")
    for band in (1, 2, 3):
        image = open_image(path, band=band)
        assert np.array_equal(image.read(BOX), cut(pixels) + band - 1)
        assert (image.band, image.band_count) == (band, 3)
    for band in (0, 4, -1):
        with pytest.raises(ImageError, match=rf"band {band} .* it has 3: .* from 1 to 3"):
            open_image(path, band=band)


@pytest.mark.parametrize("name", ["a.tif", "a.npy"])
@pytest.mark.parametrize("band", ["pan", None, 1.5, [1]])
def test_a_band_is_a_number(pixels, write_raster, tmp_path, name, band):
    path = write_raster("a.tif", pixels)
    np.save(tmp_path / "a.npy", pixels)
    with pytest.raises(ImageError, match=rf"band {re.escape(repr(band))} .*, from 1"):
        open_image(path.replace("a.tif", name), band=band)


def test_a_band_may_be_an_integer_of_numpy(pixels, write_raster):
    image = open_image(write_raster("a.tif", pixels), band=np.int64(1))
    assert type(image.band) is int


@pytest.mark.parametrize(("dtype", "nodata"), [("uint16", 0), ("int16", -999), ("float32", -1e38)])
def test_nodata_is_nan(pixels, write_raster, dtype, nodata):
    array = pixels.astype(dtype)
    array[10:12, 20:23] = nodata
    image = open_image(write_raster("a.tif", array, nodata=nodata))
    missing = np.isnan(image.read())
    assert missing.sum() == 6
    assert missing[10:12, 20:23].all()


def test_nodata_given_replaces_the_one_declared(pixels, write_raster):
    array = pixels.copy()
    array[3, 4] = 0
    image = open_image(write_raster("a.tif", array, nodata=0), nodata=float(array[5, 6]))
    missing = np.argwhere(np.isnan(image.read()))
    assert missing.tolist() == [[5, 6]]


def test_nodata_out_of_the_types_range_masks_nothing(pixels, write_raster):
    path = write_raster("a.tif", pixels)
    assert np.array_equal(open_image(path, nodata=-9999).read(), pixels)
    path = write_raster("f.tif", pixels.astype(np.float32))
    assert np.array_equal(open_image(path, nodata=-1.7e308).read(), pixels)


def test_values_that_are_not_finite_are_nan(pixels, write_raster):
    array = pixels.astype(np.float32)
    array[0, :3] = [np.nan, np.inf, -np.inf]
    assert np.isnan(open_image(write_raster("a.tif", array)).read()).sum() == 3


def test_transparent_pixels_are_nan(pixels, write_raster):
    alpha = np.full(pixels.shape, 65535, np.uint16)
    alpha[5:8, 6] = 0
    alpha[20, 20] = 300

    def declare(dataset):
        dataset.colorinterp = [ColorInterp.gray, ColorInterp.alpha]

    path = write_raster("a.tif", np.stack([pixels, alpha]), edit=declare, nodata=2000)
    missing = np.isnan(open_image(path).read())
    assert np.array_equal(missing, (alpha == 0) | (pixels == 2000))
    assert not np.isnan(open_image(path, band=2, nodata=7).read()).any()


@pytest.mark.parametrize("internal", [True, False])
def test_a_mask_beside_the_bands(pixels, write_raster, internal):
    mask = np.full(pixels.shape, 255, np.uint8)
    mask[30:33, 40:44] = 0
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=internal):
        path = write_raster("a.tif", pixels, edit=lambda dataset: dataset.write_mask(mask))
    assert os.path.exists(path + ".msk") is not internal
    missing = np.isnan(open_image(path).read())
    assert missing.sum() == 12
    assert missing[30:33, 40:44].all()


def test_scale_and_offset_apply_to_values_and_saturation(pixels, write_raster):
    def declare(dataset):
        dataset.scales, dataset.offsets = (0.5,), (-100.0,)

    array = pixels.copy()
    array[9, 12] = 0
    image = open_image(write_raster("a.tif", array, edit=declare, nodata=0, NBITS=12))
    assert image.saturation_level == 4095 * 0.5 - 100
    values = image.read(BOX)
    assert np.isnan(values[2, 1])
    values[2, 1] = -100
    assert np.array_equal(values, cut(array) * 0.5 - 100)


def test_a_negative_scale_leaves_no_value_at_the_limit(pixels, write_raster):
    """The largest count is the smallest value there: every pixel was saturated."""

    def declare(dataset):
        dataset.scales, dataset.offsets = (-1.0,), (65535.0,)

    image = open_image(write_raster("a.tif", 65535 - pixels.astype(np.uint16), edit=declare))
    assert np.array_equal(image.read(), pixels)
    assert (image.saturation_level, image.source.largest_count) == (None, 65535)


def test_a_scale_of_nothing_is_refused(pixels, write_raster):
    def declare(dataset):
        dataset.scales = (0.0,)

    with pytest.raises(ImageError, match="scale 0"):
        open_image(write_raster("a.tif", pixels, edit=declare))


def test_special_values_declared_by_the_product(pixels, write_raster):
    def declare(dataset):
        dataset.update_tags(SPECIAL_VALUE_SATURATED="1023", SPECIAL_VALUE_NODATA="17")

    image = open_image(write_raster("a.tif", pixels, edit=declare))
    assert image.saturation_level == 1023
    assert np.array_equal(np.isnan(image.read()), pixels == 17)


def test_gsd_given_goes_before_the_files(pixels, write_raster, utm):
    path = write_raster("a.tif", pixels, **utm)
    assert open_image(path).gsd() == Gsd(0.5, 0.5)
    assert open_image(path, gsd_m=0.7).gsd(3, 4) == Gsd(0.7, 0.7)
    assert open_image(path, gsd_m=Gsd(0.7, 0.6)).gsd() == Gsd(0.7, 0.6)
    with pytest.raises(OptionError, match="GSD"):
        open_image(path, gsd_m=-1)


def test_a_plain_image_warns_of_nothing(pixels, write_raster):
    path = write_raster("a.tif", pixels)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        open_image(path).read(BOX)


def test_an_image_can_be_sent_to_processes_and_threads(pixels, write_raster, utm):
    image = pickle.loads(pickle.dumps(open_image(write_raster("a.tif", pixels, **utm))))
    boxes = [Box(row, row, 8, 8) for row in range(32)]
    with ThreadPoolExecutor(4) as pool:
        for box, values in zip(boxes, pool.map(image.read, boxes), strict=True):
            assert np.array_equal(values, cut(pixels, box))
    filters = [entry for entry in warnings.filters if "NotGeoreferenced" in str(entry[2])]
    assert filters == []


def test_a_box_beyond_the_file_is_refused(pixels, write_raster):
    image = open_image(write_raster("a.tif", pixels))
    with pytest.raises(RegionError, match="outside the image of 40 rows x 50 columns"):
        image.read(Box(0, 50, 4, 4))


def test_files_that_hold_no_image(tmp_path, pixels, write_raster):
    with pytest.raises(ImageError, match=r"does not exist \(its folder exists\): "):
        open_image(tmp_path / "none.tif")
    with pytest.raises(ImageError, match="nor does its folder"):
        open_image(tmp_path / "nowhere" / "none.tif")
    with pytest.raises(ImageError, match="cannot be reached"):
        open_image(tmp_path / ("x" * 300))
    with pytest.raises(ImageError, match="it is a directory; give the image file inside it"):
        open_image(tmp_path)
    empty = tmp_path / "empty.tif"
    empty.touch()
    with pytest.raises(ImageError, match=r"is empty \(0 bytes\)"):
        open_image(empty)
    noise = tmp_path / "noise.tif"
    noise.write_bytes(np.random.default_rng(1).bytes(5000))
    with pytest.raises(ImageError, match=r"not recognized.*check that the file is whole"):
        open_image(noise)
    with pytest.raises(ImageError, match="cannot be read"):
        open_image("HDF5:none.h5://band")
    assert issubclass(ImageError, OSError)


def test_a_file_cut_short_fails_where_it_is_read(pixels, write_raster, tmp_path):
    path = write_raster("a.tif", pixels, compress="deflate")
    whole = (tmp_path / "a.tif").read_bytes()
    (tmp_path / "a.tif").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ImageError, match="cannot be read"):
        open_image(path).read()


def test_pixels_that_are_no_grey_levels(pixels, write_raster):
    path = write_raster("complex.tif", pixels.astype(np.complex64))
    with pytest.raises(ImageError, match="complex values"):
        open_image(path)
    colours = {value: (value, 0, 0, 255) for value in range(256)}
    path = write_raster(
        "palette.png",
        (pixels % 256).astype(np.uint8),
        "PNG",
        edit=lambda dataset: dataset.write_colormap(1, colours),
        photometric="palette",
    )
    with pytest.raises(ImageError, match="palette indices"):
        open_image(path)


def test_a_palette_of_greys_holds_grey_levels(pixels, write_raster):
    levels = (pixels % 256).astype(np.uint8)
    path = write_raster("grey.bmp", levels, "BMP")
    with warnings.catch_warnings(action="ignore"), rasterio.open(path) as dataset:
        assert dataset.colorinterp == (ColorInterp.palette,)
    assert np.array_equal(open_image(path).read(), levels)
    clear = {value: (value, value, value, 0 if value == 7 else 255) for value in range(256)}
    path = write_raster(
        "clear.png", levels, "PNG",
        edit=lambda dataset: dataset.write_colormap(1, clear), photometric="palette",
    )  # fmt: skip
    with pytest.raises(ImageError, match="palette indices"):
        open_image(path)


def test_several_arrays_in_one_file_are_no_packed_images(pixels, tmp_path):
    np.savez(tmp_path / "two.npz", a=pixels, b=pixels)
    with pytest.raises(ImageError, match="several arrays of NumPy: save the image by itself"):
        open_image(tmp_path / "two.npz")


def test_all_bands_are_opened_but_that_of_transparency(pixels, write_raster):
    def declare(dataset):
        dataset.colorinterp = [ColorInterp.red, ColorInterp.green, ColorInterp.alpha]

    stack = np.stack([pixels, pixels + 1, np.full(pixels.shape, 255, pixels.dtype)])
    path = write_raster("a.tif", stack, edit=declare)
    first, second = open_bands(path, gsd_m=2.0)
    assert (first.band, second.band) == (1, 2)
    assert np.array_equal(second.read(), first.read() + 1)
    assert second.gsd() == Gsd(2.0, 2.0)
    assert [one.band for one in open_bands(path, [2, 1])] == [2, 1]
    for numbers, message in (([], "no band is asked for"), ([1, 1], "every band once")):
        with pytest.raises(OptionError, match=message):
            open_bands(path, numbers)
    with pytest.raises(ImageError, match="band 4 of"):
        open_bands(path, [1, 4])
