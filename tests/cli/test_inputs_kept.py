"""No output of a command overwrites what the command reads, whatever its name."""

import os

import numpy as np
import pytest

from acutance.cli.output import check_output, outputs_of_a_run
from acutance.errors import OptionError
from acutance.raster import write_geotiff


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Inputs of every kind; none holds what it should, for nothing may be read before a refusal."""
    monkeypatch.chdir(tmp_path)
    for name in ("low.tif", "high.csv", "places.csv", "roi.csv", "my.toml", "a.json", "b.csv"):
        (tmp_path / name).write_text("mine")
    return tmp_path


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        (("points", "low.tif", "--positions", "places.csv", "--csv", "places.csv"), "places.csv"),
        (("points", "low.tif", "--surveyed", "places.csv", "--csv", "./places.csv"), "places.csv"),
        (("biresolution", "low.tif", "high.csv", "--csv", "high.csv"), "high.csv"),
        (("biresolution", "low.tif", "x", "--reference", "b.csv", "--csv", "b.csv"), "b.csv"),
        (("edge", "low.tif", "--roi", "roi.csv", "--csv", "roi.csv"), "roi.csv"),
        (("pulse", "low.tif", "--roi", "roi.csv", "--csv", "roi.csv"), "roi.csv"),
        (("bars", "low.tif", "--roi", "roi.csv", "--csv", "roi.csv"), "roi.csv"),
        (("star", "low.tif", "--roi", "roi.csv", "--csv", "roi.csv"), "roi.csv"),
        (("combine", "a.json", "b.csv", "--csv", "b.csv"), "b.csv"),
        (("simulate", "sensor-budget", "my.toml", "--toml", "my.toml"), "my.toml"),
    ],
)
def test_an_input_is_not_overwritten(acutance, folder, words, kept):
    done = acutance(*words)
    assert done.exit_code == 2
    assert f"is the input {kept}, which it would overwrite: give another name" in done.stderr
    assert (folder / kept).read_text() == "mine"


@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_a_link_to_an_input_is_the_input(acutance, folder, link):
    for name in ("other.csv", "other.tif", "other.toml"):
        link("places.csv" if name == "other.csv" else "my.toml", name)
    for words in (
        ("points", "low.tif", "--positions", "other.csv", "--csv", "places.csv"),
        ("points", "low.tif", "--positions", "places.csv", "--csv", "other.csv"),
        ("simulate", "sensor-budget", "other.toml", "--toml", "my.toml"),
        ("simulate", "edge", "--sensor", "my.toml", "--out", "other.tif"),
        ("simulate", "star", "--sensor", "my.toml", "--out", "other.tif"),
        ("simulate", "pair", "--high-sensor", "my.toml", "--out", "a.tif", "--high", "other.tif"),
    ):
        done = acutance(*words)
        assert done.exit_code == 2
        assert "which it would overwrite" in done.stderr, words
    for name in ("places.csv", "my.toml"):
        assert (folder / name).read_text() == "mine"


@pytest.mark.parametrize(
    "kept", ["low.tif", "low.IMD", "places.geojson", "my.toml", "new.db", "new.db-wal", "sub.xml"]
)
def test_a_log_is_no_file_of_its_batch(acutance, folder, kept):
    """Lines are added to a log: an image, a plan or a database with lines at its end is broken."""
    (folder / "places.geojson").write_text("mine")
    (folder / "low.IMD").write_text("mine")
    (folder / "my.toml").write_text(
        'images = "l*.tif"\ntargets = "places.geojson"\narchive = "new.db"\n'
        '[[stated]]\nmetadata = "sub.xml"\n'
    )
    before = {one.name: one.read_bytes() for one in folder.iterdir()}
    for words in (
        ("my.toml",),
        ("low.tif", "--targets", "places.geojson", "--archive", "sqlite:///new.db"),
    ):
        if kept in ("my.toml", "sub.xml") and "my.toml" not in words:
            continue
        done = acutance("batch", *words, "--log", f"./{kept}")
        assert done.exit_code == 2
        assert f"--log ./{kept} is the input " in done.stderr
        assert "which it would overwrite: give another name" in done.stderr
    assert {one.name: one.read_bytes() for one in folder.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "options"),
    [
        (("--edges", "new.csv", "--csv", "./new.csv"), "--csv and --edges"),
        (("--keep", "new.csv", "--edges", "new.csv"), "--edges and --keep"),
        (("--edges", "b.csv", "--csv", "linked.csv"), "--csv and --edges"),
        (("--csv", "a.csv", "--edges", "a-band-2.csv", "--band", "1,2"), "--edges and --csv"),
        (("--keep", "n.html", "--report", "n.html"), "--report and --keep"),
    ],
)
def test_no_output_overwrites_another(refused, folder, words, options):
    os.link("b.csv", "linked.csv")
    write_geotiff("low.tif", np.ones((2, 40, 40), np.float32), gsd_m=1.0)
    before = {one.name: one.read_bytes() for one in folder.iterdir()}
    refused(("scan", "low.tif", *words), f"{options} name the same file")
    assert {one.name: one.read_bytes() for one in folder.iterdir()} == before


def test_a_scan_keeps_its_windows_in_no_input(refused, folder):
    refused(("scan", "low.tif", "--keep", "./low.tif"), "--keep ./low.tif is the input low.tif")


def test_two_runs_may_write_the_same_file(folder):
    """In a program that calls commands one after the other."""
    for option in ("--csv", "--edges"):
        with outputs_of_a_run():
            check_output(option, "new.csv", (".csv",))


def test_words_that_are_no_path_are_no_input(folder):
    odd = ("1,2,3,4", "x" * 5000, "nul\0byte", None)
    assert check_output("--csv", "new.csv", (".csv",), keep=odd).path.name == "new.csv"


def test_a_pair_needs_two_files_however_they_are_named(acutance, folder):
    (folder / "sub").mkdir()
    done = acutance("simulate", "pair", "--out", "a.tif", "--high", "sub/../a.tif")
    assert done.exit_code == 2
    assert "name the same file" in done.stderr
    with pytest.raises(OptionError):
        check_output("--csv", "sub/../places.csv", (".csv",), keep=("places.csv",))
