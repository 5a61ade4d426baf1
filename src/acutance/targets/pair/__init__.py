"""Two images of one ground at different resolution: the MTF of the coarser one.

In the order data take: `grid` (how the images lie on each other), `register`, `tiles` (what is
read; `tile` holds one), `screen` (pixels that do not fit), `first_fit` (a Gaussian with the low
sensor's detector, `axis_blur`), `kernel_fit` (a free kernel, `kernel_basis`), `spectral_ratio` (the
published way), `kernel_otf` (kernel to OTF), `reference` (the high image's own MTF), `noise`,
`local` (departures from place to place), `checks`, `pair` (the public function),
`pair_measurement` (what comes out).
"""

from acutance.targets.pair.options import BiresolutionLimits, BiresolutionOptions
from acutance.targets.pair.pair import BIRESOLUTION_METHODS, measure_biresolution
from acutance.targets.pair.pair_measurement import BiresolutionMeasurement
from acutance.targets.pair.reference import MeasuredCurves, measured_reference

__all__ = [
    "BIRESOLUTION_METHODS",
    "BiresolutionLimits",
    "BiresolutionMeasurement",
    "BiresolutionOptions",
    "MeasuredCurves",
    "measure_biresolution",
    "measured_reference",
]
