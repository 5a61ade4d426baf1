"""Exit codes: 0 measured, 2 bad usage or input, 3 a check failed, 4 nothing to be measured."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.cli.terminal import EXIT_CODES
from acutance.raster import write_geotiff

KINDS = ("edge", "pulse", "points", "bars", "star")


@pytest.fixture(scope="module")
def images(tmp_path_factory):
    """A field of noise, and one of which all but a corner is nodata."""
    folder = tmp_path_factory.mktemp("codes")
    noise = np.random.default_rng(5).normal(500.0, 5.0, (64, 64)).astype(np.float32)
    write_geotiff(folder / "noise.tif", noise)
    empty = noise.copy()
    empty[3:] = np.nan
    write_geotiff(folder / "empty.tif", empty)
    return folder


def test_measured_is_0(acutance, edge_image):
    assert acutance("edge", edge_image).exit_code == 0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "words",
    [
        ("nowhere.tif",),
        ("noise.tif", "--roi", "100,100,20,20"),
        ("noise.tif", "--roi", "50,50,20,20"),
        ("noise.tif", "--roi", "0,0,5,5"),
        ("noise.tif", "--roi", "no-such-file.geojson"),
        ("noise.tif", "--band", "2"),
        ("noise.tif", "--gsd", "much"),
        ("noise.tif", "--limit", "rows"),
        ("noise.tif", "--no-such-option"),
        (),
    ],
)
def test_bad_usage_and_bad_input_are_2(acutance, images, kind, words):
    name = (images / words[0],) if words else ()
    result = acutance(kind, *name, *words[1:])
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr


def test_a_failed_check_under_strict_is_3(acutance, edge_image):
    assert acutance("edge", edge_image, "--limit", "rows=1000", "--strict").exit_code == 3


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["noise.tif", "empty.tif"])
def test_nothing_to_be_measured_is_4(acutance, images, kind, name):
    """Neither noise nor a region without data holds a target; both are good input."""
    result = acutance(kind, images / name)
    assert (result.exit_code, result.stdout) == (4, "")
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize("kind", [*KINDS, "biresolution", "combine"])
def test_help_names_the_codes(acutance, kind):
    words = " ".join(acutance(kind, "--help").stdout.split())
    assert EXIT_CODES in words
