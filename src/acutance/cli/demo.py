"""``acutance demo``: a whole campaign rendered, measured by every method, compared with truth."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.demo_folder import MARK, demo_folder, file_of
from acutance.cli.demo_targets import Campaign, PlaneTarget, StraightTarget, measure_campaign
from acutance.cli.output import OutputFile, check_output
from acutance.cli.terminal import say

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.report.campaign import CampaignEntry
    from acutance.report.campaign_panels import Drawing
    from acutance.report.html import Link, Section
    from acutance.simulate import Scene

__all__ = ["EXAMPLE", "demo"]

EXAMPLE = "\b\nExample:\n  acutance demo demo"
GSD_M = 0.7
SHOWN = {
    "bars": ("MTF along the bars' normal", "Bars, MTF along the normal"),
    "star": ("MTF against radius", "Star, MTF against radius"),
    "mirrors": ("PSF surface", "Mirrors, PSF"),
}
CAUSES = {
    "sdsu-2005": "the sliding window and the difference of neighbours lower the MTF by 2 to 4 %",
    "kompsat-2014": "the smoothing spline and the difference of neighbours lower the MTF",
    "iso12233": "bins of a quarter of a pixel lower the MTF by 2.5 % at Nyquist",
    "fermi": "a sum of Fermi functions is not the shape of this sensor's edge",
    "gaussian-2003": "a Gaussian stands for a blur seen through a pixel, which raises the MTF at "
    "Nyquist by 5 to 8 %, and its interval knows nothing of the grass under the mirrors",
}
"""Why a published method is off."""

EXPLAINED_STDS = 2.0


def demo(
    folder: Annotated[
        str, typer.Argument(metavar="DIR", help="Where to write; made if it does not exist.")
    ],
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")] = 1,
) -> None:
    """Measure a simulated campaign by every method, and compare with the truth.

    Edge tarps, a pulse tarp, 20 mirrors, bars and a Siemens star on grass, in one GeoTIFF with
    its truth as JSON beside it. An HTML report sets every method beside the truth and beside the
    others, and combines them into one 2-D OTF.
    """
    place = demo_folder(folder)

    import numpy as np

    from acutance import simulate
    from acutance.raster import open_image, write_geotiff
    from acutance.report import json_text, scene_document
    from acutance.report.html import render_report

    scene = simulate.brookings(_demonstration_sensor(GSD_M), np.random.default_rng(seed))
    say(f"rendering: {scene.description}")
    _output(place, MARK).write(json_text(scene_document(scene)))
    path = place / "site.tif"
    write_geotiff(path, scene.image.astype(np.float32), gsd_m=GSD_M)
    campaign = measure_campaign(scene, open_image(path))
    say("writing the report")
    entries = campaign.entries()
    links = _write_pages(place, campaign)
    _write_documents(place, campaign, entries)
    index = _output(place, "index.html")
    index.write(
        render_report(
            "One site, every method, and the truth",
            str(path),
            _sections(campaign, entries, links),
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


def _write_documents(place: Path, campaign: Campaign, entries: Sequence[CampaignEntry]) -> None:
    """The comparison, and every reference measurement as JSON."""
    from acutance.report import json_text
    from acutance.report.campaign import campaign_rows

    contents = {
        "comparison.json": {
            "schema": "acutance/campaign/1",
            "rows": campaign_rows(entries),
            "agreement": campaign.combined.evidence()["agreement"],
        },
        "combined.json": campaign.combined.to_dict(),
    }
    targets: Sequence[StraightTarget | PlaneTarget] = (*campaign.straight, *campaign.plane)
    for target in targets:
        contents[f"{file_of(target.name)}.json"] = target.measurements[0].to_dict()
    for name, content in contents.items():
        _output(place, name).write(json_text(content))


def _output(place: Path, name: str) -> OutputFile:
    return check_output("DIR", str(place / name), (Path(name).suffix,))


def _write_pages(place: Path, campaign: Campaign) -> tuple[Link, ...]:
    """A page for each target, and one for the combination."""
    from acutance.report import combine_panels, combine_sections, comparison_report, plane_report
    from acutance.report.html import Link

    links = []
    for straight in campaign.straight:
        page = comparison_report(
            straight.measurements, truth=straight.truth, true_width_px=straight.true_width_px
        )
        links.append(Link(f"The {straight.name} by every method", _write(place, straight, page)))
    together = PlaneTarget("combined", [campaign.combined], combine_panels, combine_sections)
    for plane in (*campaign.plane, together):
        page = plane_report(
            plane.measurements[0],
            extra_panels=plane.panels(plane.measurements[0]),
            extra_sections=plane.sections(plane.measurements[0]),
        )
        words = "All methods combined" if plane is together else f"The {plane.name}"
        links.append(Link(f"{words}: curves, evidence and checks", _write(place, plane, page)))
    return tuple(links)


def _write(place: Path, target: StraightTarget | PlaneTarget, page: str) -> str:
    name = f"{file_of(target.name)}.html"
    _output(place, name).write(page)
    return name


def _sections(
    campaign: Campaign, entries: Sequence[CampaignEntry], links: tuple[Link, ...]
) -> tuple[Section, ...]:
    from acutance.report.campaign import campaign_table, difference_table
    from acutance.report.campaign_panels import campaign_figure, curves_figure, site_figure
    from acutance.report.html import Headline, Plate, Section, Verdict
    from acutance.report.wording import word_estimate

    combined, scene = campaign.combined, campaign.scene
    found = combined.chi_square
    cards = []
    for one in entries:
        if one.target == "all combined":
            for name, label in (("mtf_nyquist", "MTF at Nyquist"), ("fwhm_px", "FWHM [px]")):
                number, true = one.numbers(name)
                words = word_estimate(number)
                cards.append(
                    Headline(
                        f"{label}, {one.orientation}",
                        words.value,
                        details=(f"± {words.std}", f"truth {true:.4f}"),
                    )
                )
    agree = (
        f"The methods agree: chi-square {found.value:.0f}, {found.expected:.0f} expected; the "
        f"chance of a larger one is {100 * found.p_value:.0f} %."
        if found.p_value >= 0.01
        else f"The methods disagree: chi-square {found.value:.0f}, {found.expected:.0f} expected; "
        f"all deviations were widened by {combined.birge_ratio:.2f}."
    )
    references = [one for one in entries if one.reference]
    return (
        Section(
            "All methods together",
            headlines=tuple(cards),
            verdicts=(Verdict(found.p_value >= 0.01, agree),),
        ),
        Section(
            "The site",
            paragraphs=_about(scene),
            plates=(
                Plate.of_figure(
                    site_figure(scene, _evidence(campaign)),
                    "The site",
                    "The whole image with its regions, and what each target shows. Tarps and "
                    "bars lie 6 degrees off the grid, so that their samples fall at many "
                    "sub-pixel phases; so do the mirrors.",
                    wide=True,
                ),
            ),
        ),
        Section(
            "Against the truth",
            paragraphs=(
                "Blue: the reference method of each target, with all of its uncertainty. Grey: "
                "published methods; an arrow lies outside the drawing. Black: all reference "
                "methods combined.",
                *_explanations(entries),
            ),
            plates=(
                Plate.of_figure(
                    campaign_figure(entries),
                    "Every method less the truth",
                    "Measured less true, with 95 % intervals.",
                    wide=True,
                ),
                Plate.of_figure(
                    curves_figure(entries),
                    "MTF by every reference method",
                    "With 95 % bands, and the true MTF (dashed).",
                    wide=True,
                ),
            ),
            tables=(campaign_table(entries),),
        ),
        *(
            Section(
                f"Against each other, {orientation}",
                paragraphs=(
                    "MTF at Nyquist of the row less that of the column, each less the truth of "
                    "its own direction, in standard deviations. The combination is made of the "
                    "others, so it lies nearer to them than independent results would.",
                ),
                tables=(
                    difference_table([one for one in references if one.orientation == orientation]),
                ),
            )
            for orientation in ("across", "along")
        ),
        Section("Read on", links=links),
    )


def _explanations(entries: Sequence[CampaignEntry]) -> tuple[str, ...]:
    """Why published methods are further from the truth than two standard deviations."""
    off = dict.fromkeys(
        one.method
        for one in entries
        if not one.reference and abs(one.deviation("mtf_nyquist")) > EXPLAINED_STDS
    )
    return tuple(f"{name} is off because {CAUSES[name]}." for name in off if name in CAUSES)


def _about(scene: Scene) -> tuple[str, ...]:
    blocks = ", ".join(type(block).__name__ for block in scene.sensor.blocks)
    height, width = scene.image.shape
    return (
        f"{scene.description}: {height} by {width} pixels of {GSD_M:g} m, as seen by a sensor "
        f"made of {blocks}.",
        "Because the image is simulated, the true curves are known (truth.json). Grass is no "
        "uniform ground: what lies beside a target is structure and not noise, so mirrors, star "
        "and bars have wider intervals here than on a laboratory's target, and their checks say "
        "that the noise is correlated. Intervals count the power of grass at its coarsest for all "
        "frequencies, and those of a star without stated levels allow for scattered light, of "
        "which this sensor has none: the targets agree better than their deviations promise.",
    )


def _evidence(campaign: Campaign) -> list[Drawing]:
    """A drawing of each target and one of all together."""
    from acutance.report import combine_panels
    from acutance.report.campaign_panels import draw_small_edge, draw_small_pulse, draw_titled

    edge, pulse = (
        campaign.straight[number].measurements[0] for number in (0, len(campaign.straight) - 1)
    )
    found: list[Drawing] = [partial(draw_small_edge, edge), partial(draw_small_pulse, pulse)]
    for target in campaign.plane:
        wanted, title = SHOWN[target.name]
        panels = target.panels(target.measurements[0])
        found += [partial(draw_titled, panel, title) for panel in panels if panel.title == wanted]
    directions = combine_panels(campaign.combined)[0]
    return [*found, partial(draw_titled, directions, "All combined, MTF by direction")]
