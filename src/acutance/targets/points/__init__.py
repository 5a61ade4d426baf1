"""Point sources: arrays of convex mirrors, lamps, stars of the sky.

In the order data take: `detect` (bright spots; `moments` gives their shapes), `population` (the
points among objects of all sizes), `selection` (which of them are measured; `match_places` finds
those that are asked for), `stamps` (the pixels around each), `first_fit` (one Gaussian through a
pixel for all), `fit` (the joint fit, with `per_source`, `noise`, `background`, `psf`, `psf_prior`,
`psf_families`, `psf_spline`, `psf_modes`, `amplitudes`; its last pass is `among_sensors`, with
`sensor_density` and `pads`; `learn_psf` and `learn_sensors` made what `psf_families` and
`sensor_density` read; `points_fit` is its result, `pixels_alone` what the pixels say without a
prior), `extent` (what is wider), `sources` (the numbers of each), `survey` (against surveyed
places), `checks` (with `rounding`, noise in steps of the image's numbers), `points_measurement`
(the result), `points` (the public function); `published` (the Gaussian of the report of 2003),
`options`, and `tuned` (every tuned number, and what set it).
"""

from acutance.targets.points.checks import POINTS_CHECKS
from acutance.targets.points.options import PointsOptions
from acutance.targets.points.pads import Pads
from acutance.targets.points.points import POINTS_METHODS, measure_points
from acutance.targets.points.points_measurement import PointsDetails, PointsMeasurement
from acutance.targets.points.published import AlignedFit
from acutance.targets.points.sources import PointSource, SourceStamp
from acutance.targets.points.survey import SurveyErrors, survey_errors

__all__ = [
    "POINTS_CHECKS",
    "POINTS_METHODS",
    "AlignedFit",
    "Pads",
    "PointSource",
    "PointsDetails",
    "PointsMeasurement",
    "PointsOptions",
    "SourceStamp",
    "SurveyErrors",
    "measure_points",
    "survey_errors",
]
