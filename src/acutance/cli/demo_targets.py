"""The targets of the demonstration, measured by every method that can."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from acutance.cli.terminal import say
from acutance.errors import AcutanceError

if TYPE_CHECKING:
    from acutance.curves import Response
    from acutance.curves.grid import Floats
    from acutance.raster import Image, Region
    from acutance.report.campaign import CampaignEntry
    from acutance.report.html import Section
    from acutance.report.plane_panels import PlanePanel
    from acutance.simulate import Scene
    from acutance.targets import Measurement, Measurement2d
    from acutance.targets.combine import CombinedMeasurement

__all__ = ["Campaign", "PlaneTarget", "StraightTarget", "measure_campaign"]

ResultT = TypeVar("ResultT")
ORIENTATIONS: tuple[Literal["across"], Literal["along"]] = ("across", "along")


@dataclass(frozen=True, eq=False)
class StraightTarget:
    """An edge or a pulse, and what was measured of it.

    Parameters
    ----------
    name : str
        What it is called: "vertical edge".
    truth : Response
        Along its normal.
    measurements : sequence of Measurement
        One a method, the reference first.
    true_width_px : float, optional
        Of a pulse.
    """

    name: str
    truth: Response
    measurements: Sequence[Measurement]
    true_width_px: float | None = None


@dataclass(frozen=True, eq=False)
class PlaneTarget:
    """Mirrors, bars or a star, and what was measured of them.

    Parameters
    ----------
    name : str
    measurements : sequence of Measurement2d
        One a method, the reference first.
    panels, sections : functions of a measurement
        What the method adds to the page of a 2-D measurement.
    orientations : tuple of str
        The directions it was measured in.
    """

    name: str
    measurements: Sequence[Measurement2d]
    panels: Callable[[Any], Sequence[PlanePanel]]
    sections: Callable[[Any], Sequence[Section]]
    orientations: tuple[Literal["across", "along"], ...] = ORIENTATIONS


@dataclass(frozen=True, eq=False)
class Campaign:
    """Everything that was measured on the site.

    Parameters
    ----------
    scene : Scene
    straight : tuple of StraightTarget
    plane : tuple of PlaneTarget
    combined : CombinedMeasurement
        Of the reference method of every target.
    """

    scene: Scene
    straight: tuple[StraightTarget, ...]
    plane: tuple[PlaneTarget, ...]
    combined: CombinedMeasurement

    def entries(self) -> list[CampaignEntry]:
        """Every method and direction beside the truth, across first, the combination last."""
        found = []
        for orientation in ORIENTATIONS:
            for straight in self.straight:
                found += _straight_entries(straight, orientation)
            for plane in self.plane:
                if orientation in plane.orientations:
                    found += self._plane_entries(plane, orientation)
            everything = PlaneTarget("all combined", [self.combined], _nothing, _nothing)
            found += self._plane_entries(everything, orientation)
        return found

    def _plane_entries(
        self, target: PlaneTarget, orientation: Literal["across", "along"]
    ) -> list[CampaignEntry]:
        from acutance.report.campaign import CampaignEntry

        truth = self.scene.sensor.response(0.0, orientation)
        return [
            CampaignEntry(
                target.name, one.method, orientation, getattr(one, orientation), truth, i == 0
            )
            for i, one in enumerate(target.measurements)
        ]


def _nothing(_: Any) -> tuple[()]:
    return ()


def _straight_entries(target: StraightTarget, orientation: str) -> list[CampaignEntry]:
    from acutance.report.campaign import CampaignEntry

    return [
        CampaignEntry(target.name, one.method, one.orientation, one.response, target.truth, i == 0)
        for i, one in enumerate(target.measurements)
        if one.orientation == orientation
    ]


def measure_campaign(scene: Scene, image: Image) -> Campaign:
    """Measure every target of a site by every method, and combine the reference ones."""
    from acutance.targets.combine import combine

    straight = (*_edges(scene, image), *_pulses(scene, image))
    plane = _plane_targets(scene, image)
    targets: Sequence[StraightTarget | PlaneTarget] = (*straight, *plane)
    say("combining")
    combined = combine(
        [one.measurements[0] for one in targets], names=[one.name for one in targets]
    )
    return Campaign(scene, straight, plane, combined)


def _edges(scene: Scene, image: Image) -> list[StraightTarget]:
    from acutance.raster import Region
    from acutance.targets.straight import METHODS

    found = []
    for edge in scene.edges:
        say(f"measuring the {edge.name} edge by every method")
        measurements = _by_all(METHODS, partial(_edge, image, Region(edge.region)))
        found.append(StraightTarget(f"{edge.name} edge", edge.truth.response, measurements))
    return found


def _edge(image: Image, region: Region, method: str) -> Measurement:
    from acutance.targets.straight import measure_edge

    return measure_edge(image, region, method=method)


def _pulses(scene: Scene, image: Image) -> list[StraightTarget]:
    from acutance.raster import Region
    from acutance.simulate import PulseTruth
    from acutance.targets.straight import PULSE_METHODS

    found = []
    for target in scene.targets:
        truth = target.truth
        if isinstance(truth, PulseTruth):
            say("measuring the pulse tarp by every method")
            measurements = _by_all(
                PULSE_METHODS, partial(_pulse, image, Region(target.region), truth.width_px)
            )
            found.append(StraightTarget("pulse tarp", truth.response, measurements, truth.width_px))
    return found


def _pulse(image: Image, region: Region, width_px: float, method: str) -> Measurement:
    from acutance.targets.straight import measure_pulse

    return measure_pulse(image, region, width_px=width_px, method=method)


def _plane_targets(scene: Scene, image: Image) -> tuple[PlaneTarget, ...]:
    from acutance import report
    from acutance.raster import Region
    from acutance.simulate import PointsTruth
    from acutance.targets.periodic import measure_bars, measure_star
    from acutance.targets.points import POINTS_METHODS

    found = []
    for target in scene.targets:
        region, truth = Region(target.region), target.truth
        if target.kind != "pulse":
            say(f"measuring the {target.name}")
        if isinstance(truth, PointsTruth):
            mirrors = _by_all(POINTS_METHODS, partial(_mirrors, image, region, truth.positions))
            found.append(
                PlaneTarget("mirrors", mirrors, report.points_panels, report.points_sections)
            )
        elif target.kind == "star":
            star = [measure_star(image, region)]
            found.append(PlaneTarget("star", star, report.star_panels, report.star_sections))
        elif target.kind == "bars":
            bars = [measure_bars(image, region)]
            found.append(
                PlaneTarget("bars", bars, report.bars_panels, report.bars_sections, ("across",))
            )
    return tuple(found)


def _mirrors(image: Image, region: Region, places: Floats, method: str) -> Measurement2d:
    from acutance.targets.points import measure_points

    return measure_points(image, region, positions=places, surveyed=places, method=method)


def _by_all(methods: Collection[str], measure: Callable[[str], ResultT]) -> list[ResultT]:
    """By every method that can measure the target; the others are named on stderr.

    Raises
    ------
    AcutanceError
        If the first of the methods, the reference, cannot.
    """
    found: list[ResultT] = []
    for name in methods:
        try:
            found.append(measure(name))
        except AcutanceError as error:
            if not found:
                raise
            say(f"  {name}: {error}")
    return found
