"""Whatever images, regions and places are handed in wrongly is refused in words."""

import re

import numpy as np
import pytest

from acutance.errors import AcutanceError, ImageError, OptionError, RegionError
from acutance.raster import (
    Box,
    Geolocation,
    Image,
    LogCurve,
    PowerCurve,
    Region,
    SrgbCurve,
    TableCurve,
    find_fill,
    find_site,
    find_swath_fill,
    open_bands,
    open_image,
    parse_roi,
    parse_rois,
    read_positions,
    site_region,
    sites,
    value_far_off,
    write_geotiff,
    write_geotiff_tiles,
)
from acutance.raster.metadata import read_statement

PIXELS = np.arange(400.0).reshape(20, 20)
IMAGE = Image.from_array(PIXELS)
BOX = Box(1, 1, 3, 3)
REGION = Region.from_box(BOX)
PLACE = Geolocation((1.0, 0.0, 500000.0, 0.0, -1.0, 5000000.0), "EPSG:32631")
WRONG = ["x", b"x", {"a": 1}, ["a"], 1j, object()]


@pytest.fixture
def path(tmp_path):
    name = tmp_path / "a.tif"
    write_geotiff(name, PIXELS.astype(np.float32), gsd_m=1.0)
    return name


@pytest.mark.parametrize("wrong", [*WRONG, None, [], list])
@pytest.mark.parametrize(
    "call",
    [
        lambda x: Image.from_array(PIXELS, along_track=x if x != "x" else 3),
        lambda x: IMAGE.read(x if x is not None else 3),
        lambda x: IMAGE.gsd(x if x is not None else "x"),
        lambda x: IMAGE.gsd_of_file(col=x if x is not None else "x"),
        lambda x: Box.whole(x),
        lambda x: BOX.intersection(x),
        lambda x: BOX.grown(x),
        lambda x: BOX.require_inside(x),
        lambda x: Region(x),
        lambda x: Region(REGION.vertices, margin_px=x),
        lambda x: Region(REGION.vertices, holes=[x]),
        lambda x: Region.from_box(x),
        lambda x: REGION.box(x),
        lambda x: REGION.mask(x),
        lambda x: Geolocation(x, "EPSG:32631"),
        lambda x: Geolocation(PLACE.transform, x).to_lonlat(1.0, 1.0),
        lambda x: PLACE.gsd(x, 1.0),
        lambda x: PLACE.from_crs(1.0, 1.0, x),
        lambda x: LogCurve(x),
        lambda x: PowerCurve(x, 255.0),
        lambda x: PowerCurve(2.2, x),
        lambda x: SrgbCurve(x),
        lambda x: TableCurve("a", x, np.array([0.0, 1.0])),
        lambda x: TableCurve.of_file(x),
        lambda x: find_fill(x, BOX, PIXELS[1:4, 1:4]),
        lambda x: find_fill(IMAGE, x, PIXELS[1:4, 1:4]),
        lambda x: find_fill(IMAGE, BOX, x),
        lambda x: find_swath_fill(x),
        lambda x: find_site(x),
        lambda x: parse_roi(x, IMAGE),
        lambda x: parse_rois("1,1,9,9", x),
        lambda x: read_positions(x, IMAGE),
        lambda x: site_region(x, IMAGE),
        lambda x: site_region(sites()[0], x),
        lambda x: site_region(sites()[0], IMAGE, x),
        lambda x: write_geotiff_tiles(x if x != "x" else 3, (4, 4), []),
        lambda x: write_geotiff_tiles("never.tif", x, []),
        lambda x: write_geotiff("never.tif", PIXELS, transform=x if x is not None else 3),
        lambda x: write_geotiff("never.tif", PIXELS, tags=x if not isinstance(x, dict) else 3)
        if x is not None
        else find_site(x),
    ],
)  # fmt: skip
def test_what_is_of_the_wrong_kind_is_refused(call, wrong):
    with pytest.raises(AcutanceError, match=r"give|ha(s|ve) to|must be|there is no|write|not"):
        call(wrong)


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda x: PLACE.to_map(x, 1.0),
        lambda x: PLACE.from_map(1.0, x),
        lambda x: PLACE.to_lonlat(1.0, x),
        lambda x: PLACE.from_lonlat(x, 1.0),
        lambda x: value_far_off(x),
    ],
)
def test_places_are_numbers(call, wrong):
    with pytest.raises(OptionError, match="it has to hold numbers"):
        call(wrong)


@pytest.mark.parametrize("wrong", [3, 1.5, "1", b"x", [None], [np.zeros(2)], object()])
def test_bands_and_documents_are_lists(path, wrong):
    with pytest.raises(AcutanceError, match=r"give|band"):
        open_bands(path, wrong)
    with pytest.raises(AcutanceError, match=r"give a list|give the path|cannot be read|is no file"):
        read_statement(path, wrong if not isinstance(wrong, list) else [3])


def test_fields_of_a_statement_have_names(path):
    stated = read_statement(path)
    with pytest.raises(OptionError, match=r"name is 'colour': choose one of sensor"):
        stated.value("colour")
    with pytest.raises(OptionError, match="band is '1', it has to be a whole number"):
        stated.band_name("1")
    assert stated.band_name(np.int64(9)) is None


def write_tile(values, dtype):
    pixels = np.array(values)
    write_geotiff_tiles("n.tif", pixels.shape, [(Box.whole(pixels.shape), pixels)], dtype=dtype)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: write_geotiff_tiles("n.tif", (4, 4), [], dtype="x"), OptionError, "dtype is 'x'"),
        (lambda: write_geotiff_tiles("n.tif", (4, 4), 3), OptionError, "tiles are 3: give pairs"),
        (lambda: write_tile([[255.0, 256.0]], "uint8"), ImageError, "255 to 256 do not fit uint8"),
        (lambda: write_tile([[1.0, np.nan]], "int16"), ImageError, "1 to 1 and NaN do not fit int"),
        (lambda: write_tile([[np.nan, 1e39]], "float32"), ImageError, "1e.39 do not fit float32"),
        (lambda: TableCurve("a", [1.0], [1.0, 2.0]), OptionError, "give two columns of one length"),
        (lambda: SrgbCurve(0), OptionError, "full_scale is 0: give the value of white, above 0"),
        (lambda: find_fill(IMAGE, BOX, PIXELS), OptionError, r"have the shape \(20, 20\): give"),
        (lambda: Box.whole((3, 3, 3)), RegionError, r"has to be two whole numbers"),
    ],
)
def test_what_makes_no_sense_is_refused(call, error, message):
    with pytest.raises(error, match=re.compile(message, re.DOTALL)):
        call()


def test_scalars_of_numpy_are_numbers(path):
    assert BOX.grown(np.int64(1)) == Box(0, 0, 5, 5)
    assert open_image(path).gsd(np.float64(3), np.int64(4)).row_m == 1.0
    assert [one.band for one in open_bands(path, [np.int64(1)])] == [1]
