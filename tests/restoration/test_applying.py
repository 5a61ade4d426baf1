"""Filters applied: types, windows, pixels without data, saturated ones, files and refusals."""

import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import rasterio
from rasterio.control import GroundControlPoint
from rasterio.enums import ColorInterp
from rasterio.rpc import RPC
from scipy.ndimage import convolve

import acutance as ac
from acutance.raster import rewriting
from acutance.raster.dataset import open_quietly
from acutance.restoration import restore_array
from acutance.restoration.window_filter import reach_px


@pytest.fixture(scope="module")
def landscape(sensor):
    pixels, _ = ac.simulate.landscape(
        sensor, shape=(300, 260), snr=60, rng=np.random.default_rng(8)
    )
    return pixels.astype(float) + 500


def write(path, bands, **profile):
    bands = np.atleast_3d(bands) if bands.ndim == 3 else bands[None]
    with open_quietly(
        path, "w", driver="GTiff", count=bands.shape[0], height=bands.shape[1],
        width=bands.shape[2], dtype=bands.dtype, **profile,
    ) as dataset:  # fmt: skip
        dataset.write(bands)


def test_inside_it_is_a_convolution(landscape, sharpening):
    expected = convolve(landscape, sharpening.kernel, mode="mirror")
    own = ac.restore(landscape, sharpening)
    assert own[5:-5, 5:-5] == pytest.approx(expected[5:-5, 5:-5], abs=1e-9)
    assert np.isfinite(own).all()


@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64",
                                   "float16", "float32", "float64"])  # fmt: skip
def test_every_type_is_kept(landscape, sharpening, dtype):
    kind = np.dtype(dtype)
    level = (landscape - landscape.min()) / np.ptp(landscape)
    image = (40 + 60 * level).astype(kind)
    found, counts = restore_array(image, sharpening)
    assert found.dtype == kind
    assert counts.pixels == image.size
    exact = ac.restore(image.astype(float), sharpening)
    tolerance = {"f": 0.06 if dtype == "float16" else 1e-3}.get(kind.kind, 0.501)
    assert found.astype(float) == pytest.approx(exact, abs=tolerance)


def test_what_leaves_the_range_is_clipped_and_counted(sharpening):
    image = np.full((60, 60), 5, np.uint8)
    image[:, 30:] = 250
    found, counts = restore_array(image, sharpening, saturation=256)
    assert counts.clipped_low > 0
    assert counts.clipped_high > 0
    assert (found.min(), found.max()) == (0, 255)
    with pytest.warns(UserWarning, match="clipped"):
        ac.restore(image, sharpening, saturation=256)


def test_an_array_is_not_changed(landscape, sharpening):
    before = landscape.copy()
    ac.restore(landscape, sharpening)
    assert np.array_equal(landscape, before)


def test_nodata_is_neither_spread_nor_lost(landscape, sharpening):
    image = np.rint(landscape).astype(np.uint16)
    holes = np.zeros(image.shape, bool)
    holes[100:140, 90:120] = holes[20, 30] = holes[:, :7] = True
    image[holes] = 0
    found, counts = restore_array(image, sharpening, nodata=0)
    assert counts.nodata == holes.sum()
    assert np.array_equal(found == 0, holes)
    whole = ac.restore(np.rint(landscape), sharpening)
    near = np.abs(found.astype(float) - whole)[~holes]
    assert near.max() < 0.25 * np.ptp(landscape)


def test_beside_nodata_a_filtered_pixel_errs_less_than_an_unfiltered_one(sensor):
    ideal = ac.Sensor([ac.optics.Detector()])
    pixels, truth = (
        ac.simulate.landscape(one, shape=(300, 300), rng=np.random.default_rng(2))[0].astype(float)
        for one in (sensor, ideal)
    )
    filter = ac.design_restoration(sensor, snr=300, noise_gain=1.7)
    holes = np.zeros(pixels.shape, bool)
    holes[::40] = True
    image = np.where(holes, np.nan, pixels)
    found = ac.restore(image, filter)
    assert np.array_equal(np.isnan(found), holes)
    beside = np.zeros_like(holes)
    beside[1::40] = beside[39::40] = True
    beside[:, :20] = beside[:, -20:] = False
    filtered, plain = (np.mean((one - truth)[beside] ** 2) for one in (found, pixels))
    assert filtered < 0.9 * plain


def test_a_value_of_nodata_is_not_made(sharpening):
    image = np.full((50, 50), 10, np.uint16)
    image[20:30, 20:30] = 60
    plain, _ = restore_array(image, sharpening)
    made = next(value for value in np.unique(plain).tolist() if value not in (10, 60))
    result, counts = restore_array(image, sharpening, nodata=made)
    assert counts.off_nodata > 0
    assert not (result == made).any()


@pytest.mark.parametrize("nodata", [-9999, 70000, -9999.0, 0.5])
def test_a_value_of_nodata_that_the_type_does_not_have_is_that_of_no_pixel(
    tmp_path, sharpening, nodata
):
    image = np.zeros((50, 50), np.uint16)
    image[20:30, 20:30] = 60
    plain, _ = restore_array(image, sharpening)
    found, counts = restore_array(image, sharpening, nodata=nodata)
    assert np.array_equal(found, plain)
    assert counts.nodata == counts.off_nodata == 0
    np.save(tmp_path / "a.npy", image)
    ac.restore(tmp_path / "a.npy", sharpening, out=tmp_path / "b.npy", nodata=nodata)
    assert np.array_equal(np.load(tmp_path / "b.npy"), plain)
    write(tmp_path / "a.tif", image)
    ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif", nodata=nodata)
    with open_quietly(tmp_path / "b.tif") as dataset:
        assert np.array_equal(dataset.read(1), plain)


def test_masks_of_arrays_stay(landscape, sharpening):
    image = np.ma.masked_greater(landscape, np.percentile(landscape, 99))
    found = ac.restore(image, sharpening)
    assert isinstance(found, np.ma.MaskedArray)
    assert np.array_equal(found.mask, image.mask)
    assert np.isfinite(found.compressed()).all()


def test_saturated_pixels_do_not_ring(sensor, sharpening):
    rows, cols = np.indices((80, 80))
    glint = 60000 * np.exp(-((rows - 40) ** 2 + (cols - 40) ** 2) / 1.5)
    image = np.minimum(1000 + glint, 4095).astype(np.uint16)
    found, counts = restore_array(image, sharpening, saturation=4095)
    assert counts.saturated == (image == 4095).sum() > 4
    assert np.array_equal(found[image == 4095], image[image == 4095])
    rings, _ = restore_array(image, sharpening, saturation=65535)
    assert found.min() > 0.95 * 1000
    assert rings.min() < 0.8 * 1000


@pytest.mark.parametrize("height", [700, 1200])
def test_windows_do_not_show(sharpening, tmp_path, monkeypatch, height):
    image = np.random.default_rng(3).normal(3000, 300, (height, 500)).astype(np.uint16)
    image[rng_holes(image.shape)] = 0
    path, out = str(tmp_path / "a.tif"), str(tmp_path / "b.tif")
    write(path, image, nodata=0)
    monkeypatch.setattr(rewriting, "_WINDOW_ROWS", 256)
    monkeypatch.setattr(rewriting, "_WINDOW_COLS", 256)
    seen = []
    ac.restore(path, sharpening, out=out, progress=lambda *done: seen.append(done))
    with open_quietly(out) as dataset:
        found = dataset.read(1)
    whole = ac.restore(image, sharpening, nodata=0)
    assert np.abs(found.astype(int) - whole.astype(int)).max() <= 1
    assert np.mean(found != whole) < 1e-3
    assert seen[-1] == (image.size, image.size)


def rng_holes(shape):
    rng = np.random.default_rng(6)
    holes = rng.random(shape) < 0.001
    holes[240:300, 200:330] = True
    return holes


def test_everything_else_of_a_file_is_kept(sharpening, tmp_path):
    path, out = str(tmp_path / "a.tif"), str(tmp_path / "b.tif")
    image = np.random.default_rng(1).integers(100, 3000, (3, 90, 80)).astype(np.uint16)
    write(path, image, crs="EPSG:32631", transform=rasterio.Affine(0.7, 0, 5e5, 0, -0.7, 5e6),
          nodata=0, tiled=True, blockxsize=64, blockysize=64)  # fmt: skip
    rpc = RPC(
        height_off=1.0, height_scale=500.0, lat_off=3.0, lat_scale=0.1, line_den_coeff=[1.0] * 20,
        line_num_coeff=[0.5] * 20, line_off=45.0, line_scale=45.0, long_off=4.0, long_scale=0.1,
        samp_den_coeff=[1.0] * 20, samp_num_coeff=[0.25] * 20, samp_off=40.0, samp_scale=40.0,
    )  # fmt: skip
    with open_quietly(path, "r+") as dataset:
        dataset.update_tags(MISSION="one", TIFFTAG_DATETIME="2026:01:02 03:04:05")
        dataset.update_tags(ns="IMD", cloudCover="0.1")
        dataset.update_tags(ns="VENDOR", ORBIT="17")
        dataset.update_tags(2, GAIN="7", STATISTICS_MAXIMUM="1500")
        dataset.update_tags(1, STATISTICS_MAXIMUM="1400")
        dataset.descriptions = ("pan", "red", "alpha")
        dataset.scales, dataset.offsets = (0.1, 0.1, 1.0), (5.0, 5.0, 0.0)
        dataset.units = ("W", "W", "")
        dataset.rpcs = rpc
        dataset.colorinterp = (ColorInterp.gray, ColorInterp.undefined, ColorInterp.alpha)
    ac.restore(path, sharpening, out=out, bands=2, accept_mismatch=True)
    with open_quietly(path) as old, open_quietly(out) as new:
        assert (new.crs, new.transform, new.nodata) == (old.crs, old.transform, old.nodata)
        assert (new.dtypes, new.shape, new.count) == (old.dtypes, old.shape, old.count)
        assert (new.descriptions, new.scales, new.offsets) == (
            old.descriptions, old.scales, old.offsets)  # fmt: skip
        assert (new.units, new.colorinterp) == (old.units, old.colorinterp)
        assert new.rpcs.to_dict() == old.rpcs.to_dict()
        assert new.tags()["MISSION"] == "one"
        assert new.tags()["TIFFTAG_DATETIME"] == "2026:01:02 03:04:05"
        assert new.tags(ns="IMD")["cloudCover"] == "0.1"
        assert new.tags()["VENDOR.ORBIT"] == "17"
        assert new.tags(2)["GAIN"] == "7"
        # GDAL's numbers of pixels that are others now.
        assert "STATISTICS_MAXIMUM" not in new.tags(2)
        assert new.tags(1)["STATISTICS_MAXIMUM"] == "1400"
        assert "bands 2; noise gain 1.8" in new.tags()["ACUTANCE_RESTORATION"]
        assert new.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert np.array_equal(new.read(1), old.read(1))
        assert np.array_equal(new.read(3), old.read(3))
        assert not np.array_equal(new.read(2), old.read(2))


def test_control_points_and_a_mask_are_kept(sharpening, tmp_path):
    path, out = str(tmp_path / "a.tif"), str(tmp_path / "b.tif")
    image = np.random.default_rng(1).integers(100, 3000, (60, 80)).astype(np.int16)
    write(path, image)
    points = [GroundControlPoint(row=r, col=c, x=4 + c / 1e4, y=50 - r / 1e4, z=0.0)
              for r, c in ((0, 0), (0, 79), (59, 0), (59, 79))]  # fmt: skip
    mask = np.full(image.shape, 255, np.uint8)
    mask[:9] = 0
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True), open_quietly(path, "r+") as dataset:
        dataset.gcps = (points, "EPSG:4326")
        dataset.write_mask(mask)
    done = ac.restore(path, sharpening, out=out)
    assert done.bands[1].nodata == 9 * 80
    with open_quietly(out) as new:
        found, crs = new.gcps
        assert [(one.row, one.col, one.x) for one in found] == [
            (one.row, one.col, one.x) for one in points]  # fmt: skip
        assert crs.to_epsg() == 4326
        assert np.array_equal(new.read_masks(1), mask)
        assert np.array_equal(new.read(1)[:9], image[:9])


def test_a_numpy_file_becomes_one(landscape, sharpening, tmp_path):
    path, out = tmp_path / "a.npy", tmp_path / "b.npy"
    np.save(path, landscape)
    done = ac.restore(path, sharpening, out=out)
    assert np.array_equal(np.load(out), ac.restore(landscape, sharpening))
    assert done.bands[1].pixels == landscape.size
    with pytest.raises(ac.OptionError, match=r"name a \.npy"):
        ac.restore(path, sharpening, out=tmp_path / "b.tif")


def test_a_numpy_file_that_is_interrupted_leaves_nothing(
    landscape, sharpening, tmp_path, monkeypatch
):
    def cut(file, _):
        file.write(b"half")
        raise KeyboardInterrupt

    np.save(tmp_path / "a.npy", landscape)
    monkeypatch.setattr(np, "save", cut)
    with pytest.raises(KeyboardInterrupt):
        ac.restore(tmp_path / "a.npy", sharpening, out=tmp_path / "b.npy")
    assert [one.name for one in tmp_path.iterdir()] == ["a.npy"]


def scene(tmp_path, bands=1, gsd=0.7, **profile):
    path = tmp_path / f"scene-{bands}-{gsd}.tif"
    image = np.random.default_rng(1).integers(100, 3000, (bands, 40, 50)).astype(np.uint16)
    write(path, image, crs="EPSG:32631", transform=rasterio.Affine(gsd, 0, 5e5, 0, -gsd, 5e6),
          **profile)  # fmt: skip
    return str(path)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"nodata": "x"}, "nodata is 'x': give the number"),
        ({"saturation": "x"}, "saturation is 'x': give a finite stored value"),
        ({"saturation": np.inf}, "saturation is inf: give a finite stored value"),
    ],
)
def test_values_of_pixels_are_numbers(landscape, sharpening, wrong, message):
    with pytest.raises(ac.OptionError, match=message):
        ac.restore(landscape, sharpening, **wrong)


def test_other_pixels_and_another_band_are_refused(sharpening, tmp_path):
    out = str(tmp_path / "out.tif")
    with pytest.raises(ac.OptionError, match="pixels of 2 by 2 m"):
        ac.restore(scene(tmp_path, gsd=2.0), sharpening, out=out)
    ac.restore(scene(tmp_path, gsd=2.0), sharpening, out=out, accept_mismatch=True)
    several = scene(tmp_path, bands=3)
    with pytest.raises(ac.OptionError, match="measured in band 1, band 2 was asked for"):
        ac.restore(several, sharpening, out=out, bands=2)
    assert list(ac.restore(several, sharpening, out=out, bands="all").bands) == [1, 2, 3]
    assert list(ac.restore(several, sharpening, out=out).bands) == [1]
    for stated in (np.int64(1), [np.uint8(1)], np.array([1], np.uint8)):
        assert list(ac.restore(several, sharpening, out=out, bands=stated).bands) == [1]
    assert len(ac.restore(several, sharpening, out=out, bands=np.array([1, 2]),
                          accept_mismatch=True).bands) == 2  # fmt: skip
    for wrong in ("pan", 1.5, [1, "2"]):
        with pytest.raises(ac.OptionError, match="give numbers from 1, or 'all'"):
            ac.restore(several, sharpening, out=out, bands=wrong)
    with pytest.raises(ac.OptionError, match="no band was named"):
        ac.restore(several, sharpening, out=tmp_path / "copy.tif", bands=[])
    assert not (tmp_path / "copy.tif").exists()
    done = ac.restore(several, sharpening, out=out, bands=[1, 1])
    assert done.bands[1].pixels == 40 * 50
    assert "; bands 1; " in rewriting.stored_tags(out)["ACUTANCE_RESTORATION"]
    with pytest.raises(ac.ImageError, match="band 7"):
        ac.restore(several, sharpening, out=out, bands=7, accept_mismatch=True)


def test_an_image_restored_before_is_restored_again(sensor, sharpening, tmp_path):
    first, second, third = (str(tmp_path / f"{name}.tif") for name in "abc")
    ac.restore(scene(tmp_path), sharpening, out=first)
    with pytest.raises(ac.OptionError, match="was restored before"):
        ac.restore(first, sharpening, out=second)
    other = ac.design_restoration(sensor, noise_gain=1.5, size=5)
    ac.restore(first, other, out=second, accept_mismatch=True)
    ac.restore(second, sharpening, out=third, accept_mismatch=True)
    tags = [rewriting.stored_tags(path) for path in (first, second, third)]
    applied = [one["ACUTANCE_RESTORATION"] for one in tags]
    assert ["noise gain 1.8" in one for one in applied] == [True, False, True]
    assert "kernel 5x5" in applied[1]
    assert [one.get("ACUTANCE_RESTORATION_BEFORE") for one in tags] == [
        None, applied[0], f"{applied[0]} | {applied[1]}"]  # fmt: skip


def test_a_filter_without_a_band_needs_one_of_several(sensor, tmp_path):
    filter = ac.design_restoration(sensor, noise_gain=1.5, size=5)
    with pytest.raises(ac.OptionError, match="say which"):
        ac.restore(scene(tmp_path, bands=3), filter, out=tmp_path / "out.tif")


def test_an_image_is_not_restored_twice(sharpening, tmp_path):
    first, second = str(tmp_path / "one.tif"), str(tmp_path / "two.tif")
    ac.restore(scene(tmp_path), sharpening, out=first)
    with pytest.raises(ac.OptionError, match="was restored before"):
        ac.restore(first, sharpening, out=second)


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.ones((1, 1)), "fewer than the kernel"),
        (np.ones((200, 4)), "fewer than the kernel"),
        (np.ones((20, 20), complex), "complex"),
        (np.ones((3, 20, 20)), "two axes"),
        (np.ones((20, 20), bool), "mask"),
        (np.zeros((0, 5)), "empty"),
    ],
)
def test_what_is_no_image_or_too_small_is_refused(sharpening, image, message):
    with pytest.raises(ac.AcutanceError, match=message):
        ac.restore(image, sharpening)


def test_an_image_without_any_data_stays_so(sharpening):
    found, counts = restore_array(np.full((30, 30), np.nan), sharpening)
    assert np.isnan(found).all()
    assert counts.nodata == 900


def test_an_open_image_is_refused_with_what_to_give(landscape, sharpening):
    with pytest.raises(ac.OptionError, match=r"give its pixels, image\.read\(\)"):
        ac.restore(ac.Image.from_array(landscape), sharpening)


def test_outputs_that_cannot_be_are_refused(sharpening, tmp_path):
    path = scene(tmp_path)
    with pytest.raises(ac.OptionError, match="the input itself"):
        ac.restore(path, sharpening, out=path)
    with pytest.raises(ac.ImageError, match="cannot be written"):
        ac.restore(path, sharpening, out=tmp_path / "missing" / "out.tif")
    with pytest.raises(ac.OptionError, match="name the one to be written"):
        ac.restore(path, sharpening)
    with pytest.raises(ac.OptionError, match=r"name a \.tif"):
        ac.restore(path, sharpening, out=tmp_path / "out.png")
    with pytest.raises(ac.OptionError, match="a folder"):
        ac.restore(path, sharpening, out=tmp_path)
    with pytest.raises(ac.OptionError, match="the filter is a dict"):
        ac.restore(path, sharpening.to_dict(), out=tmp_path / "out.tif")
    with pytest.raises(ac.ImageError):
        ac.restore(tmp_path / "none.tif", sharpening, out=tmp_path / "out.tif")


def test_an_error_in_between_leaves_nothing_behind(sharpening, tmp_path):
    path, out = scene(tmp_path), tmp_path / "out.tif"

    def fails(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ac.restore(path, sharpening, out=out, progress=fails)
    assert sorted(one.name for one in tmp_path.iterdir()) == [os.path.basename(path)]


def test_a_killed_process_leaves_no_file_of_the_final_name(sharpening, tmp_path):
    path, out, kept = scene(tmp_path), tmp_path / "out.tif", tmp_path / "filter.json"
    from acutance.report import json_text

    kept.write_text(json_text(sharpening.to_dict()))
    program = textwrap.dedent(
        """
        import sys, time
        import acutance as ac

        def slow(done, total):
            print("window", flush=True)
            time.sleep(60)

        ac.restore(sys.argv[1], ac.RestorationFilter.read(sys.argv[2]), out=sys.argv[3],
                   progress=slow)
        """
    )
    arguments = [sys.executable, "-c", program, path, str(kept), str(out)]
    with subprocess.Popen(arguments, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"window\n"
        process.send_signal(signal.SIGKILL)
    assert not out.exists()
    assert list(tmp_path.glob(".acutance-*"))
    ac.restore(path, sharpening, out=out)
    assert not list(tmp_path.glob(".acutance-*"))


def test_a_window_needs_no_more_than_its_reach(sharpening):
    """Pixels farther away change nothing, holes and all: so windows may be cut anywhere."""
    rng = np.random.default_rng(9)
    image = rng.normal(1000, 100, (300, 300))
    image[rng.random(image.shape) < 0.02] = np.nan
    image[100:150, 100:180] = np.nan
    reach = reach_px(sharpening.kernel)
    part = image[60 : 200 + 2 * reach, 40 : 180 + 2 * reach]
    whole, cut = ac.restore(image, sharpening), ac.restore(part, sharpening)
    inner = np.s_[reach:-reach, reach:-reach]
    expected = whole[60 : 200 + 2 * reach, 40 : 180 + 2 * reach][inner]
    assert cut[inner] == pytest.approx(expected, abs=1e-9, nan_ok=True)


@pytest.fixture(scope="module")
def swath(landscape):
    """Zeros beyond a slanted border, which nothing declares."""
    rows, cols = np.indices(landscape.shape)
    outside = cols > 200 + 0.2 * rows - 30
    return np.where(outside, 0, np.rint(landscape)).astype(np.uint16), outside


def test_undeclared_fill_is_no_data(tmp_path, monkeypatch, swath, sharpening):
    image, outside = swath
    expected = ac.restore(image, sharpening, nodata=0)
    assert not expected[outside].any()
    with pytest.warns(UserWarning, match=f"{np.count_nonzero(outside)} of them fill that is not"):
        assert np.array_equal(ac.restore(image, sharpening), expected)
    write(tmp_path / "a.tif", image)
    monkeypatch.setattr(rewriting, "_WINDOW_ROWS", 70)
    monkeypatch.setattr(rewriting, "_WINDOW_COLS", 90)
    done = ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif")
    counts = done.bands[1]
    assert counts.fill == counts.nodata == np.count_nonzero(outside)
    with open_quietly(tmp_path / "b.tif") as dataset:
        assert np.array_equal(dataset.read(1), expected)
        assert dataset.nodata is None


def test_every_value_can_be_stated_to_be_data(tmp_path, swath, sharpening):
    image, outside = swath
    write(tmp_path / "a.tif", image)
    done = ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif", nodata=np.nan)
    assert done.bands[1].nodata == 0
    with open_quietly(tmp_path / "b.tif") as dataset:
        assert dataset.read(1)[outside].any()
        assert dataset.nodata is None


def test_dark_data_do_not_become_fill(swath, sharpening):
    """A pixel with data that the kernel would make zero is moved by one."""
    image, outside = swath
    image = image.copy()
    image[100:103, 50:53] = 3
    found, counts = restore_array(image, sharpening)
    assert (found[~outside] > 0).all()
    assert counts.off_nodata > 0


BANDS_OF_THEIR_OWN = """<VRTDataset rasterXSize="90" rasterYSize="90">
<SRS>EPSG:32631</SRS><GeoTransform>500000, 0.7, 0, 5000000, 0, -0.7</GeoTransform>
{}</VRTDataset>"""
ONE_BAND = """<VRTRasterBand dataType="{kind}" band="{number}">{nodata}
<SimpleSource><SourceFilename relativeToVRT="1">band-{number}.tif</SourceFilename></SimpleSource>
</VRTRasterBand>"""


@pytest.fixture
def write_bands(tmp_path):
    """Write a VRT of bands, each with its own nodata value or none."""

    def write_vrt(bands, values):
        parts = []
        for number, (band, nodata) in enumerate(zip(bands, values, strict=True), 1):
            write(tmp_path / f"band-{number}.tif", band)
            kind = {"uint8": "Byte", "float32": "Float32"}[band.dtype.name]
            declared = "" if nodata is None else f"<NoDataValue>{nodata}</NoDataValue>"
            parts.append(ONE_BAND.format(kind=kind, number=number, nodata=declared))
        path = tmp_path / "bands.vrt"
        path.write_text(BANDS_OF_THEIR_OWN.format("".join(parts)))
        return path

    return write_vrt


@pytest.mark.parametrize("bands", ["all", 1])
def test_bands_with_different_nodata_get_a_common_one(sharpening, tmp_path, write_bands, bands):
    """A GeoTIFF has one: fill of the others became data, and data of its value were lost."""
    rng = np.random.default_rng(5)
    first, second, third = rng.integers(60, 190, (3, 90, 90)).astype(np.uint8)
    first[:20], second[:30], second[60, 40:45], third[:9] = 0, 255, 0, 0
    path, out = write_bands([first, second, third], [0, 255, None]), tmp_path / "out.tif"
    done = ac.restore(path, sharpening, out=out, bands=bands, accept_mismatch=True)
    with open_quietly(out) as dataset:
        assert dataset.nodatavals == (0, 0, 0)
        found = dataset.read()
    assert np.array_equal(found[0] == 0, first == 0)
    assert np.array_equal(found[1] == 0, second == 255)
    assert (found[2] > 0).all()
    assert found[1, 60, 40:45].max() < 60
    note = done.notes[-1]
    assert note.startswith("the bands have different nodata values (0, 255, none)")
    assert "in the new file all have 0" in note
    if bands == 1:
        assert note.endswith("moved by one step: 5 of band 2, 810 of band 3")
        assert np.array_equal(found[1][30:], np.maximum(second[30:], 1))


def test_floats_with_different_nodata_get_nan(sharpening, tmp_path, write_bands):
    first, second = np.random.default_rng(5).normal(100, 9, (2, 90, 90)).astype(np.float32)
    first[:20], second[:30], second[60, 40:45] = -9999, np.nan, -9999
    path, out = write_bands([first, second], [-9999, "nan"]), tmp_path / "out.tif"
    done = ac.restore(path, sharpening, out=out, accept_mismatch=True)
    with open_quietly(out) as dataset:
        assert np.isnan(dataset.nodatavals).all()
        found = dataset.read()
    assert np.array_equal(np.isnan(found[0]), first == -9999)
    assert np.array_equal(found[1], second, equal_nan=True)
    assert done.notes[-1].endswith("(-9999, nan), in the new file all have nan")


def test_a_product_declares_the_nodata_of_its_bands(sharpening, tmp_path):
    image = np.random.default_rng(1).integers(100, 3000, (60, 60)).astype(np.uint16)
    image[20:30, 20:30] = 7
    write(tmp_path / "a.tif", image)
    with open_quietly(tmp_path / "a.tif", "r+") as dataset:
        dataset.update_tags(SPECIAL_VALUE_NODATA="7")
    done = ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif")
    assert done.bands[1].nodata == 100
    with open_quietly(tmp_path / "b.tif") as dataset:
        assert np.array_equal(dataset.read(1) == 7, image == 7)
        assert dataset.nodata == 7


@pytest.mark.parametrize("nodata", [-9999, 70000, 0.5])
def test_a_nodata_value_that_no_pixel_can_have(sharpening, tmp_path, nodata):
    image = np.random.default_rng(1).integers(0, 300, (60, 60)).astype(np.uint16)
    found, counts = restore_array(image, sharpening, nodata=nodata)
    expected, _ = restore_array(image, sharpening)
    assert np.array_equal(found, expected)
    assert (counts.nodata, counts.off_nodata) == (0, 0)
    write(tmp_path / "a.tif", image)
    ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif", nodata=nodata)
    with open_quietly(tmp_path / "b.tif") as dataset:
        assert dataset.nodata is None
        assert np.abs(dataset.read(1).astype(int) - expected).max() <= 1


@pytest.mark.parametrize("dtype", [np.uint8, np.int8, np.float32])
def test_black_data_beside_black_fill_stay_dark(sharpening, dtype):
    """Of the value of fill, they were moved below the lowest value of the type: to the highest."""
    lowest = 0 if dtype is np.float32 else np.iinfo(dtype).min
    image = (lowest + np.random.default_rng(2).integers(55, 66, (150, 150))).astype(dtype)
    image[:50] = image[90:110, 70:90] = lowest
    found, counts = restore_array(image, sharpening)
    assert counts.fill == 50 * 150
    assert counts.off_nodata > 0
    assert (found[50:] != lowest).all()
    assert found[95:105, 75:85].max() < lowest + 12


def test_saturated_counts_stay_where_the_scale_is_negative(sharpening, tmp_path):
    image = np.random.default_rng(2).integers(500, 600, (60, 60)).astype(np.uint16)
    image[30, 30:33] = 1023
    write(tmp_path / "a.tif", image)
    with open_quietly(tmp_path / "a.tif", "r+") as dataset:
        dataset.scales, dataset.offsets = (-0.1,), (200.0,)
        dataset.update_tags(SPECIAL_VALUE_SATURATED="1023")
    done = ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif")
    assert done.bands[1].saturated == 3
    with open_quietly(tmp_path / "b.tif") as dataset:
        assert np.array_equal(dataset.read(1)[30, 30:33], [1023] * 3)


def test_an_image_without_data_is_not_written(tmp_path, sharpening):
    write(tmp_path / "a.tif", np.full((60, 60), np.nan, np.float32))
    with pytest.raises(ac.NoDataError, match="no pixel of"):
        ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif")
    assert [one.name for one in tmp_path.iterdir()] == ["a.tif"]
    (tmp_path / "a.tif").unlink()
    np.save(tmp_path / "a.npy", np.zeros((60, 60)))
    with pytest.raises(ac.NoDataError, match="no pixel of"):
        ac.restore(tmp_path / "a.npy", sharpening, out=tmp_path / "b.npy", nodata=0)
    assert [one.name for one in tmp_path.iterdir()] == ["a.npy"]


@pytest.mark.parametrize("ending", ["tif", "npy"])
def test_an_image_of_saturated_pixels_alone_is_not_written(tmp_path, sharpening, ending):
    image = np.full((60, 60), 500, np.uint16)
    image[:20] = 0
    if ending == "tif":
        write(tmp_path / "a.tif", image)
    else:
        np.save(tmp_path / "a.npy", image)
    with pytest.raises(ac.NoDataError, match="that has data is saturated: nothing was written"):
        ac.restore(
            tmp_path / f"a.{ending}", sharpening, out=tmp_path / f"b.{ending}", nodata=0,
            saturation=300,
        )  # fmt: skip
    assert [one.name for one in tmp_path.iterdir()] == [f"a.{ending}"]


def test_what_was_not_compared_is_told(tmp_path, landscape, sharpening):
    image = np.rint(landscape).astype(np.uint16)
    write(tmp_path / "a.tif", np.stack([image] * 3))
    (done, every) = (
        ac.restore(tmp_path / "a.tif", sharpening, out=tmp_path / "b.tif", bands=bands)
        for bands in (1, "all")
    )
    assert done.notes == (
        "the pixel size was not compared: that of the image is not known",
        "copied unfiltered: bands 2, 3",
    )
    assert "filtered though the filter is of band 1: bands 2, 3" in every.notes
    assert every.to_dict()["notes"] == list(every.notes)


def test_a_neighbour_of_the_name_of_a_part_stays(tmp_path, sharpening, landscape):
    own = tmp_path / f"b.npy.{os.getpid()}.part"
    own.write_text("precious")
    np.save(tmp_path / "a.npy", landscape)
    ac.restore(tmp_path / "a.npy", sharpening, out=tmp_path / "b.npy")
    assert own.read_text() == "precious"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.npy", "b.npy", own.name]
