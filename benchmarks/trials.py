"""What the benchmarks share: random edges, work on several processes, tables."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import acutance as ac
from acutance.curves import Estimate, Response
from acutance.simulate import Truth

METRICS: dict[str, Callable[[Response], Estimate]] = {
    "MTF(0.5)": lambda response: response.mtf_nyquist,
    "MTF(0.25)": lambda response: response.mtf(0.25),
    "RER": lambda response: response.rer,
    "FWHM": lambda response: response.fwhm_px,
}
TWO_SIDED_95 = 1.959964
COMBINATIONS = [(o, p) for o in ("across", "along") for p in ("rising", "falling")]


@dataclass(frozen=True)
class Ranges:
    """Where random edges are drawn from: sizes and SNR log-uniform, the rest uniform."""

    size_px: tuple[int, int] = (30, 60)
    snr: tuple[float, float] = (50.0, 150.0)
    angle_deg: tuple[float, float] = (2.0, 43.0)
    offset_px: float = 1.5


def random_edge(
    rng: np.random.Generator, sensor: ac.Sensor, ranges: Ranges, scene: str = "white"
) -> tuple[np.ndarray, Truth]:
    """A square image of an edge with random place, direction and noise.

    `scene` is "white", "signal-dependent" (variance a + b I, half to all of it from the signal
    at mid level) or "resampled" (cubic convolution at one random sub-pixel shift).
    """
    side = round(float(np.exp(rng.uniform(*np.log(ranges.size_px)))))
    snr = float(np.exp(rng.uniform(*np.log(ranges.snr))))
    orientation, polarity = COMBINATIONS[int(rng.integers(4))]
    dark, bright = 200.0, 1200.0
    variance = ((bright - dark) / snr) ** 2
    share = float(rng.uniform(0.5, 1.0)) if scene == "signal-dependent" else 0.0
    noise = ac.simulate.Noise(
        read=np.sqrt((1 - share) * variance), shot_gain=share * variance / (0.5 * (dark + bright))
    )
    shifts = rng.uniform(-0.5, 0.5, 2) if scene == "resampled" else None
    return ac.simulate.edge(
        sensor,
        angle_deg=float(rng.uniform(*ranges.angle_deg) * rng.choice([-1, 1])),
        orientation=orientation,
        polarity=polarity,
        shape=(side, side),
        dark=dark,
        bright=bright,
        offset_px=float(rng.uniform(-ranges.offset_px, ranges.offset_px)),
        noise=noise,
        regrid=None if shifts is None else ac.simulate.Regrid(*shifts.tolist()),
        rng=rng,
    )


@dataclass(frozen=True)
class Compared:
    """A measurement against the truth, by metric.

    Attributes
    ----------
    error, z : list of float
        Found less true, and this over the stated standard deviation.
    word : str
        Of the verdict.
    curvature_per_px : float
        Of the line that was found.
    """

    error: list[float]
    z: list[float]
    word: str
    curvature_per_px: float


def compare(image: np.ndarray, true: Response) -> Compared | None:
    """Measure an edge and compare it with its true curves; nothing if it is refused."""
    try:
        found = ac.measure_edge(image)
    except ac.AcutanceError:
        return None
    estimates = [metric(found.response) for metric in METRICS.values()]
    error = [
        estimate.value - metric(true).value
        for estimate, metric in zip(estimates, METRICS.values(), strict=True)
    ]
    z = [miss / estimate.std for miss, estimate in zip(error, estimates, strict=True)]
    return Compared(error, z, found.verdict.word, found.line.curvature_per_px)


def bias(compared: Sequence[Compared]) -> np.ndarray:
    """Mean error of every metric."""
    return np.asarray(np.mean([one.error for one in compared], axis=0))


def root_mean_square(compared: Sequence[Compared]) -> np.ndarray:
    """Root mean square error of every metric."""
    return np.asarray(np.sqrt(np.mean(np.square([one.error for one in compared]), axis=0)))


def rms(errors: ArrayLike) -> float:
    """Root mean square of some numbers."""
    return float(np.sqrt(np.mean(np.square(errors))))


def coverage(compared: Sequence[Compared]) -> np.ndarray:
    """Per cent of the 95 % intervals that hold the truth, of every metric."""
    inside = np.abs([one.z for one in compared]) < TWO_SIDED_95
    return np.asarray(100 * np.mean(inside, axis=0))


def command(description: str, draws: int) -> argparse.ArgumentParser:
    """The options all benchmarks have."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--draws", type=int, default=draws, help="random images a condition")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--out", type=Path, help="write the Markdown here as well")
    return parser


def work_through(
    task: Callable[[Any], Any], jobs: Iterable[Any], processes: int, label: str
) -> list[Any]:
    """Results of `task` for all jobs, in their order; each process keeps to one core."""
    jobs = list(jobs)
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ[f"{library}_NUM_THREADS"] = "1"
    results = []
    # Fresh processes: they read the number of threads when they load the libraries.
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        chunk = max(1, min(16, len(jobs) // (4 * processes)))
        for done, result in enumerate(pool.map(task, jobs, chunksize=chunk), 1):
            results.append(result)
            if done == len(jobs) or done % 100 == 0:
                print(f"{label}: {done} of {len(jobs)}", file=sys.stderr, flush=True)
    return results


def table(head: Sequence[str], rows: Iterable[Sequence[str]], texts: int = 1) -> str:
    """A Markdown table; the first `texts` columns are text, the others are numbers."""
    lines = [head, ["---"] * texts + ["---:"] * (len(head) - texts), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def publish(title: str, parts: Sequence[str], arguments: argparse.Namespace) -> None:
    """Print the parts; with ``--out`` keep them with how they came about."""
    print("\n\n".join(parts))
    if arguments.out is None:
        return
    given = [
        f"--{name.replace('_', '-')} {value}"
        for name, value in vars(arguments).items()
        if name != "out"
    ]
    how = (
        f"`python benchmarks/{Path(sys.argv[0]).name} {' '.join(given)}`, "
        f"acutance {ac.__version__}, {datetime.now(UTC):%Y-%m-%d}, 2 cores."
    )
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text("\n\n".join([f"# {title}", how, *parts]) + "\n", encoding="utf-8")
