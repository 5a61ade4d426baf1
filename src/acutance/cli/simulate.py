"""``acutance simulate``: images of targets, each with its truth."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli import scenes, simulate_landscape, simulate_pair, simulate_site
from acutance.cli.noise import NoiseOptions
from acutance.cli.option_groups import with_groups
from acutance.cli.scenes import Seed, SimulatedFiles, parse_size
from acutance.cli.sensor import BUDGET_EXAMPLE, OptionalSensorName, named_sensor, sensor_budget
from acutance.cli.terminal import say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.optics import Block, Sensor
    from acutance.simulate import Truth

__all__ = ["EXAMPLE", "app", "edge"]

EXAMPLE = (
    "\b\nExample:\n"
    "  acutance simulate edge --gaussian 0.39 --smear 0.25 --snr 100 --seed 1 --out edge.tif"
)

_MIN_RISE = 0.9
"""Less of an edge's rise than this in an image is told."""

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Render a target, with its truth.",
    epilog=EXAMPLE,
)


@app.callback()
def _simulate() -> None:
    """Render a target as a sensor sees it, with its truth."""


@app.command("edge", epilog=EXAMPLE)
@with_groups
def edge(
    *,
    out: Annotated[
        str,
        typer.Option(
            metavar="FILE", help="The image, .tif; the truth goes next to it as .truth.json."
        ),
    ],
    sensor: OptionalSensorName = None,
    gaussian: Annotated[
        float | None, typer.Option(metavar="PX", help="Gaussian blur: its standard deviation.")
    ] = None,
    detector: Annotated[
        float | None,
        typer.Option(metavar="PX", help="Side of the square detector; 1 if not given."),
    ] = None,
    smear: Annotated[
        float | None, typer.Option(metavar="PX", help="Linear motion along the columns (y).")
    ] = None,
    jitter: Annotated[
        float | None, typer.Option(metavar="PX", help="Random motion: its standard deviation.")
    ] = None,
    butterworth: Annotated[
        float | None, typer.Option(metavar="CPP", help="Electronics: cut-off frequency.")
    ] = None,
    diffraction: Annotated[
        float | None, typer.Option(metavar="CPP", help="Diffraction: cut-off frequency.")
    ] = None,
    obscuration: Annotated[
        float | None,
        typer.Option(metavar="RATIO", help="Central obscuration, 0 to 1; needs --diffraction."),
    ] = None,
    gsd: Annotated[
        float | None, typer.Option(metavar="M", help="Ground sampling distance in metres.")
    ] = None,
    angle: Annotated[
        float, typer.Option(metavar="DEG", help="Tilt against the nearer image axis, -45 to 45.")
    ] = 6.0,
    along: Annotated[
        bool, typer.Option("--along", help="A nearly horizontal edge: the MTF along track.")
    ] = False,
    falling: Annotated[
        bool, typer.Option("--falling", help="The bright side first: left, or above.")
    ] = False,
    size: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Size of the image in pixels.")
    ] = "60,40",
    dark: Annotated[float, typer.Option(metavar="DN", help="Level of the dark side.")] = 200.0,
    bright: Annotated[float, typer.Option(metavar="DN", help="Level of the bright side.")] = 1200.0,
    noise: NoiseOptions,
    seed: Seed = 0,
) -> None:
    """Render a straight edge as a sensor sees it, and write what a perfect measurement finds."""
    files = SimulatedFiles.of(out, sensor)
    shape = parse_size(size)
    blocks = {
        "gaussian": gaussian,
        "detector": detector,
        "smear": smear,
        "jitter": jitter,
        "butterworth": butterworth,
        "diffraction": diffraction,
        "obscuration": obscuration,
    }
    sizes = {name: size for name, size in blocks.items() if size is not None}
    if sensor is not None and sizes:
        given = ", ".join(f"--{name}" for name in sizes)
        raise OptionError(f"--sensor {sensor} stands alone: leave out {given}")
    seen = _sensor(sizes, gsd) if sensor is None else named_sensor(sensor, gsd)

    import numpy as np

    from acutance import simulate
    from acutance.report import truth_document

    pixels, truth = simulate.edge(
        seen,
        angle_deg=angle,
        orientation="along" if along else "across",
        polarity="falling" if falling else "rising",
        shape=shape,
        dark=dark,
        bright=bright,
        snr=noise.snr,
        noise=noise.described(),
        rng=np.random.default_rng(seed),
    )
    files.write(pixels, seen, truth_document(truth, seen), seed)
    known = math.isfinite(truth.fwhm_px.value)
    width = f"FWHM {truth.fwhm_px} px" if known else "no FWHM within 32 px"
    typer.echo(f"true MTF at Nyquist {truth.mtf_nyquist}, RER {truth.rer}, {width}")
    _say_what_is_cut(seen, truth, shape)


def _say_what_is_cut(sensor: Sensor, truth: Truth, shape: tuple[int, int]) -> None:
    """Tell that an image ends before its edge has risen: nothing can be measured in it."""
    profile = sensor.profile(truth.line.normal_deg)
    across = shape[1] if truth.orientation == "across" else shape[0]
    low, high = profile.esf([profile.half_px - 0.5 * across, profile.half_px + 0.5 * across])
    if high - low < _MIN_RISE:
        say(
            f"note: the image shows {100 * (high - low):.0f} % of the edge's rise: {across} px "
            "across it are narrower than the blur; give a larger --size, or less blur"
        )


def _sensor(sizes: dict[str, float], gsd_m: float | None) -> Sensor:
    """The sensor the options describe, one block an option."""
    from acutance import optics

    if "obscuration" in sizes and "diffraction" not in sizes:
        raise OptionError("--obscuration belongs to an aperture: add --diffraction CPP")
    blocks: list[Block] = [optics.Detector(sizes.get("detector", 1.0))]
    if "gaussian" in sizes:
        blocks.append(optics.Gaussian(sizes["gaussian"]))
    if "diffraction" in sizes:
        blocks.append(optics.Diffraction(sizes["diffraction"], sizes.get("obscuration", 0.0)))
    if "smear" in sizes:
        blocks.append(optics.Smear(sizes["smear"], "along"))
    if "jitter" in sizes:
        blocks.append(optics.Jitter(sizes["jitter"]))
    if "butterworth" in sizes:
        blocks.append(optics.Butterworth(sizes["butterworth"]))
    return optics.Sensor(blocks, gsd_m=gsd_m)


for _name, _command in (
    ("pulse", scenes.pulse),
    ("bars", scenes.bars),
    ("star", scenes.star),
    ("points", scenes.points),
    ("site", simulate_site.site),
    ("checkerboard", simulate_site.checkerboard),
):
    _example = (scenes.EXAMPLES | simulate_site.SITE_EXAMPLES)[_name]
    _title = "Examples" if "\n" in _example else "Example"
    app.command(_name, epilog=f"\b\n{_title}:\n{_example}")(_command)
app.command("pair", epilog=f"\b\nExample:\n{simulate_pair.PAIR_EXAMPLE}")(simulate_pair.pair)
app.command("landscape", epilog=f"\b\nExamples:\n{simulate_landscape.LANDSCAPE_EXAMPLE}")(
    simulate_landscape.landscape
)
app.command("sensor-budget", epilog=BUDGET_EXAMPLE)(sensor_budget)
