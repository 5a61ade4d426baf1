"""``acutance scan``: measure a sensor from all straight edges of a scene, in its bands."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import parse_grid
from acutance.cli.option_groups import with_groups
from acutance.cli.options import ImageArgument, PixelOptions, ResultOptions, SoftnessOptions
from acutance.cli.output import OutputFile, check_optional, require_folder, require_own_file
from acutance.cli.progress import progress_bar
from acutance.cli.results import Outputs, Shown
from acutance.cli.study import WorkersOption, dask_option
from acutance.cli.terminal import command_line
from acutance.errors import FewEdgesError, OptionError

if TYPE_CHECKING:
    from acutance.raster import Image
    from acutance.scan import BandScenes, SceneMeasurement
    from acutance.scan.edge_table import EdgeTable

__all__ = ["EXAMPLE", "scan"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance scan scene.tif --report scan.html --edges edges.geojson\n"
    "  acutance scan scene.tif --band all --field 5x5 --json\n"
    "  acutance scan scene.tif --roi 0,0,4000,4000 --workers 2\n"
    "  acutance scan fields.tif --target-softness-m 2+-1\n"
    "  acutance scan large.tif --keep large.scan --dask tcp://host:8786"
)


@dataclass(frozen=True)
class ScenePixelOptions(PixelOptions):
    """Which pixels are meant: of one band or of several, and of one region."""

    roi: Annotated[
        str | None,
        typer.Option(
            metavar="ROI",
            help="Region: ROW,COL,HEIGHT,WIDTH in pixels, lonlat:WEST,SOUTH,EAST,NORTH in "
            "degrees, or a GeoJSON file with one polygon. The whole image without it.",
        ),
    ] = None
    band: Annotated[
        str,
        typer.Option(
            metavar="BAND,...|all",
            help="Which band: its number, from 1, or its name (acutance image lists them). "
            "Several, 1,2,3 or all, are measured at the same edges, with the shifts between them.",
        ),
    ] = "1"


@dataclass(frozen=True)
class SceneResultOptions(ResultOptions):
    """What is asked of a scene: of several bands, never of several regions."""

    figure: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Draw the steps: .png, .svg or .pdf. Of several bands one file each: "
            "FILE-band-1.png.",
        ),
    ] = None
    report: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Write a self-contained page: .html. Of several bands one page of all of them.",
        ),
    ] = None
    csv: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Write the MTF in steps of 0.02 c/px: .csv. Of several bands: FILE-band-1.csv.",
        ),
    ] = None


@dataclass(frozen=True)
class ObjectOptions(SoftnessOptions):
    """What is stated of the objects of a scene."""

    target_softness_m: Annotated[
        str | None,
        typer.Option(
            metavar="M[+-STD]",
            help="Softness that even the sharpest objects have, and no edge can show (borders of "
            "fields, of plants): the standard deviation of its Gaussian profile in metres, and its "
            "own (2+-1). The MTF is divided by the borders'.",
        ),
    ] = None


@with_groups
def scan(
    *,
    image: ImageArgument,
    pixels: ScenePixelOptions,
    edges: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Write every edge that was found, used or not: .csv, .parquet, or .geojson. "
            "Longitude and latitude are added where the image has a CRS.",
        ),
    ] = None,
    keep: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Keep finished windows in this file: an interrupted scan goes on from it when it "
            "is called again, and a finished one with other outputs measures no edge again. Remove "
            "it when it is no longer needed.",
        ),
    ] = None,
    min_length: Annotated[
        float,
        typer.Option(
            metavar="PX",
            help="Shorter edges are left out, as they are found; of others a shorter part may be "
            "usable. 8 to 42: long edges are cut into pieces.",
        ),
    ] = 15.0,
    field: Annotated[
        str,
        typer.Option(
            metavar="ROWSxCOLS",
            help="Tell the sharpness in the middle of so many equal parts of the scene.",
        ),
    ] = "3x3",
    objects: ObjectOptions,
    workers: WorkersOption = None,
    dask: Annotated[str | None, dask_option("IMAGE under the same name")] = None,
    wanted: SceneResultOptions,
) -> None:
    """Measure a sensor from all straight edges of a scene: roofs, fields, roads, coasts.

    Every edge is found and measured; what they share is the sensor, and how soft the objects are
    is estimated with it.
    """
    kept = (image, pixels.roi, pixels.linearize)
    outputs = Outputs.checked(wanted, kept)
    table = check_optional("--edges", edges, (".csv", ".parquet", ".geojson"), keep=kept)
    if dask is not None and workers is not None:
        raise OptionError("--workers and --dask cannot be combined: the cluster has its own")
    if keep is not None:
        require_folder("--keep", keep)
        require_own_file("--keep", keep, keep=kept)
    places = parse_grid("--field", field)
    images, regions = pixels.open(image)
    if len(regions) > 1:
        raise OptionError(
            f"--roi names {len(regions)} regions, and a scene is one: give one of them"
        )
    (region,) = regions.values()
    if pixels.are_several:
        # Files that cannot be written, or are others of the run, are found out before the work.
        outputs.of_regions([_band_stem(str(one.band)) for one in images])

    from acutance.scan import BandScenes, ScanOptions, scan_bands, scan_scene
    from acutance.scan.parquet import require_parquet

    if table is not None and table.ending == ".parquet":
        require_parquet()
    with progress_bar(f"scan {Path(image).name}") as progress:
        how: dict[str, Any] = {
            "options": ScanOptions(
                min_length_px=min_length, places=places, limits=wanted.limits, **objects.softness
            ),
            "workers": workers or os.cpu_count() or 1,
            "scheduler": dask,
            "keep": keep,
            "progress": progress,
            "tell": progress.tell,
        }
        found: SceneMeasurement | BandScenes
        try:
            if pixels.are_several:
                found = scan_bands(images, roi=region, **how)
            else:
                found = scan_scene(images[0], region, **how)
        except FewEdgesError as error:
            # The reasons are what is asked for then.
            if table is not None:
                _write_edges(table, error.edges, images[0])
            _tell_reasons(error, is_written=table is not None)
            raise
    if table is not None:
        _write_edges(table, found.edges, images[0])
    if isinstance(found, BandScenes):
        _deliver_bands(outputs, found, images)
    else:
        is_drawn = outputs.figure is not None or outputs.report is not None
        outputs.deliver(Shown(found, _backdrop(images[0], found) if is_drawn else {}))


def _backdrop(image: Image, found: SceneMeasurement) -> dict[str, Any]:
    """A quick look at what was scanned, for its map."""
    from acutance.raster import Box
    from acutance.raster.quick_look import quick_look

    return {"backdrop": quick_look(image, Box(*found.image.roi))}


def _tell_reasons(error: FewEdgesError, is_written: bool) -> None:
    """Why edges are not used, beside the message, and where there is more about each."""
    from acutance import report

    if reasons := report.reasons_text(error.edges):
        typer.echo(reasons, err=True)
        if not is_written:
            typer.echo("the table of the edges has the reason of each: --edges FILE", err=True)


def _write_edges(table: OutputFile, edges: EdgeTable, image: Image) -> None:
    lonlat = None if image.geolocation is None else image.geolocation.to_lonlat
    if table.ending == ".csv":
        table.deliver(edges.to_csv(lonlat))
    elif table.ending == ".parquet":
        content = io.BytesIO()
        edges.to_parquet(content, lonlat)
        table.deliver(content.getvalue())
    else:
        from acutance.report import json_text

        table.deliver(json_text(edges.to_geojson(lonlat)))


def _band_stem(name: str) -> str:
    """What a band is called in the names of files."""
    return f"band-{name}"


def _deliver_bands(outputs: Outputs, found: BandScenes, images: Sequence[Image]) -> None:
    """One page and one document of all bands; figures and curves in files of their own."""
    from acutance import report

    names = [_band_stem(name) for name in found.scenes]
    looks: dict[str, dict[str, Any]] = {name: {} for name in found.scenes}
    if outputs.figure is not None or outputs.report is not None:
        by_band = {one.band: one for one in images}
        looks = {
            name: _backdrop(by_band[scene.image.band], scene)
            for name, scene in found.scenes.items()
        }
    each = [Shown(scene, looks[name]) for name, scene in found.scenes.items()]
    for own, shown in zip(outputs.of_regions(names), each, strict=True):
        replace(own, report=None).write_files(shown)
    if outputs.report is not None:
        backdrops = {name: look["backdrop"] for name, look in looks.items()}
        outputs.report.deliver(
            report.bands_page(
                found, command=command_line(), required=outputs.required, backdrops=backdrops
            )
        )
    if outputs.as_json:
        document = report.bands_document(found, outputs.covariance, required=outputs.required)
        typer.echo(report.json_text(document))
    else:
        typer.echo(report.bands_text(found, required=outputs.required))
    outputs.require_checks(each, missing=len(found.rejected))
