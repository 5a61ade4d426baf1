"""Scenes of few edges, most of them soft: does the verdict tell which of them to trust?

Landscapes of fields as of benchmarks/scenes.py, but small, under four sensors and one drawn from
each of four families; 40, 75 and 90 % of the borders are soft. A scan whose MTF across or along
errs by more than four deviations, at Nyquist or half of it, is wrong: the verdict has to say so.
The limits of the check `ideal_borders` stand on the second table.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scenes import DRAWN, SYSTEMS, Case, draw, sensor_of, true_mtf
from trials import TWO_SIDED_95, command, publish, table, work_through

import acutance as ac

SHARES = (0.4, 0.75, 0.9)
SIZES_PX = (320, 480, 640)
SENSORS = (*SYSTEMS, *DRAWN[:4])
BORDERS = (0.0, 2.0, 4.0, 6.0, 8.0, 12.0, 1000.0)
WRONG = 4.0


@dataclass(frozen=True)
class Scanned:
    """One scene: errors in deviations, how many borders are ideal, edges used, the verdict."""

    deviations: tuple[float, ...]
    ideal_borders: float
    used: int
    verdict: str

    @property
    def is_wrong(self) -> bool:
        return max(map(abs, self.deviations)) > WRONG

    @property
    def is_trusted(self) -> bool:
        return self.verdict in ("good", "usable")


def scanned(job: tuple[float, int, str, int]) -> Scanned | None:
    """Draw a scene and scan it; nothing if it is refused."""
    soft, size_px, name, seed = job
    sensor = sensor_of(name, (seed,))
    image, _ = draw(Case(soft, False), sensor, size_px, (seed, size_px))
    try:
        scene = ac.scan_scene(image)
    except ac.AcutanceError:
        return None
    deviations = []
    for direction, normal_deg in ((scene.across, 0.0), (scene.along, 90.0)):
        for freq_cpp in (0.5, 0.25):
            number = direction.mtf(freq_cpp)
            deviations.append((number.value - true_mtf(sensor, freq_cpp, normal_deg)) / number.std)
    borders = next(check.value for check in scene.checks if check.name == "ideal_borders")
    used = int(scene.edges.used.sum())
    return Scanned(tuple(deviations), borders, used, scene.verdict.word)


def row(name: str, some: list[Scanned]) -> list[str]:
    """How good the scans are, those that may be trusted, and the others."""
    trusted = [one for one in some if one.is_trusted]
    warned = [one for one in some if not one.is_trusted]
    off = np.abs([one.deviations for one in trusted])
    cells = [name, f"{len(some)}", f"{len(trusted)}"]
    if trusted:
        held = f"{100 * np.mean(off < TWO_SIDED_95):.0f}"
        cells += [held, f"{np.sqrt(np.mean(off**2)):.2f}"]
    else:
        cells += ["", ""]
    wrong = sum(one.is_wrong for one in warned)
    return [*cells, f"{sum(one.is_wrong for one in trusted)}", f"{wrong} of {len(warned)}"]


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=4).parse_args()
    jobs = [
        (soft, size_px, name, arguments.seed + number)
        for soft in SHARES
        for size_px in SIZES_PX
        for number in range(arguments.draws)
        for name in SENSORS
    ]
    found = work_through(scanned, jobs, arguments.processes, "scenes")
    known = [(job, one) for job, one in zip(jobs, found, strict=True) if one is not None]
    rows = []
    for soft in SHARES:
        for size_px in SIZES_PX:
            own = [one for job, one in known if job[:2] == (soft, size_px)]
            if own:
                used = f"{np.mean([one.used for one in own]):.0f}"
                rows.append(row(f"{100 * soft:.0f} % soft, {size_px} px, {used} edges", own))
    every = [one for _, one in known]
    rows.append(row("all", every))
    by_borders = []
    for low, high in pairwise(BORDERS):
        own = [one for one in every if low <= one.ideal_borders < high]
        if own:
            name = f"{low:g} to {high:g}" if high < BORDERS[-1] else f"{low:g} and more"
            off = np.abs([one.deviations for one in own])
            held, wrong = np.mean(off < TWO_SIDED_95), sum(one.is_wrong for one in own)
            rms = np.sqrt(np.mean(off**2))
            by_borders.append([name, f"{len(own)}", f"{100 * held:.0f}", f"{rms:.2f}", f"{wrong}"])
    head = ["objects, rows and columns, edges used", "scans", "good or usable", "held / %",
            "RMS / deviations", "wrong", "wrong of doubtful and invalid"]  # fmt: skip
    parts = [
        __doc__.partition("\n\n")[2].strip(),
        f"{sum(one is None for one in found)} of {len(jobs)} scenes were refused, for too few "
        "edges. Intervals of 95 %, of the scans that are good or usable.",
        table(head, rows),
        "All scans, by the number of ideal borders that was found:",
        table(["ideal borders", "scans", "held / %", "RMS / deviations", "wrong"], by_borders),
    ]
    publish("Scenes of few edges", parts, arguments)


if __name__ == "__main__":
    main()
