"""``acutance simulate pair``: the same ground seen by two sensors."""

from __future__ import annotations

from typing import Annotated

import typer

from acutance.cli.choices import parse_pair
from acutance.cli.output import check_output
from acutance.cli.scenes import Seed, SimulatedFiles, parse_size
from acutance.cli.sensor import SensorName, named_sensor
from acutance.cli.terminal import say

__all__ = ["PAIR_EXAMPLE", "pair"]

PAIR_EXAMPLE = "  acutance simulate pair --ratio 2 --snr 100 --out low.tif --high high.tif"
_ORIGIN_M = (500_000.0, 5_000_000.0)
_CRS = "EPSG:32633"


def pair(
    out: Annotated[
        str,
        typer.Option(
            metavar="FILE", help="The low image, .tif; the truth goes next to it as .truth.json."
        ),
    ],
    high: Annotated[str, typer.Option(metavar="FILE", help="The high image, .tif.")],
    sensor: SensorName = "gaussian",
    high_sensor: Annotated[
        str, typer.Option(metavar="FILE|NAME", help="The sensor of the high image.")
    ] = "gaussian",
    ratio: Annotated[
        float, typer.Option(metavar="R", help="Ratio of the GSDs, in quarters.")
    ] = 2.0,
    size: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Size of the low image in pixels.")
    ] = "128,128",
    shift: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Error of registration in low pixels.")
    ] = "0,0",
    gain: Annotated[float, typer.Option(help="Of the low image against the high one.")] = 1.0,
    offset: Annotated[float, typer.Option(metavar="DN", help="Of the low image.")] = 0.0,
    gsd: Annotated[float, typer.Option(metavar="M", help="GSD of the low image in metres.")] = 20.0,
    dark: Annotated[float, typer.Option(metavar="DN", help="Level of the darkest field.")] = 200.0,
    bright: Annotated[
        float, typer.Option(metavar="DN", help="Level of the brightest field.")
    ] = 1200.0,
    snr: Annotated[
        float | None,
        typer.Option(metavar="RATIO", help="Contrast over noise; no noise if not given."),
    ] = None,
    seed: Seed = 0,
) -> None:
    """Render a pair of georeferenced images of fields and texture, by two sensors."""
    inputs = (sensor, high_sensor)
    files, shape = SimulatedFiles.of(out, *inputs), parse_size(size)
    fine = check_output("--high", high, (".tif", ".tiff"), keep=inputs)
    rows, cols = parse_pair("--shift", shift, "rows and columns, as in 0.4,-1.2")

    system = named_sensor(sensor, gsd)
    # A ratio that is none is refused with the images.
    reference = named_sensor(high_sensor, gsd / ratio if ratio > 0 else None)

    import numpy as np

    from acutance import simulate
    from acutance.raster import Box, write_geotiff_tiles
    from acutance.report import json_text, sensor_document

    coarse, detailed, truth = simulate.pair(
        system,
        reference,
        ratio=ratio,
        shape=shape,
        shift_px=(rows, cols),
        gain=gain,
        offset=offset,
        dark=dark,
        bright=bright,
        snr=snr,
        rng=np.random.default_rng(seed),
    )
    for file, image, gsd_m in ((files.image, coarse, gsd), (fine, detailed, gsd / ratio)):
        transform = (gsd_m, 0.0, _ORIGIN_M[0], 0.0, -gsd_m, _ORIGIN_M[1])
        whole = Box.whole((image.shape[0], image.shape[1]))
        write_geotiff_tiles(
            file.place, whole.shape, [(whole, image)], transform=transform, crs=_CRS
        )
        say(f"wrote {file.path}")
    document = {
        "schema": "acutance/truth/1",
        **truth.to_dict(),
        "sensor": sensor_document(system),
        "high_sensor": sensor_document(reference),
        "snr": snr,
        "seed": seed,
    }
    files.truth.deliver(json_text(document))
    across, along = (truth.response(axis).mtf_nyquist for axis in ("across", "along"))
    typer.echo(f"true MTF at Nyquist {across} across, {along} along")
