"""One target of one band: found near its place, and measured by its kind."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from acutance.batch.find_line import edge_candidates, grown, line_region, require_near
from acutance.batch.find_points import find_points
from acutance.batch.place_target import PlacedTarget
from acutance.batch.plan_options import ChosenOptions
from acutance.errors import TargetError
from acutance.numerics.one_thread import one_thread
from acutance.raster import Image
from acutance.targets.measurement import Measurement

__all__ = ["measure_target"]


@one_thread
def measure_target(
    placed: PlacedTarget, image: Image, chosen: ChosenOptions, scan_workers: int = 1
) -> Measurement:
    """Measure a target where it lies in an image.

    Parameters
    ----------
    placed : PlacedTarget
    image : Image
    chosen : ChosenOptions
    scan_workers : int, optional
        Processes of a scene.

    Raises
    ------
    AcutanceError
        If it cannot be measured; `NotHereError` if it is not found near its place.
    """
    if placed.target.kind == "scene":
        return _scene(placed, image, chosen, scan_workers)
    return _MEASURES[placed.target.kind](placed, image, chosen)


def _edge(placed: PlacedTarget, image: Image, chosen: ChosenOptions) -> Measurement:
    """The likeliest edge that can be measured; if none can, the error of the likeliest."""
    from acutance.targets.straight.edge import measure_segment

    first: TargetError | None = None
    options = chosen.build()
    for region, segment in edge_candidates(placed, image):
        try:
            return measure_segment(region, segment, chosen.method, options)
        except TargetError as error:
            first = first or error
    raise first or TargetError("there is no edge")


def _pulse(placed: PlacedTarget, image: Image, chosen: ChosenOptions) -> Measurement:
    from acutance.targets.straight import measure_pulse

    stated = {
        name: one
        for name in ("width_m", "width_px", "fit_width")
        if (one := placed.target.settings.get(name)) is not None
    }
    is_line = placed.target.shape == "LineString"
    region = line_region(placed, _width_px(placed)) if is_line else grown(placed)
    found = measure_pulse(
        image, region, gsd_m=placed.gsd, method=chosen.method, options=chosen.build(), **stated
    )
    if is_line:
        width_px = 0.0 if found.width_px is None else found.width_px.value
        require_near(placed, found.line, width_px)
    return found


def _width_px(placed: PlacedTarget) -> float:
    """The stated width in the smaller pixels; 0 if none is stated."""
    width_m, width_px = (placed.target.settings.get(name) for name in ("width_m", "width_px"))
    if width_px is not None:
        return float(width_px)
    if width_m is None or placed.gsd is None:
        return 0.0
    return float(width_m) / min(placed.gsd.row_m, placed.gsd.col_m)


def _points(placed: PlacedTarget, image: Image, chosen: ChosenOptions) -> Measurement:
    from acutance.targets.points import measure_points

    how: dict[str, Any] = {
        "gsd_m": placed.gsd,
        "method": chosen.method,
        "options": chosen.build(),
    }
    if placed.target.shape == "Polygon":
        return measure_points(image, grown(placed), **how)
    box, places = find_points(placed, image)
    # The survey with its common shift taken out: what is left is compared point by point.
    surveyed = places if len(places) > 1 else None
    return measure_points(image, box, positions=places, surveyed=surveyed, **how)


def _star(placed: PlacedTarget, image: Image, chosen: ChosenOptions) -> Measurement:
    from acutance.targets.periodic import measure_star

    return measure_star(
        image, grown(placed), cycles=placed.target.settings.get("cycles"), gsd_m=placed.gsd,
        method=chosen.method, options=chosen.build(),
    )  # fmt: skip


def _bars(placed: PlacedTarget, image: Image, chosen: ChosenOptions) -> Measurement:
    from dataclasses import replace

    from acutance.targets.periodic import measure_bars

    count = placed.target.settings.get("count")
    options = chosen.build()
    if count is not None:
        options = replace(options, count=count)
    return measure_bars(
        image, grown(placed), gsd_m=placed.gsd, method=chosen.method, options=options
    )


def _scene(
    placed: PlacedTarget, image: Image, chosen: ChosenOptions, workers: int
) -> Measurement:  # fmt: skip
    from acutance.scan import scan_scene

    region = grown(placed) if placed.target.points else None
    return scan_scene(image, region, gsd_m=placed.gsd, options=chosen.build(), workers=workers)


_MEASURES: dict[str, Callable[[PlacedTarget, Image, ChosenOptions], Measurement]] = {
    "edge": _edge,
    "pulse": _pulse,
    "points": _points,
    "star": _star,
    "bars": _bars,
}
