"""Trends, weighted means and specifications against simulated archives whose truth is known.

Example: python benchmarks/trends.py --draws 1000 --processes 1
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import timedelta
from itertools import pairwise

import numpy as np
from trials import command, publish, table, work_through

from acutance.archive.specification import Requirement
from acutance.archive.specification_check import check_requirement
from acutance.archive.trends.fit_trend import fit_trend
from acutance.archive.trends.series import Series, date_of
from acutance.archive.weighted_means import weighted_mean

LEVEL = 0.16
START = 2021.0
DAYS = 60.0
WIDTH_95 = 2 * 1.959964
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Case:
    """How an archive is simulated; all but times relative to the level.

    Drift a year, a step in the middle, amplitude of a season. `tails` are degrees of freedom of
    the scatter (0: normal). `stated` is the stated deviation over the true one. `gap` leaves out
    the images of a year in the middle. `outlier` moves one image.
    """

    images: int = 40
    years: float = 3.0
    scatter: float = 0.04
    drift: float = 0.0
    step: float = 0.0
    season: float = 0.0
    tails: float = 0.0
    std: float = 0.01
    stated: float = 1.0
    each: int = 1
    gap: bool = False
    outlier: float = 0.0


STEADY = {
    "steady": Case(),
    "steady, 15 images": Case(images=15),
    "steady, 120 images": Case(images=120),
    "steady, Student-t scatter (3)": Case(tails=3.0),
    "steady, a season of 3 %": Case(season=0.03),
    "drift 2 %": Case(drift=0.02),
    "drift 2 %, 15 images": Case(drift=0.02, images=15),
    "drift 2 %, 120 images": Case(drift=0.02, images=120),
    "drift 1 %": Case(drift=0.01),
    "drift 5 %": Case(drift=0.05),
    "drift 1 %, 15 years, scatter 3 %": Case(years=15.0, drift=0.01, scatter=0.03),
    "drift -25 %, one year, scatter 2 %": Case(years=1.0, scatter=0.02, drift=-0.25),
    "drift 2 %, scatter 2 %": Case(drift=0.02, scatter=0.02),
    "drift 2 %, Student-t scatter (3)": Case(drift=0.02, tails=3.0),
    "drift 2 %, a season of 3 %": Case(drift=0.02, season=0.03),
    "drift 2 %, a gap of a year": Case(drift=0.02, gap=True),
    "drift 2 %, five measurements an image": Case(drift=0.02, each=5, std=0.05),
    "drift 2 %, stated std 0.8 of true": Case(drift=0.02, scatter=0.02, std=0.04, stated=0.8),
    "drift 2 %, stated std 1.25 of true": Case(drift=0.02, scatter=0.02, std=0.04, stated=1.25),
    "drift 2 %, one image off by 60 %": Case(drift=0.02, outlier=0.6),
}
STEPS = {
    "step 5 %, scatter 4 %": Case(step=0.05),
    "step 5 %, scatter 3 %": Case(step=0.05, scatter=0.03),
    "step 5 %, scatter 2 %": Case(step=0.05, scatter=0.02),
    "step 5 %, scatter 2 %, 120 images": Case(step=0.05, scatter=0.02, images=120),
    "step 5 %, scatter 4 %, 120 images": Case(step=0.05, images=120),
    "step 10 %, scatter 4 %": Case(step=0.10),
    "step 5 %, scatter 2 %, Student-t (3)": Case(step=0.05, scatter=0.02, tails=3.0),
    "step 5 %, scatter 2 %, drift 2 %": Case(step=0.05, scatter=0.02, drift=0.02),
    "step 5 %, scatter 2 %, drift -2 %": Case(step=0.05, scatter=0.02, drift=-0.02),
}
Job = tuple[Case, tuple[int, ...]]


def simulate(case: Case, rng: np.random.Generator) -> tuple[Series, np.ndarray]:
    """A series, and the true means of its images relative to the level."""
    years = np.sort(rng.uniform(0, case.years, case.images))
    if case.gap:
        years = np.sort(years * (case.years - 1) / case.years)
        years[years > case.years / 2 - 0.5] += 1
    truth = 1 + case.drift * (years - case.years / 2) + case.step * (years > case.years / 2)
    truth = truth + case.season * np.cos(2 * np.pi * (years - rng.uniform()))
    count = case.images
    noise = rng.standard_t(case.tails, count) if case.tails else rng.normal(size=count)
    value = truth + case.scatter * noise
    if case.outlier:
        value[case.images // 3] += case.outlier
    image = np.repeat(np.arange(case.images), case.each)
    measured = value[image] + case.std * rng.normal(size=image.size)
    series = Series(
        metric="mtf_nyquist", when=START + years[image], value=LEVEL * measured,
        std=np.full(image.size, LEVEL * case.std * case.stated), image=image,
    )  # fmt: skip
    return series, years


def one_trend(job: Job) -> tuple[float, ...]:
    """Whether the rate's interval holds, its deviation, probabilities and dates of steps."""
    case, seed = job
    series, years = simulate(case, np.random.default_rng(seed))
    begun = time.process_time()
    trend = fit_trend(series)
    seconds = time.process_time() - begun
    low, high = trend.rate.interval()
    true_rate = case.drift * LEVEL
    mean = trend.mean(START + case.years / 4, season=False)
    at_low, at_high = mean.interval()
    true_mean = LEVEL * (1 - case.drift * case.years / 4)
    middle = date_of(START + case.years / 2)
    near = [abs(change.date - middle) <= timedelta(days=DAYS) for change in trend.changes]
    inside = [change.since <= middle <= change.until for change in trend.changes]
    return (
        float(low <= true_rate <= high), (high - low) / WIDTH_95 / LEVEL,
        float(at_low <= true_mean <= at_high), float(len(trend.changes) > 0),
        float(any(near)), float(any(inside)), float(trend.steady_probability < 0.5),
        _oracle_days(series, years, case), seconds,
    )  # fmt: skip


def _oracle_days(series: Series, years: np.ndarray, case: Case) -> float:
    """How near the date comes to the truth where one step, both levels and no drift are known."""
    if not case.step or case.each > 1:
        return float("nan")
    value = series.value / LEVEL - case.drift * (years - case.years / 2)
    misfit = [
        ((value[:at] - 1) ** 2).sum() + ((value[at:] - 1 - case.step) ** 2).sum()
        for at in range(1, years.size)
    ]
    at = int(np.argmin(misfit)) + 1
    found = 0.5 * (years[at - 1] + years[at])
    return float(abs(found - case.years / 2) * 365.25 <= DAYS)


def jobs_of(case: Case, draws: int, seed: int) -> list[Job]:
    """So many archives of one case."""
    return [(case, (seed, draw)) for draw in range(draws)]


def percent(share: float) -> str:
    """A share in per cent."""
    return f"{100 * share:.1f}"


def trend_rows(
    cases: dict[str, Case], draws: int, seed: int, processes: int, columns: Sequence[int]
) -> list[list[str]]:
    """Means of some columns of `one_trend`, a row a case; each is said when it is there."""
    rows = []
    for name, case in cases.items():
        found = np.array(work_through(one_trend, jobs_of(case, draws, seed), processes, name))
        mean = found.mean(axis=0)
        rows.append([name, *(_written(column, mean[column]) for column in columns)])
        print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    return rows


def _written(column: int, value: float) -> str:
    if column == 1:
        return f"{100 * value:.2f}"
    return f"{value:.2f}" if column == 8 else percent(value)


def possible_rows(draws: int, seed: int) -> list[list[str]]:
    """How well the best step and the best line can be told apart at all, by their residuals."""
    rows = []
    for scatter in (0.04, 0.03, 0.02, 0.01):
        rng = np.random.default_rng(seed)
        stepped = Case(step=0.05, scatter=scatter)
        drifting = Case(drift=0.02, scatter=scatter)
        found = {
            case: np.array([_step_over_line(*simulate(case, rng)) for _ in range(draws)])
            for case in (stepped, drifting)
        }
        limit = np.quantile(found[drifting], 0.95)
        needed = np.quantile(found[stepped], 0.1)
        rows.append([f"{100 * scatter:.0f} %", percent((found[stepped] > limit).mean()),
                     percent((found[drifting] > needed).mean())])  # fmt: skip
    return rows


def _step_over_line(series: Series, years: np.ndarray) -> float:
    """How much less the squares of residuals are with the best step than with the best line."""
    value, count = series.value, series.size
    line = np.polyval(np.polyfit(years, value, 1), years)
    before = np.arange(3, count - 2)
    sums = np.cumsum(value)
    left, right = sums[before - 1], sums[-1] - sums[before - 1]
    kept = (left**2 / before + right**2 / (count - before)).max()
    return float(((value - line) ** 2).sum() - ((value**2).sum() - kept))


def mean_rows(draws: int, seed: int) -> list[list[str]]:
    """Coverage of weighted means by number of measurements, heterogeneity and deviations."""
    kinds: dict[str, tuple[float, Callable[[np.random.Generator, int], np.ndarray]]] = {
        "equal deviations": (0.0, lambda rng, count: rng.normal(size=count)),
        "unequal (factor 7)": (1.0, lambda rng, count: rng.normal(size=count)),
        "unequal, Student-t scatter (3)": (1.0, lambda rng, count: rng.standard_t(3, count)),
    }
    rows = []
    for name, (unequal, scatter) in kinds.items():
        for count in (2, 3, 5, 10, 40):
            row = [name, str(count)]
            for tau in (0.0, 0.3, 1.0, 3.0, 10.0):
                rng = np.random.default_rng((seed, count, int(10 * tau)))
                held = 0
                for _ in range(draws):
                    std = np.exp(unequal * rng.uniform(-1, 1, count))
                    shared = 0.5 * rng.normal()
                    value = tau * scatter(rng, count) + std * rng.normal(size=count) + shared
                    low, high = weighted_mean(value, std, systematic_std=0.5).mean.interval()
                    held += low <= 0 <= high
                row.append(percent(held / draws))
            rows.append(row)
    return rows


@dataclass(frozen=True)
class Judged:
    """A requirement judged: stated probability, whether it is truly met, the word."""

    probability: float
    is_met: bool
    word: str


def judge(job: tuple[int, tuple[int, ...]]) -> Judged:
    """One archive near the limit: the true mean lies within some deviations of it."""
    count, seed = job
    rng = np.random.default_rng(seed)
    drift = float(rng.normal(0, 0.01))
    case = Case(images=count, years=2.0, drift=drift, scatter=float(rng.uniform(0.01, 0.06)))
    series, years = simulate(case, rng)
    truth = LEVEL * (1 + drift * (years[-1] - case.years / 2))
    limit = float(truth * (1 + rng.uniform(-0.06, 0.06)))
    requirement = Requirement(metric="mtf_nyquist", minimum=limit, confidence=CONFIDENCE)
    found = check_requirement(requirement, series)
    assert found.probability is not None
    return Judged(found.probability, bool(truth >= limit), found.word)


def specification_rows(draws: int, seed: int, processes: int) -> tuple[list[list[str]], str]:
    """Stated probability against frequency, and how the decisions were."""
    jobs = [((4, 8, 20, 40)[draw % 4], (seed, draw)) for draw in range(draws)]
    judged = work_through(judge, jobs, processes, "specification")
    stated = np.array([one.probability for one in judged])
    met = np.array([one.is_met for one in judged])
    edges = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)
    rows = []
    for low, high in pairwise(edges):
        inside = (stated >= low) & ((stated < high) | (high == 1.0))
        if inside.any():
            rows.append([f"{low:g} to {high:g}", str(int(inside.sum())),
                         f"{stated[inside].mean():.3f}", f"{met[inside].mean():.3f}"])  # fmt: skip
    words = np.array([one.word for one in judged])
    said_met, said_not = words == "met", words == "not met"
    sentence = (
        f"At a confidence of {CONFIDENCE:g}: {percent(said_met.mean())} % were said to be met, "
        f"{percent((said_met & ~met).sum() / max(said_met.sum(), 1))} % of them wrongly; "
        f"{percent(said_not.mean())} % not met, "
        f"{percent((said_not & met).sum() / max(said_not.sum(), 1))} % of them wrongly; the others "
        "could not be told."
    )
    return rows, sentence


def large_rows() -> list[list[str]]:
    """Processor time of large series."""
    rows = []
    for name, case in {
        "100,000 measurements in 40 images": Case(each=2500, drift=0.02),
        "100,000 measurements in 1,000 images": Case(images=1000, each=100, drift=0.02),
        "100,000 measurements in 100,000 images": Case(images=100_000, drift=0.02),
    }.items():
        series, _ = simulate(case, np.random.default_rng(1))
        begun = time.process_time()
        trend = fit_trend(series)
        seconds = time.process_time() - begun
        rows.append([name, f"{seconds:.2f}", str(trend.relative_rate_per_year)])
    return rows


def main() -> None:
    parser = command(__doc__ or "", 1000)
    parser.add_argument("--some", type=int, default=300, help="draws of the other conditions")
    arguments = parser.parse_args()
    draws, some = arguments.draws, arguments.some
    seed, processes = arguments.seed, arguments.processes
    fit_trend(simulate(Case(), np.random.default_rng(0))[0])
    main_case = {"drift 2 %": Case(drift=0.02)}
    steady = trend_rows(main_case, draws, seed, processes, (0, 1, 2, 3, 6, 8))
    others = {name: case for name, case in STEADY.items() if name not in main_case}
    steady += trend_rows(others, some, seed, processes, (0, 1, 2, 3, 6, 8))
    steps = trend_rows(STEPS, some, seed, processes, (3, 4, 5, 7, 6, 0))
    rows, sentence = specification_rows(draws, seed, processes)
    parts = [
        f"Archives of 40 images over 3 years at random dates, scatter between images 4 % (standard "
        f"deviation; scale where Student-t), stated deviations 1 %, where nothing else is said. "
        f"Drift 2 % (scatter 4 %) and specifications: {draws} archives; others {some}. Held: how "
        "often 95 % intervals hold the truth.",
        "## Series without steps",
        table(["series", "rate held / %", "its std / % a year", "mean held / %", "false steps / %",
               "said not to be steady / %", "time / s"], steady),
        "## A step in the middle",
        f"The date within {DAYS:g} days, of all series; beside it what is possible for one who "
        "knows that there is one step, both levels, and the drift.",
        table(["series", "step found / %", "date within 60 days / %", "date's interval holds / %",
               "date, all else known / %", "said not to be steady / %", "rate held / %"], steps),
        "What is possible: of series with a step of 5 % and of others with a drift of 2 % a year, "
        "how often the best step leaves so much smaller residuals than the best line that 5 % of "
        "the drifting series would be mistaken; and how many of these are, where 90 % of the "
        "steps are to be found.",
        table(["scatter", "steps found / %, 5 % of drifts mistaken",
               "drifts mistaken / %, 90 % of steps found"], possible_rows(4 * draws, seed)),
        "## Specifications",
        "A minimum within 6 % of the true mean on the day of the last image; 4 to 40 images, "
        "drifts of 1 % a year (standard deviation), scatter 1 to 6 %.",
        table(["stated probability", "archives", "mean stated", "truly met"], rows), sentence,
        "## Weighted means",
        f"Held / % of the 95 % intervals, {draws} draws each, by scatter in units of a typical "
        "deviation; a systematic part of .5 is shared by all.",
        table(["measurements", "number", "0", ".3", "1", "3", "10"], mean_rows(draws, seed), 1),
        "## Large archives",
        table(["series", "processor time / s", "rate relative to the level"], large_rows()),
    ]  # fmt: skip
    publish("Trends and specifications", parts, arguments)


if __name__ == "__main__":
    main()
