"""The landscape of the demonstration: no target in it, every edge scanned."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from acutance.cli.terminal import say

if TYPE_CHECKING:
    from acutance.curves.grid import Floats
    from acutance.optics import Sensor
    from acutance.report.html import Headline, Section
    from acutance.scan import SceneMeasurement
    from acutance.simulate import LandscapeTruth

__all__ = ["LANDSCAPE", "ScannedLandscape", "landscape_section", "scan_landscape"]

LANDSCAPE = "landscape"
SIZE_PX, SNR = 900, 100.0


@dataclass(frozen=True, eq=False)
class ScannedLandscape:
    """A landscape, its truth, and what a scan of it finds.

    Parameters
    ----------
    sensor : Sensor
    pixels : (rows, cols) array
    truth : LandscapeTruth
    measurement : SceneMeasurement
    """

    sensor: Sensor
    pixels: Floats
    truth: LandscapeTruth
    measurement: SceneMeasurement

    @property
    def document(self) -> dict[str, Any]:
        """Its true edges, as GeoJSON in pixels."""
        from acutance.report import landscape_document

        return landscape_document(self.truth)


def scan_landscape(sensor: Sensor, path: Path, seed: int) -> ScannedLandscape:
    """Draw a landscape, write it to `path`, and scan the file."""
    import numpy as np

    from acutance import simulate
    from acutance.raster import open_image, write_geotiff
    from acutance.scan import scan_scene

    say(f"rendering a landscape of {SIZE_PX} by {SIZE_PX} pixels")
    pixels, truth = simulate.landscape(
        sensor, shape=(SIZE_PX, SIZE_PX), snr=SNR, rng=np.random.default_rng(seed)
    )
    write_geotiff(path, pixels, gsd_m=sensor.gsd_m)
    say("scanning the landscape")
    return ScannedLandscape(sensor, pixels, truth, scan_scene(open_image(path)))


def landscape_section(scanned: ScannedLandscape, page: str) -> Section:
    """What the index says of it; `page` is the file that has everything."""
    from acutance.report.figures.campaign import landscape_figure
    from acutance.report.html import Link, Plate, Section

    found = scanned.measurement
    used, ideal = int(found.edges.used.sum()), 100 * found.objects["ideal"].value
    return Section(
        "Without a target",
        paragraphs=(
            f"The same sensor over fields, roofs and roads: {found.edges.size} pieces of straight "
            f"edges were found, {used} can be used. Some borders are soft on the ground; the scan "
            f"estimates how many ({ideal:.0f} % are ideal) together with the sensor under all of "
            "them.",
        ),
        headlines=_headlines(scanned),
        plates=(
            Plate.of_figure(
                landscape_figure(found, scanned.pixels, scanned.sensor),
                "The landscape and its edges",
                "The image; its edges, coloured by how much each is sharper or softer than the "
                "sensor; the MTF at Nyquist of each along its normal, of the sensor under them "
                "with its 95 % band, and the truth (dashed).",
                wide=True,
            ),
        ),
        links=(Link("The landscape, scanned: numbers, curves, checks", page),),
    )


def _headlines(scanned: ScannedLandscape) -> tuple[Headline, ...]:
    """MTF at Nyquist and FWHM of both directions, with the truth."""
    from acutance.report.html import Headline
    from acutance.report.labels import word_estimate

    cards = []
    for direction, response in scanned.measurement.directions.items():
        true = scanned.sensor.response(0.0, direction).metrics()
        for name, label in (("mtf_nyquist", "MTF at Nyquist"), ("fwhm_px", "FWHM [px]")):
            words = word_estimate(response.metrics()[name])
            details = (f"± {words.std}", f"truth {true[name].value:.4f}")
            cards.append(Headline(f"{label}, {direction}", words.value, details=details))
    return tuple(cards)
