"""Hidden folders of unfinished images: those of killed processes go, all others stay."""

import os
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure

import acutance as ac
from acutance.execution import partial_folder as module
from acutance.execution.partial_folder import partial_folder, whole_file
from acutance.raster import write_geotiff


@pytest.fixture(scope="module")
def ended():
    """The number of a process that is no more."""
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        process.wait()
    return process.pid


@pytest.fixture
def left_behind(tmp_path, ended):
    """The folder of a process that was killed in the middle of an image."""
    with partial_folder(tmp_path / "a.tif") as running:
        name = os.path.basename(running)
    folder = tmp_path / name.replace(f"-{os.getpid()}-", f"-{ended}-")
    folder.mkdir()
    (folder / "image.tif").write_bytes(b"half")
    return folder


def test_what_a_killed_process_left_is_removed(tmp_path, left_behind):
    write_geotiff(tmp_path / "a.tif", np.zeros((300, 300)))
    assert [one.name for one in tmp_path.iterdir()] == ["a.tif"]


@pytest.mark.parametrize(
    "rename",
    [
        lambda name, ended: name.replace(f"-{ended}-", f"-{os.getpid()}-"),
        lambda name, ended: name.replace(f"-{ended}-", "-1-"),
        lambda name, ended: name.replace(f"-{ended}-", f"-{10**30}-"),
        lambda name, ended: name.replace(".acutance-", ".acutance-f"),
        lambda name, ended: name.replace(".acutance-", ".other-"),
        lambda name, ended: name + ".kept",
        lambda name, ended: ".acutance-kept",
    ],
    ids=["own", "running", "no process", "another system", "another program", "longer", "older"],
)
def test_every_other_folder_stays(tmp_path, left_behind, ended, rename):
    other = left_behind.rename(tmp_path / rename(left_behind.name, ended))
    write_geotiff(tmp_path / "a.tif", np.zeros((300, 300)))
    assert (other / "image.tif").read_bytes() == b"half"


def test_files_and_links_of_such_a_name_stay(tmp_path, left_behind):
    kept = left_behind.rename(tmp_path / "kept")
    left_behind.symlink_to(kept)
    write_geotiff(tmp_path / "a.tif", np.zeros((300, 300)))
    assert left_behind.is_symlink()
    left_behind.unlink()
    left_behind.write_bytes(b"a file")
    write_geotiff(tmp_path / "a.tif", np.zeros((300, 300)))
    assert left_behind.read_bytes() == b"a file"


def test_the_folder_of_another_user_stays(tmp_path, left_behind, monkeypatch):
    user = os.getuid() + 1
    monkeypatch.setattr(module.os, "getuid", lambda: user)
    write_geotiff(tmp_path / "a.tif", np.zeros((300, 300)))
    assert (left_behind / "image.tif").exists()


SENSOR = ac.optics.preset("generic-2005")


def _refuse(part, *_, **__):
    with part.open("wb") as file:
        file.write(b"half")
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("name", "write"),
    [
        (
            "sensor.toml",
            lambda path: ac.optics.write_sensor(ac.optics.preset("generic-2005"), path),
        ),
        ("figure.png", lambda path: ac.report.save_figure(Figure(), path)),
    ],
)
def test_an_interrupted_file_leaves_the_one_that_was_there(tmp_path, monkeypatch, name, write):
    path = tmp_path / name
    path.write_bytes(b"before")
    with monkeypatch.context() as broken:
        broken.setattr("pathlib.Path.write_text", _refuse)
        broken.setattr("pathlib.Path.write_bytes", _refuse)
        with pytest.raises(KeyboardInterrupt):
            write(path)
    assert [one.name for one in tmp_path.iterdir()] == [name]
    assert path.read_bytes() == b"before"
    write(path)
    assert path.read_bytes() != b"before"


def test_a_link_stays_one_and_a_pipe_is_written_to(tmp_path):
    linked = tmp_path / "link.txt"
    linked.symlink_to(tmp_path / "there.txt")
    with whole_file(linked) as part:
        part.write_bytes(b"all")
    assert linked.is_symlink()
    assert (tmp_path / "there.txt").read_bytes() == b"all"
    os.mkfifo(tmp_path / "pipe")
    with whole_file(tmp_path / "pipe") as part:
        assert part == tmp_path / "pipe"


@pytest.mark.parametrize("place", ["no/figure.png", "a\0b.png", "folder.png"])
def test_a_figure_that_cannot_be_written_is_refused_in_words(tmp_path, place):
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(ac.OptionError, match=r"(?s)cannot be written \(.*\): choose another path"):
        ac.report.save_figure(Figure(), tmp_path / place)
