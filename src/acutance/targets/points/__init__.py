"""Point sources: arrays of convex mirrors, lamps, stars of the sky.

In the order data take: `detect` (bright spots; `moments` tells what they are), `stamps` (the
pixels around each), `first_fit` (one Gaussian through a pixel for all), `fit` (the joint fit, with
`per_source`, `noise`, `background`, `psf`, `psf_prior`, `airy`, `amplitudes`), `points` (the public
function), `sources` (every source as evidence), `survey` (against surveyed places), `checks`,
`published` (the Gaussian of the report of 2003).
"""

from acutance.targets.points.options import PointsLimits, PointsOptions
from acutance.targets.points.points import POINTS_METHODS, PointsMeasurement, measure_points
from acutance.targets.points.sources import PointSource
from acutance.targets.points.survey import SurveyErrors, survey_errors

__all__ = [
    "POINTS_METHODS",
    "PointSource",
    "PointsLimits",
    "PointsMeasurement",
    "PointsOptions",
    "SurveyErrors",
    "measure_points",
    "survey_errors",
]
