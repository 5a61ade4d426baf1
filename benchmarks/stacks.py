"""Time, memory and accuracy of thousands of given regions of one image.

The image holds squares turned by six angles, seen by a Gaussian of 0.4 px through a pixel at SNR
100; a region of 60 x 60 px lies about the middle of every side. `acutance.each_edge` hands out a
record of each: all numbers with their standard deviations, curves, covariance, checks and verdict.
The plain 4x-binned e-SFR (benchmarks/speed.py) measures the same regions in the same run: it finds
no edge, trims nothing and has no uncertainty. MTF Mapper, where it is found on the path, finds the
squares itself and measures every side, without standard deviations. Times are of the processor, but
those of several workers and of one are of the clock. The first edge of a process is timed in a
fresh one, from the import of acutance to the numbers; compiled loops and the byte code of modules
were kept by an earlier process, as of any installed package.
"""

from __future__ import annotations

import math
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from mtf_mapper import MapperEdges, mtf_mapper_edges
from speed import plain_esfr
from trials import TWO_SIDED_95, command, publish, table

import acutance as ac
from acutance.simulate.scene import Patch, add_patches

SENSOR = ac.simulate.reference_systems()["gaussian"]
ANGLES_DEG = (3.0, 6.0, 10.0, 15.0, 22.0, 30.0)
SIDE_PX, PITCH_PX, REGION_PX = 96, 180, 60
DARK, CONTRAST, SNR = 2000.0, 20000.0, 100.0

FIRST_EDGE = """
import numpy as np, time
import acutance as ac
image = np.load("{path}")
found = ac.measure_edge(image)
found.mtf_nyquist, found.rer, found.fwhm_px
print(time.process_time())
"""


@dataclass(frozen=True)
class Squares:
    """An image of squares, and the regions about their sides.

    Attributes
    ----------
    image : (rows, cols) uint16 array
    regions : list of (row, col, height, width)
    normal_deg : list of float
        Direction of every side's normal.
    """

    image: np.ndarray
    regions: list[tuple[int, int, int, int]]
    normal_deg: list[float]


def draw_squares(regions: int, seed: int) -> Squares:
    """As many squares as have so many sides."""
    rng = np.random.default_rng(seed)
    count = math.ceil(regions / 4)
    across = math.ceil(math.sqrt(count))
    image = np.full((across * PITCH_PX,) * 2, DARK, np.float32)
    boxes, normals = [], []
    for number in range(count):
        row, col = (
            (place + 0.5) * PITCH_PX + rng.uniform(-0.5, 0.5) for place in divmod(number, across)
        )
        turn = ANGLES_DEG[number % len(ANGLES_DEG)]
        add_patches(image, SENSOR, [Patch(row, col, SIDE_PX, SIDE_PX, turn, CONTRAST)])
        for normal in (turn, turn + 90, turn + 180, turn + 270):
            away = 0.5 * SIDE_PX
            middle_row = row + away * math.sin(math.radians(normal))
            middle_col = col + away * math.cos(math.radians(normal))
            corner = (round(middle - REGION_PX / 2) for middle in (middle_row, middle_col))
            boxes.append((*corner, REGION_PX, REGION_PX))
            normals.append(normal)
    image += rng.normal(0.0, CONTRAST / SNR, image.shape).astype(np.float32)
    return Squares(image.round().astype(np.uint16), boxes[:regions], normals[:regions])


def processor_time(work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds of this process and its children, and what the work gave."""
    start = sum(resource.getrusage(who).ru_utime for who in _WHO)
    found = work()
    return sum(resource.getrusage(who).ru_utime for who in _WHO) - start, found


_WHO = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


def shortest(work: Callable[[], Any], repeats: int = 9) -> float:
    """Shortest processor time of some repetitions."""
    taken = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        taken.append(time.process_time() - start)
    return min(taken)


def numbers_of_all(squares: Squares, workers: int = 1) -> np.ndarray:
    """MTF at Nyquist and its standard deviation of every region, (n, 2); NaN where rejected."""
    found = []
    for one in ac.each_edge(squares.image, squares.regions, workers=workers):
        if isinstance(one, ac.Record):
            (direction,) = one.directions.values()
            found.append((direction.mtf_nyquist.value, direction.mtf_nyquist.std))
        else:
            found.append((math.nan, math.nan))
    return np.array(found)


def plain_of_all(squares: Squares) -> list[float]:
    """The plain e-SFR of every region, its edge upright."""
    found = []
    for (row, col, height, width), normal in zip(squares.regions, squares.normal_deg, strict=True):
        cut = squares.image[row : row + height, col : col + width].astype(float)
        upright = cut if abs(math.cos(math.radians(normal))) > 0.7 else np.ascontiguousarray(cut.T)
        found.append(plain_esfr(upright))
    return found


def true_nyquist(normal_deg: Sequence[float]) -> np.ndarray:
    """MTF at 0.5 cycles per pixel along normals."""
    along = np.radians(normal_deg)
    return np.abs(SENSOR.otf(0.5 * np.cos(along), 0.5 * np.sin(along)))


def first_edge(image: np.ndarray) -> float:
    """Processor time from the start of a process to the numbers of one edge."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "edge.npy"
        np.save(path, image)
        code = [sys.executable, "-c", FIRST_EDGE.format(path=path)]
        kept = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
        taken = [
            float(subprocess.run(code, capture_output=True, text=True, check=True, env=kept).stdout)
            for _ in range(4)
        ]
    return min(taken[1:])


def main() -> None:
    parser = command(__doc__.partition("\n")[0], draws=4356)
    arguments = parser.parse_args()
    squares = draw_squares(arguments.draws, arguments.seed)
    few = Squares(squares.image, squares.regions[:24], squares.normal_deg[:24])
    numbers_of_all(few)
    plain_of_all(few)
    plain, esfr = processor_time(lambda: plain_of_all(squares))
    wall = time.perf_counter()
    one, found = processor_time(lambda: numbers_of_all(squares))
    wall_one = time.perf_counter() - wall
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    wall = time.perf_counter()
    again = numbers_of_all(squares, workers=2)
    wall_two = time.perf_counter() - wall
    if not np.array_equal(found, again, equal_nan=True):
        raise SystemExit("two workers give other numbers than one")
    count, truth = len(squares.regions), true_nyquist(squares.normal_deg)
    mapper = mtf_mapper_edges(squares.image, bright_targets=True)
    times = [
        ("plain 4x-binned e-SFR, without deviations", plain, "1.00"),
        ("each_edge, records with checks and verdict", one, f"{one / plain:.2f}"),
        *mapper_time(mapper, count, plain),
    ]
    error = found[:, 0] - truth
    accuracy = [
        accuracy_row("plain 4x-binned e-SFR", np.array(esfr) - truth, None),
        accuracy_row("each_edge", error, found[:, 1]),
        *mapper_accuracy(mapper),
    ]
    small = squares.regions[0]
    cut = squares.image[small[0] + 10 : small[0] + 50, small[1] + 10 : small[1] + 50].astype(float)
    single = [
        [
            "one edge of 40 x 40 px, numbers and verdict / ms",
            f"{1e3 * shortest(_verdict(cut)):.2f}",
        ],
        ["first edge of a process, import included / s", f"{first_edge(cut):.2f}"],
        ["two workers, as many times as fast as one", f"{wall_one / wall_two:.2f}"],
        ["memory of one process, at most / MB", f"{memory_mb:.0f}"],
        ["rejected of all", f"{int(np.isnan(error).sum())} of {count}"],
    ]
    parts = [
        f"{count} regions of {REGION_PX} x {REGION_PX} px of one image of "
        f"{squares.image.shape[0]} x {squares.image.shape[1]} px, sides of squares turned by "
        f"{', '.join(f'{angle:g}' for angle in ANGLES_DEG)} degrees; Gaussian of 0.4 px, SNR 100.",
        table(
            ["method", "a region / ms", "ratio to plain"],
            [[name, f"{1e3 * taken / count:.2f}", ratio] for name, taken, ratio in times],
        ),
        table(["MTF at Nyquist", "bias", "std", "95 % intervals that hold"], accuracy),
        table(["", "found"], single),
    ]
    publish("Thousands of regions of one image", parts, arguments)


def mapper_time(
    mapper: MapperEdges | None, count: int, plain: float
) -> list[tuple[str, float, str]]:
    """MTF Mapper's row of the times, for as many edges; none where it is not installed."""
    if mapper is None:
        return []
    taken = mapper.processor_s / mapper.angle_deg.size * count
    name = f"MTF Mapper, {mapper.angle_deg.size} sides found by itself, without deviations"
    return [(name, taken, f"{taken / plain:.2f}")]


def mapper_accuracy(mapper: MapperEdges | None) -> list[list[str]]:
    """MTF Mapper's row of the accuracies."""
    if mapper is None:
        return []
    return [accuracy_row("MTF Mapper", mapper.mtf(0.5) - true_nyquist(mapper.angle_deg), None)]


def _verdict(image: np.ndarray) -> Callable[[], Any]:
    def work() -> Any:
        found = ac.measure_edge(image)
        return found.mtf_nyquist.std, found.rer.std, found.fwhm_px.std, found.verdict

    return work


def accuracy_row(name: str, error: np.ndarray, std: np.ndarray | None) -> list[str]:
    """Bias and scatter of errors, and how often intervals hold the truth."""
    known = np.isfinite(error)
    holds = "" if std is None else f"{np.mean(np.abs(error / std)[known] < TWO_SIDED_95):.3f}"
    return [name, f"{np.mean(error[known]):+.4f}", f"{np.std(error[known]):.4f}", holds]


if __name__ == "__main__":
    main()
