"""A small simulated edge on disk, and what command lines are held to."""

import numpy as np
import pytest

from acutance import optics, simulate
from acutance.archive import Archive
from acutance.archive.published import published_entries
from acutance.raster import write_geotiff

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=0.7)


@pytest.fixture(scope="session")
def edge_image(tmp_path_factory):
    """60 x 44 pixels, an edge at 6 degrees, SNR 100, 0.7 m."""
    pixels, _ = simulate.edge(
        SENSOR, angle_deg=6.0, shape=(60, 44), snr=100, rng=np.random.default_rng(3)
    )
    path = tmp_path_factory.mktemp("images") / "edge.tif"
    write_geotiff(path, pixels.astype(np.float32), gsd_m=0.7)
    return str(path)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """An archive of the printed table of KOMPSAT-3."""
    path = tmp_path_factory.mktemp("archive") / "published.db"
    with Archive(path) as archive:
        archive.add_entries(published_entries("kompsat3-2014"))
    return str(path)


@pytest.fixture(scope="session")
def site_image(tmp_path_factory):
    """The calibration site: a checkerboard with four edges on grass."""
    scene = simulate.site(SENSOR, np.random.default_rng(3))
    path = tmp_path_factory.mktemp("images") / "site.tif"
    write_geotiff(path, scene.image.astype(np.float32), gsd_m=0.7)
    return str(path)


@pytest.fixture
def shown(monkeypatch):
    """What commands hand to `acutance.report` to be drawn: (name, result, how) each time.

    Drawing takes longer than measuring. The tests of the report draw every kind of result, and
    the demonstration writes a page of each.
    """
    calls = []

    def keep(name, answer):
        def function(result, **how):
            calls.append((name, result, how))
            return answer

        monkeypatch.setattr(f"acutance.report.{name}", function)

    keep("draw", None)
    keep("page", "<!DOCTYPE html>")
    monkeypatch.setattr("acutance.report.figure_bytes", lambda figure, ending: ending.encode())
    return calls


@pytest.fixture
def refused(acutance):
    """A command line ends with one message on stderr, and an exit code."""

    def check(words, message, code=2):
        result = acutance(*words)
        assert result.exit_code == code, result.output
        assert result.stdout == ""
        assert message in " ".join(result.stderr.split())
        assert "Traceback" not in result.stderr

    return check


@pytest.fixture(scope="session")
def keeps_to_schema(schema_validator):
    """A measurement's document keeps to the schema; what does not is named in a line each."""

    def check(document):
        assert not [
            f"{e.json_path}: {e.message:.200}" for e in schema_validator.iter_errors(document)
        ]

    return check
