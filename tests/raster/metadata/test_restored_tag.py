"""An image that acutance restored is recognised as one, by the tag that was written into it."""

from __future__ import annotations

import numpy as np
import pytest

import acutance as ac
from acutance import report
from acutance.raster import write_geotiff

TAG = "wiener kernel 11x11 sha256:0123456789abcdef; bands 2; noise gain 1.8; MTF at Nyquist 0.3"
OF_RESTORED = "the MTF is that of the restored product"


@pytest.fixture
def restored(tmp_path):
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()], gsd_m=0.7)
    pixels, _ = ac.simulate.edge(
        sensor, angle_deg=6.0, shape=(60, 44), snr=100, rng=np.random.default_rng(3)
    )
    path = tmp_path / "sharp.tif"
    write_geotiff(path, np.stack([pixels, pixels]), tags={"ACUTANCE_RESTORATION": TAG})
    return path


def test_the_statement_of_a_restored_image_says_so(restored):
    (note,) = ac.read_statement(restored).notes
    assert note == f"sharp.tif: tag ACUTANCE_RESTORATION, {TAG}: {OF_RESTORED}"


def test_a_measurement_of_a_restored_band_carries_what_was_applied(restored):
    plain, sharp = (ac.measure_edge(ac.open_image(restored, band)) for band in (1, 2))
    assert plain.record.image.restored is None
    assert "restored" not in report.text(plain)
    document = sharp.to_dict()
    assert document["image"]["restored"] == TAG
    assert ac.Record.from_dict(document).image.restored == TAG
    assert "restored by acutance" in report.text(sharp)
