"""A planned watch over a sensor in words and as a drawing."""

from __future__ import annotations

import math
from itertools import cycle
from typing import TYPE_CHECKING

from acutance.archive.counted import counted
from acutance.archive.trends.trend_plan import NOTICED
from acutance.curves.aligned_columns import align_columns
from acutance.report.labels import MISSING, format_number
from acutance.report.paper import FAINT, INK, PALETTE, new_page, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from acutance.archive.trends import PlannedWatch, TrendPlan

__all__ = ["trend_plan_figure", "trend_plan_text"]


def trend_plan_text(plan: TrendPlan) -> str:
    """A planned watch as text: what is assumed, every design, when the drift is noticed.

    Parameters
    ----------
    plan : TrendPlan
    """
    options = plan.options
    earlier = len(options.earlier)
    assumed = (
        f"scatter between images {_per_cent(options.scatter)}, deviation of the mean of an image "
        f"{_per_cent(options.std)}, all in shares of the level"
    )
    if earlier:
        assumed += (
            f"\n  {counted(earlier, 'image')} of the last {max(options.earlier):.1f} years count, "
            "too"
        )
    rows = [("images", "years", "all", "deviation of the", "", "drift of", "least drift"),
            ("a year", "from now", "images", "drift a year", "at best",
             f"{_per_cent(options.drift_per_year)} noticed", "noticed a year"),
            *map(_row, plan.designs)]  # fmt: skip
    simulated = (
        f"by trends of {options.draws} simulated series each"
        if options.draws
        else "by theory alone: trends, which allow for steps, need more"
    )
    # A trend takes drifts to be small beforehand, and little else says how large they are then.
    few = (
        "; of few images trends take a drift to be small, and state less"
        if any(one.std < one.bound for one in plan.designs)
        else ""
    )
    return "\n\n".join([
        f"Plan of a watch for a drift of {_per_cent(options.drift_per_year)} a year\n  {assumed}",
        align_columns(rows, "rrrrrrr")
        + f"\n  at best: a line through normal scatter, nothing else allowed for{few}"
        f"\n  least drift: noticed in 8 of 10 cases, {simulated}",
        "\n".join(_answer(plan, pace) for pace in dict.fromkeys(options.images_per_year)),
    ])  # fmt: skip


def _row(watch: PlannedWatch) -> tuple[str, ...]:
    return (
        f"{watch.images_per_year:.3g}", f"{watch.years:g}", str(watch.images),
        _per_cent(watch.std), _per_cent(watch.bound), f"{100 * watch.noticed:.0f} %",
        _per_cent(watch.least_drift),
    )  # fmt: skip


def _per_cent(share: float) -> str:
    return f"{format_number(100 * share, 2)} %" if math.isfinite(share) else MISSING


def _answer(plan: TrendPlan, pace: float) -> str:
    """When the drift is noticed at one pace, in a sentence."""
    needed, designs = plan.years_needed(pace), plan.of_pace(pace)
    drift = _per_cent(plan.options.drift_per_year)
    who = f"{pace:.3g} images a year"
    if math.isnan(needed):
        last = designs[-1]
        return (
            f"{who} do not notice {drift} a year within {_years(last.years)} (the least is "
            f"{_per_cent(last.least_drift)}): take more images or more time, or lower the scatter"
        )
    if needed == designs[0].years:
        return f"{who} notice {drift} a year after {_years(needed)} or sooner"
    return f"{who} notice {drift} a year after about {needed:.1f} years"


def _years(count: float) -> str:
    return "1 year" if count == 1 else f"{count:g} years"


def trend_plan_figure(plan: TrendPlan) -> Figure:
    """The least drift that is noticed, and how often the planned one is, over time.

    Parameters
    ----------
    plan : TrendPlan
    """
    from matplotlib.ticker import LogLocator, NullLocator

    options = plan.options
    with styled():
        figure = new_page(10.4, 4.6)
        least, noticed = figure.subplots(1, 2)
        for pace, color in zip(dict.fromkeys(options.images_per_year), cycle(PALETTE)):
            designs = plan.of_pace(pace)
            years = [one.years for one in designs]
            label = f"{pace:.3g} images a year"
            least.plot(years, [one.least_drift for one in designs], "o-", color=color, label=label)
            noticed.plot(years, [one.noticed for one in designs], "o-", color=color, label=label)
        asked = _per_cent(options.drift_per_year)
        _line(least, abs(options.drift_per_year), f"{asked} a year")
        _line(noticed, NOTICED, "8 of 10")
        least.set(yscale="log", xlabel="years from now", ylabel="least drift noticed, a year",
                  title="Noticed in 8 of 10 cases")  # fmt: skip
        noticed.set(ylim=(-0.03, 1.03), xlabel="years from now", ylabel="noticed",
                    title=f"A drift of {asked} a year")  # fmt: skip
        for axes in (least, noticed):
            axes.set_xlim(left=0)
            axes.yaxis.set_major_formatter(lambda share, _: f"{100 * share:g} %")
        least.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        least.yaxis.set_minor_locator(NullLocator())
        least.legend(loc="best")
    return figure


def _line(axes: Axes, at: float, words: str) -> None:
    axes.axhline(at, color=FAINT, linewidth=1, linestyle="--")
    axes.annotate(words, (0.01, at), (0, 3), xycoords=("axes fraction", "data"),
                  textcoords="offset points", fontsize=8, color=INK)  # fmt: skip
