"""A GSD that is stated for an image which has another one of its own."""

import numpy as np
import pytest

import acutance as ac
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
