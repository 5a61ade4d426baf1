"""Whatever a filter, and what applies and proves it, is handed in wrongly is refused in words."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance.restoration import restore_array

SENSOR = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
PIXELS = np.random.default_rng(1).normal(500.0, 9.0, (40, 40))
IMAGE = ac.Image.from_array(PIXELS)
WRONG = ["x", b"x", {"a": 1}, ["a"], 1j, list, object(), np.zeros((3, 3))]


@pytest.fixture(scope="module")
def designed():
    return ac.design_restoration(SENSOR, snr=80.0, noise_gain=1.5, size=7)


@pytest.fixture
def path(tmp_path):
    name = tmp_path / "a.tif"
    ac.raster.write_geotiff(name, PIXELS.astype(np.float32))
    return name


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda f, x: ac.design_restoration(SENSOR, snr=80.0, isotropic=x),
        lambda f, x: ac.niirs(gsd_m=0.7, rer=0.45, snr=80.0, version=x),
        lambda f, x: ac.restore(PIXELS, x),
        lambda f, x: ac.restore(PIXELS, f, nodata=x),
        lambda f, x: ac.restore(PIXELS, f, bands=x),
        lambda f, x: ac.restore(PIXELS, f, accept_mismatch=x),
        lambda f, x: restore_array(PIXELS, x),
        lambda f, x: restore_array(PIXELS, f, nodata=x),
        lambda f, x: ac.verify_restoration(x, IMAGE, f),
        lambda f, x: ac.verify_restoration(IMAGE, x, f),
        lambda f, x: ac.verify_restoration(IMAGE, IMAGE, x),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(designed, call, wrong):
    with pytest.raises(ac.OptionError, match=r"give|has to be|there are|leave them out"):
        call(designed, wrong)


@pytest.mark.parametrize("wrong", [3, b"x", {"a": 1}, ["a"], object(), np.zeros((3, 3))])
def test_a_new_file_has_a_path(designed, path, wrong):
    with pytest.raises(ac.OptionError, match=r"(?s)out is .*: give the path of a file"):
        ac.restore(path, designed, out=wrong)
    with pytest.raises(ac.AcutanceError, match=r"give|region"):
        ac.verify_restoration(IMAGE, IMAGE, designed, regions=wrong)


def test_a_version_may_be_a_number_of_numpy():
    assert ac.niirs(gsd_m=0.7, rer=0.45, snr=80.0, version=np.int64(5)).version == 5


@pytest.mark.parametrize("wrong", [3, b"x", {"a": 1}, ["a"], object(), np.zeros((3, 3))])
def test_a_filter_is_read_and_asked_in_words(designed, wrong):
    with pytest.raises(ac.OptionError, match=r"(?s)path is .*: give the path of a file"):
        ac.RestorationFilter.read(wrong)
    with pytest.raises(ac.OptionError, match=r"method is"):
        ac.design_restoration(SENSOR, snr=80.0, method=wrong)
    if not isinstance(wrong, int | np.ndarray):
        with pytest.raises(ac.OptionError, match=r"u_cpp is .*: it has to hold numbers"):
            designed.otf(wrong, 0.0)


def test_a_filter_that_was_written_is_read_as_it_was(designed, tmp_path):
    place = tmp_path / "filter.json"
    place.write_text("older", encoding="utf-8")
    designed.write(place)
    again = ac.RestorationFilter.read(place)
    np.testing.assert_array_equal(again.kernel, designed.kernel)
    assert again.summary() == designed.summary()
    assert again.to_dict() == json.loads(place.read_text(encoding="utf-8"))
    assert [one.name for one in tmp_path.iterdir()] == ["filter.json"]


def test_a_filter_that_cannot_be_written_leaves_what_was_there(designed, tmp_path, monkeypatch):
    place = tmp_path / "filter.json"
    place.write_text("older", encoding="utf-8")

    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("os.replace", full)
        with pytest.raises(ac.OptionError, match=r"filter.json cannot be written \(No space"):
            designed.write(place)
    assert place.read_text(encoding="utf-8") == "older"
    assert [one.name for one in tmp_path.iterdir()] == ["filter.json"]
    with pytest.raises(ac.OptionError, match="cannot be written"):
        designed.write(tmp_path / "missing" / "filter.json")
    with pytest.raises(ac.OptionError, match=r"path is 3.*: give the path of a file"):
        designed.write(3)


def test_a_missing_filter_names_both_ways_of_writing_one(tmp_path):
    with pytest.raises(ac.OptionError) as caught:
        ac.RestorationFilter.read(tmp_path / "no.json")
    assert "acutance restore design" in str(caught.value)
    assert "RestorationFilter.write(path)" in str(caught.value)
