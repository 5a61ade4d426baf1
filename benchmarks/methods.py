"""Every method on one site, with and without grass: errors, deviations and what they promise.

The site of `acutance demo` (`acutance.simulate.brookings`): two edges of 32 by 64 px, a pulse of
3 px, 20 mirrors, four groups of bars and a star of 48 px, all of one sensor, and all combined.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from trials import command, publish, table, work_through

import acutance as ac
from acutance import optics
from acutance.curves import Response
from acutance.raster import Region
from acutance.simulate import PointsTruth, PulseTruth, SceneTarget
from acutance.targets import Measurement

GROUNDS = {"uniform ground": 0.0, "grass": 14.0}
NUMBERS = ("mtf_nyquist", "rer", "fwhm_px")


def sensor() -> ac.Sensor:
    """The published generic sensor."""
    blocks: list[optics.Block] = [
        optics.Gaussian(0.39), optics.Detector(), optics.Smear(0.25, "along"),
        optics.Butterworth(1.4),
    ]  # fmt: skip
    return ac.Sensor(blocks, gsd_m=0.7)


@dataclass(frozen=True)
class Draw:
    """One site, reproducible from its seed."""

    texture_std: float
    seeds: tuple[int, ...]


Errors = dict[str, tuple[tuple[float, float], ...]]
"""By method and direction: error and standard deviation of every number."""


def site_errors(draw: Draw) -> Errors:
    """All methods on one site."""
    scene = ac.simulate.brookings(
        sensor(), np.random.default_rng(draw.seeds), texture_std=draw.texture_std
    )
    image = np.asarray(scene.image, float)
    results: list[Measurement] = []
    found: Errors = {}
    for edge in scene.edges:
        one = ac.measure_edge(image, Region(edge.region))
        found[f"edge, {one.orientation}"] = _errors(one.response, edge.truth.response)
        results.append(one)
    for target in scene.targets:
        measured = _measured(image, target)
        results.append(measured)
        if isinstance(target.truth, PulseTruth):
            found["pulse, across"] = _errors(measured.response, target.truth.response)
        else:
            found |= _plane_errors(target.name, measured, scene.sensor)
    return found | _plane_errors("all combined", ac.combine(results), scene.sensor)


def _measured(image: np.ndarray, target: SceneTarget) -> Measurement:
    region, truth = Region(target.region), target.truth
    if isinstance(truth, PulseTruth):
        return ac.measure_pulse(image, region, width_px=truth.width_px)
    if isinstance(truth, PointsTruth):
        return ac.measure_points(image, region, positions=truth.positions)
    return (
        ac.measure_star(image, region) if target.kind == "star" else ac.measure_bars(image, region)
    )


def _plane_errors(name: str, measured: Measurement, sensor: ac.Sensor) -> Errors:
    found = {f"{name}, across": _errors(measured.across, sensor.response())}
    if name != "bars":
        found[f"{name}, along"] = _errors(measured.along, sensor.response(0.0, "along"))
    return found


def _errors(measured: Response, true: Response) -> tuple[tuple[float, float], ...]:
    pairs = ((getattr(measured, name), getattr(true, name)) for name in NUMBERS)
    return tuple((number.value - wanted.value, number.std) for number, wanted in pairs)


def row(name: str, draws: list[tuple[tuple[float, float], ...]]) -> list[str]:
    """One line of the table."""
    values = np.array(draws)
    cells = [name]
    for i in range(len(NUMBERS)):
        error, std = values[:, i].T
        cells += [f"{error.mean():+.4f}", f"{np.sqrt(np.mean(error**2)):.4f}", f"{std.mean():.4f}"]
    held = 100 * np.mean(np.abs(values[:, 0, 0]) < 1.96 * values[:, 0, 1])
    return [*cells, f"{held:.0f}"]


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=20).parse_args()
    head = ["method"]
    for name in ("MTF(0.5)", "RER", "FWHM / px"):
        head += [f"{name}: mean error", "rms error", "mean std"]
    parts = [
        f"{arguments.draws} sites for each ground. Held: per cent of the 95 % intervals of MTF at "
        "Nyquist that hold the truth."
    ]
    for number, (ground, std) in enumerate(GROUNDS.items()):
        jobs = [Draw(std, (arguments.seed, number, draw)) for draw in range(arguments.draws)]
        results = work_through(site_errors, jobs, arguments.processes, ground)
        names = list(results[0])
        rows = [row(name, [one[name] for one in results if name in one]) for name in names]
        parts += [f"## {ground.capitalize()}", table([*head, "held / %"], rows)]
    publish("Every method on one site", parts, arguments)


if __name__ == "__main__":
    main()
