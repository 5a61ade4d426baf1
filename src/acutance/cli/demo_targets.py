"""The targets of the demonstration, measured by every method that can."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from acutance.cli.terminal import say
from acutance.errors import AcutanceError
from acutance.targets.kinds import KINDS

if TYPE_CHECKING:
    from acutance.curves import Response
    from acutance.geometry.line import Orientation
    from acutance.raster import Image
    from acutance.report import Comparison
    from acutance.report.tables.campaign import CampaignEntry
    from acutance.simulate import Scene
    from acutance.targets import Measurement
    from acutance.targets.combine import CombinedMeasurement

__all__ = ["COMBINED", "Campaign", "CampaignTarget", "measure_campaign"]

COMBINED = "all combined"
DIRECTIONS: tuple[Orientation, Orientation] = ("across", "along")


@dataclass(frozen=True, eq=False)
class CampaignTarget:
    """A target, and what was measured of it.

    Parameters
    ----------
    name : str
        What it is called: "vertical edge".
    comparison : Comparison
        One measurement a method, the reference first, and the truth.
    """

    name: str
    comparison: Comparison

    @property
    def reference(self) -> Measurement:
        """The measurement by the reference method."""
        return self.comparison.measurements[0]

    def entries(self, direction: Orientation) -> Iterator[CampaignEntry]:
        """Every method with the truth, in a direction that the target shows."""
        from acutance.report.tables.campaign import CampaignEntry

        for one in self.comparison.measurements:
            if direction in one.measured_directions:
                yield CampaignEntry(
                    self.name, one.method, direction, one.directions[direction],
                    self.comparison.truth[direction], one is self.reference,
                )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Campaign:
    """Everything that was measured on the site.

    Parameters
    ----------
    scene : Scene
    targets : tuple of CampaignTarget
    combined : CombinedMeasurement
        Of the reference method of every target.
    """

    scene: Scene
    targets: tuple[CampaignTarget, ...]
    combined: CombinedMeasurement

    def entries(self) -> list[CampaignEntry]:
        """Every method and direction with the truth, across first, the combination last."""
        from acutance import report

        truth = _truth_in_both(self.scene)
        together = CampaignTarget(COMBINED, report.compare([self.combined], truth=truth))
        return [
            entry
            for direction in DIRECTIONS
            for target in (*self.targets, together)
            for entry in target.entries(direction)
        ]


def measure_campaign(scene: Scene, image: Image) -> Campaign:
    """Measure every target of a site by every method, and combine the reference ones."""
    from acutance.targets.combine import combine

    targets = (*_edges(scene, image), *_other_targets(scene, image))
    say("combining")
    combined = combine([one.reference for one in targets], names=[one.name for one in targets])
    return Campaign(scene, targets, combined)


def _truth_in_both(scene: Scene) -> dict[str, Response]:
    return {name: scene.sensor.response(0.0, name) for name in DIRECTIONS}


def _edges(scene: Scene, image: Image) -> Iterator[CampaignTarget]:
    from acutance import report
    from acutance.raster import Region

    for edge in scene.edges:
        found = _by_all_methods(f"{edge.name} edge", "edge", image, Region(edge.region))
        compared = report.compare(found, truth=edge.truth.response)
        yield CampaignTarget(f"{edge.name} edge", compared)


def _other_targets(scene: Scene, image: Image) -> Iterator[CampaignTarget]:
    """Pulse, mirrors, bars and star, in the order of the scene."""
    from acutance import report
    from acutance.raster import Region
    from acutance.simulate import PointsTruth, PulseTruth

    for target in scene.targets:
        truth = target.truth
        name = "pulse tarp" if target.kind == "pulse" else target.name
        measure = partial(_by_all_methods, name, target.kind, image, Region(target.region))
        if isinstance(truth, PulseTruth):
            found = measure(width_px=truth.width_px)
            compared = report.compare(found, truth=truth.response, true_width_px=truth.width_px)
        elif isinstance(truth, PointsTruth):
            found = measure(positions=truth.positions, surveyed=truth.positions)
            compared = report.compare(found, truth=_truth_in_both(scene))
        else:
            compared = report.compare(measure(), truth=_truth_in_both(scene))
        yield CampaignTarget(name, compared)


def _by_all_methods(
    name: str, kind: str, image: Image, region: Any, **arguments: Any
) -> list[Measurement]:
    """By every method of the kind that can measure the target; the others are named on stderr.

    Raises
    ------
    AcutanceError
        If the first of the methods, the reference, cannot.
    """
    known = KINDS[kind]
    measure = known.load(known.measure)
    say(f"measuring the {name}{' by every method' if len(known.methods) > 1 else ''}")
    found: list[Measurement] = []
    for method in known.methods:
        try:
            found.append(measure(image, region, method=method, **arguments))
        except AcutanceError as error:
            if not found:
                raise
            say(f"  {method}: {error}")
    return found
