"""From the options of a measuring command to its results: the same for every kind of target."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import typer

from acutance.cli.options import PixelOptions, ResultOptions
from acutance.cli.results import Outputs, Shown
from acutance.cli.terminal import say
from acutance.errors import NoEdgeError, RegionError, TargetError
from acutance.targets.kinds import Kind

if TYPE_CHECKING:
    from acutance.raster import Image, Region
    from acutance.report import Comparison
    from acutance.targets import Measurement

__all__ = ["measure_target"]


def _no_arguments(image: Image) -> Mapping[str, Any]:
    return {}


def measure_target(
    kind: Kind,
    path: str,
    pixels: PixelOptions,
    wanted: ResultOptions,
    *,
    options: Mapping[str, Any],
    arguments: Callable[[Image], Mapping[str, Any]] = _no_arguments,
    methods: Sequence[str] = (),
    measure_all: bool = False,
    inputs: Iterable[str | None] = (),
) -> None:
    """Measure a target in each region, and deliver what was asked for.

    Parameters
    ----------
    kind : Kind
    path : str
        Of the image.
    pixels : PixelOptions
    wanted : ResultOptions
    options : mapping
        Fields of the kind's options, without its limits.
    arguments : function of an Image, optional
        Gives the other arguments of the kind's function.
    methods : sequence of str, optional
        Several are compared; without them the reference measures.
    measure_all : bool, optional
        Measure every target of the region.
    inputs : iterable of str or None, optional
        Files the command reads besides.
    """
    kept = (path, pixels.roi, pixels.linearize, *inputs)
    outputs = Outputs.checked(wanted, kept)
    chosen = kind.load(kind.options)(**options, limits=wanted.limits)
    image, regions = pixels.open(path)
    given = {**arguments(image), "options": chosen}
    names = methods or kind.methods[:1]

    def measure(region: Region | None) -> Shown:
        if measure_all:
            return _every_target(kind, image, region, {**given, "method": names[0]})
        function = partial(kind.load(kind.measure), image, roi=region, **given)
        return Shown(function(method=names[0]) if len(names) == 1 else _compared(function, names))

    if len(regions) == 1:
        (region,) = regions.values()
        outputs.deliver(measure(region))
    else:
        _deliver_regions(outputs, regions, measure, kept)


def _compared(function: Callable[..., Measurement], names: Sequence[str]) -> Comparison:
    """A target by several methods; one that cannot measure it leaves the others their results.

    Raises
    ------
    TargetError
        That of the first method, if none measures it.
    """
    from acutance.report import Comparison
    from acutance.targets import Rejected

    found: list[Measurement] = []
    rejected: list[Rejected] = []
    first: TargetError | None = None
    for name in names:
        try:
            one = function(method=name)
            _require_same_direction(one, found)
        except TargetError as error:
            first = first or error
            rejected.append(Rejected("method", str(error), {"method": name}))
            say(f"acutance: method {name}: {error}")
        else:
            found.append(one)
    if first is not None and not found:
        raise first
    return Comparison(tuple(found), rejected=tuple(rejected))


def _require_same_direction(one: Measurement, found: Sequence[Measurement]) -> None:
    """Refuse the measurement of another edge than the first method's: there is nothing to compare.

    A method that cannot measure the strongest edge of a region goes on to the next.
    """
    if found and not set(one.measured_directions) & set(found[0].measured_directions):
        raise TargetError(
            f"{one.method} measured another target of the region, "
            f"{' and '.join(one.measured_directions)} track, than {found[0].method}, "
            f"{' and '.join(found[0].measured_directions)} track: choose a region around one target"
        )


def _every_target(
    kind: Kind, image: Image, region: Region | None, given: Mapping[str, Any]
) -> Shown:
    """All edges of a region, on the pixels they are drawn on."""
    from acutance.raster import Box
    from acutance.targets.region import read_data

    result = kind.load(str(kind.measure_all))(image, region, **given)
    if not result.measurements:
        tried = len(result.rejected)
        why = f"; of {tried} tried the first: {result.rejected[0].reason}" if tried else ""
        raise NoEdgeError(
            f"no {kind.name} of {image.path} could be measured{why}. Choose a region around one "
            "target"
        )
    box = Box.whole(image.shape) if region is None else region.box(image.shape)
    return Shown(result, {"backdrop": read_data(image, box)[0], "origin": (box.row, box.col)})


def _deliver_regions(
    outputs: Outputs,
    regions: Mapping[str, Region | None],
    measure: Callable[[Region | None], Shown],
    kept: tuple[str | None, ...],
) -> None:
    """Measure every region; one that holds no target is named, and the others go on."""
    from acutance import report

    found: dict[str, Shown] = {}
    rejected: dict[str, str] = {}
    for (name, region), own in zip(
        regions.items(), outputs.of_regions(list(regions), kept), strict=True
    ):
        try:
            found[name] = measure(region)
        except (TargetError, RegionError) as error:
            rejected[name] = str(error)
            say(f"acutance: region {name}: {error}")
            own.write_rejection(f"Region {name}", str(error))
            continue
        own.write_files(found[name])
    if not found:
        raise TargetError(f"none of the {len(regions)} regions could be measured")
    if outputs.as_json:
        typer.echo(report.json_text(_regions_document(found, rejected, outputs.covariance)))
    else:
        texts = {name: report.text(shown.result) for name, shown in found.items()}
        texts |= {name: f"not measured: {reason}" for name, reason in rejected.items()}
        typer.echo("\n\n".join(f"region {name}: {texts[name]}" for name in regions))
    outputs.require_checks(found.values(), missing=len(rejected))


def _regions_document(
    found: Mapping[str, Shown], rejected: Mapping[str, str], covariance: bool
) -> dict[str, Any]:
    """The document ``acutance/regions/1``: one result a region, and the regions without one."""
    from acutance import report

    return {
        "schema": "acutance/regions/1",
        "results": [
            {"region": name, **report.document(shown.result, covariance=covariance)}
            for name, shown in found.items()
        ],
        "rejected": [
            {"stage": "measurement", "reason": reason, "values": {"region": name}}
            for name, reason in rejected.items()
        ],
    }
