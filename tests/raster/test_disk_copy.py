"""Images in memory that other processes read from a file."""

import pickle

import numpy as np

import acutance as ac
from acutance.raster.disk_copy import disk_copy, named_from_root


def test_pixels_mask_and_description_are_kept(tmp_path):
    values = np.ma.masked_equal(np.arange(3000, dtype=np.int16).reshape(50, 60), 7)
    image = ac.Image.from_array(values, gsd_m=2.0, nodata=11)
    copy = disk_copy(image, tmp_path)
    assert np.array_equal(copy.read(), image.read(), equal_nan=True)
    assert (copy.path, copy.dtype, copy.saturation_level) == (None, "int16", 32767.0)
    assert copy.gsd() == image.gsd()
    assert len(pickle.dumps(copy)) < 2000


def test_a_linearised_image_stays_so(tmp_path):
    image = ac.Image.from_array(np.linspace(0, 1, 400).reshape(20, 20)).linearized(2.2)
    copy = disk_copy(image, tmp_path)
    assert np.array_equal(copy.read(), image.read())
    assert copy.characteristic == image.characteristic


def test_a_file_is_not_copied(tmp_path):
    np.save(tmp_path / "image.npy", np.zeros((20, 20)))
    image = ac.open_image(tmp_path / "image.npy")
    assert disk_copy(image, tmp_path) is image


def test_a_file_is_found_from_another_folder(tmp_path, monkeypatch):
    np.save(tmp_path / "image.npy", np.arange(400.0).reshape(20, 20))
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    image = ac.open_image("image.npy").linearized(2.2)
    named = named_from_root(image)
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert np.array_equal(named.read(), np.arange(400.0).reshape(20, 20) ** 2.2)
    assert named.path == str(tmp_path / "image.npy")
    in_memory = ac.Image.from_array(np.zeros((20, 20)))
    assert named_from_root(in_memory) is in_memory
