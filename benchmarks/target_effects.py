"""Trends, means and specifications where targets or sites come again and differ.

Archives of a steady sensor whose truth is known: what is peculiar to each target is drawn with the
deviation of the case. Beside them the same archives without the names of their targets: what the
answers would be if nothing were known of these.

Example: python benchmarks/target_effects.py --draws 200 --processes 1
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from trials import command, publish, table, work_through

from acutance.archive.mean_of_images import mean_of_images
from acutance.archive.specification import Requirement
from acutance.archive.specification_check import check_requirement
from acutance.archive.trends import Event, Series, Trend, fit_trend

LEVEL: Final = 0.16
START: Final = 2021.0
IMAGES, YEARS = 40, 3.0
MEAN_DRAWS = 1000
"""A trend takes a second, a mean some milliseconds."""


@dataclass(frozen=True)
class Case:
    """How targets come again; deviations relative to the level.

    All of them in every image, one an image by chance, or one after the other in blocks.
    """

    order: Literal["all", "random", "blocks"]
    targets: int = 4
    target_std: float = 0.04
    image_std: float = 0.02
    stated_std: float = 0.01


CASES = {
    "4 in every image": Case("all"),
    "4, one an image": Case("random"),
    "4, one after the other": Case("blocks"),
    "2, one after the other": Case("blocks", 2),
    "2 that differ by 2 %, scatter 1 %, one after the other": Case("blocks", 2, 0.02, 0.01),
    "4 that do not differ, one an image": Case("random", target_std=0.0),
    "4 that do not differ, in every image": Case("all", target_std=0.0),
    "12, one an image": Case("random", 12),
}
Job = tuple[Case, bool, tuple[int, ...]]


def simulate(case: Case, rng: np.random.Generator) -> Series:
    """The series of a steady sensor."""
    years = np.sort(rng.uniform(0, YEARS, IMAGES))
    own = rng.normal(0, case.target_std, case.targets)
    image = np.arange(IMAGES)
    if case.order == "all":
        image, target = np.repeat(image, case.targets), np.tile(np.arange(case.targets), IMAGES)
    elif case.order == "random":
        target = rng.integers(0, case.targets, IMAGES)
    else:
        target = image * case.targets // IMAGES
    value = 1 + case.image_std * rng.normal(size=IMAGES)[image] + own[target]
    value += case.stated_std * rng.normal(size=image.size)
    return Series(
        metric="mtf_nyquist", when=START + years[image], value=LEVEL * value,
        std=np.full(image.size, LEVEL * case.stated_std), image=image, target=target,
    )  # fmt: skip


def answers(job: Job) -> tuple[float, ...]:
    """What holds: level, rate, mean; deviations of the level; steps, steadiness; a requirement."""
    case, named, seed = job
    rng = np.random.default_rng(seed)
    series = simulate(case, rng)
    series = series if named else replace(series, target=None)
    trend: Trend = fit_trend(series)
    mean = mean_of_images(series).mean
    limit = LEVEL * (1 + rng.uniform(-0.06, 0.06))
    found = check_requirement(Requirement(metric="mtf_nyquist", minimum=limit), series)
    is_wrong = found.word == ("met" if limit > LEVEL else "not met")
    held = (_holds(trend.level.interval(), LEVEL), _holds(trend.rate.interval(), 0.0),
            _holds(mean.interval(), LEVEL))  # fmt: skip
    return (
        *map(float, held), trend.level.std / LEVEL, mean.std / LEVEL, float(bool(trend.changes)),
        float(trend.steady_probability < 0.5), float(found.word in ("met", "not met")),
        float(is_wrong),
    )  # fmt: skip


def mean_answers(job: Job) -> tuple[float, float]:
    """Whether the interval of a mean over images holds, and its deviation."""
    case, _, seed = job
    mean = mean_of_images(simulate(case, np.random.default_rng(seed))).mean
    return float(_holds(mean.interval(), LEVEL)), mean.std / LEVEL


def event_answers(job: tuple[int, int, float, float, tuple[int, ...]]) -> tuple[float, ...]:
    """Whether the intervals of a stated step and of the drift beside it hold."""
    before, after, step, drift, seed = job
    rng = np.random.default_rng(seed)
    years = np.sort(np.concatenate([rng.uniform(0, 1.5, before), rng.uniform(1.5, 3, after)]))
    value = 1 + step * (years > 1.5) + drift * (years - 1.5)
    value += 0.04 * rng.normal(size=years.size) + 0.01 * rng.normal(size=years.size)
    series = Series(
        metric="mtf_nyquist", when=START + years, value=LEVEL * value,
        std=np.full(years.size, LEVEL * 0.01), image=np.arange(years.size),
    )  # fmt: skip
    trend = fit_trend(series, [Event("2022-07-02T12:00", "refocus")])
    size = trend.events[0].size
    return (
        float(_holds(size.interval(), LEVEL * step)),
        float(_holds(trend.rate.interval(), LEVEL * drift)), size.std / LEVEL,
    )  # fmt: skip


EVENTS = {
    "20 and 20 images, -10 %": (20, 20, -0.1, 0.0),
    "8 and 3, +5 %": (8, 3, 0.05, 0.0),
    "8 and 3, +50 %, drift -5 % a year": (8, 3, 0.5, -0.05),
    "5 and 3, -60 %, drift -3 % a year": (5, 3, -0.6, -0.03),
    "20 and 5, +60 %, drift -5 % a year": (20, 5, 0.6, -0.05),
}


def _holds(interval: tuple[float, float], truth: float) -> bool:
    return interval[0] <= truth <= interval[1]


def percent(share: float) -> str:
    """A share in per cent."""
    return f"{100 * share:.1f}"


def main() -> None:
    arguments = command(__doc__.partition("\n")[0], 200).parse_args()
    draws, seed = range(arguments.draws), arguments.seed
    rows = []
    for name, case in CASES.items():
        for named in (True, False):
            label = name if named else "  the same, names unknown"
            jobs = [(case, named, (seed, draw)) for draw in draws]
            mean = np.mean(work_through(answers, jobs, arguments.processes, label), axis=0)
            wrong = mean[8] / max(mean[7], 1e-9)
            rows.append([label, *map(percent, mean[:3]), *(f"{100 * one:.2f}" for one in mean[3:5]),
                         *map(percent, mean[5:8]), percent(wrong)])  # fmt: skip
    means = []
    for name, case in CASES.items():
        jobs = [(case, True, (seed, 1, draw)) for draw in range(MEAN_DRAWS)]
        held, std = np.mean(work_through(mean_answers, jobs, arguments.processes, name), axis=0)
        means.append([name, percent(held), f"{100 * std:.2f}"])
    events = []
    for name, (before, after, step, drift) in EVENTS.items():
        jobs = [(before, after, step, drift, (seed, draw)) for draw in draws]
        mean = np.mean(work_through(event_answers, jobs, arguments.processes, name), axis=0)
        events.append([name, *map(percent, mean[:2]), f"{100 * mean[2]:.1f}"])
    parts = [
        f"{IMAGES} images over {YEARS:g} years of a steady sensor; targets differ by 4 %, images "
        "scatter by 2 %, deviations are stated as 1 % (all of them standard deviations, relative "
        "to the level), where nothing else is said. A requirement is a minimum within 6 % of the "
        "truth.",
        table(
            ["targets", "level held / %", "rate held / %", "mean held / %", "level's std / %",
             "mean's std / %", "false steps / %", "said not to be steady / %",
             "requirement answered / %", "of these wrongly / %"], rows,
        ),
        "## Means alone",
        f"{MEAN_DRAWS} archives each.",
        table(["targets", "mean held / %", "mean's std / %"], means),
        "## Stated steps",
        "Scatter 4 %, stated deviations 1 %, three years, the event in their middle.",
        table(["event", "step held / %", "rate held / %", "step's std / %"], events),
    ]  # fmt: skip
    publish("Targets and events in trends", parts, arguments)


if __name__ == "__main__":
    main()
