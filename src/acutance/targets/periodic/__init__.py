"""Periodic targets: groups of bars, and Siemens stars.

In the order data take: `bars_find`, `star_find` (with `star_extent`, `star_rings`), `bars_ends` and
`bars_seen`, `star_waves` (what a pixel sees), `fit_bars` and `fit_star` (one fit of all pixels of a
two-dimensional OTF: `otf_modes`, `otf_model`; `stated_contrast` holds levels known beforehand),
`bars` and `star` (the public functions), `bars_readings` (plain readings), `bars_checks`,
`star_checks`.
"""

from acutance.targets.periodic.bars import (
    BARS_METHODS,
    BarsGroup,
    BarsMeasurement,
    measure_bars,
)
from acutance.targets.periodic.bars_options import BarsLimits, BarsOptions
from acutance.targets.periodic.star import STAR_METHODS, Rings, StarMeasurement, measure_star
from acutance.targets.periodic.star_options import StarLimits, StarOptions

__all__ = [
    "BARS_METHODS",
    "STAR_METHODS",
    "BarsGroup",
    "BarsLimits",
    "BarsMeasurement",
    "BarsOptions",
    "Rings",
    "StarLimits",
    "StarMeasurement",
    "StarOptions",
    "measure_bars",
    "measure_star",
]
