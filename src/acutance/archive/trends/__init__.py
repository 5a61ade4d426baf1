"""Trends: what years of measurements say of a sensor.

In the order the data take:

- `measured_series`: rows of an archive become a `series`, one metric of one sensor
- `gsd`: a GSD that changes is an event
- `images`: the measurements of an image are joined
- `design`: the columns of level, drift, season and stated events
- `steps`: steps at unknown dates, which places are weighed
- `target_effects`: what is peculiar to targets and sites that come again
- `combinations`: steps, season, tails and targets, each weighed by evidence
  (`acutance.numerics.student_regression`); `posterior`: all of them together
- `normal_mixture`, `scatter`, `bands`: what is read from it
- `changes`, `crossing`: steps and events; when a limit will be passed
- `fit_trend`: all of it, from a series to a `trend`; `words`, `documents`: as text and JSON
- `trend_plan`: how many images, over how long, until a drift is noticed
- `tuned`: the numbers that were tuned
"""

from acutance.archive.trends.bands import TrendBands
from acutance.archive.trends.changes import Change, EventEffect
from acutance.archive.trends.crossing import Crossing
from acutance.archive.trends.fit_trend import fit_trend
from acutance.archive.trends.series import Event, Series, date_of, decimal_year
from acutance.archive.trends.trend import BadDay, Trend
from acutance.archive.trends.trend_plan import (
    PlannedWatch,
    TrendPlan,
    TrendPlanOptions,
    plan_trend,
)

__all__ = [
    "BadDay",
    "Change",
    "Crossing",
    "Event",
    "EventEffect",
    "PlannedWatch",
    "Series",
    "Trend",
    "TrendBands",
    "TrendPlan",
    "TrendPlanOptions",
    "date_of",
    "decimal_year",
    "fit_trend",
    "plan_trend",
]
