"""``acutance demo``: a whole campaign rendered, measured by every method, compared with truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.demo_folder import MARK, demo_folder, file_of
from acutance.cli.demo_index import Page, index_sections
from acutance.cli.demo_landscape import LANDSCAPE, ScannedLandscape, scan_landscape
from acutance.cli.demo_restoration import RESTORATION, RESTORED_SITE, RestoredSite, restore_site
from acutance.cli.demo_targets import Campaign, measure_campaign
from acutance.cli.demo_year import measure_year
from acutance.cli.output import OutputFile, check_output
from acutance.cli.terminal import say

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.report.tables.campaign import CampaignEntry

__all__ = ["EXAMPLE", "demo"]

EXAMPLE = "\b\nExample:\n  acutance demo demo"
GSD_M = 0.7


def demo(
    folder: Annotated[
        str, typer.Argument(metavar="DIR", help="Where to write; made if it does not exist.")
    ],
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")] = 1,
) -> None:
    """Measure a simulated campaign by every method, and compare with the truth.

    Edge tarps, a pulse tarp, 20 mirrors, bars and a Siemens star on grass, in one GeoTIFF with
    its truth as JSON. An HTML report compares every method with the truth and with the others, and
    combines them into one 2-D OTF. The site is sharpened by a filter made from that, and shown
    before and after. The same sensor over a landscape without targets is scanned. Another is
    watched for a year: a batch of images, an archive, the trend.
    """
    place = demo_folder(folder)

    import numpy as np

    from acutance import simulate
    from acutance.raster import open_image, write_geotiff
    from acutance.report import json_text, scene_document
    from acutance.report.html import render_page

    scene = simulate.brookings(_demonstration_sensor(GSD_M), np.random.default_rng(seed))
    say(f"rendering: {scene.description}")
    _output(place, MARK).write(json_text(scene_document(scene)))
    path = place / "site.tif"
    write_geotiff(path, scene.image.astype(np.float32), gsd_m=GSD_M)
    campaign = measure_campaign(scene, open_image(path))
    restored = restore_site(campaign, path, place / RESTORED_SITE)
    landscape = scan_landscape(scene.sensor, place / f"{LANDSCAPE}.tif", seed)
    year = measure_year(place, seed)
    say("writing the report")
    entries = campaign.entries()
    pages = [_write_page(place, page) for page in _pages(campaign, landscape)]
    _write_restoration(place, restored)
    _write_documents(place, campaign, entries, landscape)
    index = _output(place, "index.html")
    index.write(
        render_page(
            "One site, every method, and the truth",
            str(path),
            index_sections(campaign, entries, pages, landscape, year, restored),
        )
    )
    typer.echo(f"open {index.path}")


def _demonstration_sensor(gsd_m: float) -> Sensor:
    """Optics, pixel, motion and electronics of the published generic sensor."""
    from acutance import optics

    blocks: list[optics.Block] = [
        optics.Gaussian(0.39),
        optics.Detector(1.0),
        optics.Smear(0.25, "along"),
        optics.Butterworth(1.4),
    ]
    return optics.Sensor(blocks, gsd_m=gsd_m)


def _pages(campaign: Campaign, landscape: ScannedLandscape) -> Iterator[Page]:
    """A page for each target, by every method where there are several, for all, for the scan."""
    for target in campaign.targets:
        several = len(target.comparison.measurements) > 1
        words = f"The {target.name}{' by every method' if several else ''}"
        result = target.comparison if several else target.reference
        yield Page(target.name, words, result, target.reference)
    yield Page("combined", "All methods combined", campaign.combined, campaign.combined)
    scanned = landscape.measurement
    yield Page(LANDSCAPE, f"The {LANDSCAPE}, scanned", scanned, scanned)


def _write_page(place: Path, page: Page) -> Page:
    from acutance import report

    _output(place, page.file).write(report.page(page.result))
    return page


def _write_restoration(place: Path, restored: RestoredSite) -> None:
    """The filter as JSON and as a page."""
    from acutance.report import json_text, restoration_page

    _output(place, f"{RESTORATION}.json").write(json_text(restored.filter.to_dict()))
    _output(place, f"{RESTORATION}.html").write(restoration_page(restored.filter))


def _write_documents(
    place: Path, campaign: Campaign, entries: Sequence[CampaignEntry], landscape: ScannedLandscape
) -> None:
    """The comparison, and every reference measurement as JSON."""
    from acutance.report import json_text
    from acutance.report.tables.campaign import campaign_rows

    contents = {
        "comparison.json": {
            "schema": "acutance/campaign/1",
            "rows": campaign_rows(entries),
            "agreement": campaign.combined.target_document()["agreement"],
        },
        "combined.json": campaign.combined.to_dict(),
        f"{LANDSCAPE}.json": landscape.measurement.to_dict(),
        f"{LANDSCAPE}.truth.geojson": landscape.document,
        **{f"{file_of(one.name)}.json": one.reference.to_dict() for one in campaign.targets},
    }
    for name, content in contents.items():
        _output(place, name).write(json_text(content))


def _output(place: Path, name: str) -> OutputFile:
    return check_output("DIR", str(place / name), (Path(name).suffix,))
