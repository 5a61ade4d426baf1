"""The site of the demonstration, sharpened by a kernel made from all methods combined."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from acutance.cli.terminal import say

if TYPE_CHECKING:
    from acutance.cli.demo_targets import Campaign
    from acutance.curves.grid import Floats
    from acutance.report.html import Section
    from acutance.restoration import RestorationFilter, RestorationProof

__all__ = ["RESTORATION", "RESTORED_SITE", "RestoredSite", "restoration_section", "restore_site"]

RESTORATION, RESTORED_SITE = "restoration", "site-restored.tif"
NOISE_GAIN = 1.8


@dataclass(frozen=True, eq=False)
class RestoredSite:
    """The site before and after a filter.

    Parameters
    ----------
    filter : RestorationFilter
    proof : RestorationProof
        Its edges before and after.
    before, after : (rows, cols) array
        The star.
    """

    filter: RestorationFilter
    proof: RestorationProof
    before: Floats
    after: Floats


def restore_site(campaign: Campaign, path: Path, out: Path) -> RestoredSite:
    """Design a filter from the combined measurement, apply it to the site, and measure again."""
    from acutance.raster import Box, Region, open_image
    from acutance.restoration import design_restoration, restore, verify_restoration

    say("restoring the site")
    edges = campaign.scene.edges
    snr = min(one.reference.snr for one in campaign.targets[: len(edges)])
    filter = design_restoration(campaign.combined, snr=snr, noise_gain=NOISE_GAIN)
    restore(path, filter, out=out)
    before, after = open_image(path), open_image(out)
    regions = [Region(one.region) for one in edges]
    star = next(one for one in campaign.scene.targets if one.kind == "star")
    shown = Region(star.region).box(before.shape).intersection(Box.whole(before.shape))
    return RestoredSite(
        filter,
        verify_restoration(before, after, filter, regions),
        before.read(shown),
        after.read(shown),
    )


def restoration_section(restored: RestoredSite, page: str) -> Section:
    """What the index says of it; `page` is the file that has the sheet."""
    from acutance.report.figures.restoration import before_after_figure
    from acutance.report.html import Link, Plate, Section
    from acutance.report.tables.restoration import proof_table

    filter = restored.filter
    return Section(
        "Restored",
        paragraphs=(
            f"A kernel of {filter.size} by {filter.size} pixels, made from all methods combined, "
            f"sharpens the site at a noise gain of {filter.noise_gain:.2f}: SNR {filter.snr:.0f} "
            f"becomes {filter.snr_after:.0f}. Its edges were measured before and after.",
        ),
        plates=(
            Plate.of_figure(
                before_after_figure(restored.before, restored.after, ("as taken", "restored")),
                "The star before and after",
                "The same pixels in the same greys.",
                wide=True,
            ),
        ),
        tables=(proof_table(restored.proof),),
        links=(Link("The filter: what it does and what it costs", page),),
    )
