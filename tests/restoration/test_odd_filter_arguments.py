"""Whatever a filter, and what applies and proves it, is handed in wrongly is refused in words."""

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
