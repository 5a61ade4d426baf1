"""The command on a page repeats the measurement, or there is none."""

import html
import re
from pathlib import Path

import numpy as np
import pytest

import acutance as ac
from acutance.raster import Gsd, Region, open_image
from acutance.report import page

pytestmark = pytest.mark.usefixtures("undrawn")

TRIANGLE = Region(np.array([[4.0, 4.0], [4.0, 44.0], [54.0, 44.0], [54.0, 12.0]]))


@pytest.fixture(scope="module")
def edge_file(tmp_path_factory) -> Path:
    sensor = ac.Sensor([ac.optics.Gaussian(0.42), ac.optics.Detector(1.0)])
    rng = np.random.default_rng(0)
    pixels, _ = ac.simulate.edge(sensor, angle_deg=6, shape=(60, 50), snr=60, rng=rng)
    path = tmp_path_factory.mktemp("repeated") / "edge.npy"
    np.save(path, pixels)
    return path


def command_of(result) -> str | None:
    found = re.search(r"acutance (?:edge|pulse) [^<]*", page(result))
    return None if found is None else html.unescape(found[0])


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"options": ac.EdgeOptions(robust=False)}, "--no-robust"),
        ({"options": ac.EdgeOptions(limits={"rows": 100, "outliers": 0.5})},
         "--limit rows=100 --limit outliers=0.5"),
        ({"gsd_m": Gsd(1.0, 3.0)}, "--gsd 1,3"),
        ({"method": "kompsat-2014", "options": ac.EdgeOptions(rer_centre="half")},
         "--rer-centre half"),
    ],
)  # fmt: skip
def test_what_was_asked_stands_in_the_command(edge_file, asked, words):
    measured = ac.measure_edge(open_image(edge_file), **asked)
    assert words in command_of(measured)


def test_a_default_is_not_written(edge_file):
    command = command_of(ac.measure_edge(open_image(edge_file), method="kompsat-2014"))
    for one in ("--rer-centre", "--no-robust", "--limit", "--nodata", "--gsd", "--all"):
        assert one not in command


@pytest.mark.parametrize(("nodata", "words"), [(-9999, "--nodata -9999"), (np.nan, "--nodata nan")])
def test_a_stated_nodata_value_stands_in_the_command(edge_file, nodata, words):
    measured = ac.measure_edge(open_image(edge_file, nodata=nodata))
    assert words in command_of(measured)


def test_all_edges_of_a_region_are_asked_for(edge_file):
    assert command_of(ac.measure_edges(open_image(edge_file))).endswith(" --all")


def test_what_cannot_be_typed_has_no_command(edge_file):
    assert command_of(ac.measure_edge(open_image(edge_file), TRIANGLE)) is None
