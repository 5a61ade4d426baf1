"""``acutance demo``: a site and a pulse tarp are rendered, measured, compared with their truth."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.output import check_output
from acutance.cli.terminal import say
from acutance.errors import AcutanceError, OptionError

if TYPE_CHECKING:
    import numpy as np

    from acutance.measure.measurement import Measurement
    from acutance.optics import Sensor
    from acutance.raster import Image, Region
    from acutance.report.html import Section
    from acutance.simulate import PulseTruth, Scene, Truth

__all__ = ["EXAMPLE", "demo"]

EXAMPLE = "\b\nExample:\n  acutance demo demo"
GSD_M = 0.7
TARP_GSD_M = 2.8
TARP_WIDTH_M = 8.83
COMPARED = ("mtf_nyquist", "rer", "fwhm_px")


@dataclass(frozen=True)
class Target:
    """A target whose truth is known, and what was measured of it.

    Parameters
    ----------
    name : str
        What it is called: "upper edge".
    page : str
        Name of the page that compares the methods.
    truth : Truth or PulseTruth
    measurements : sequence of Measurement
        One a method.
    true_width_px : float, optional
        Of a pulse.
    """

    name: str
    page: str
    truth: Truth | PulseTruth
    measurements: Sequence[Measurement]
    true_width_px: float | None = None


def demo(
    folder: Annotated[
        str, typer.Argument(metavar="DIR", help="Where to write; made if it does not exist.")
    ],
    seed: Annotated[int, typer.Option(metavar="N", help="Of the random numbers.")] = 1,
) -> None:
    """Measure a simulated site and a pulse tarp, and compare with their truth.

    Every edge and the pulse are measured by every method; an HTML report shows the result.
    """
    place = _make_folder(folder)
    index = check_output("DIR", str(place / "index.html"), (".html",))

    import numpy as np

    from acutance import simulate
    from acutance.measure import measure_edges
    from acutance.raster import open_image, write_geotiff
    from acutance.report.html import render_report
    from acutance.report.sections import target_sections

    scene = simulate.site(_demonstration_sensor(GSD_M), np.random.default_rng(seed))
    say(f"rendering: {scene.description}")
    path = place / "site.tif"
    write_geotiff(path, scene.image.astype(np.float32), gsd_m=GSD_M)
    image = open_image(path)
    say("finding and measuring every edge")
    result = measure_edges(image)
    tarp = _measure_tarp(place / "pulse.tif", np.random.default_rng([seed, 1]))
    targets = (*_measure_edges_of(scene, image), tarp)
    _write_truths(place, scene, tarp)
    for target in targets:
        _write_comparison(place, target)
    sections = (
        _introduction(scene),
        _truth_section(targets),
        *target_sections(result, backdrop=image.read(), command=f"acutance edge {path} --all"),
    )
    index.write(render_report("A calibration site, measured", str(path), sections))
    typer.echo(f"open {index.path}")


def _make_folder(name: str) -> Path:
    folder = Path(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OptionError(f"the folder {name} cannot be made ({reason}): give another") from error
    return folder


def _demonstration_sensor(gsd_m: float) -> Sensor:
    """Optics, pixel, motion and electronics of the published generic sensor."""
    from acutance import optics

    blocks: list[optics.Block] = [
        optics.Gaussian(0.39),
        optics.Detector(1.0),
        optics.Smear(0.25, "along"),
        optics.Butterworth(1.4),
    ]
    return optics.Sensor(blocks, gsd_m=gsd_m)


def _measure_edges_of(scene: Scene, image: Image) -> list[Target]:
    """Every edge of the site by every method."""
    from acutance.measure import METHODS
    from acutance.raster import Region

    found = []
    for edge in scene.edges:
        say(f"measuring the {edge.name} edge by every method")
        region = Region(edge.region)
        measurements = _measure_by_all(METHODS, partial(_measure_edge, image, region))
        found.append(
            Target(f"{edge.name} edge", f"edge-{edge.name}.html", edge.truth, measurements)
        )
    return found


def _measure_edge(image: Image, region: Region, method: str) -> Measurement:
    from acutance.measure import measure_edge

    return measure_edge(image, region, method=method)


def _measure_tarp(path: Path, rng: np.random.Generator) -> Target:
    """A tarp on grass, as wide as the blue one of Brookings, rendered and measured."""
    import numpy as np

    from acutance import simulate
    from acutance.measure import PULSE_METHODS, measure_pulse
    from acutance.raster import open_image, write_geotiff

    say(f"rendering: a tarp of {TARP_WIDTH_M:g} m on grass, pixels of {TARP_GSD_M:g} m")
    pixels, truth = simulate.pulse(
        _demonstration_sensor(TARP_GSD_M),
        width_px=TARP_WIDTH_M / TARP_GSD_M,
        shape=(64, 44),
        dark=330.0,
        bright=900.0,
        right_dark=345.0,
        length_px=46.0,
        noise=simulate.Noise(read=7.0),
        ground_noise=simulate.GroundNoise(variance=0.6),
        rng=rng,
    )
    write_geotiff(path, pixels.astype(np.float32), gsd_m=TARP_GSD_M)
    image = open_image(path)
    say("measuring the pulse tarp by every method")
    measurements = _measure_by_all(
        PULSE_METHODS, lambda name: measure_pulse(image, width_m=TARP_WIDTH_M, method=name)
    )
    return Target("pulse tarp", "pulse-tarp.html", truth, measurements, truth.width_px)


def _measure_by_all(
    methods: Collection[str], measure: Callable[[str], Measurement]
) -> list[Measurement]:
    """By every method that can measure the target; the others are named on stderr."""
    found = []
    for name in methods:
        try:
            found.append(measure(name))
        except AcutanceError as error:
            say(f"  {name}: {error}")
    return found


def _write_truths(folder: Path, scene: Scene, tarp: Target) -> None:
    from acutance.report import json_text, truth_document

    document = {
        "schema": "acutance/scene/1",
        "description": scene.description,
        "edges": {
            edge.name: {
                "region": edge.region.tolist(),
                "truth": truth_document(edge.truth, scene.sensor),
            }
            for edge in scene.edges
        },
    }
    pulse = truth_document(tarp.truth, _demonstration_sensor(TARP_GSD_M))
    for name, content in (("truth.json", document), ("pulse.truth.json", pulse)):
        check_output("DIR", str(folder / name), (".json",)).write(json_text(content))


def _write_comparison(folder: Path, target: Target) -> None:
    from acutance.report import comparison_report

    page = check_output("DIR", str(folder / target.page), (".html",))
    page.write(
        comparison_report(
            target.measurements, truth=target.truth.response, true_width_px=target.true_width_px
        )
    )


def _introduction(scene: Scene) -> Section:
    from acutance.report.html import Section

    blocks = ", ".join(type(block).__name__ for block in scene.sensor.blocks)
    return Section(
        "What this is",
        paragraphs=(
            f"{scene.description}, with grass and a road around it, as seen by a sensor made of "
            f"{blocks} with pixels of {GSD_M:g} m. And in an image of its own a pulse: a tarp "
            f"{TARP_WIDTH_M:g} m wide on grass, seen by the same sensor with pixels of "
            f"{TARP_GSD_M:g} m.",
            "Because the images are simulated, the true curves are known: every number below can "
            "be compared with what it should be.",
        ),
    )


def _truth_section(targets: Sequence[Target]) -> Section:
    """A table of all targets by all methods beside the truth, and where to read more."""
    from acutance.report.html import Link, Section, Table
    from acutance.report.wording import metric_words, word_estimate

    rows = []
    for target in targets:
        truth, width = target.truth, target.true_width_px
        truths = [getattr(truth.response, name) for name in COMPARED]
        true_words = (word_estimate(true).value for true in truths)
        true_width = "" if width is None else f"{width:.4f}"
        rows.append((target.name, truth.orientation, "truth", *true_words, true_width, ""))
        for one in target.measurements:
            numbers = [getattr(one, name) for name in COMPARED]
            off = (numbers[0].value - truths[0].value) / numbers[0].std
            words = (word_estimate(number).value_and_std for number in numbers)
            found = "" if one.width_px is None else word_estimate(one.width_px).value_and_std
            rows.append(("", "", one.method, *words, found, f"{off:+.1f}".replace("-", "−")))
    columns = (
        "Target",
        "Direction",
        "Method",
        *(metric_words(name).label_with_unit for name in (*COMPARED, "width_px")),
        "MTF off by [std]",
    )
    return Section(
        "Against the truth",
        tables=(Table(columns, tuple(rows), "lllrrrrr"),),
        links=tuple(
            Link(f"The {target.name} by every method: curves and differences", target.page)
            for target in targets
        ),
    )
