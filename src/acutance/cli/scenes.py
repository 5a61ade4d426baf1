"""``acutance simulate pulse | bars | star | points``: an image, and its truth next to it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import numbers_of
from acutance.cli.noise import NoiseOptions
from acutance.cli.option_groups import with_groups
from acutance.cli.output import OutputFile, check_output
from acutance.cli.sensor import SensorGsd, SensorName, named_sensor
from acutance.cli.star import WaveOption
from acutance.cli.terminal import say
from acutance.errors import OptionError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from acutance.curves.grid import Floats
    from acutance.optics import Sensor
    from acutance.raster import Box

__all__ = [
    "EXAMPLES",
    "Angle",
    "Out",
    "Seed",
    "SimulatedFiles",
    "bars",
    "parse_size",
    "points",
    "pulse",
    "star",
]

EXAMPLES = {
    "pulse": "  acutance simulate pulse --sensor ikonos-like --width-px 3 --snr 70 --out pulse.tif",
    "bars": "  acutance simulate bars --periods 8,4,3,2 --angle 6 --out bars.tif",
    "star": "  acutance simulate star --wave square --sensor my-sensor.toml --out star.tif",
    "points": "  acutance simulate points --peak 1500 --snr 80 --out mirrors.tif",
}

Out = Annotated[
    str,
    typer.Option(metavar="FILE", help="The image, .tif; the truth goes next to it as .truth.json."),
]
Angle = Annotated[
    float, typer.Option(metavar="DEG", help="Tilt against the nearer image axis, -45 to 45.")
]
Along = Annotated[bool, typer.Option("--along", help="Nearly horizontal: the MTF along track.")]
Dark = Annotated[float, typer.Option(metavar="DN", help="Level of the background.")]
Bright = Annotated[float, typer.Option(metavar="DN", help="Level of the target.")]
Seed = Annotated[int, typer.Option(metavar="N", min=0, help="Of the random numbers.")]


@dataclass(frozen=True)
class SimulatedFiles:
    """An image and the file of its truth, found writable before anything is rendered.

    Parameters
    ----------
    image, truth : OutputFile
    """

    image: OutputFile
    truth: OutputFile

    @classmethod
    def of(cls, out: str, *inputs: str | None, truth_ending: str = ".json") -> SimulatedFiles:
        """The files for ``--out``, refused if they cannot be written or are among the inputs."""
        image = check_output("--out", out, (".tif", ".tiff"), keep=inputs)
        truth_name = str(image.path.with_suffix(f".truth{truth_ending}"))
        truth = check_output("--out", truth_name, (truth_ending,), keep=inputs)
        return cls(image, truth)

    def write(self, pixels: Floats, sensor: Sensor, document: dict[str, Any], seed: int) -> None:
        """Write both: pixels in single precision, the truth with the seed that made them."""
        from acutance.raster import Box

        whole = Box.whole((pixels.shape[0], pixels.shape[1]))
        self.write_tiles([(whole, pixels)], whole.shape, sensor, document, seed)

    def write_tiles(
        self,
        tiles: Iterable[tuple[Box, NDArray[Any]]],
        shape: tuple[int, int],
        sensor: Sensor,
        document: dict[str, Any],
        seed: int,
    ) -> None:
        """The same of an image that comes in parts."""
        from acutance.raster import Gsd, write_geotiff_tiles
        from acutance.report import json_text

        gsd = None if sensor.pixel_m is None else Gsd(*sensor.pixel_m)
        write_geotiff_tiles(self.image.place, shape, tiles, gsd_m=gsd)
        say(f"wrote {self.image.path}")
        self.truth.deliver(json_text({**document, "seed": seed}))


def parse_size(text: str) -> tuple[int, int]:
    """Rows and columns of an image, typed as ``60,40``.

    Raises
    ------
    OptionError
        If they are not two numbers above 0.
    """
    try:
        rows, cols = (int(part) for part in text.split(","))
    except ValueError as error:
        raise OptionError(f"--size {text}: write rows and columns, as in 60,40") from error
    if min(rows, cols) < 1:
        raise OptionError(f"--size {text}: rows and columns have to be 1 or more")
    return rows, cols


@with_groups
def pulse(
    *,
    out: Out,
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    width_px: Annotated[
        float | None, typer.Option(metavar="PX", help="Width in pixels; 3 if not given.")
    ] = None,
    width_m: Annotated[
        float | None, typer.Option(metavar="M", help="Width in metres, instead of pixels.")
    ] = None,
    length: Annotated[
        float | None, typer.Option(metavar="PX", help="Length; endless if not given.")
    ] = None,
    angle: Angle = 6.0,
    along: Along = False,
    size: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Size of the image in pixels.")
    ] = "60,40",
    dark: Dark = 100.0,
    right_dark: Annotated[
        float | None,
        typer.Option(metavar="DN", help="Level of the background behind the pulse, if it differs."),
    ] = None,
    bright: Bright = 1200.0,
    noise: NoiseOptions,
    ground_noise: Annotated[
        bool,
        typer.Option(
            "--ground-noise", help="Clutter of the ground: 20 grains of variance 100 each."
        ),
    ] = False,
    seed: Seed = 0,
) -> None:
    """Render a pulse: two parallel edges between plateaus."""
    files, shape = SimulatedFiles.of(out, sensor), parse_size(size)
    system = named_sensor(sensor, gsd)

    import numpy as np

    from acutance import simulate
    from acutance.report import target_truth_document

    pixels, truth = simulate.pulse(
        system,
        width_px=_width_px(system, width_px, width_m, angle, along),
        length_px=length,
        angle_deg=angle,
        orientation="along" if along else "across",
        shape=shape,
        dark=dark,
        right_dark=right_dark,
        bright=bright,
        snr=noise.snr,
        noise=noise.described(),
        ground_noise=simulate.GroundNoise() if ground_noise else None,
        rng=np.random.default_rng(seed),
    )
    files.write(pixels, system, target_truth_document(truth, system), seed)
    typer.echo(
        f"true width {truth.width_px:.4f} px, MTF at Nyquist {truth.mtf_nyquist}, RER {truth.rer}, "
        f"FWHM {truth.fwhm_px} px"
    )


def _width_px(
    system: Sensor, width_px: float | None, width_m: float | None, angle: float, along: bool
) -> float:
    from acutance.optics.sensor import normal_direction_deg

    if width_m is None:
        return 3.0 if width_px is None else width_px
    if width_px is not None:
        raise OptionError(
            f"--width-px {width_px:g} and --width-m {width_m:g} were both given: use one"
        )
    normal = normal_direction_deg(angle, "along" if along else "across")
    gsd_m = system.gsd_along_normal_m(normal)
    if gsd_m is None:
        raise OptionError(
            f"--width-m {width_m:g} needs a sensor with a GSD: give --gsd, or use --width-px"
        )
    return width_m / gsd_m


@with_groups
def bars(
    *,
    out: Out,
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    periods: Annotated[
        str, typer.Option(metavar="PX,PX,...", help="Distance of two bars in each group.")
    ] = "8,6,5,4,3.2,2.5,2",
    count: Annotated[int, typer.Option(metavar="N", help="Bars in a group.")] = 5,
    length: Annotated[float, typer.Option(metavar="PX", help="Length of the bars.")] = 24.0,
    angle: Angle = 0.0,
    along: Along = False,
    dark: Dark = 200.0,
    bright: Bright = 1200.0,
    noise: NoiseOptions,
    seed: Seed = 0,
) -> None:
    """Render groups of bars below one another."""
    files, system = SimulatedFiles.of(out, sensor), named_sensor(sensor, gsd)
    distances = tuple(numbers_of(periods))
    if not distances:
        raise OptionError(f"--periods {periods}: write numbers, as in 8,6,4")

    import numpy as np

    from acutance import simulate
    from acutance.report import target_truth_document

    pixels, truth = simulate.bars(
        system,
        periods_px=distances,
        count=count,
        length_px=length,
        angle_deg=angle,
        orientation="along" if along else "across",
        dark=dark,
        bright=bright,
        snr=noise.snr,
        noise=noise.described(),
        rng=np.random.default_rng(seed),
    )
    files.write(pixels, system, target_truth_document(truth, system), seed)
    for freq, mtf in zip(truth.freq_cpp, truth.mtf, strict=True):
        typer.echo(f"true MTF at {freq:.4f} cycles per pixel {mtf:.4f}")


@with_groups
def star(
    *,
    out: Out,
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    cycles: Annotated[int, typer.Option(metavar="N", help="Periods in a full turn.")] = 36,
    radius: Annotated[float, typer.Option(metavar="PX", help="Outer radius.")] = 52.0,
    wave: WaveOption = "sine",
    start: Annotated[float, typer.Option(metavar="DEG", help="Where a fan begins.")] = 0.0,
    sweep: Annotated[float, typer.Option(metavar="DEG", help="How far it goes.")] = 360.0,
    size: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Size of the image in pixels.")
    ] = "128,128",
    dark: Annotated[float, typer.Option(metavar="DN", help="Lowest level of the spokes.")] = 200.0,
    bright: Annotated[float, typer.Option(metavar="DN", help="Highest level.")] = 1200.0,
    noise: NoiseOptions,
    seed: Seed = 0,
) -> None:
    """Render a Siemens star."""
    if wave not in ("sine", "square"):
        raise OptionError(f"--wave {wave}: it has to be sine or square")
    files, shape = SimulatedFiles.of(out, sensor), parse_size(size)
    system = named_sensor(sensor, gsd)

    import numpy as np

    from acutance import simulate
    from acutance.report import target_truth_document

    pixels, truth = simulate.star(
        system,
        cycles=cycles,
        shape=shape,
        radius_px=radius,
        wave="square" if wave == "square" else "sine",
        start_deg=start,
        sweep_deg=sweep,
        dark=dark,
        bright=bright,
        snr=noise.snr,
        noise=noise.described(),
        rng=np.random.default_rng(seed),
    )
    files.write(pixels, system, target_truth_document(truth, system), seed)
    typer.echo(f"true mean MTF at Nyquist {float(truth.mtf_mean(0.5)):.4f}")


@with_groups
def points(
    *,
    out: Out,
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    layout: Annotated[
        str,
        typer.Option(metavar="NAME", help="columns: 20 mirrors in two; square: 4 by 4 of them."),
    ] = "columns",
    peak: Annotated[
        float, typer.Option(metavar="DN", help="What a centred mirror adds to its pixel.")
    ] = 1000.0,
    background: Annotated[
        float, typer.Option(metavar="DN", help="Level of the background.")
    ] = 200.0,
    noise: NoiseOptions,
    seed: Seed = 0,
) -> None:
    """Render an array of mirrors."""
    files, system = SimulatedFiles.of(out, sensor), named_sensor(sensor, gsd)

    import numpy as np

    from acutance import simulate
    from acutance.report import target_truth_document

    first = (12.0, 12.0)
    layouts = {
        "columns": simulate.mirror_columns(first),
        "square": simulate.mirror_square(first),
    }
    if layout not in layouts:
        raise OptionError(f"--layout {layout}: the layouts are {', '.join(layouts)}")
    pixels, truth = simulate.points(
        system,
        positions=layouts[layout],
        peak=peak,
        background=background,
        snr=noise.snr,
        noise=noise.described(),
        rng=np.random.default_rng(seed),
    )
    files.write(pixels, system, target_truth_document(truth, system), seed)
    across, along = truth.response("across").mtf_nyquist, truth.response("along").mtf_nyquist
    typer.echo(
        f"{len(truth.positions)} mirrors, true MTF at Nyquist {across} across, {along} along"
    )
