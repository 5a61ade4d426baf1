"""Edges along arcs of circles: radii of 300 to 5000 px, bent to either side, 30 to 80 px long.

Every pixel is the edge spread function at its distance from the circle, which is exact but for
the curvature within one blur: less than a thousandth of a pixel. The measured line is a parabola.
SNR 100, regions 50 px wide, 4 to 20 degrees.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from trials import METRICS, Compared, bias, command, compare, coverage, publish, table, work_through

import acutance as ac
from acutance.curves import Response
from acutance.curves.grid import Floats

SYSTEMS = ["gaussian", "diffraction"]
RADII_PX = [300, -300, 500, -500, 1000, -1000, 2000, -2000, 5000, -5000]
LENGTHS_PX = [30, 50, 80]
WIDTH_PX, SNR, ANGLE_DEG = 50, 100.0, (4.0, 20.0)
DARK, CONTRAST = 200.0, 1000.0
MAX_BIAS, MIN_COVERAGE = 0.004, 90.0
BIASED = ("MTF(0.5)", "RER")
_COLUMNS = [list(METRICS).index(name) for name in BIASED]


@dataclass(frozen=True)
class Arc:
    """One curved edge."""

    system: str
    radius_px: int
    length_px: int
    seed: tuple[int, ...]


def arc_edge(sensor: ac.Sensor, job: Arc, rng: np.random.Generator) -> tuple[Floats, Response]:
    """Image and true curves; a positive radius bends the edge towards its bright side."""
    normal = np.deg2rad(rng.uniform(*ANGLE_DEG)) * rng.choice([-1, 1])
    row, col = np.indices((job.length_px, WIDTH_PX))
    middle_row = 0.5 * (job.length_px - 1)
    middle_col = 0.5 * (WIDTH_PX - 1) + rng.uniform(-1, 1)
    centre_row = middle_row + job.radius_px * np.sin(normal)
    centre_col = middle_col + job.radius_px * np.cos(normal)
    outside = np.hypot(col - centre_col, row - centre_row) - abs(job.radius_px)
    profile = sensor.profile(float(np.rad2deg(normal)))
    esf = profile.esf(profile.half_px - np.sign(job.radius_px) * outside)
    image = DARK + CONTRAST * (esf + rng.normal(0, 1 / SNR, esf.shape))
    return image, sensor.response_along(float(np.rad2deg(normal)))


def measured(job: Arc) -> Compared | None:
    """The measurement of one edge; nothing if it was refused."""
    sensor = ac.simulate.reference_systems()[job.system]
    return compare(*arc_edge(sensor, job, np.random.default_rng(job.seed)))


HEAD = [
    "draws", *(f"bias {name}" for name in BIASED), *(f"{name} / %" for name in METRICS),
    "good or usable / %", "refused",
]  # fmt: skip


def numbers(results: Sequence[Compared | None]) -> list[str]:
    """Bias and coverage, trusted measurements and refusals."""
    found = [result for result in results if result is not None]
    count, refused = f"{len(results)}", f"{len(results) - len(found)}"
    if not found:
        return [count, *["-"] * (len(HEAD) - 2), refused]
    trusted = np.mean([result.word in ("good", "usable") for result in found])
    return [
        count, *(f"{value:+.4f}" for value in bias(found)[_COLUMNS]),
        *(f"{share:.0f}" for share in coverage(found)), f"{100 * trusted:.0f}", refused,
    ]  # fmt: skip


def keeps_bars(results: Sequence[Compared | None]) -> bool:
    """Whether bias and coverage are as asked, and nothing is refused."""
    found = [result for result in results if result is not None]
    if len(found) < len(results):
        return False
    right = np.abs(bias(found)[_COLUMNS]) <= MAX_BIAS
    return bool(np.all(right) and np.all(coverage(found) >= MIN_COVERAGE))


def curvature(results: Sequence[Compared | None]) -> str:
    """Mean curvature found, in 1/1000 px."""
    found = [1000 * result.curvature_per_px for result in results if result is not None]
    return f"{np.mean(found):+.2f} ± {np.std(found):.2f}" if found else "-"


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=8).parse_args()
    jobs = [
        Arc(system, radius, length, (arguments.seed, a, b, c, draw))
        for a, system in enumerate(SYSTEMS)
        for b, radius in enumerate(RADII_PX)
        for c, length in enumerate(LENGTHS_PX)
        for draw in range(arguments.draws)
    ]
    results = work_through(measured, jobs, arguments.processes, "arcs")
    both = list(zip(jobs, results, strict=True))
    pooled, rows = [], []
    for size in sorted({abs(radius) for radius in RADII_PX}):
        own = [result for job, result in both if abs(job.radius_px) == size]
        pooled.append([f"{size}", *numbers(own), "yes" if keeps_bars(own) else "no"])
    pooled.append(["**all**", *numbers(results), "yes" if keeps_bars(results) else "no"])
    for radius in RADII_PX:
        for length in LENGTHS_PX:
            own = [
                result for job, result in both
                if (job.radius_px, job.length_px) == (radius, length)
            ]  # fmt: skip
            measured_curvature = f"{1000 / radius:+.2f}", curvature(own)
            rows.append([f"{radius:+d}", f"{length}", *measured_curvature, *numbers(own)])
    parts = [
        f"SNR {SNR:.0f}, regions {WIDTH_PX} px wide; {' and '.join(SYSTEMS)}. Bias: mean error. "
        "Metrics / %: per cent of the 95 % intervals that hold the truth. Good or usable: per cent "
        "of the verdicts.",
        "## By radius, both signs and all lengths",
        f"Bars: biases of {MAX_BIAS:.3f} at most, coverage of {MIN_COVERAGE:.0f} % at least, "
        "nothing refused.",
        table(["radius / px", *HEAD, "bars"], pooled),
        "## By radius and length",
        "Positive radii bend towards the bright side. Curvature: 1000 / radius, 1/px; found: mean "
        "± deviation.",
        table(["radius / px", "length / px", "curvature", "found", *HEAD], rows, texts=0),
    ]
    publish("Curved edges", parts, arguments)


if __name__ == "__main__":
    main()
