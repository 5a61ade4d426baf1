"""Measurements: an image in, a `Measurement` out."""

from acutance.fit.bars_group import Bars
from acutance.measure.bars import BARS_METHODS, BarsGroup, BarsMeasurement, measure_bars
from acutance.measure.bars_options import BarsLimits, BarsOptions
from acutance.measure.biresolution import BIRESOLUTION_METHODS, measure_biresolution
from acutance.measure.biresolution_measurement import BiresolutionMeasurement
from acutance.measure.biresolution_options import BiresolutionLimits, BiresolutionOptions
from acutance.measure.biresolution_reference import MeasuredCurves, measured_reference
from acutance.measure.combination import CombinedMeasurement, CombinedPart, combine
from acutance.measure.combine_options import CombineLimits, CombineOptions
from acutance.measure.edge import METHODS, measure_edge
from acutance.measure.measurement import Check, ImageInfo, Measurement, Samples
from acutance.measure.measurement2d import Measurement2d
from acutance.measure.options import EdgeLimits, EdgeOptions, PulseLimits, PulseOptions
from acutance.measure.plane_slices import PlaneSlices
from acutance.measure.points import POINTS_METHODS, PointsMeasurement, measure_points
from acutance.measure.points_evidence import PointSource
from acutance.measure.points_options import PointsLimits, PointsOptions
from acutance.measure.points_survey import SurveyErrors, survey_errors
from acutance.measure.pulse import PULSE_METHODS, measure_pulse
from acutance.measure.star import STAR_METHODS, Rings, StarMeasurement, measure_star
from acutance.measure.star_options import StarLimits, StarOptions
from acutance.measure.target import EdgeGroup, Rejected, TargetResult, measure_edges

__all__ = [
    "BARS_METHODS",
    "BIRESOLUTION_METHODS",
    "METHODS",
    "POINTS_METHODS",
    "PULSE_METHODS",
    "STAR_METHODS",
    "Bars",
    "BarsGroup",
    "BarsLimits",
    "BarsMeasurement",
    "BarsOptions",
    "BiresolutionLimits",
    "BiresolutionMeasurement",
    "BiresolutionOptions",
    "Check",
    "CombineLimits",
    "CombineOptions",
    "CombinedMeasurement",
    "CombinedPart",
    "EdgeGroup",
    "EdgeLimits",
    "EdgeOptions",
    "ImageInfo",
    "MeasuredCurves",
    "Measurement",
    "Measurement2d",
    "PlaneSlices",
    "PointSource",
    "PointsLimits",
    "PointsMeasurement",
    "PointsOptions",
    "PulseLimits",
    "PulseOptions",
    "Rejected",
    "Rings",
    "Samples",
    "StarLimits",
    "StarMeasurement",
    "StarOptions",
    "SurveyErrors",
    "TargetResult",
    "combine",
    "measure_bars",
    "measure_biresolution",
    "measure_edge",
    "measure_edges",
    "measure_points",
    "measure_pulse",
    "measure_star",
    "measured_reference",
    "survey_errors",
]
