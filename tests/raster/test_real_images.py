"""The real images open with their bands, types and positions."""

from pathlib import Path

import numpy as np
import pytest

from acutance.raster import Box, open_image

FOLDER = Path(__file__).parents[3] / "shared" / "data"

pytestmark = [
    pytest.mark.real,
    pytest.mark.skipif(not FOLDER.is_dir(), reason=f"no folder of real images at {FOLDER}"),
]


@pytest.mark.parametrize(
    ("name", "shape", "band_count", "gsd_m"),
    [
        ("03_sfrmat5_chart_edge1_mono.tif", (124, 343), 1, None),
        ("07_spacenet6_wv2_pan_rotterdam.tif", (360, 600), 1, 0.5),
        ("08_s2a_T33UUB_10m_B4B3B2B8.tif", (600, 600), 4, None),
        ("09_s2_maricopa_10m.tif", (500, 500), 1, 10.0),
        ("10_l8_oli_pan15m_robinson.tif", (500, 774), 1, 15.0),
        ("12_l8_oli_b5_30m_matogrosso.tif", (200, 200), 1, 30.0),
        ("13_ucmerced_runway04.tif", (256, 256), 3, None),
        ("15_tetra3_stars.tif", (560, 560), 1, None),
    ],
)
def test_real_image(name, shape, band_count, gsd_m):
    image = open_image(FOLDER / name, band=band_count)
    assert (image.shape, image.band_count) == (shape, band_count)
    assert np.isfinite(image.read(Box(20, 20, 60, 60))).all()
    gsd = image.gsd()
    if gsd_m is None:
        assert gsd is None
    else:
        assert gsd.along_normal(40.0) == pytest.approx(gsd_m, rel=1e-4)
