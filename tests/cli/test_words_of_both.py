"""Messages help users of the command and of the library; nodata is an option."""

import json

import numpy as np
import pytest

from acutance.errors import OptionError, TargetError
from acutance.raster import open_image, write_geotiff
from acutance.targets.kinds import KINDS

NODATA = -9999.0


@pytest.fixture(scope="module")
def spoilt(edge_image, tmp_path_factory):
    """The edge with a frame of a value that its file does not declare as nodata."""
    pixels = open_image(edge_image).read()
    pixels[:6] = pixels[-6:] = NODATA
    path = tmp_path_factory.mktemp("spoilt") / "spoilt.tif"
    write_geotiff(path, pixels.astype(np.float32), gsd_m=0.7)
    return str(path)


def test_nodata_can_be_named(acutance, edge_image, spoilt):
    whole = acutance("edge", edge_image, "--roi", "6,0,48,44", "--json")
    named = acutance("edge", spoilt, "--nodata", NODATA, "--json")
    assert named.exit_code == 0, named.stderr
    found, expected = (json.loads(one.stdout)["rer"] for one in (named, whole))
    assert found["value"] == pytest.approx(expected["value"], abs=2 * expected["std"])
    taken = acutance("edge", spoilt, "--json")
    document = json.loads(taken.stdout)
    assert document["rer"] == found
    assert "undeclared_fill" in {
        check["name"] for check in document["checks"] if not check["passed"]
    }


MEASURING = ("edge", "pulse", "points", "biresolution", "bars", "star")


@pytest.mark.parametrize("command", MEASURING)
def test_every_measuring_command_has_the_shared_options(acutance, command):
    words = acutance(command, "--help").stdout.split()
    for name in ("roi", "site", "band", "nodata", "gsd", "along-track", "figure", "report", "csv"):
        assert f"--{name}" in words
    for name in ("json", "covariance", "limit", "strict", "robust"):
        assert f"--{name}" in words


@pytest.mark.parametrize("kind", ["pulse", "points", "biresolution", "bars", "star"])
def test_along_track_and_limits_reach_every_kind(acutance, edge_image, monkeypatch, kind):
    seen = []

    def measure(image, *, roi, options, **_):
        seen.append((image.along_track, roi, dict(options.limits)))
        raise TargetError("enough seen")

    monkeypatch.setattr(f"{KINDS[kind].room}.{KINDS[kind].measure}", measure)
    images = [edge_image] * (2 if kind == "biresolution" else 1)
    limit = f"{LIMITED[kind]}=0.5"
    done = acutance(kind, *images, "--along-track", "x", "--roi", "2,3,30,20", "--limit", limit)
    assert (done.exit_code, done.stderr) == (4, "acutance: enough seen\n")
    ((axis, region, limits),) = seen
    assert (axis, limits) == ("x", {LIMITED[kind]: 0.5})
    assert region.box((60, 44)).as_tuple() == (2, 3, 30, 20)


LIMITED = {
    "pulse": "background_step",
    "points": "phase_gap_px",
    "biresolution": "coherence",
    "bars": "finest_cpp",
    "star": "level",
}


@pytest.mark.parametrize("command", ["edge", "pulse", "bars", "star", "points"])
def test_every_measuring_command_knows_nodata(acutance, tmp_path, command):
    path = tmp_path / "empty.npy"
    np.save(path, np.full((60, 60), 7.0))
    result = acutance(command, path, "--nodata", 7)
    assert result.exit_code == 4
    assert "hold data" in result.stderr, result.stderr


def test_both_images_of_a_pair_have_a_nodata(acutance, tmp_path, monkeypatch):
    np.save(tmp_path / "low.npy", np.eye(60))
    np.save(tmp_path / "high.npy", np.eye(120))
    seen = []

    def measure(low, high, **_):
        seen.extend(int(np.isnan(one.read()).sum()) for one in (low, high))
        raise OptionError("enough seen")

    monkeypatch.setattr("acutance.targets.pair.measure_biresolution", measure)
    pair = (tmp_path / "low.npy", tmp_path / "high.npy")
    acutance("biresolution", *pair, "--nodata", 1, "--high-nodata", 0)
    acutance("biresolution", *pair)
    assert seen == [60, 120 * 119, 0, 0]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("edge", ""), "the name of the image is empty: give the path of a file"),
        (("edge", " "), "the name of the image is empty"),
        (("edge", "IMAGE", "--gsd", "-1"), "for example 0.7 (gsd_m, --gsd)"),
        (("bars", "IMAGE", "--count", 1), "--count is 1, a group has 2 bars or more"),
        (("bars", "IMAGE", "--group", "1,2,3,4,1,6"), "1,2,3,4,1,6: COUNT is 1, a group has 2"),
        (("plan", "edge", "--angle", 0), "angles_deg (--angle)"),
        (("plan", "pulse", "--width-px", 0), "widths_px (--width-px, --width-m)"),
        (("plan", "mirrors", "--sensor", "gaussian"), "(gsd_m, --gsd)"),
    ],
)
def test_messages_name_the_option(acutance, edge_image, words, message):
    result = acutance(*(edge_image if word == "IMAGE" else word for word in words))
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())


def test_a_single_bar_is_sent_to_the_command_for_it(acutance, edge_image):
    result = acutance("bars", edge_image, "--count", 1)
    assert "which acutance pulse measures" in result.stderr
    assert "measure_pulse" not in result.stderr
