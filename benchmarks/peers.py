"""Errors beside those of other programs, on the same edges.

Images of dark squares, each turned by an angle of its own, one sensor an image: the reference
systems, and sensors drawn at random from every family (`acutance.optics.population`). Each side is
measured in a region of 60 x 60 px about its middle, which holds the whole side, by the method
"spline" and by two published ones that are in use, as this package has them: "iso12233" (e-SFR)
and "sdsu-2005" (Fermi functions, Savitzky-Golay); and by MTF Mapper, where it is found on the path,
which finds the squares itself. The truth is the sensor's MTF along the normal of the side.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mtf_mapper import mtf_mapper_edges
from trials import TWO_SIDED_95, command, publish, table, work_through

import acutance as ac
from acutance.optics.population import FAMILIES, draw_sensor
from acutance.simulate.scene import Patch, add_patches
from acutance.targets.straight.options import EdgeOptions
from acutance.targets.straight.published import Iso12233Options, SdsuOptions

SNRS = (50.0, 100.0, 200.0)
SIDE_PX, PITCH_PX, REGION_PX, REACH_PX = 60, 130, 60, 60
SQUARES_ACROSS = 4
DARK, BRIGHT = 12000.0, 42000.0
FREQS_CPP = (0.25, 0.5)
METHODS = {
    "spline": EdgeOptions(),
    "iso12233": EdgeOptions(method_options=Iso12233Options(replicates=0)),
    "sdsu-2005": EdgeOptions(method_options=SdsuOptions(replicates=0)),
}
PROGRAMS = (*METHODS, "MTF Mapper")
_SAME_EDGE_PX = 12.0


@dataclass(frozen=True)
class Side:
    """One side of a square: its middle, the direction of its normal, and the true MTF there."""

    row: float
    col: float
    normal_deg: float
    truth: np.ndarray


@dataclass(frozen=True)
class Found:
    """Errors of the programs on one image.

    Attributes
    ----------
    kind : str
        Name of the system, or "family" and its name.
    snr : float
    error : (n, programs, freqs) array
        Found less true; NaN where a program has nothing.
    inside : (n, freqs) array
        Whether the 95 % intervals of the spline hold the truth; NaN where it refused.
    """

    kind: str
    snr: float
    error: np.ndarray
    inside: np.ndarray


def draw_image(
    sensor: ac.Sensor, snr: float, rng: np.random.Generator
) -> tuple[np.ndarray, list[Side]]:
    """Dark squares on bright ground, and their sides."""
    image = np.full(((SQUARES_ACROSS + 1) * PITCH_PX,) * 2, BRIGHT, np.float32)
    sides = []
    for number in range(SQUARES_ACROSS**2):
        row, col = (
            (1 + place) * PITCH_PX + rng.uniform(-0.5, 0.5)
            for place in divmod(number, SQUARES_ACROSS)
        )
        turn = rng.uniform(3, 28)
        square = Patch(row, col, SIDE_PX, SIDE_PX, turn, DARK - BRIGHT)
        add_patches(image, sensor, [square], reach_px=REACH_PX)
        sides += [_side(sensor, row, col, turn + quarter) for quarter in (0, 90, 180, 270)]
    image += rng.normal(0.0, (BRIGHT - DARK) / snr, image.shape).astype(np.float32)
    return image, sides


def _side(sensor: ac.Sensor, row: float, col: float, normal_deg: float) -> Side:
    x, y = math.cos(math.radians(normal_deg)), math.sin(math.radians(normal_deg))
    truth = np.abs(sensor.otf(x * np.array(FREQS_CPP), y * np.array(FREQS_CPP)))
    away = 0.5 * SIDE_PX
    return Side(row + away * y, col + away * x, normal_deg, truth)


def measured(job: tuple[str, float, int]) -> Found:
    """The errors on the image of one sensor."""
    kind, snr, seed = job
    rng = np.random.default_rng(seed)
    systems = ac.simulate.reference_systems()
    fits = False
    while not fits:
        sensor = systems.get(kind) or draw_sensor(kind.removeprefix("family "), rng)
        values, sides = draw_image(sensor, snr, rng)
        # Some kernels drawn overshoot by several contrasts: no product, and nothing for 16 bits.
        fits = values.min() > 0 and values.max() < np.iinfo(np.uint16).max
    image = values.round().astype(np.uint16)
    error = np.full((len(sides), len(PROGRAMS), len(FREQS_CPP)), math.nan)
    inside = np.full((len(sides), len(FREQS_CPP)), math.nan)
    mapper = mtf_mapper_edges(image, bright_targets=False)
    for number, side in enumerate(sides):
        top, left = round(side.row - REGION_PX / 2), round(side.col - REGION_PX / 2)
        box = image[top : top + REGION_PX, left : left + REGION_PX].astype(float)
        for program, (method, options) in enumerate(METHODS.items()):
            try:
                response = ac.measure_edge(box, method=method, options=options).response
            except ac.AcutanceError:
                continue
            own = [response.mtf(freq) for freq in FREQS_CPP]
            error[number, program] = [one.value for one in own] - side.truth
            if program == 0:
                z = error[number, 0] / [one.std for one in own]
                inside[number] = np.abs(z) < TWO_SIDED_95
        if mapper is not None:
            away = np.hypot(mapper.row - side.row, mapper.col - side.col)
            if away.size and away.min() < _SAME_EDGE_PX:
                nearest = int(np.argmin(away))
                error[number, -1] = [mapper.mtf(f)[nearest] for f in FREQS_CPP] - side.truth
    return Found(kind, snr, error, inside)


def _name(kind: str, found: Sequence[Found]) -> list[str]:
    """What a row is of, and how many sides every program has measured, of how many."""
    error, common = _common(found)
    return [f"{kind}, SNR {found[0].snr:g}", f"{error.shape[0]} of {common.size}"]


def _common(found: Sequence[Found]) -> tuple[np.ndarray, np.ndarray]:
    """Errors of the sides that every program has measured, and which of all those are."""
    error = np.concatenate([one.error for one in found])
    there = ~np.isnan(error).all(axis=(0, 2))
    common = ~np.isnan(error[:, there]).any(axis=(1, 2))
    return error[common], common


def _words(numbers: np.ndarray, form: str) -> list[str]:
    """A number of each program, empty where the program is not there."""
    return ["" if math.isnan(number) else format(number, form) for number in numbers]


def rms_row(kind: str, found: Sequence[Found]) -> list[str]:
    """RMS errors at 0.5, then at 0.25 cycles per pixel, and the coverage of the spline."""
    error, _ = _common(found)
    square = np.sqrt(np.mean(error**2, axis=0))
    inside = np.concatenate([one.inside for one in found])[:, 1]
    sizes = [*_words(square[:, 1], ".4f"), *_words(square[:, 0], ".4f")]
    return [*_name(kind, found), *sizes, f"{100 * np.nanmean(inside):.1f}"]


def bias_row(kind: str, found: Sequence[Found]) -> list[str]:
    """Mean errors at 0.5, then at 0.25 cycles per pixel."""
    mean = np.mean(_common(found)[0], axis=0)
    return [*_name(kind, found), *_words(mean[:, 1], "+.4f"), *_words(mean[:, 0], "+.4f")]


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=6)
    arguments = parser.parse_args()
    systems = ac.simulate.reference_systems()
    kinds = [*systems, *(f"family {name}" for name in FAMILIES for _ in range(arguments.draws))]
    cells = [(kind, snr) for snr in SNRS for kind in kinds]
    seeds = np.random.SeedSequence(arguments.seed).generate_state(len(cells))
    jobs = [(*cell, int(seed)) for cell, seed in zip(cells, seeds, strict=True)]
    found: list[Found] = work_through(measured, jobs, arguments.processes, "images")

    def rows(names: Sequence[str]) -> list[list[str]]:
        of = [[one for one in found if (one.kind, one.snr) == (name, snr)]
              for name in names for snr in SNRS]  # fmt: skip
        return [rms_row(each[0].kind, each) for each in of]

    drawn = [[one for one in found if one.kind not in systems and one.snr == snr] for snr in SNRS]
    columns = [f"{name}, {freq} c/px" for freq in ("0.5", "0.25") for name in PROGRAMS]
    head = ["RMS error of the MTF", "sides", *columns, "95 % intervals that hold"]
    parts = [
        f"Sides of dark squares of {SIDE_PX} px, turned by 3 to 28 degrees; contrast over noise "
        f"{', '.join(f'{snr:g}' for snr in SNRS)}. Errors over the sides that every program "
        "measured; how many of the 95 % intervals of the spline hold the MTF at 0.5 cycles per "
        "pixel. MTF Mapper states none.",
        "## Sensors drawn at random from eleven families",
        table(head, [rms_row("all families", each) for each in drawn]),
        table(["bias of the MTF", "sides", *columns],
              [bias_row("all families", each) for each in drawn]),
        "## Each family",
        table(head, rows([f"family {name}" for name in FAMILIES])),
        "## Reference systems",
        table(head, rows(list(systems))),
    ]  # fmt: skip
    publish("Beside other programs", parts, arguments)


if __name__ == "__main__":
    main()
