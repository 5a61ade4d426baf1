"""``acutance demo``: a site is rendered, measured, and compared with its truth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from acutance.cli.output import check_output
from acutance.cli.terminal import say
from acutance.errors import AcutanceError, OptionError

if TYPE_CHECKING:
    from acutance.measure.measurement import Measurement
    from acutance.optics import Sensor
    from acutance.raster import Image
    from acutance.report.html import Section
    from acutance.simulate import Scene, SceneEdge

__all__ = ["EXAMPLE", "demo"]

EXAMPLE = "\b\nExample:\n  acutance demo demo"
GSD_M = 0.7
COMPARED = ("mtf_nyquist", "rer", "fwhm_px")


def demo(
    folder: Annotated[
        str, typer.Argument(metavar="DIR", help="Where to write; made if it does not exist.")
    ],
    seed: Annotated[int, typer.Option(metavar="N", help="Of the random numbers.")] = 1,
) -> None:
    """Measure a simulated site and compare with its truth.

    Every edge is measured by every method; an HTML report shows the result.
    """
    target = _make_folder(folder)
    index = check_output("DIR", str(target / "index.html"), (".html",))

    import numpy as np

    from acutance import simulate
    from acutance.measure import measure_edges
    from acutance.raster import open_image, write_geotiff
    from acutance.report.html import render_report
    from acutance.report.sections import target_sections

    sensor = _demonstration_sensor()
    scene = simulate.site(sensor, np.random.default_rng(seed))
    say(f"rendering: {scene.description}")
    path = target / "site.tif"
    write_geotiff(path, scene.image.astype(np.float32), gsd_m=GSD_M)
    _write_truths(target, scene)
    image = open_image(path)
    say("finding and measuring every edge")
    result = measure_edges(image)
    by_edge = {}
    for edge in scene.edges:
        say(f"measuring the {edge.name} edge by every method")
        by_edge[edge.name] = _measure_by_all(image, edge)
        _write_comparison(target, edge, by_edge[edge.name])
    sections = (
        _introduction(scene),
        _truth_section(scene.edges, by_edge),
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


def _demonstration_sensor() -> Sensor:
    """Optics, pixel, motion and electronics of the published generic sensor, with 0.7 m pixels."""
    from acutance import optics

    blocks: list[optics.Block] = [
        optics.Gaussian(0.39),
        optics.Detector(1.0),
        optics.Smear(0.25, "along"),
        optics.Butterworth(1.4),
    ]
    return optics.Sensor(blocks, gsd_m=GSD_M)


def _measure_by_all(image: Image, edge: SceneEdge) -> list[Measurement]:
    """One edge by every method that can measure it; the others are named on stderr."""
    from acutance.measure import METHODS, measure_edge
    from acutance.raster import Region

    found = []
    for method in METHODS:
        try:
            found.append(measure_edge(image, Region(edge.region), method=method))
        except AcutanceError as error:
            say(f"  {method}: {error}")
    return found


def _write_truths(folder: Path, scene: Scene) -> None:
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
    check_output("DIR", str(folder / "truth.json"), (".json",)).write(json_text(document))


def _write_comparison(folder: Path, edge: SceneEdge, measurements: Sequence[Measurement]) -> None:
    from acutance.report import comparison_report

    page = check_output("DIR", str(folder / _page_name(edge)), (".html",))
    page.write(comparison_report(measurements, truth=edge.truth.response))


def _page_name(edge: SceneEdge) -> str:
    return f"edge-{edge.name}.html"


def _introduction(scene: Scene) -> Section:
    from acutance.report.html import Section

    blocks = ", ".join(type(block).__name__ for block in scene.sensor.blocks)
    return Section(
        "What this is",
        paragraphs=(
            f"{scene.description}, with grass and a road around it, as seen by a sensor made of "
            f"{blocks} with pixels of {GSD_M:g} m.",
            "Because the image is simulated, the true curves are known: every number below can be "
            "compared with what it should be.",
        ),
    )


def _truth_section(edges: Sequence[SceneEdge], by_edge: dict[str, list[Measurement]]) -> Section:
    """A table of all edges by all methods beside the truth, and where to read more."""
    from acutance.report.html import Link, Section, Table
    from acutance.report.wording import metric_words, word_estimate

    rows = []
    for edge in edges:
        truths = [getattr(edge.truth.response, name) for name in COMPARED]
        true_words = (word_estimate(true).value for true in truths)
        rows.append((edge.name, edge.truth.orientation, "truth", *true_words, ""))
        for one in by_edge[edge.name]:
            numbers = [getattr(one, name) for name in COMPARED]
            off = (numbers[0].value - truths[0].value) / numbers[0].std
            words = (word_estimate(number).value_and_std for number in numbers)
            rows.append(("", "", one.method, *words, f"{off:+.1f}".replace("-", "−")))
    columns = (
        "Edge",
        "Direction",
        "Method",
        *(metric_words(name).label_with_unit for name in COMPARED),
        "MTF off by [std]",
    )
    return Section(
        "Against the truth",
        tables=(Table(columns, tuple(rows), "lllrrrr"),),
        links=tuple(
            Link(f"The {edge.name} edge by every method: curves and differences", _page_name(edge))
            for edge in edges
        ),
    )
