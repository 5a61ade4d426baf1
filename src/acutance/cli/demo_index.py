"""The index page of the demonstration: every method, the truth, and what each page holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from acutance.cli.demo_folder import file_of
from acutance.cli.demo_landscape import LANDSCAPE, ScannedLandscape, landscape_section
from acutance.cli.demo_restoration import RESTORATION, RestoredSite, restoration_section
from acutance.cli.demo_targets import COMBINED, Campaign
from acutance.cli.demo_year import SimulatedYear, year_section

if TYPE_CHECKING:
    from acutance.report import Comparison
    from acutance.report.figures.campaign import Drawing
    from acutance.report.html import Headline, Section, Verdict
    from acutance.report.tables.campaign import CampaignEntry
    from acutance.simulate import Scene
    from acutance.targets import Measurement
    from acutance.targets.combine import CombinedMeasurement

__all__ = ["Page", "index_sections"]

SHOWN = {
    "bars": ("MTF along the bars' normal", "Bars, MTF along the normal"),
    "star": ("MTF against radius", "Star, MTF against radius"),
    "mirrors": ("PSF surface", "Mirrors, PSF"),
    "combined": ("Directions", "All combined, MTF by direction"),
}
"""Which drawing of a target the site shows, and its title there."""
CAUSES = {
    "sdsu-2005": "the sliding window and the difference of neighbours lower the MTF by 2 to 4 %",
    "kompsat-2014": "the smoothing spline and the difference of neighbours lower the MTF",
    "iso12233": "bins of a quarter of a pixel lower the MTF by 2.5 % at Nyquist",
    "fermi": "a sum of Fermi functions is not the shape of this sensor's edge",
    "gaussian-2003": "a Gaussian stands for a blur seen through a pixel, and its interval leaves "
    "out the grass under the mirrors",
}
"""Why a published method is off."""

EXPLAINED_STDS = 2.0
MIN_P_VALUE = 0.01


@dataclass(frozen=True, eq=False)
class Page:
    """A page of the demonstration: what it shows, and the words that lead to it.

    Parameters
    ----------
    name : str
        Of the target.
    words : str
        What the page holds.
    result : Measurement or Comparison
    measurement : Measurement
        The reference, whose verdict the index shows.
    """

    name: str
    words: str
    result: Measurement | Comparison
    measurement: Measurement

    @property
    def file(self) -> str:
        """Its file."""
        return f"{file_of(self.name)}.html"


def index_sections(
    campaign: Campaign,
    entries: Sequence[CampaignEntry],
    pages: Sequence[Page],
    landscape: ScannedLandscape,
    year: SimulatedYear,
    restored: RestoredSite,
) -> tuple[Section, ...]:
    """The sections of the index page.

    Parameters
    ----------
    campaign : Campaign
    entries : sequence of CampaignEntry
        Every method and direction.
    pages : sequence of Page
        Those the index leads to.
    landscape : ScannedLandscape
    year : SimulatedYear
    restored : RestoredSite
    """
    from acutance.report.html import Link, Section

    return (
        Section(
            "All methods together",
            headlines=_headlines(entries),
            verdicts=(_agreement(campaign.combined),),
        ),
        Section(
            "Verdicts",
            paragraphs=("What the checks of each reference measurement come to.",),
            verdicts=tuple(_verdict(page) for page in pages),
            links=tuple(Link(f"{one.words}: numbers, curves, checks", one.file) for one in pages),
        ),
        _site_section(campaign),
        *_truth_sections(entries),
        restoration_section(restored, f"{RESTORATION}.html"),
        landscape_section(landscape, f"{file_of(LANDSCAPE)}.html"),
        year_section(year),
    )


def _verdict(page: Page) -> Verdict:
    """The verdict of a page, with every check that failed."""
    from acutance.report.html import Verdict

    found = page.measurement.verdict
    details = tuple((check.name, check.message) for check in page.measurement.failed_checks)
    text = f"{page.words}: {found.word}" + ("" if details else f", {found.sentence}")
    return Verdict(found.word, f"{text}.", details)


def _headlines(entries: Sequence[CampaignEntry]) -> tuple[Headline, ...]:
    """The combined MTF and FWHM of both directions, with the truth."""
    from acutance.report.html import Headline
    from acutance.report.labels import word_estimate

    cards = []
    for one in (one for one in entries if one.target == COMBINED):
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
    return tuple(cards)


def _agreement(combined: CombinedMeasurement) -> Verdict:
    """Whether the methods agree: the chi-square of the combination."""
    from acutance.report.html import Verdict

    found = combined.chi_square
    numbers = f"chi-square {found.value:.0f}, {found.expected:.0f} expected"
    chance = f"the chance of a larger one is {100 * found.p_value:.0f} %"
    if found.p_value < MIN_P_VALUE:
        widened = f"all deviations were widened by {combined.birge_ratio:.2f}"
        return Verdict("doubtful", f"The methods disagree: {numbers}; {widened}.")
    if found.p_value > 1 - MIN_P_VALUE:
        return Verdict(
            "usable",
            f"The methods agree better than their deviations promise: {numbers}; {chance}. Some "
            "deviations are too wide: below, The site has the reasons.",
        )
    return Verdict("good", f"The methods agree: {numbers}; {chance}.")


def _site_section(campaign: Campaign) -> Section:
    from acutance.report.figures.campaign import site_figure
    from acutance.report.html import Plate, Section

    return Section(
        "The site",
        paragraphs=_about(campaign.scene),
        plates=(
            Plate.of_figure(
                site_figure(campaign.scene, _drawings(campaign)),
                "The site",
                "The whole image with its regions, and what each target shows. Tarps and "
                "bars lie 6 degrees off the grid, so that their samples fall at many "
                "sub-pixel phases; so do the mirrors.",
                wide=True,
            ),
        ),
    )


def _truth_sections(entries: Sequence[CampaignEntry]) -> Iterator[Section]:
    """Every method against the truth, and the reference methods against each other."""
    from acutance.report.figures.campaign import campaign_figure, curves_figure
    from acutance.report.html import Plate, Section
    from acutance.report.tables.campaign import campaign_table, difference_table

    yield Section(
        "Against the truth",
        paragraphs=(
            "Blue: the reference method of each target, with all of its uncertainty. Grey: "
            "published methods; an arrow where they or their intervals lie outside the drawing. "
            "Black: all reference methods combined.",
            *_explanations(entries),
        ),
        plates=(
            Plate.of_figure(
                campaign_figure(entries),
                "Every method minus the truth",
                "Measured minus true, with 95 % intervals.",
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
    )
    for direction in ("across", "along"):
        own = [one for one in entries if one.reference and one.orientation == direction]
        yield Section(
            f"Against each other, {direction}",
            paragraphs=(
                "MTF at Nyquist of the row minus that of the column, each minus the truth of "
                "its own direction, in standard deviations. The combination is made of the "
                "others, so it lies nearer to them than independent results would.",
            ),
            tables=(difference_table(own),),
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
        f"{scene.description}: {height} by {width} pixels of {scene.sensor.gsd_m:g} m, as seen by "
        f"a sensor made of {blocks}.",
        "Because the image is simulated, the true curves are known (truth.json). Grass is no "
        "uniform background: what surrounds a target is structure and not noise, so mirrors, star "
        "and bars have wider intervals here than on a laboratory's target, and their checks say "
        "that the noise is correlated. Their intervals count the power of grass at its coarsest "
        "for all frequencies, and those of a star without stated levels allow for scattered "
        "light, of which this sensor has none: the targets agree better than their deviations "
        "promise.",
    )


def _drawings(campaign: Campaign) -> list[Drawing]:
    """A drawing of each target and one of all together."""
    from acutance import report
    from acutance.report.figures.campaign import draw_small_edge, draw_small_pulse, draw_titled

    measured: dict[str, Any] = {one.name: one.reference for one in campaign.targets}
    found: list[Drawing] = [
        partial(draw_small_edge, measured["vertical edge"]),
        partial(draw_small_pulse, measured["pulse tarp"]),
    ]
    for name, (wanted, title) in SHOWN.items():
        result = campaign.combined if name == "combined" else measured[name]
        panel = next(one for one in report.panels(result) if one.title == wanted)
        found.append(partial(draw_titled, panel, title))
    return found
