"""Scenes against their truth: the sensor under ideal, partly soft and mostly soft objects.

Landscapes of fields (`acutance.simulate.landscape`) without anything beside them, SNR 100 of the
middle contrast; a share of the borders is soft, Gaussians of .15 to 2 px. `acutance.scan_scene`
measures across and along; the median of the used edges nearest to either direction stands beside.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from trials import TWO_SIDED_95, command, publish, table, work_through

import acutance as ac
from acutance.simulate import LandscapeOptions

SYSTEMS = ("gaussian", "diffraction", "halo", "smeared")
SOFT = (0.0, 0.4, 0.75)
SIZE_PX = 1200
CLEAN = {
    "roofs": 0.0, "roads": 0.0, "discs": 0.0, "rims": 0.0, "gutters": 0.0, "shadows": 0.0,
    "side_roads": 0.0, "neighbours": 0.0, "texture": (0.0, 0.0), "slope_per_px": 0.0,
    "curved": 0.0, "density_per_mpx": 60,
}  # fmt: skip


@dataclass(frozen=True)
class Scanned:
    """One scene: errors at Nyquist and .25 c/px across and along, deviations, edges, verdict."""

    soft: float
    error: tuple[float, ...]
    std: tuple[float, ...]
    median_error: float
    found: int
    used: int
    verdict: str
    seconds: float


def true_mtf(sensor: ac.Sensor, freq_cpp: float, normal_deg: float) -> float:
    """MTF of a sensor at one place of the plane."""
    turn = np.radians(normal_deg)
    u, v = np.array([freq_cpp * np.cos(turn)]), np.array([freq_cpp * np.sin(turn)])
    return float(np.abs(sensor.otf(u, v))[0])


def scan(job: tuple[float, str, tuple[int, ...]]) -> Scanned | None:
    """Draw a scene and scan it; nothing if it is refused."""
    soft, name, seed = job
    sensor = ac.simulate.reference_systems()[name]
    options = LandscapeOptions(soft=soft, softness_px=(0.15, 2.0), **CLEAN)
    image, _ = ac.simulate.landscape(
        sensor, shape=(SIZE_PX, SIZE_PX), snr=100, options=options, rng=np.random.default_rng(seed)
    )
    start = time.process_time()
    try:
        scene = ac.scan_scene(image)
    except ac.AcutanceError:
        return None
    seconds = time.process_time() - start
    error, std = [], []
    for direction, normal_deg in ((scene.across, 0.0), (scene.along, 90.0)):
        for freq_cpp in (0.5, 0.25):
            number = direction.mtf(freq_cpp)
            error.append(number.value - true_mtf(sensor, freq_cpp, normal_deg))
            std.append(number.std)
    edges = scene.edges
    used = edges.used
    own = [
        value - true_mtf(sensor, 0.5, normal)
        for value, normal in zip(edges.mtf_nyquist[used], edges.normal_deg[used], strict=True)
    ]
    return Scanned(
        soft, tuple(error), tuple(std), float(np.median(own)), edges.size, int(used.sum()),
        scene.verdict.word, seconds,
    )  # fmt: skip


def row(name: str, scanned: list[Scanned]) -> list[str]:
    """RMS, bias and coverage over scenes, directions and both frequencies."""
    error, std = np.array([one.error for one in scanned]), np.array([one.std for one in scanned])
    nyquist, quarter = (slice(start, None, 2) for start in (0, 1))
    holds = np.abs(error) < TWO_SIDED_95 * std
    good = sum(one.verdict in ("good", "usable") for one in scanned)
    return [
        name,
        f"{np.sqrt(np.mean(error[:, nyquist] ** 2)):.4f}",
        f"{np.mean(error[:, nyquist]):+.4f}",
        f"{100 * np.mean(holds[:, nyquist]):.0f}",
        f"{np.sqrt(np.mean(error[:, quarter] ** 2)):.4f}",
        f"{100 * np.mean(holds[:, quarter]):.0f}",
        f"{np.mean([one.median_error for one in scanned]):+.4f}",
        f"{np.mean([one.used for one in scanned]):.0f} of "
        f"{np.mean([one.found for one in scanned]):.0f}",
        f"{good} of {len(scanned)}",
        f"{np.mean([one.seconds for one in scanned]):.1f}",
    ]


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=5).parse_args()
    jobs = [
        (soft, name, (arguments.seed, draw, number))
        for soft in SOFT
        for number, name in enumerate(SYSTEMS)
        for draw in range(arguments.draws)
    ]
    found = work_through(scan, jobs, arguments.processes, "scenes")
    rows = []
    for soft in SOFT:
        for name in SYSTEMS:
            own = [
                one
                for one, job in zip(found, jobs, strict=True)
                if one is not None and job[:2] == (soft, name)
            ]
            if own:
                rows.append(row(f"{100 * soft:.0f} % soft, {name}", own))
        every = [one for one in found if one is not None and one.soft == soft]
        if every:
            rows.append(row(f"**{100 * soft:.0f} % soft, all**", every))
    head = [
        "objects, sensor", "RMS at Nyquist", "bias", "held / %", "RMS at .25", "held / %",
        "median of the edges, bias", "edges used", "good or usable", "time / s",
    ]  # fmt: skip
    parts = [
        f"Scenes of {SIZE_PX} x {SIZE_PX} px, {arguments.draws} a row, SNR 100; errors of the MTF "
        "across and along, and how often 95 % intervals hold the truth. Soft borders: Gaussians of "
        ".15 to 2 px. Processor time of one scan.",
        table(head, rows),
    ]
    publish("Whole scenes", parts, arguments)


if __name__ == "__main__":
    main()
