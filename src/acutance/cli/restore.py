"""``acutance restore design | apply``: a kernel from measurements, and images sharpened by it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import parse_share
from acutance.cli.documents import read_json
from acutance.cli.named_bands import numbers_of_bands, parse_bands
from acutance.cli.option_groups import with_groups
from acutance.cli.options import (
    GsdOption,
    ImageArgument,
    JsonOption,
    method_option,
    parse_gsd,
    without_others,
)
from acutance.cli.output import OutputFile, check_optional, check_output
from acutance.cli.progress import progress_bar
from acutance.cli.sensor import named_sensor
from acutance.cli.terminal import FAILED_CHECK, command_line, say
from acutance.errors import OptionError
from acutance.targets.kinds import KINDS

if TYPE_CHECKING:
    from acutance.raster import Region
    from acutance.restoration import RestorationFilter, RestorationProof

__all__ = ["EXAMPLE", "app", "apply", "design"]

EXAMPLE = (
    "\b\nExamples:\n"
    "  acutance restore design across.json along.json --noise-gain 2 --out filter.json\n"
    "  acutance restore design scene.json --overshoot 0.03 --out filter.json --report filter.html\n"
    "  acutance restore apply scene.tif --filter filter.json --out sharp.tif --verify"
)

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Sharpen images by a kernel made from a measured MTF.",
    epilog=EXAMPLE,
)


@dataclass(frozen=True)
class KnobOptions:
    """How far the kernel goes: one of them, or none."""

    noise_gain: Annotated[
        float | None,
        typer.Option(
            metavar="G", help="Standard deviation of the noise after the kernel over before."
        ),
    ] = None
    mtf_nyquist: Annotated[
        float | None,
        typer.Option(
            metavar="MTF", help="MTF at Nyquist after the kernel, mean of across and along."
        ),
    ] = None
    overshoot: Annotated[
        str | None,
        typer.Option(metavar="SHARE", help="Largest overshoot of an edge (5% or 0.05)."),
    ] = None
    target: Annotated[
        str | None,
        typer.Option(metavar="FILE|NAME", help="Reach the OTF of this sensor, whatever the noise."),
    ] = None


@app.command("design", epilog=EXAMPLE)
@with_groups
def design(
    *,
    files: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FILE...",
            help="Measurements as JSON, written by a measuring command: one in two dimensions, or "
            "edges of several directions.",
        ),
    ] = None,
    sensor: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|NAME", help="A described sensor (.toml, or a preset) instead of FILE."
        ),
    ] = None,
    out: Annotated[str, typer.Option(metavar="FILE", help="The filter, .json.")],
    knob: KnobOptions,
    snr: Annotated[
        float | None,
        typer.Option(metavar="RATIO", help="Signal to noise ratio; else the measurement's."),
    ] = None,
    size: Annotated[int, typer.Option(metavar="PX", help="Rows and columns of the kernel.")] = 15,
    method: Annotated[
        str | None,
        typer.Option(
            metavar="wiener|constrained|target",
            help="The scene that is expected, or that of constrained least squares.",
        ),
    ] = None,
    scene: Annotated[
        str,
        typer.Option(
            metavar="natural|IMAGE",
            help="Spectrum of the scene: 1/f^2, or that of an image, blur and noise divided out.",
        ),
    ] = "natural",
    desired: Annotated[
        str,
        typer.Option(metavar="pixel|point", help="Sharpest aim: means of pixels, or points."),
    ] = "pixel",
    isotropic: Annotated[
        bool, typer.Option("--isotropic", help="State that all directions have the same blur.")
    ] = False,
    gsd: GsdOption = None,
    figure: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the sheet: .png, .svg or .pdf.")
    ] = None,
    report: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write a self-contained page: .html.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Design a kernel that sharpens the images of a measured sensor.

    Give one of --noise-gain, --mtf-nyquist, --overshoot or --target; the others are reported.
    Without one the expected error is least.
    """
    inputs = tuple(files or ())
    if bool(inputs) == (sensor is not None):
        raise OptionError("give the JSON files of measurements, or --sensor: one of them")
    kept = (*inputs, sensor, knob.target, scene)
    target_file = check_output("--out", out, (".json",), keep=kept)
    drawing = check_optional("--figure", figure, (".png", ".svg", ".pdf"), keep=kept)
    page = check_optional("--report", report, (".html",), keep=kept)
    known: Any = (
        named_sensor(sensor) if sensor is not None else [read_json(name) for name in inputs]
    )

    from acutance.report import json_text, restoration_page, restoration_text
    from acutance.restoration import design_restoration

    found = design_restoration(
        known, snr=snr, noise_gain=knob.noise_gain, mtf_nyquist=knob.mtf_nyquist,
        overshoot=None if knob.overshoot is None else parse_share("--overshoot", knob.overshoot),
        target=None if knob.target is None else named_sensor(knob.target),
        size=size, method=method, scene=_scene(scene), desired=desired,  # type: ignore[arg-type]
        isotropic=isotropic, gsd_m=parse_gsd(gsd), names=inputs or None,
    )  # fmt: skip
    text = json_text(found.to_dict())
    target_file.deliver(text)
    _draw(drawing, found)
    if page is not None:
        page.deliver(restoration_page(found, command=command_line()))
    typer.echo(text if as_json else restoration_text(found))


@app.command("apply", epilog=EXAMPLE)
def apply(
    image: ImageArgument,
    filter: Annotated[
        str, typer.Option(metavar="FILE", help="The filter, of 'acutance restore design'.")
    ],
    out: Annotated[
        str, typer.Option(metavar="FILE", help="The sharper image, .tif (of a .npy: .npy).")
    ],
    band: Annotated[
        str | None,
        typer.Option(
            metavar="BAND,...|all",
            help="Which bands, by number or name; without it the measured one, or the only one. "
            "Others are copied.",
        ),
    ] = None,
    nodata: Annotated[
        float | None,
        typer.Option(
            metavar="DN",
            help="Stored value without data, instead of the file's; nan: every value is data.",
        ),
    ] = None,
    saturation: Annotated[
        float | None,
        typer.Option(
            metavar="DN", help="Stored value of saturated pixels, instead of the type's largest."
        ),
    ] = None,
    accept_mismatch: Annotated[
        bool,
        typer.Option(
            "--accept-mismatch",
            help="Filter although pixel size or band are others than measured, or a second time.",
        ),
    ] = False,
    verify: Annotated[
        bool,
        typer.Option(
            "--verify", help="Measure edges before and after, and set them beside the prediction."
        ),
    ] = False,
    roi: Annotated[
        str | None,
        typer.Option(
            metavar="REGION", help="Where --verify finds edges, one a region; else it scans."
        ),
    ] = None,
    method: Annotated[str, method_option("edge")] = KINDS["edge"].methods[0],
    as_json: JsonOption = False,
) -> None:
    """Sharpen an image of any size.

    Type, georeference and metadata are kept; pixels without data stay so, saturated ones too.
    """
    if roi is not None and not verify:
        raise OptionError("--roi names edges for --verify: add it")
    if method != KINDS["edge"].methods[0] and not verify:
        raise OptionError("--method measures edges for --verify: add it")
    from acutance.raster.pixels import is_npy

    ending = ".npy" if is_npy(image) else ".tif"
    place = check_output("--out", out, (ending, ".tiff") if ending == ".tif" else (ending,),
                         keep=(image, filter, roi))  # fmt: skip

    from acutance.restoration import RestorationFilter, restore
    from acutance.targets.straight.edge import require_method

    require_method(method)
    chosen = RestorationFilter.read(filter)
    regions = _regions(image, roi, nodata)
    with progress_bar(f"restore {Path(image).name}") as progress:
        restored = restore(
            image, chosen, out=place.place, bands=_bands(image, band), nodata=nodata,
            saturation=saturation, accept_mismatch=accept_mismatch, progress=progress,
        )  # fmt: skip
    say(f"wrote {place.path}")
    document: dict[str, Any] = {"schema": "acutance/restored/1", **restored.to_dict()}
    lines = [f"band {number}: {counts.in_words()}" for number, counts in restored.bands.items()]
    if any(counts.fill for counts in restored.bands.values()):
        lines.append(
            "fill: the constant beyond the swath was left as it is; --nodata DN states another "
            "value, --nodata nan that every value is data"
        )
    lines += [f"note: {note}" for note in restored.notes]
    if not as_json:
        typer.echo("\n".join(lines))
    proof = None
    if verify:
        of = chosen.band if chosen.band in restored.bands else next(iter(restored.bands))
        proof = _verified((image, str(place.place)), of, chosen, regions, nodata, method)
        document["proof"] = {"band": of, **proof.to_dict()}
        if not as_json:
            typer.echo(f"\n{_proof_text(proof, of, len(restored.bands))}")
    if as_json:
        from acutance.report import json_text

        typer.echo(json_text(document))
    if proof is not None and not proof.agrees:
        raise typer.Exit(FAILED_CHECK)


def _regions(image: str, roi: str | None, nodata: float | None) -> Mapping[str, Region]:
    """The regions of ``--roi`` by their names, each in the image."""
    from acutance.raster import open_image
    from acutance.raster.roi import parse_features

    if roi is None:
        return {}
    before = open_image(image, nodata=nodata)
    regions = without_others(parse_features(roi, before))
    for region in regions.values():
        region.box(before.shape)
    return regions


def _verified(
    files: tuple[str, str],
    band: int,
    chosen: RestorationFilter,
    regions: Mapping[str, Region],
    nodata: float | None,
    method: str,
) -> RestorationProof:
    """Edges of a band before and after."""
    from acutance.raster import open_image
    from acutance.restoration import verify_restoration

    before, after = (
        open_image(name, band, nodata=nodata, along_track=chosen.along_track) for name in files
    )
    try:
        return verify_restoration(before, after, chosen, regions, method=method)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"interrupted: {files[1]} is written, its edges were not all measured"
        ) from None


def _proof_text(proof: RestorationProof, band: int, filtered: int) -> str:
    from acutance.report import proof_text

    return f"band {band}:\n{proof_text(proof)}" if filtered > 1 else proof_text(proof)


def _bands(image: str, text: str | None) -> Any:
    """The value of ``--band``: numbers, "all", or None."""
    if text is None or text == "all":
        return text
    return numbers_of_bands(image, parse_bands(text))


def _scene(text: str) -> Any:
    """The value of ``--scene``: a word, or an image."""
    if text == "natural":
        return text
    from acutance.raster import open_image

    return open_image(text)


def _draw(drawing: OutputFile | None, found: Any) -> None:
    if drawing is None:
        return
    from acutance.report import figure_bytes, restoration_figure

    drawing.deliver(figure_bytes(restoration_figure(found), drawing.ending))
