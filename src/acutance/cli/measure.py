"""From the options of a measuring command to its results: the same for every kind of target."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
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
    images, regions = pixels.open_features(path)
    parts = [
        _Part(image, region, name if len(regions) > 1 else "", pixels.are_several)
        for image in images
        for name, region in regions.items()
    ]
    names = methods or kind.methods[:1]

    def measure(part: _Part) -> Shown:
        if isinstance(part.region, str):
            raise RegionError(part.region)
        given = {**arguments(part.image), "options": chosen}
        if measure_all:
            return _every_target(kind, part.image, part.region, {**given, "method": names[0]})
        function = partial(kind.load(kind.measure), part.image, roi=part.region, **given)
        return Shown(function(method=names[0]) if len(names) == 1 else _compared(function, names))

    if len(parts) == 1 and not pixels.are_several:
        outputs.deliver(measure(parts[0]), parts[0].document)
    else:
        _deliver_parts(outputs, parts, measure)


@dataclass(frozen=True)
class _Part:
    """A region of a band: one of those that are measured, each by itself.

    Parameters
    ----------
    image : Image
    region : Region, str or None
        Of a feature that is no region the reason.
    name : str
        Of the region, where there are several.
    is_of_bands : bool
        Whether several bands were asked for.
    """

    image: Image
    region: Region | str | None
    name: str
    is_of_bands: bool

    @property
    def label(self) -> str:
        """What it is called in messages."""
        band = [f"band {self.image.band_label}"] if self.is_of_bands else []
        return ", ".join([*band, *([f"region {self.name}"] if self.name else [])])

    @property
    def stem(self) -> str:
        """What it is called in the names of files."""
        return "-".join(
            [*([f"band-{self.image.band}"] if self.is_of_bands else []), *filter(None, [self.name])]
        )

    @property
    def document(self) -> dict[str, Any]:
        """What its document is marked with."""
        band = {"band": str(self.image.band)} if self.is_of_bands else {}
        if self.is_of_bands and self.image.band_name is not None:
            band["band_name"] = self.image.band_name
        return band | ({"region": self.region_name} if self.region_name else {})

    @property
    def region_name(self) -> str:
        """The name of the region, also of the only one where it has one."""
        own = "" if self.region is None or isinstance(self.region, str) else self.region.name
        return self.name or own


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
        else:
            found.append(one)
    if first is not None and not found:
        raise first
    for refused in rejected:
        say(f"acutance: method {refused.values['method']}: {refused.reason}")
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
        why = (
            f"; of {tried} tried the first: {result.rejected[0].reason}"
            if tried
            else ": nothing straight stands out: the region is flat, or its edges are too short"
        )
        raise NoEdgeError(
            f"no {kind.name} of {image.path} could be measured{why}. Choose a region around one "
            "target"
        )
    box = Box.whole(image.shape) if region is None else region.box(image.shape)
    return Shown(result, {"backdrop": read_data(image, box)[0], "origin": (box.row, box.col)})


def _deliver_parts(
    outputs: Outputs,
    parts: Sequence[_Part],
    measure: Callable[[_Part], Shown],
) -> None:
    """Measure every region of every band; one that holds no target is named, and the others go on.

    Raises
    ------
    TargetError
        If none of them does.
    """
    from acutance import report

    found: dict[int, Shown] = {}
    rejected: dict[int, str] = {}
    owns = outputs.of_regions([one.stem for one in parts])
    for place, (part, own) in enumerate(zip(parts, owns, strict=True)):
        try:
            found[place] = measure(part)
        except (TargetError, RegionError) as error:
            rejected[place] = str(error)
            say(f"acutance: {part.label}: {error}")
            own.write_rejection(part.label[:1].upper() + part.label[1:], str(error))
            continue
        own.write_files(found[place])
    if not found:
        what = "bands and regions" if parts[0].is_of_bands else "regions"
        raise TargetError(f"none of the {len(parts)} {what} could be measured")
    if outputs.as_json:
        typer.echo(report.json_text(_parts_document(parts, found, rejected, outputs)))
    else:
        texts = {
            place: report.text(shown.result, required=outputs.required)
            for place, shown in found.items()
        }
        texts |= {place: f"not measured: {reason}" for place, reason in rejected.items()}
        labelled = (f"{one.label}: {texts[place]}" for place, one in enumerate(parts))
        typer.echo("\n\n".join(labelled))
    outputs.require_checks(found.values(), missing=len(rejected))


def _parts_document(
    parts: Sequence[_Part], found: Mapping[int, Shown], rejected: Mapping[int, str],
    outputs: Outputs,
) -> dict[str, Any]:  # fmt: skip
    """The document ``acutance/regions/1``, of several bands ``acutance/bands/1``.

    It holds one result a region and band, and those without one.
    """
    return {
        "schema": "acutance/bands/1" if parts[0].is_of_bands else "acutance/regions/1",
        "results": [
            {**parts[place].document, **outputs.document(shown)} for place, shown in found.items()
        ],
        "rejected": [
            {"stage": "measurement", "reason": reason, "values": parts[place].document}
            for place, reason in rejected.items()
        ],
    }
