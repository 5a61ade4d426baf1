"""The sensor of every band of a folder of real images, from all their natural edges.

The folder and its files are described in its README; images are no part of this project. Beside
the numbers stand which share of the edges that can be measured is good or usable (the check
trusted_share), how far they are from the form of the sensor (form_agrees: about 1 or less), and
what is in use for the sensor at Nyquist, where that is known. Of Sentinel-2 that is the
instrument's, as its specification is: products were interpolated by a spline, which in the mean
leaves .58 of it across and .50 along. Bands without edges enough are refused, with the reason: the
second table.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

from trials import command, publish, table, work_through

import acutance as ac
from acutance.raster import open_bands

S2_10M, S2_20M = "08_s2a_T33UUB_10m_B4B3B2B8, ", "08_s2a_T33UUB_20m_B5B6B7B8AB11B12, "
IN_USE = {
    f"{S2_10M}1": ".24", f"{S2_10M}2": ".28", f"{S2_10M}3": ".26", f"{S2_10M}4": ".26",
    f"{S2_20M}4": ".33", "21_s2_B02": ".26", "21_s2_B03": ".28", "21_s2_B04": ".24",
    "21_s2_B08": ".26", "21_s2_B8A": ".33", "07_spacenet6_wv2_pan": ".11 to .14",
    "23_wv2_rotterdam_pan": ".11 to .14", "23_wv2_rotterdam_ms": ".27 to .35",
}  # fmt: skip
"""MTF at Nyquist of the sensor, by how the name of a band begins."""
IMAGES = (".tif", ".jp2", ".jpg")


@dataclass(frozen=True)
class Band:
    """One band of a file."""

    path: Path
    number: int

    @property
    def name(self) -> str:
        """The file without its ending, and the number of the band."""
        return f"{self.path.stem}, {self.number}"

    @property
    def in_use(self) -> str:
        """What is in use for the sensor."""
        found = (value for name, value in IN_USE.items() if self.name.startswith(name))
        return next(found, "")


def bands_of(folder: Path) -> list[Band]:
    """Every band of all images of a folder and of its folder of scenes."""
    files = sorted(folder.glob("[0-9]*")) + sorted((folder / "scenes").iterdir())
    return [
        Band(path, one.band)
        for path in files
        if path.suffix in IMAGES
        for one in open_bands(str(path))
    ]


def measured(band: Band) -> list[str] | str:
    """One row of the first table, or why there is none."""
    start = time.process_time()
    try:
        scene = ac.scan_scene(ac.open_image(band.path, band=band.number))
    except ac.AcutanceError as error:
        return str(error).partition(":")[0]
    across, along = scene.across, scene.along
    checks = {check.name: check.value for check in scene.checks}
    return [
        band.name,
        scene.verdict.word,
        f"{scene.edges.used.sum()} of {scene.edges.size}",
        f"{checks['trusted_share']:.2f}",
        *(f"{one.mtf_nyquist}" for one in (across, along)),
        *(f"{one.rer}" for one in (across, along)),
        *(f"{one.fwhm_px}" for one in (across, along)),
        f"{scene.objects['ideal']}",
        f"{checks['form_agrees']:.2f}",
        band.in_use,
        f"{time.process_time() - start:.0f}",
    ]


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=1)
    parser.add_argument("folder", type=Path, help="of the images")
    arguments = parser.parse_args()
    bands = bands_of(arguments.folder)
    found = work_through(measured, bands, arguments.processes, "bands")
    head = [
        "file, band", "verdict", "edges used", "trusted_share", "Nyquist across", "along",
        "RER across", "along", "FWHM across / px", "along / px", "ideal objects", "form_agrees",
        "in use at Nyquist", "processor time / s",
    ]  # fmt: skip
    scanned = [one for one in found if not isinstance(one, str)]
    refused = [
        [band.name, one] for band, one in zip(bands, found, strict=True) if isinstance(one, str)
    ]
    how = argparse.Namespace(processes=arguments.processes, out=arguments.out)
    text = __doc__.partition("\n\n")[2].strip()
    parts = [text, table(head, scanned, texts=2), "## Refused"]
    publish("Real scenes", [*parts, table(["file, band", "why"], refused, texts=2)], how)


if __name__ == "__main__":
    main()
