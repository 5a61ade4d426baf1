"""Plan a watch over a sensor: how many images, over how long, until a drift is noticed."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any, Final

import numpy as np

from acutance.archive.counted import counted
from acutance.archive.trends.fit_trend import fit_trend
from acutance.archive.trends.series import Series
from acutance.archive.trends.trend import Trend
from acutance.archive.trends.tuned import MIN_IMAGES
from acutance.arguments import require_types
from acutance.curves.estimate import normal_quantile
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.execution import run_tasks

__all__ = ["NOTICED", "PlannedWatch", "TrendPlan", "TrendPlanOptions", "plan_trend"]

SCHEMA: Final = "acutance/trend-plan/1"
NOTICED: Final = 0.8
"""Probability from which a drift is called noticed: the usual power of a planned test."""
_TWO_SIDED_95: Final = normal_quantile(0.95)
_NOTICED_STDS: Final = _TWO_SIDED_95 + normal_quantile(2 * NOTICED - 1)
"""A drift of so many deviations lies outside of 0 with that probability (normal densities)."""
_MAX_IMAGES: Final = 2000
_START: Final = 2000.0
"""A year with decimals from which simulated series count; trends do not depend on it."""


@dataclass(frozen=True)
class TrendPlanOptions:
    """What a watch over a sensor is planned with; all but times relative to the level.

    Parameters
    ----------
    images_per_year : tuple of float
        Images with the target in clear sky; several are compared.
    years : tuple of float
        How long they are taken; several are compared.
    scatter : float
        Between images beyond the stated deviations (atmosphere, state of the target), as
        `Trend.relative_scatter` tells it of an archive.
    std : float
        Stated random deviation of the mean of one image.
    drift_per_year : float
        That is to be noticed; its sign does not matter.
    earlier : tuple of float
        Images that there are already: how many years before now each was taken.
    draws : int
        Simulated series of each design, 10 or more; 0 leaves the simulation out.
    seed : int
        Of the random numbers.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    images_per_year: tuple[float, ...] = (12.0,)
    years: tuple[float, ...] = (1.0, 2.0, 3.0, 5.0)
    scatter: float = 0.04
    std: float = 0.02
    drift_per_year: float = 0.01
    earlier: tuple[float, ...] = ()
    draws: int = 40
    seed: int = 2005

    def __post_init__(self) -> None:
        require_types(self)
        for name, low, high in (
            ("images_per_year", 0.1, 366.0), ("years", 0.1, 50.0), ("earlier", 0.0, 50.0),
        ):  # fmt: skip
            values = getattr(self, name)
            if not all(low <= one <= high for one in values) or not (values or name == "earlier"):
                raise OptionError(
                    f"{name} is {', '.join(f'{one:g}' for one in values) or 'none'}: give numbers "
                    f"from {low:g} to {high:g}"
                )
        for name, least in (("scatter", 0.0), ("std", 0.0), ("drift_per_year", 1e-6)):
            value = getattr(self, name)
            if not least <= (abs(value) if name == "drift_per_year" else value) <= 1:
                raise OptionError(
                    f"{name} is {value:g}: it is a share of the level, {least:g} to 1 (2 % is .02)"
                )
        if self.scatter + self.std == 0:
            raise OptionError("scatter and std are both 0: of such images two show any drift")
        if self.draws < 0 or 0 < self.draws < 10:
            raise OptionError(
                f"draws is {self.draws}: give 10 or more simulated series, or 0 for theory alone"
            )
        if self.seed < 0:
            raise OptionError(f"seed is {self.seed}: it has to be 0 or more")

    @classmethod
    def of_trend(cls, trend: Trend, **others: Any) -> TrendPlanOptions:
        """What an archive shows of its images, and those that it has.

        Parameters
        ----------
        trend : Trend
        **others
            Other fields, in place of what the trend says.

        Raises
        ------
        OptionError
            If the level of the trend may be 0: no share of it is known then.
        """
        if not trend.has_scale:
            raise OptionError(
                f"{trend.title}: the level {trend.level} may be 0, and a plan is in shares of it; "
                "plan with the scatter of another metric"
            )
        images, level = trend.images, abs(trend.level.value)
        when = np.repeat(images.when, images.images_by_place)
        span = images.last - images.first
        found: dict[str, Any] = {
            "images_per_year": (min(max((when.size - 1) / span, 0.1), 366.0),),
            "scatter": min(trend.relative_scatter, 1.0),
            "std": min(images.image_std / level, 1.0),
            "earlier": tuple((images.last - when).tolist()),
        }
        return cls(**{**found, **others})


@dataclass(frozen=True)
class PlannedWatch:
    """What one pace over one time gives; deviations and drifts are shares of the level a year.

    Attributes
    ----------
    images_per_year, years : float
    images : int
        Those that there are already among them.
    bound : float
        Least standard deviation of the drift: a line through normal scatter, nothing else allowed.
    std : float
        Median of the standard deviations that trends of simulated images state: they allow for
        steps, a season and heavy tails. ``nan`` without simulation.
    noticed : float
        How often the 95 % interval of the drift leaves out 0 where the sensor does drift; by
        the bound without simulation.
    least_drift : float
        That is noticed in 8 of 10 cases, told from the series of the drift asked for: up to a
        quarter too little where that is far smaller.
    """

    images_per_year: float
    years: float
    images: int
    bound: float
    std: float
    noticed: float
    least_drift: float


@dataclass(frozen=True)
class TrendPlan:
    """A planned watch: what every pace and every time gives.

    Attributes
    ----------
    options : TrendPlanOptions
    designs : tuple of PlannedWatch
        Paces in the order of the options, of each the times, rising.
    """

    options: TrendPlanOptions
    designs: tuple[PlannedWatch, ...]

    def of_pace(self, images_per_year: float) -> tuple[PlannedWatch, ...]:
        """The designs of one pace, the shortest time first."""
        return tuple(one for one in self.designs if one.images_per_year == images_per_year)

    def years_needed(self, images_per_year: float) -> float:
        """The time after which the drift is noticed in 8 of 10 cases; ``nan`` beyond those planned.

        Between two planned times it is interpolated: the least drift falls as a power of time.
        """
        ratios = [(one.years, one.least_drift / abs(self.options.drift_per_year))
                  for one in self.of_pace(images_per_year)]  # fmt: skip
        for place, (years, ratio) in enumerate(ratios):
            if ratio > 1:
                continue
            if place == 0:
                return years
            before, more = ratios[place - 1]
            share = math.log(more) / math.log(more / ratio)
            return float(before * (years / before) ** share)
        return math.nan

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and lists, for JSON; ``None`` where there is no number."""
        return {
            "schema": SCHEMA,
            "options": asdict(self.options),
            "designs": [
                {name: value if math.isfinite(value) else None for name, value in vars(one).items()}
                for one in self.designs
            ],
            "years_needed": {
                f"{pace:g}": value if math.isfinite(value := self.years_needed(pace)) else None
                for pace in self.options.images_per_year
            },
        }

    def to_csv(self) -> str:
        """The designs as CSV with a header; nothing where there is no number."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(vars(self.designs[0]))
        for one in self.designs:
            writer.writerow(f"{value:.6g}" if math.isfinite(value) else ""
                            for value in vars(one).values())  # fmt: skip
        return text.getvalue()


def plan_trend(
    options: TrendPlanOptions | None = None,
    *,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> TrendPlan:
    """How soon trends notice a drift, by theory and by trends of simulated series.

    Images are taken at random dates, all as good as one another, and measured in pixels of one
    size. Each simulated series is asked as an archive is (`fit_trend`).

    Parameters
    ----------
    options : TrendPlanOptions, optional
    workers : int, optional
        Processes; all cores unless given. With more than one, a script has to guard its own start
        by ``if __name__ == "__main__"``.
    progress : function of (done, total), optional

    Returns
    -------
    TrendPlan

    Raises
    ------
    OptionError
        If a design has fewer than three images, or more than 2000 that are yet to be taken.

    Examples
    --------
    >>> from acutance.archive.trends import TrendPlanOptions, plan_trend
    >>> plan = plan_trend(TrendPlanOptions(images_per_year=(12.0, 24.0), draws=0))
    >>> print(f"{plan.years_needed(24.0):.1f}")
    3.7
    """
    chosen = options or TrendPlanOptions()
    watches = [
        _bounded(chosen, pace, years)
        for pace in dict.fromkeys(chosen.images_per_year)
        for years in sorted(set(chosen.years))
    ]
    told = _simulated(chosen, watches, workers, progress)
    return TrendPlan(chosen, tuple(map(_with_simulation, watches, told)))


def _bounded(options: TrendPlanOptions, pace: float, years: float) -> PlannedWatch:
    """A design as a straight line through its images would have it."""
    new = round(pace * years)
    earlier = len(options.earlier)
    images = earlier + new
    if images < MIN_IMAGES or new > _MAX_IMAGES:
        beside = f", with {earlier} that there are already" if earlier else ""
        raise OptionError(
            f"a pace of {pace:g} a year over {years:g} years gives {counted(new, 'image')}"
            f"{beside}: a trend needs {MIN_IMAGES}, and up to {_MAX_IMAGES} are planned"
        )
    # Of uniform dates the variance is a twelfth of the square of the time.
    squares = new * years**2 / 12
    when = np.array([-one for one in options.earlier])
    middle = (when.sum() + new * years / 2) / images
    squares += new * (years / 2 - middle) ** 2 + float(((when - middle) ** 2).sum())
    bound = math.hypot(options.scatter, options.std) / math.sqrt(squares)
    return PlannedWatch(
        pace, years, images, bound, math.nan, _noticed(abs(options.drift_per_year) / bound),
        _NOTICED_STDS * bound,
    )  # fmt: skip


def _noticed(stds: float) -> float:
    """How often a normal number so many deviations from 0 differs from it at 95 %."""
    return 0.5 * (math.erfc((_TWO_SIDED_95 - stds) / math.sqrt(2))
                  + math.erfc((_TWO_SIDED_95 + stds) / math.sqrt(2)))  # fmt: skip


def _simulated(
    options: TrendPlanOptions,
    watches: Sequence[PlannedWatch],
    workers: int | None,
    progress: Callable[[int, int], None] | None,
) -> list[Floats]:
    """(draws, 3) of every design: stated deviation, whether it is noticed, the least that is."""
    tasks = [(place, draw) for place in range(len(watches)) for draw in range(options.draws)]
    found = np.full((len(watches), options.draws, 3), math.nan)
    done = 0

    def keep(task: int, told: tuple[float, float, float]) -> None:
        nonlocal done
        found[tasks[task]] = told
        done += 1
        if progress is not None:
            progress(done, len(tasks))

    run_tasks(partial(_watched, options, watches), tasks, keep, workers=workers)
    return list(found)


def _watched(
    options: TrendPlanOptions, watches: Sequence[PlannedWatch], task: tuple[int, int]
) -> tuple[float, float, float]:
    """The trend of one simulated series: what it states, and whether it leaves out 0.

    And from which drift on it would, if its interval moved with the drift.
    """
    place, _ = task
    watch = watches[place]
    rng = np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=task))
    new = rng.uniform(0, watch.years, watch.images - len(options.earlier))
    years = np.sort([*(-one for one in options.earlier), *new])
    value = 1 + options.drift_per_year * (years - years.mean())
    value += rng.normal(0, options.scatter, years.size) + rng.normal(0, options.std, years.size)
    series = Series(
        metric="mtf_nyquist", when=_START + years, value=value,
        std=np.full(years.size, options.std), image=np.arange(years.size),
    )  # fmt: skip
    low, high = fit_trend(series).rate.interval()
    drift = options.drift_per_year
    least = drift - low if drift > 0 else high - drift
    return (high - low) / (2 * _TWO_SIDED_95), float(not low <= 0 <= high), least


def _with_simulation(watch: PlannedWatch, told: Floats) -> PlannedWatch:
    if not told.size:
        return watch
    return replace(
        watch,
        std=float(np.median(told[:, 0])),
        noticed=float(told[:, 1].mean()),
        least_drift=float(np.quantile(told[:, 2], NOTICED)),
    )
