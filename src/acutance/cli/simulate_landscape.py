"""``acutance simulate landscape``: objects beside one another, and the truth of every edge."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acutance.cli.choices import parse_pair
from acutance.cli.noise import NoiseOptions
from acutance.cli.option_groups import with_groups
from acutance.cli.progress import progress_bar
from acutance.cli.scenes import Seed, SimulatedFiles, parse_size
from acutance.cli.sensor import SensorGsd, SensorName, named_sensor
from acutance.errors import OptionError

if TYPE_CHECKING:
    from acutance.optics import Sensor
    from acutance.raster import Box
    from acutance.simulate import SensorField
    from acutance.simulate.landscape_pixels import Canvas

__all__ = ["LANDSCAPE_EXAMPLE", "landscape"]

LANDSCAPE_EXAMPLE = (
    "  acutance simulate landscape --size 2000,2000 --snr 100 --seed 1 --out land.tif\n"
    "  acutance simulate landscape --corner-blur 0.3 --clean --out land.tif\n"
    "  acutance simulate landscape --size 10000,10000 --tilt-blur 0.5,0.2 --out land.tif\n"
    "  acutance edge land.tif --roi land.truth.geojson --json"
)


@dataclass(frozen=True)
class BesideOptions:
    """Shares of the borders beside which something lies."""

    rims: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Borders with a bright or dark rim; 0.12.")
    ] = None
    gutters: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Borders with a dark line; 0.08.")
    ] = None
    shadows: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Borders that cast a shadow; 0.1.")
    ] = None
    side_roads: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Borders beside a road; 0.1.")
    ] = None
    neighbours: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Borders beside another field; 0.12.")
    ] = None

    def shares(self, clean: bool) -> dict[str, Any]:
        """What was given by name; nothing lies beside any border if `clean`."""
        given = {one.name: getattr(self, one.name) for one in fields(self)}
        shares = {name: share for name, share in given.items() if share is not None}
        if not clean:
            return shares
        if shares:
            named = ", ".join("--" + name.replace("_", "-") for name in shares)
            raise OptionError(
                f"--clean leaves nothing beside the borders: leave it out, or {named}"
            )
        return dict.fromkeys(given, 0.0)


@with_groups
def landscape(
    *,
    out: Annotated[
        str,
        typer.Option(
            metavar="FILE",
            help="The image, .tif; its edges go next to it as .truth.geojson, in pixels.",
        ),
    ],
    sensor: SensorName = "generic-2005",
    gsd: SensorGsd = None,
    corner_blur: Annotated[
        float,
        typer.Option(
            metavar="PX", min=0.0, help="Gaussian blur added in the corners, none in the middle."
        ),
    ] = 0.0,
    tilt_blur: Annotated[
        str | None,
        typer.Option(
            metavar="ACROSS,ALONG",
            help="Gaussian blurs of a tilted focus in px, in the last column; none in the first.",
        ),
    ] = None,
    size: Annotated[
        str, typer.Option(metavar="ROWS,COLS", help="Size of the image in pixels.")
    ] = "1000,1000",
    density: Annotated[
        float, typer.Option(metavar="N", help="Objects wanted in a million pixels.")
    ] = 45.0,
    clean: Annotated[
        bool, typer.Option("--clean", help="Nothing beside any border: the next five are 0.")
    ] = False,
    beside: BesideOptions,
    soft: Annotated[
        float, typer.Option(metavar="SHARE", help="Borders of fields that are soft on the ground.")
    ] = 0.25,
    soft_normal: Annotated[
        str,
        typer.Option(
            metavar="LOW,HIGH",
            help="Directions of the normals of borders that may be soft, degrees; 135,225: across.",
        ),
    ] = "0,180",
    curved: Annotated[
        float, typer.Option(metavar="SHARE", help="Borders of fields that are arcs.")
    ] = 0.2,
    texture: Annotated[
        str, typer.Option(metavar="LOW,HIGH", help="Texture, as shares of the contrast.")
    ] = "0.01,0.04",
    slope: Annotated[
        float, typer.Option(metavar="SHARE", help="Slopes, as shares of the contrast per pixel.")
    ] = 0.0005,
    half_width: Annotated[
        float,
        typer.Option(metavar="PX", min=4.0, help="How far the regions reach beside the edges."),
    ] = 20.0,
    noise: NoiseOptions,
    seed: Seed = 0,
) -> None:
    """Render fields, roofs, roads and discs of any direction, with the truth of every edge.

    Beside borders lie rims, gutters, shadows, roads and neighbours; ground slopes and has texture.
    """
    files = SimulatedFiles.of(out, sensor, truth_ending=".geojson")
    shape, system = parse_size(size), named_sensor(sensor, gsd)
    shares = beside.shares(clean)
    soft_normals = parse_pair("--soft-normal", soft_normal, "lowest and highest, as in 45,135")
    textures = parse_pair("--texture", texture, "lowest and highest, as in 0.01,0.04")

    import numpy as np

    from acutance import simulate
    from acutance.report import landscape_document

    options = simulate.LandscapeOptions(
        density_per_mpx=density,
        soft=soft,
        soft_normal_deg=soft_normals,
        curved=curved,
        texture=textures,
        slope_per_px=slope,
        **shares,
    )
    field = _field(system, shape, corner_blur, tilt_blur)
    tiles, truth = simulate.landscape_tiles(
        field,
        shape=shape,
        options=options,
        snr=noise.snr,
        noise=noise.described(),
        rng=np.random.default_rng(seed),
    )
    with progress_bar("truth of edges") as progress:
        document = landscape_document(truth, half_width_px=half_width, progress=progress)
    with progress_bar("image, megapixels") as progress:
        files.write_tiles(_counted(tiles, shape, progress), shape, system, document, seed)
    found = Counter(edge.kind(half_width) for edge in truth.edges)
    listed = ", ".join(f"{kind} {count}" for kind, count in found.most_common())
    typer.echo(f"{len(truth.edges)} edges, by what lies within {half_width:g} px: {listed}")


def _field(
    sensor: Sensor, shape: tuple[int, int], corner_blur: float, tilt_blur: str | None
) -> Sensor | SensorField:
    """The sensor, and how its blur changes over the image."""
    from acutance.simulate import SoftCorners, TiltedFocus

    if tilt_blur is None:
        return SoftCorners(sensor, shape, corner_blur) if corner_blur > 0 else sensor
    if corner_blur > 0:
        raise OptionError(
            f"--corner-blur {corner_blur:g} and --tilt-blur {tilt_blur} were both given: use one"
        )
    across, along = parse_pair("--tilt-blur", tilt_blur, "blur across and along, as in 0.4,0.2")
    return TiltedFocus(sensor, shape, across, along)


def _counted(
    tiles: Iterable[tuple[Box, Canvas]],
    shape: tuple[int, int],
    progress: Callable[[int, int], None] | None,
) -> Iterator[tuple[Box, Canvas]]:
    """Tiles with their pixels counted in millions."""
    done = 0
    for box, pixels in tiles:
        yield box, pixels
        done += pixels.size
        if progress is not None:
            progress(math.ceil(done / 1e6), math.ceil(shape[0] * shape[1] / 1e6))
