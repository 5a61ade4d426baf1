"""Edges on ground that is not even: strips beside the edge, and slopes through it.

A strip lies parallel to the edge, on one of its sides, and is brighter or darker by a share of the
contrast; the sensor blurs its two borders as it blurs the edge. Regions of 56, 80 and 120 px
across and 60 px along hold it or end in it. A slope runs through edge and region alike; its share
is that of the whole region's width. Angles of 4 to 15 degrees to either side, both polarities.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from trials import (
    METRICS,
    Compared,
    bias,
    command,
    compare,
    coverage,
    publish,
    root_mean_square,
    table,
    work_through,
)

import acutance as ac
from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.simulate.edge import line_through_centre

SYSTEMS = {
    "gaussian .4": "gaussian",
    "gaussian .6": "wide",
    "diffraction": "diffraction",
    "halo": "halo",
}
STRIPS_PX = [(2, 12), (4, 10), (8, 14)]
STRIP_SHARES = [0.02, 0.03, 0.05, -0.03]
SIDES = {-1: "dark", 1: "bright"}
HALF_WIDTHS_PX = [28, 40, 60]
STRIP_SNR, STRIP_ROWS = 200.0, 60
STRIP_METRICS = ("MTF(0.5)", "RER")
SLOPE_SYSTEMS = ["gaussian .4", "diffraction", "halo"]
SLOPE_SHARES = [0.02, 0.05, -0.02, -0.05]
SLOPE_SIZES_PX = [40, 70]
SLOPE_SNR = 100.0
SLOPE_METRICS = ("RER", "MTF(0.25)")
DARK, CONTRAST = 200.0, 1000.0
WORDS = ("good", "usable", "doubtful", "invalid")
MAX_BIAS, MIN_COVERAGE = 0.010, 85.0


@dataclass(frozen=True)
class Strip:
    """One edge with a strip beside it, on its dark (-1) or bright side (1)."""

    system: str
    strip_px: tuple[int, int]
    share: float
    side: int
    half_width_px: int
    seed: tuple[int, ...]


@dataclass(frozen=True)
class Slope:
    """One edge on ground that slopes through it."""

    system: str
    share: float
    size_px: int
    seed: tuple[int, ...]


def strip_edge(sensor: ac.Sensor, job: Strip, rng: np.random.Generator) -> tuple[Floats, Response]:
    """Image and true curves: three steps behind one sensor."""
    profile, distance_px, response = _random_edge(
        sensor, (STRIP_ROWS, 2 * job.half_width_px), (4.0, 15.0), rng
    )
    near, far = (job.side * np.array(job.strip_px)).tolist()
    border = profile(distance_px - min(near, far)) - profile(distance_px - max(near, far))
    scene = profile(distance_px) + job.share * border
    return DARK + CONTRAST * (scene + rng.normal(0, 1 / STRIP_SNR, scene.shape)), response


def sloping_edge(
    sensor: ac.Sensor, job: Slope, rng: np.random.Generator
) -> tuple[Floats, Response]:
    """Image and true curves: a blurred slope is the slope itself."""
    profile, distance_px, response = _random_edge(
        sensor, (job.size_px, job.size_px), (4.0, 20.0), rng
    )
    scene = profile(distance_px) + job.share * distance_px / job.size_px
    return DARK + CONTRAST * (scene + rng.normal(0, 1 / SLOPE_SNR, scene.shape)), response


def _random_edge(
    sensor: ac.Sensor,
    shape: tuple[int, int],
    angle_deg: tuple[float, float],
    rng: np.random.Generator,
) -> tuple[Callable[[Floats], Floats], Floats, Response]:
    """ESF about its half point, distances of the pixels and true curves of a random edge."""
    polarity = "rising" if rng.random() < 0.5 else "falling"
    angle = float(rng.uniform(*angle_deg) * rng.choice([-1, 1]))
    line = line_through_centre(shape, angle, "across", polarity)
    line = line.moved(float(rng.uniform(-0.5, 0.5)), 0.0)
    profile = sensor.profile(line.normal_deg)
    response = sensor.response_along(line.normal_deg)
    distance_px = line.normal_distance(*np.indices(shape))
    return lambda s: profile.esf(s + profile.half_px), distance_px, response


def measured(job: Strip | Slope) -> Compared | None:
    """The measurement of one edge; nothing if it was refused."""
    sensor = ac.simulate.reference_systems()[SYSTEMS[job.system]]
    rng = np.random.default_rng(job.seed)
    if isinstance(job, Strip):
        return compare(*strip_edge(sensor, job, rng))
    return compare(*sloping_edge(sensor, job, rng))


def head(names: Sequence[str]) -> list[str]:
    """Heads of the columns of `numbers`."""
    return [
        *(f"{what} {name}" for what in ("bias", "RMS") for name in names),
        *(f"{name} / %" for name in names), *WORDS, "refused",
    ]  # fmt: skip


def numbers(results: Sequence[Compared | None], names: Sequence[str]) -> list[str]:
    """Bias, RMS and coverage of some metrics, verdicts and refusals."""
    found = [result for result in results if result is not None]
    refused = f"{len(results) - len(found)}"
    if not found:
        return ["-"] * (3 * len(names) + len(WORDS)) + [refused]
    columns = [list(METRICS).index(name) for name in names]
    words = [result.word for result in found]
    return [
        *(f"{value:+.4f}" for value in bias(found)[columns]),
        *(f"{value:.4f}" for value in root_mean_square(found)[columns]),
        *(f"{value:.0f}" for value in coverage(found)[columns]),
        *(f"{100 * words.count(word) / len(words):.0f}" for word in WORDS), refused,
    ]  # fmt: skip


def keeps_bar(results: Sequence[Compared | None]) -> bool:
    """Whether Nyquist and RER are right to .010, or else named and held by their intervals."""
    found = [result for result in results if result is not None]
    if not found:
        return True
    columns = [list(METRICS).index(name) for name in STRIP_METRICS]
    named = all(result.word in ("doubtful", "invalid") for result in found)
    held = named and bool(np.all(coverage(found)[columns] >= MIN_COVERAGE))
    return held or bool(np.all(np.abs(bias(found)[columns]) <= MAX_BIAS))


def strip_parts(draws: int, seed: int, processes: int) -> list[str]:
    """Tables of the strips, by system, place and side, and by half width."""
    jobs = [
        Strip(system, strip, share, side, half, (seed, 0, *place, draw))
        for place, (system, strip, share, side, half) in _numbered(
            SYSTEMS, STRIPS_PX, STRIP_SHARES, SIDES, HALF_WIDTHS_PX
        )
        for draw in range(draws)
    ]
    results = work_through(measured, jobs, processes, "strips")
    select = partial(_chosen, jobs, results)
    kept, rows = [], []
    for _, (system, strip, share, side) in _numbered(SYSTEMS, STRIPS_PX, STRIP_SHARES, SIDES):
        own = select(system=system, strip_px=strip, share=share, side=side)
        kept.append(keeps_bar(own))
        rows.append(
            [system, f"{strip[0]} to {strip[1]}", SIDES[side], f"{100 * share:+.0f}",
             *numbers(own, STRIP_METRICS), "yes" if kept[-1] else "no"]
        )  # fmt: skip
    by_width = [
        [f"{half}", *numbers(select(half_width_px=half), STRIP_METRICS)] for half in HALF_WIDTHS_PX
    ]
    by_width.append(["**all**", *numbers(results, STRIP_METRICS)])
    return [
        "## Strips beside the edge",
        f"SNR {STRIP_SNR:.0f}; half widths of the regions: "
        f"{', '.join(str(half) for half in HALF_WIDTHS_PX)} px, {draws} edges of each a row.",
        table(["half width / px", *head(STRIP_METRICS)], by_width),
        "By system, place and side. Bar: the bias of both is "
        f"{MAX_BIAS:.3f} at most, or every verdict is doubtful or invalid and the intervals hold "
        f"the truth in {MIN_COVERAGE:.0f} %. {sum(kept)} of {len(kept)} rows keep it.",
        table(
            ["system", "strip / px", "side", "share / %", *head(STRIP_METRICS), "bar"],
            rows, texts=3,
        ),
    ]  # fmt: skip


def slope_parts(draws: int, seed: int, processes: int) -> list[str]:
    """Table of the slopes, by system and size."""
    jobs = [
        Slope(system, share, size, (seed, 1, *place, draw))
        for place, (system, share, size) in _numbered(SLOPE_SYSTEMS, SLOPE_SHARES, SLOPE_SIZES_PX)
        for draw in range(draws)
    ]
    results = work_through(measured, jobs, processes, "slopes")
    select = partial(_chosen, jobs, results)
    rows = [
        [f"**all of {100 * share:.0f} %**", "", "",
         *numbers([*select(share=share), *select(share=-share)], SLOPE_METRICS)]
        for share in sorted({abs(share) for share in SLOPE_SHARES})
    ]  # fmt: skip
    rows += [
        [system, f"{100 * share:+.0f}", f"{size}",
         *numbers(select(system=system, share=share, size_px=size), SLOPE_METRICS)]
        for _, (system, share, size) in _numbered(SLOPE_SYSTEMS, SLOPE_SHARES, SLOPE_SIZES_PX)
    ]  # fmt: skip
    return [
        "## Slopes through the edge",
        f"SNR {SLOPE_SNR:.0f}, {draws} edges a row; share: change of the ground over the region's "
        "width, positive where it rises towards the bright side.",
        table(["system", "share / %", "size / px", *head(SLOPE_METRICS)], rows),
    ]


def _numbered(*lists: Sequence) -> list[tuple[tuple[int, ...], tuple]]:
    """All combinations of the members of some lists, each after its numbers."""
    members = [list(members) for members in lists]
    places = np.ndindex(*(len(own) for own in members))
    return [
        (place, tuple(own[k] for own, k in zip(members, place, strict=True))) for place in places
    ]


def _chosen(
    jobs: Sequence[Strip | Slope], results: Sequence[Compared | None], **wanted: object
) -> list[Compared | None]:
    """Results of the jobs with the wanted attributes."""
    return [
        result
        for job, result in zip(jobs, results, strict=True)
        if all(getattr(job, name) == value for name, value in wanted.items())
    ]


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], draws=4).parse_args()
    seed, processes = arguments.seed, arguments.processes
    parts = [
        "Bias: mean error; RMS: root mean square. Metrics / %: per cent of the 95 % "
        "intervals that hold the truth. Good, usable, doubtful, invalid: per cent of the "
        "measurements with that verdict.",
        *strip_parts(arguments.draws, seed, processes),
        *slope_parts(3 * arguments.draws, seed, processes),
    ]
    publish("Edges on uneven ground", parts, arguments)


if __name__ == "__main__":
    main()
