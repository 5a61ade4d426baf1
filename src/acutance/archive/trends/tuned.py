"""Numbers of trends that were tuned: what each is, which benchmark set it, what it gave.

All are relative to the level of the series; ``benchmarks/trends.py`` measures what they give.
"""

from __future__ import annotations

from typing import Final

__all__ = [
    "CHANGED",
    "DEGREES",
    "DRIFT_STDS_PER_YEAR",
    "EVENT_STDS",
    "FREE_TARGET_STD",
    "MAX_IMAGES",
    "MIN_IMAGES",
    "MIN_IMAGES_BY_STEPS",
    "MIN_SEGMENT",
    "NO_STD",
    "OUTLIER_SCALES",
    "REPORTED_SIGN",
    "REPORTED_SPAN",
    "REPORTED_STEP",
    "SCATTER",
    "SEASON_PROBABILITY",
    "SEASON_STD",
    "STEPS_PER_YEAR",
    "STEP_STD",
    "TARGET_STDS",
]

DRIFT_STDS_PER_YEAR: Final = {0.05: 0.4, 0.3: 0.1}
"""Standard deviations of the prior of a drift, and their prior probabilities: the rest is that of a
sensor that does not drift at all. With the first alone a loss of 25 % a year, seen for a year, came
out as 16 ± 4 %."""
STEP_STD: Final = 0.08
"""Standard deviation of the prior of the size of a step."""
STEPS_PER_YEAR: Final = 0.03
"""How often a step is expected that no event is stated for. With 0.1 the interval of a drift of 2 %
a year held 99 % instead of 95 %: it allows for steps; with less, drifts stand in for steps."""
REPORTED_STEP: Final = 0.3
"""Probability from which a step is reported: 3 % of series that drift by 2 % a year and 1 % of
steady ones are said to have one. At 0.2 it is 8 %."""
REPORTED_SPAN: Final = 0.5
"""Part of the series within which the date of a step has to be known, if its sign is not."""
REPORTED_SIGN: Final = 0.9
"""Probability that a step goes up, or that it goes down, from which it is reported, whatever is
known of its date. Over many years small steps are probable beforehand, and images that drift do not
exclude them: without this 16 % of series that drift by 1 % a year for 15 years were said to have a
step, now 5 %."""
CHANGED: Final = 0.5
"""Probability of a drift or a step from which a sensor is said not to be steady."""
EVENT_STDS: Final = {0.15: 0.7, 0.6: 0.3}
"""Standard deviations of the prior of the steps at events, stated ones and changes of the GSD, and
their prior probabilities: they are expected to change much. With the first alone a step of 50 %
before three images was drawn towards none, and its interval held 79 %."""
TARGET_STDS: Final = {0.004: 0.12, 0.015: 0.24, 0.035: 0.32, 0.08: 0.21, 0.18: 0.11}
"""Standard deviations of what is peculiar to targets (or sites) that come again, and their prior
probabilities: a half-Cauchy prior of median .035. With .025 the rate of four sites that followed
one another, and differed by 4 %, was held by 89 %."""
FREE_TARGET_STD: Final = 0.3
"""Standard deviation by which effects are first taken out, as good as free."""
SEASON_STD: Final = 0.03
"""Standard deviation of the prior of the cosine and of the sine of a season."""
SEASON_PROBABILITY: Final = 0.2
NO_STD: Final = 1e-4
"""Standard deviation of what is absent: one form of the model serves with and without it."""
SCATTER: Final = 0.04
"""Median of the prior of the scatter between images (half-Cauchy)."""
DEGREES: Final = (3.0, 8.0, 60.0)
"""Degrees of freedom of the scatter between images: heavy tails to nearly normal, all likely."""
MIN_SEGMENT: Final = 3
"""Images before, after and between steps: fewer are bad days."""
MIN_IMAGES_BY_STEPS: Final = (8, 15, 24)
"""Images from which one, two and three steps are sought."""
MIN_IMAGES: Final = 3
MAX_IMAGES: Final = 200
"""More images are joined in the order of time: steps are sought among so many at most."""
OUTLIER_SCALES: Final = 4.5
"""An image farther than so many scales from the trend is a bad day."""
