"""Two images of one ground at different resolution: the MTF of the coarser one.

In the order data take: `grid` (how the images lie on each other), `tiles` (what is read, without
`defects`; `tile` holds one), `register`, `screen` (pixels that do not fit), `gaussian_fit` (a
Gaussian with the low sensor's detector, `axis_gaussian`), `kernel_fit` (a free kernel,
`kernel_basis`, with its `kernel_prior` and `kernel_covariance`), `noise`, `spectral_ratio` (the
published way), `kernel_otf` (kernel to OTF), `reference` (the high image's own MTF, a
`reference_otf`), `residual_slopes` (what a part differs by: `local`, from place to place;
`equal_blur`, strong structures from weak ones), `checks`, `pair` (the public function),
`pair_measurement` (what comes out). `tuned` holds the numbers that were tuned.

Inside, "down" and "across" are the axes of the pixels: from row to row, and from column to column.
Only a measurement's `across` and `along` follow the satellite's track.
"""

from acutance.targets.pair.checks import PAIR_CHECKS
from acutance.targets.pair.options import BiresolutionOptions
from acutance.targets.pair.pair import BIRESOLUTION_METHODS, measure_biresolution
from acutance.targets.pair.pair_measurement import (
    BiresolutionMeasurement,
    Coherence,
    PairDetails,
)
from acutance.targets.pair.reference import MeasuredCurves, measured_reference

__all__ = [
    "BIRESOLUTION_METHODS",
    "PAIR_CHECKS",
    "BiresolutionMeasurement",
    "BiresolutionOptions",
    "Coherence",
    "MeasuredCurves",
    "PairDetails",
    "measure_biresolution",
    "measured_reference",
]
