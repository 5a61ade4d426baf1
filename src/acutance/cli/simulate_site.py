"""``acutance simulate site | checkerboard``: scenes of several targets, and their truths."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from acutance.cli.noise import NoiseOptions, Quantum, Saturation, ShotGain, described_noise
from acutance.cli.option_groups import with_groups
from acutance.cli.scenes import Out, Seed, SimulatedFiles, parse_size
from acutance.cli.sensor import SensorGsd, SensorName, named_sensor
from acutance.errors import OptionError

__all__ = ["SITE_EXAMPLES", "checkerboard", "site"]

SITE_EXAMPLES = {
    "site": "  acutance simulate site --out site.tif\n"
    "  acutance simulate site --targets 1000 --size 4000,4000 --out scene.tif",
    "checkerboard": "  acutance simulate checkerboard --tile 40 --size 160,160 --snr 100 "
    "--out board.tif",
}


def site(
    out: Out,
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    targets: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Fill the image with N tarps, no campaign."),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(metavar="ROWS,COLS", help="Size of the image, with --targets; 1000,1000."),
    ] = None,
    angle: Annotated[
        float,
        typer.Option(metavar="DEG", help="Tilt of the targets: 2 to 14, with --targets -45 to 45."),
    ] = 6.0,
    texture: Annotated[
        float, typer.Option(metavar="DN", help="Standard deviation of the grass.")
    ] = 14.0,
    read_noise: Annotated[
        float, typer.Option(metavar="DN", help="Standard deviation of white noise.")
    ] = 8.0,
    shot_gain: ShotGain = None,
    quantum: Quantum = None,
    saturation: Saturation = None,
    seed: Seed = 0,
) -> None:
    """Render a campaign on grass: edge and pulse tarps, mirrors, bars, a star."""
    if size is not None and targets is None:
        raise OptionError(
            f"--size {size} belongs to --targets: the campaign has a size of its own, leave it out"
        )
    files, system = SimulatedFiles.of(out, sensor), named_sensor(sensor, gsd)
    shape = parse_size(size or "1000,1000")

    import numpy as np

    from acutance import simulate
    from acutance.report import scene_document

    rng = np.random.default_rng(seed)
    noise = described_noise(read_noise, shot_gain, quantum, saturation)
    if targets is None:
        scene = simulate.brookings(system, rng, turn_deg=angle, texture_std=texture, noise=noise)
    else:
        tarps = simulate.tarp_rows(shape, targets, turn_deg=angle)
        with typer.progressbar(length=targets, label="rendering", file=sys.stderr) as bar:
            scene = simulate.render_site(
                system,
                tarps,
                shape,
                texture_std=texture,
                noise=noise,
                rng=rng,
                progress=lambda done, total: bar.update(1),
                description=f"{targets} tarps on grass, turned by {angle:g} deg",
            )
    files.write(scene.image, system, scene_document(scene), seed)
    typer.echo(f"{scene.description}: {len(scene.edges)} edges, {len(scene.targets)} other targets")


@with_groups
def checkerboard(
    *,
    out: Out,
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    tile: Annotated[
        float, typer.Option(metavar="PX", help="Side of a tile, 16 px or more.")
    ] = 28.0,
    angle: Annotated[
        float, typer.Option(metavar="DEG", help="Tilt of the board, -45 to 45.")
    ] = 7.0,
    size: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Size of the image in pixels.")
    ] = "120,120",
    dark: Annotated[float, typer.Option(metavar="DN", help="Level of the dark tiles.")] = 200.0,
    bright: Annotated[
        float, typer.Option(metavar="DN", help="Level of the bright tiles.")
    ] = 1200.0,
    ground: Annotated[float, typer.Option(metavar="DN", help="Level around the board.")] = 500.0,
    texture: Annotated[
        float, typer.Option(metavar="DN", help="Standard deviation of the ground around it.")
    ] = 0.0,
    noise: NoiseOptions,
    seed: Seed = 0,
) -> None:
    """Render a checkerboard of two by two tiles: four edges, two across and two along."""
    files, shape = SimulatedFiles.of(out, sensor), parse_size(size)
    system = named_sensor(sensor, gsd)

    import numpy as np

    from acutance import simulate
    from acutance.report import scene_document

    scene = simulate.checkerboard(
        system,
        shape=shape,
        tile_px=tile,
        turn_deg=angle,
        dark=dark,
        bright=bright,
        ground=ground,
        texture_std=texture,
        snr=noise.snr,
        noise=noise.described(),
        rng=np.random.default_rng(seed),
    )
    files.write(scene.image, system, scene_document(scene), seed)
    typer.echo(f"{scene.description}: {len(scene.edges)} edges")
    for edge in scene.edges:
        typer.echo(f"{edge.name}: true MTF at Nyquist {edge.truth.mtf_nyquist}")
