"""Periodic targets: groups of bars, and Siemens stars.

In the order data take: `bars_find` (with `bars_rows`), `star_find` (with `star_extent`,
`star_rings`), `bars_pixels` with `bars_ends` and `bars_neighbours`, `star_waves` (with
`star_tables`) and `star_kernels` (the images of modes), `fit_bars` and `fit_star` (one fit of all
pixels of a two-dimensional optical transfer function, OTF: `otf_regression`, `otf_model`; of bars
`oblique_blur` weighs how their blur is turned; `star_rings` sees in the residuals what the modes do
not follow; `stated_contrast` holds levels known beforehand; `curvature` is that of values that are
not proportional to light, `uneven_contrast` that of some groups or sides, `residual_share` what the
fit leaves of either), `bars_readings` (plain readings), `bars_checks`, `star_checks` (with
`pattern_checks`, what both ask), `bars_measurement`, `star_measurement`, `bars` and `star` (the
public functions). The numbers that were tuned stand in `tuned`.
"""

from acutance.targets.periodic.bars import BARS_METHODS, measure_bars
from acutance.targets.periodic.bars_checks import BARS_CHECKS
from acutance.targets.periodic.bars_measurement import (
    BarsDetails,
    BarsGroup,
    BarsMeasurement,
    GroupProfile,
)
from acutance.targets.periodic.bars_options import BarsOptions
from acutance.targets.periodic.star import STAR_METHODS, measure_star
from acutance.targets.periodic.star_checks import STAR_CHECKS
from acutance.targets.periodic.star_measurement import Rings, StarDetails, StarMeasurement
from acutance.targets.periodic.star_options import StarOptions

__all__ = [
    "BARS_CHECKS",
    "BARS_METHODS",
    "STAR_CHECKS",
    "STAR_METHODS",
    "BarsDetails",
    "BarsGroup",
    "BarsMeasurement",
    "BarsOptions",
    "GroupProfile",
    "Rings",
    "StarDetails",
    "StarMeasurement",
    "StarOptions",
    "measure_bars",
    "measure_star",
]
