"""The options of measuring commands, each declared once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from acutance.cli.choices import (
    numbers_of,
    parse_limits,
    parse_share,
    parse_stated,
)
from acutance.cli.named_bands import numbers_of_bands, parse_bands
from acutance.cli.terminal import say
from acutance.errors import OptionError, RegionError
from acutance.targets.kinds import KINDS, methods_text

if TYPE_CHECKING:
    from acutance.raster import Gsd, Image, Region
    from acutance.raster.image import AlongTrack
    from acutance.targets import ToleranceLimit

__all__ = [
    "BrightOption",
    "CompareOption",
    "DarkOption",
    "GsdOption",
    "ImageArgument",
    "JsonOption",
    "LevelStdOption",
    "PixelOptions",
    "RerCentreOption",
    "ResultOptions",
    "RobustOption",
    "SoftnessOptions",
    "StatedOptions",
    "method_option",
    "parse_gsd",
    "without_others",
]

_T = TypeVar("_T")

_AXES: dict[str, AlongTrack] = {"x": "x", "y": "y"}

ImageArgument = Annotated[
    str, typer.Argument(metavar="IMAGE", help="Any raster GDAL reads, or a .npy array.")
]
GsdOption = Annotated[
    str | None,
    typer.Option(
        metavar="M",
        help="Ground sampling distance in metres, or ROW,COL distances where they differ. "
        "That of the file without it.",
    ),
]
CompareOption = Annotated[
    str | None,
    typer.Option(
        metavar="METHOD,...", help="Measure by these methods too, and compare the results."
    ),
]
RerCentreOption = Annotated[
    str | None,
    typer.Option(
        metavar="half|peak",
        help="Centre RER on the 50 % point or on the peak of the LSF; without it as the "
        "method does.",
    ),
]
RobustOption = Annotated[
    bool, typer.Option(help="Bound the weight of outlying pixels (the reference method).")
]
DarkOption = Annotated[
    float | None,
    typer.Option(
        metavar="DN",
        help="Level of a wide patch of the dark material, before blur. The contrast is fitted "
        "without --dark and --bright, which is less exact.",
    ),
]
BrightOption = Annotated[
    float | None, typer.Option(metavar="DN", help="Level of a wide patch of the bright material.")
]
LevelStdOption = Annotated[
    float, typer.Option(metavar="DN", help="Standard deviation of --bright minus --dark.")
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the JSON document, and nothing else, to stdout.")
]


def method_option(kind: str) -> Any:
    """The option ``--method`` of a kind of target, with the names there are."""
    return typer.Option(metavar="METHOD", help=f"{methods_text(KINDS[kind].methods)}.")


@dataclass(frozen=True)
class PixelOptions:
    """Which pixels are meant, and where they lie."""

    roi: Annotated[
        str | None,
        typer.Option(
            metavar="ROI",
            help="Region: ROW,COL,HEIGHT,WIDTH in pixels, lonlat:WEST,SOUTH,EAST,NORTH in "
            "degrees, or a GeoJSON file, each polygon of which is measured. The whole image "
            "without it.",
        ),
    ] = None
    site: Annotated[
        str | None, typer.Option(metavar="NAME", help="Region: a known site (see acutance sites).")
    ] = None
    band: Annotated[
        str,
        typer.Option(
            metavar="BAND,...|all",
            help="Which band: its number, from 1, or its name (acutance image lists them). Of "
            "several, 1,2,3 or all, each is measured by itself.",
        ),
    ] = "1"
    nodata: Annotated[
        float | None,
        typer.Option(
            metavar="VALUE",
            help="The stored value of unusable pixels; that of the file without it. nan: every "
            "value is data, also a constant beyond a swath's border.",
        ),
    ] = None
    gsd: GsdOption = None
    along_track: Annotated[
        str,
        typer.Option(metavar="x|y", help="The image axis along track: y, down the columns, or x."),
    ] = "y"
    gamma: Annotated[
        float | None,
        typer.Option(
            metavar="G", help="The values are the 1/G-th power of light: linearise them first."
        ),
    ] = None
    linearize: Annotated[
        str | None,
        typer.Option(
            metavar="CURVE",
            help="Linearise the values first: sRGB (or sRGB:WHITE), log:DECADE, or a table "
            "FILE.csv of stored values and light.",
        ),
    ] = None

    @property
    def bands(self) -> Sequence[int | str] | None:
        """Numbers or names of the bands; None for all of them."""
        return None if self.band == "all" else parse_bands(self.band)

    @property
    def are_several(self) -> bool:
        """Whether several bands are asked for, be there one in the end."""
        bands = self.bands
        return bands is None or len(bands) > 1

    def open(self, path: str) -> tuple[tuple[Image, ...], dict[str, Region | None]]:
        """As `open_features`; features that are no regions are named on stderr."""
        images, found = self.open_features(path)
        return images, without_others(found)

    def open_features(self, path: str) -> tuple[tuple[Image, ...], dict[str, Region | str | None]]:
        """Open the bands of the image and find the regions the options ask for, by name.

        Of a feature that is no polygon there is the reason why it is no region.

        Raises
        ------
        OptionError, ImageError, RegionError
            If the options contradict each other, or the image or a region cannot be had.
        """
        bands = self.bands
        if self.roi is not None and self.site is not None:
            raise OptionError("--roi and --site both name a region: give one of them")
        if self.along_track not in _AXES:
            raise OptionError(f"--along-track {self.along_track}: it has to be x or y")
        if self.gamma is not None and self.linearize is not None:
            raise OptionError("--gamma and --linearize both name a curve: give one of them")
        gsd_m = parse_gsd(self.gsd)
        from acutance.raster import Region, find_site, open_bands, site_region
        from acutance.raster.roi import parse_features

        place = None if self.site is None else find_site(self.site)
        images = open_bands(
            path, None if bands is None else numbers_of_bands(path, bands), gsd_m, self.nodata,
            along_track=_AXES[self.along_track],
            linearize=self.linearize if self.gamma is None else self.gamma,
        )  # fmt: skip
        if place is not None:
            return images, {place.name: site_region(place, images[0])}
        if self.roi is None:
            return images, {"": None}
        regions = parse_features(self.roi, images[0])
        for name, region in regions.items():
            if isinstance(region, Region) and (inside := _part_inside(region, images[0].shape)):
                say(
                    f"acutance: region {name} reaches beyond the image: the part inside, {inside} "
                    "(row,col,height,width), is measured"
                )
        return images, dict(regions)


@dataclass(frozen=True)
class ResultOptions:
    """What is asked of a result, and what becomes of it."""

    figure: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Draw the steps: .png, .svg or .pdf. Of several regions or bands one file each: "
            "FILE-NAME.png.",
        ),
    ] = None
    panels: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Draw each step by itself, for papers and slides: .png, .svg or .pdf; "
            "FILE-modulation-transfer-function.pdf, ...",
        ),
    ] = None
    report: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Write a self-contained page: .html. Of several regions, or bands of a target, "
            "one page each: FILE-NAME.html, and no FILE.html.",
        ),
    ] = None
    csv: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Write the MTF in steps of 0.02 c/px: .csv. Of several: FILE-NAME.csv.",
        ),
    ] = None
    as_json: JsonOption = False
    covariance: Annotated[
        bool, typer.Option("--covariance", help="With --json: add the covariance factors.")
    ] = False
    limit: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Ask more or less of a check; repeatable."),
    ] = None
    require: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NUMBER>=LIMIT",
            help="Tell whether a number keeps a limit, with the probability: mtf_nyquist>=0.09, or "
            "along.fwhm_m<=1.5 for one direction; repeatable. Of the sensor over many images: "
            "acutance archive check.",
        ),
    ] = None
    strict: Annotated[
        bool,
        typer.Option(
            "--strict",
            help="Exit with code 3 when a check failed, or a requirement is not met or cannot be "
            "told yet.",
        ),
    ] = False

    @property
    def limits(self) -> Mapping[str, float]:
        """The limits of ``--limit`` by the names of the checks."""
        return parse_limits(self.limit or ())

    @property
    def required(self) -> tuple[ToleranceLimit, ...]:
        """What ``--require`` asks for.

        Raises
        ------
        OptionError
            If a text states no limit.
        """
        if not self.require:
            return ()
        from acutance.targets import ToleranceLimit

        return tuple(map(ToleranceLimit.of, self.require))


@dataclass(frozen=True)
class SoftnessOptions:
    """How soft the border of a target is stated to be."""

    target_softness_m: Annotated[
        str | None,
        typer.Option(
            metavar="M[+-STD]",
            help="Softness of the target's own border, as painted or laid: the standard deviation "
            "of its Gaussian profile in metres, and its own (0.05+-0.02). The MTF is divided by "
            "the border's.",
        ),
    ] = None
    target_softness_px: Annotated[
        str | None, typer.Option(metavar="PX[+-STD]", help="The same in pixels.")
    ] = None

    @property
    def softness(self) -> dict[str, Any]:
        """Fields of the options of an edge, a pulse or a scan."""
        metres, pixels = self.target_softness_m, self.target_softness_px
        if metres is not None and pixels is not None:
            raise OptionError(
                "--target-softness-m and --target-softness-px state the same thing: give one"
            )
        return {
            "target_softness_m": parse_stated("--target-softness-m", metres),
            "target_softness_px": parse_stated("--target-softness-px", pixels),
        }


@dataclass(frozen=True)
class StatedOptions(SoftnessOptions):
    """What is stated of a straight target because no pixel shows it."""

    level_uncertainty: Annotated[
        str | None,
        typer.Option(
            metavar="SHARE",
            help="Standard deviation of the target's true contrast over the fitted one (0.5%).",
        ),
    ] = None

    @property
    def fields(self) -> dict[str, Any]:
        """Fields of the options of an edge or a pulse."""
        level = parse_share("--level-uncertainty", self.level_uncertainty)
        return {**self.softness, "level_uncertainty": level}


def without_others(found: Mapping[str, _T | str]) -> dict[str, _T]:
    """The regions among features; why the others are none is said on stderr."""
    regions: dict[str, _T] = {}
    for name, one in found.items():
        if isinstance(one, str):
            say(f"acutance: region {name}: {one}")
        else:
            regions[name] = one
    return regions


def _part_inside(region: Region, shape: tuple[int, int]) -> str:
    """The part of a region that reaches beyond an image, as a box in words; empty of others."""
    low, high = region.vertices.min(axis=0), region.vertices.max(axis=0)
    # Centres of pixels that the image would have there.
    if (low > -1.0).all() and (high <= shape).all():
        return ""
    try:
        return ",".join(map(str, region.box(shape).as_tuple()))
    except RegionError:
        # None of it is inside: that is refused, or told, where it is measured.
        return ""


def parse_gsd(text: str | None) -> float | Gsd | None:
    """The value of ``--gsd``: one number, or the spacing of rows and that of columns.

    Raises
    ------
    OptionError
        If it is neither.
    """
    if text is None:
        return None
    numbers = numbers_of(text)
    if len(numbers) not in (1, 2):
        raise OptionError(
            f"--gsd {text} is not a distance: write metres (0.7), or those between rows and "
            "between columns (0.72,0.70)"
        )
    if len(numbers) == 1:
        return numbers[0]
    from acutance.raster import Gsd

    return Gsd(*numbers)
