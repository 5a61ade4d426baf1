"""Peak memory of measuring a region of 60 x 60 px in a file of 30,000 x 30,000.

A sparse GeoTIFF with one edge in it is written to a temporary folder; a fresh process imports the
package, opens the file and measures; its largest resident set is reported next to that of an
`import acutance` with an array of the region's size.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from trials import command, publish, table

import acutance as ac

SIDE_PX = 30_000
CORNER = (14_970, 15_010)
REGION_PX = 60

# A fresh process's ru_maxrss begins with that of the process that started it; VmHWM does not.
_REPORT = """
from pathlib import Path
status = Path("/proc/self/status")
if status.exists():
    (line,) = [one for one in status.read_text().splitlines() if one.startswith("VmHWM")]
    print(line.split()[1])
else:
    import resource
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""
_MEASURE = """
import sys
import acutance as ac
path, row, col, side = sys.argv[1], *map(int, sys.argv[2:])
found = ac.measure_edge(ac.open_image(path), (row, col, side, side))
assert all(number.std > 0 for number in (found.mtf_nyquist, found.rer, found.fwhm_px))
"""
_IMPORT = """
import numpy as np
import acutance as ac
ac.measure_edge, np.zeros((60, 60))
"""


def write_scene(path: Path, seed: int, tiled: bool) -> None:
    """A file that holds data in one place only."""
    import rasterio
    from rasterio.windows import Window

    sensor = ac.simulate.reference_systems()["gaussian"]
    rng = np.random.default_rng(seed)
    image, _ = ac.simulate.edge(
        sensor, angle_deg=6.0, shape=(REGION_PX, REGION_PX), snr=100, rng=rng
    )
    layout = {"tiled": True, "blockxsize": 256, "blockysize": 256} if tiled else {}
    with rasterio.open(
        path, "w", driver="GTiff", width=SIDE_PX, height=SIDE_PX, count=1, dtype="uint16",
        sparse_ok=True, transform=rasterio.Affine(0.7, 0, 5e5, 0, -0.7, 4.8e6), crs="EPSG:32631",
        **layout,
    ) as file:  # fmt: skip
        window = Window(CORNER[1], CORNER[0], REGION_PX, REGION_PX)
        file.write(np.round(image).astype(np.uint16), 1, window=window)


def peak_mb(program: str, *arguments: str) -> float:
    """Largest resident set of a fresh process in MB."""
    command_line = [sys.executable, "-c", program + _REPORT, *arguments]
    answer = subprocess.run(command_line, check=True, capture_output=True, text=True)
    # Linux counts kibibytes, macOS bytes.
    unit = 1 if sys.platform == "darwin" else 1024
    return int(answer.stdout) * unit / 1e6


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=3).parse_args()
    rows = []
    place = [str(number) for number in (*CORNER, REGION_PX)]
    with tempfile.TemporaryDirectory() as folder:
        for name, tiled in (("tiles of 256 x 256", True), ("strips of whole rows", False)):
            path = Path(folder) / "scene.tif"
            write_scene(path, arguments.seed, tiled)
            peaks = [peak_mb(_MEASURE, str(path), *place) for _ in range(arguments.draws)]
            rows.append([f"measure, {name}", f"{max(peaks):.0f}"])
            print(f"{name}: done", file=sys.stderr)
    imported = [peak_mb(_IMPORT) for _ in range(arguments.draws)]
    rows.append(["import only", f"{max(imported):.0f}"])
    size = SIDE_PX**2 * 2 / 1e6
    parts = [
        f"Region of {REGION_PX} x {REGION_PX} px in a GeoTIFF of {SIDE_PX} x {SIDE_PX} px uint16 "
        f"({size:.0f} MB of pixels); the largest of {arguments.draws} fresh processes each.",
        table(["what", "peak resident memory / MB"], rows),
    ]
    publish("Memory of one region in a large file", parts, arguments)


if __name__ == "__main__":
    main()
