"""A GSD that is stated for an image which has another one of its own."""

import numpy as np
import pytest

import acutance as ac
from acutance.errors import OptionError
from acutance.raster import Gsd, write_geotiff
from acutance.report import text


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    sensor = ac.simulate.reference_systems()["gaussian"]
    image, _ = ac.simulate.edge(sensor, snr=100, shape=(50, 50), rng=np.random.default_rng(1))
    path = tmp_path_factory.mktemp("gsd") / "half_metre.tif"
    write_geotiff(path, image, gsd_m=0.5)
    return path, image


@pytest.mark.parametrize("at_opening", [True, False])
def test_another_gsd_than_the_images_own_is_named(scene, at_opening):
    path, _ = scene
    image = ac.open_image(path, gsd_m=30.0 if at_opening else None)
    found = ac.measure_edge(image, gsd_m=None if at_opening else 30.0)
    assert found.image.gsd_m == 30.0
    assert found.image.file_gsd_m == (0.5, 0.5)
    assert "GSD 30 m (stated; the image's own is 0.5 m)" in text(found)
    (check,) = [one for one in found.failed_checks if one.name == "stated_gsd"]
    assert "30 m, the image's own 0.5 m: another by a factor of 60" in check.message
    assert found.verdict.word == "doubtful"
    again = ac.Record.from_dict(found.to_dict())
    assert again.image == found.image


@pytest.mark.parametrize("stated", [None, 0.51, Gsd(0.5, 0.5)])
def test_the_images_own_gsd_or_a_rounding_of_it_needs_no_note(scene, stated):
    path, _ = scene
    found = ac.measure_edge(ac.open_image(path), gsd_m=stated)
    assert found.image.file_gsd_m is None
    assert "stated" not in text(found).splitlines()[1]


def test_an_array_in_memory_has_no_other_gsd(scene):
    _, image = scene
    assert ac.measure_edge(image, gsd_m=30.0).image.file_gsd_m is None
    with_one = ac.Image.from_array(image, gsd_m=0.5)
    assert ac.measure_edge(with_one, gsd_m=30.0).image.file_gsd_m == (0.5, 0.5)


def test_a_gsd_within_the_factor_is_no_doubt(scene):
    path, _ = scene
    found = ac.measure_edge(ac.open_image(path), gsd_m=1.0)
    (check,) = [one for one in found.checks if one.name == "stated_gsd"]
    assert (check.passed, check.value) == (True, 2.0)
    trusting = ac.EdgeOptions(limits={"stated_gsd": 100})
    again = ac.measure_edge(ac.open_image(path), gsd_m=30.0, options=trusting)
    assert "stated_gsd" not in [one.name for one in again.failed_checks]


@pytest.mark.parametrize("gsd_m", [1e9, 1e-6, Gsd(0.5, 1e9)])
def test_a_gsd_that_no_image_has_is_refused(scene, gsd_m):
    path, image = scene
    with pytest.raises(OptionError, match=r"images of the Earth's surface have 0.005 to 100000 m"):
        ac.open_image(path, gsd_m=gsd_m)
    with pytest.raises(OptionError, match="give metres"):
        ac.measure_edge(image, gsd_m=gsd_m)
