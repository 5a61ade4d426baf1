"""A window of a large file costs its own pixels: small ones, and a column down all its rows."""

import subprocess
import sys

import numpy as np
import pytest

SIZE_PX = 30_000
LIMIT_MB = 250

SCRIPT = """
import sys
from pathlib import Path
from acutance.raster import Box, open_image
image = open_image(sys.argv[1])
rows, cols = image.shape
for start in range(0, rows - 60, 1_000):
    assert image.read(Box(start, start, 60, 60)).shape == (60, 60)
image.read(Box(0, 15_000, rows, 20))
status = dict(line.split(":") for line in Path("/proc/self/status").read_text().splitlines())
print(status["VmHWM"].split()[0])
"""


def peak_memory_mb(path):
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(path)], check=True, capture_output=True, text=True
    )
    return int(run.stdout) / 1024


@pytest.mark.skipif(sys.platform != "linux", reason="the peak is read from /proc")
@pytest.mark.parametrize(
    "layout",
    [
        {"tiled": True, "blockxsize": 512, "blockysize": 512},
        {"tiled": False},
        {"tiled": False, "blockysize": 64, "compress": "deflate"},
    ],
)
def test_geotiff(write_sparse, layout):
    assert peak_memory_mb(write_sparse(SIZE_PX, **layout)) < LIMIT_MB


@pytest.mark.skipif(sys.platform != "linux", reason="the peak is read from /proc")
def test_npy(tmp_path):
    path = tmp_path / "large.npy"
    array = np.lib.format.open_memmap(path, "w+", np.uint16, (SIZE_PX // 5, SIZE_PX))
    array.flush()
    assert peak_memory_mb(path) < LIMIT_MB


@pytest.fixture
def write_sparse(tmp_path):
    """A GeoTIFF of which no block is stored, so that it takes no room on the disk."""
    import rasterio

    def write(size_px, **layout):
        path = tmp_path / "large.tif"
        with rasterio.open(
            path,
            "w",
            driver="GTiff",
            count=1,
            height=size_px,
            width=size_px,
            dtype="uint16",
            sparse_ok=True,
            crs="EPSG:32631",
            transform=rasterio.Affine(0.5, 0, 600000, 0, -0.5, 5000000),
            **layout,
        ):
            pass
        return path

    return write
