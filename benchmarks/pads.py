"""Mirrors on mounts (pads) brighter or darker than their ground: bias and coverage.

Example: python benchmarks/pads.py --draws 20 --processes 2
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from trials import METRICS, command, publish, table, work_through

import acutance as ac
from acutance.simulate import Patch, Point, mirror_columns, render_patches

PEAK = 1000.0
PADS = ((0.0, 3.0), (0.02, 2.0), (-0.02, 2.0), (0.02, 3.0), (-0.02, 3.0), (0.02, 5.0), (-0.02, 5.0))
SNRS = (80.0, 200.0)


@dataclass(frozen=True)
class Job:
    """One image of 20 mirrors on pads: contrast over the peak, side in pixels."""

    system: str
    contrast: float
    side_px: float
    snr: float
    seed: tuple[int, ...]


def systems() -> dict[str, ac.Sensor]:
    """A Gaussian and two of the reference systems."""
    gaussian = ac.Sensor([ac.optics.Gaussian(0.45), ac.optics.Detector()])
    reference = ac.simulate.reference_systems()
    return {"gaussian 0.45": gaussian} | {name: reference[name] for name in ("diffraction", "halo")}


def measured(job: Job) -> tuple[np.ndarray, bool]:
    """Errors and deviations of every metric across and along; whether pads were seen."""
    sensor, rng = systems()[job.system], np.random.default_rng(job.seed)
    places = mirror_columns((12.0, 12.0)) + rng.uniform(0, 1, (1, 2))
    shape = tuple((np.ceil(places.max(axis=0)).astype(int) + 13).tolist())
    centred = render_patches(sensor, [Point(8.0, 8.0, 1.0)], (17, 17))[8, 8]
    mirrors = [Point(row, col, PEAK / centred) for row, col in places.tolist()]
    pads = [
        Patch(row, col, job.side_px, job.side_px, 0.0, job.contrast * PEAK)
        for row, col in places.tolist()
    ]
    image = 200.0 + render_patches(sensor, [*mirrors, *(pads if job.contrast else [])], shape)
    image += rng.standard_normal(shape) * PEAK / job.snr
    found = ac.measure_points(image, positions=places)
    pairs = []
    for name, response in (("across", found.across), ("along", found.along)):
        true = sensor.response(0.0, name)
        for read in METRICS.values():
            estimate = read(response)
            pairs.append((estimate.value - read(true).value, estimate.std))
    return np.array(pairs).reshape(2, len(METRICS), 2), found.pads is not None


def main() -> None:
    """Measure all conditions and print a table for every SNR."""
    arguments = command(__doc__.splitlines()[0], 20).parse_args()
    jobs = [
        Job(system, contrast, side_px, snr, (arguments.seed, i))
        for snr in SNRS
        for system in systems()
        for contrast, side_px in PADS
        for i in range(arguments.draws)
    ]
    found = work_through(measured, jobs, arguments.processes, "pads")
    head = ("system", "pad", "seen / %", *(f"{name}: bias" for name in METRICS),
            *(f"{name}: coverage / %" for name in METRICS), "std MTF(0.5)")  # fmt: skip
    parts = []
    for snr in SNRS:
        rows = []
        for system in systems():
            for contrast, side_px in PADS:
                own = [
                    one
                    for job, one in zip(jobs, found, strict=True)
                    if (job.snr, job.system, job.contrast, job.side_px)
                    == (snr, system, contrast, side_px)
                ]
                pairs = np.array([one[0] for one in own]).reshape(-1, len(METRICS), 2)
                held = np.mean(np.abs(pairs[..., 0]) < 1.96 * pairs[..., 1], axis=0)
                pad = f"{100 * contrast:+.0f} %, {side_px:g} px" if contrast else "none"
                rows.append(
                    (system, pad, f"{100 * np.mean([one[1] for one in own]):.0f}",
                     *(f"{bias:+.4f}" for bias in pairs[..., 0].mean(axis=0)),
                     *(f"{100 * share:.0f}" for share in held), f"{pairs[:, 0, 1].mean():.4f}")
                )  # fmt: skip
        parts.append(f"## Peak SNR {snr:g}\n\n" + table(head, rows, texts=2))
    publish("Mirrors on pads", parts, arguments)


if __name__ == "__main__":
    main()
