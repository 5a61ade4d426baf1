"""The points method in fields of stars, galaxies and cosmic rays: what it takes for a point.

Example: python benchmarks/sky.py --draws 4 --processes 2
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from trials import command, publish, table, work_through

import acutance as ac

SAME_PX = 1.0


@dataclass(frozen=True)
class Job:
    """One field: a system, a kind of field and a seed."""

    system: str
    field: str
    seed: tuple[int, ...]


@dataclass(frozen=True)
class Found:
    """What the default call found: numbers of sources, shares of error, the refusal."""

    sources: int = 0
    stars: int = 0
    usable: int = 0
    usable_found: int = 0
    fwhm: tuple[float, ...] = ()
    fwhm_std: tuple[float, ...] = ()
    refused: bool = False


def systems() -> dict[str, ac.Sensor]:
    """Sensors with a FWHM of 1.4 to 3 px, each seen through a square pixel."""
    optics, pixel = ac.optics, ac.optics.Detector()
    return {
        "gaussian 1.4 px": ac.Sensor([optics.Gaussian(0.5), pixel]),
        "gaussian 2 px": ac.Sensor([optics.Gaussian(0.8), pixel]),
        "gaussian 3 px": ac.Sensor([optics.Gaussian(1.2), pixel]),
        "diffraction": ac.Sensor([optics.Diffraction(0.8, obscuration=0.3), pixel]),
        "halo": ac.Sensor([optics.Gaussian(0.6), optics.Halo(0.1, 2.5), pixel]),
        "asymmetric": ac.Sensor(
            [optics.Gaussian(0.5), optics.Exponential(0.5, "across"),
             optics.Exponential(0.3, "along"), pixel]
        ),
    }  # fmt: skip


def fields() -> dict[str, ac.simulate.SkyField]:
    """Fields by name; an image has 512 by 512 pixels."""
    field = ac.simulate.SkyField
    return {
        "30 stars, 300 galaxies": field(),
        "60 stars, 600 galaxies": field(
            stars=60, galaxies=600, doubles=20, cosmic_rays=60, hot_pixels=16
        ),
        "8 stars, 300 galaxies": field(stars=8),
        "30 stars, no galaxies": field(galaxies=0),
        "no stars, 300 galaxies": field(stars=0, doubles=0),
        "no stars, 20 galaxies": field(stars=0, doubles=0, galaxies=20),
    }


def measured(job: Job) -> Found:
    """What the default call finds in one field."""
    rng = np.random.default_rng(job.seed)
    image, truth = ac.simulate.sky(systems()[job.system], fields()[job.field], rng=rng)
    places = truth.points.positions
    snr = truth.points.fluxes / truth.points.noise.read
    try:
        found = ac.measure_points(image)
    except ac.TargetError:
        return Found(refused=True)
    away = np.hypot(*(found.positions[:, None] - places[None]).transpose(2, 0, 1))
    is_star = (away < SAME_PX).any(axis=1) if len(places) else np.zeros(len(away), bool)
    seen = (away < SAME_PX).any(axis=0) if len(places) else np.zeros(0, bool)
    bright = snr > np.median(snr) if len(snr) else np.zeros(0, bool)
    ratio, std = [], []
    for name, response in (("across", found.across), ("along", found.along)):
        true = truth.points.response(name).fwhm_px.value
        ratio.append(response.fwhm_px.value / true - 1)
        std.append(response.fwhm_px.std / true)
    return Found(
        len(found.sources), int(is_star.sum()), int(bright.sum()), int((seen & bright).sum()),
        tuple(ratio), tuple(std),
    )  # fmt: skip


def main() -> None:
    """Measure all fields and print a table."""
    arguments = command(__doc__.splitlines()[0], 4).parse_args()
    jobs = [
        Job(system, field, (arguments.seed, i))
        for field in fields()
        for system in systems()
        for i in range(arguments.draws)
    ]
    found = work_through(measured, jobs, arguments.processes, "sky")
    parts = ["Image of 512 by 512 px; peaks of stars at 15 to 600 times the noise."]
    for field in fields():
        rows = []
        for system in systems():
            own = [
                one
                for job, one in zip(jobs, found, strict=True)
                if (job.field, job.system) == (field, system)
            ]
            rows.append((system, *_row(own)))
        head = (
            "system", "measured", "refused", "sources", "stars among them / %",
            "brighter half found / %", "FWHM: bias / %", "largest error / %", "std / %",
        )  # fmt: skip
        parts.append(f"## {field}\n\n" + table(head, rows))
    publish("Points among galaxies", parts, arguments)


def _row(own: list[Found]) -> tuple[str, ...]:
    count = Counter(one.refused for one in own)
    kept = [one for one in own if not one.refused]
    if not kept:
        return "0", str(count[True]), *[""] * 6
    sources, usable = (sum(getattr(one, name) for one in kept) for name in ("sources", "usable"))
    error = 100 * np.array([one.fwhm for one in kept])
    return (
        str(count[False]), str(count[True]), str(sources),
        f"{100 * sum(one.stars for one in kept) / sources:.1f}",
        f"{100 * sum(one.usable_found for one in kept) / usable:.0f}" if usable else "",
        f"{error.mean():+.2f}", f"{np.abs(error).max():.2f}",
        f"{100 * np.mean([one.fwhm_std for one in kept]):.2f}",
    )  # fmt: skip


if __name__ == "__main__":
    main()
