"""Numbers of this room that were tuned: what each is, which benchmark set it, what it gave.

Lengths named WIDTHS are in units of the blur's full width at half maximum (FWHM), shares in units
of the contrast. Tolerances of iterations and the sizes of grids stand where they are used.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics import otf_families

__all__ = [
    "APERTURE_PX",
    "APERTURE_TAIL_PX",
    "BORDER_STRIP",
    "BROAD_PRIOR",
    "CHANGE_SIGMAS",
    "CURVATURE_STD_PER_PX",
    "DETAIL",
    "DETAIL_LOG_AMPLITUDE",
    "FAMILY_LOG_AMPLITUDES",
    "FAMILY_WEIGHTS",
    "FAR_GROUND_STEPS",
    "GRADIENT_SIGMAS",
    "GROUND_LOG_AMPLITUDE",
    "HALO_SHARE",
    "HALO_WIDTH_PX2",
    "KERNEL_FLOOR",
    "KERNEL_LOG_WIDTH",
    "KERNEL_SCALES",
    "LOG_AMPLITUDE",
    "LOG_AMPLITUDE_STD",
    "MAX_ANGLE_BY_ROWS_DEG",
    "MAX_CORRECTED_WIDTH",
    "MAX_FINE_STEP",
    "MAX_NOISE_CORRELATION",
    "MAX_OUTLIER_SHARE",
    "MAX_RESAMPLED_POWER",
    "MAX_SENSOR_MISFIT",
    "MAX_TOLERANCE",
    "MIN_CONTRAST_SHARE",
    "MIN_CONTRAST_SNR",
    "MIN_FITTED_HEIGHT",
    "MIN_PHASES",
    "MIN_PILED_PIXELS",
    "MIN_ROWS",
    "MIN_SIDE_PIXELS",
    "MIN_SNR",
    "MIN_SPECTRUM_PIXELS",
    "MIN_STRENGTH_SHARE",
    "MIN_TRUSTED_SNR",
    "MISFIT",
    "NEAR_GROUND_STEPS",
    "NEAR_TOLERANCE",
    "NOISE_FLOOR",
    "NONLINEAR_LOG_ODDS",
    "OTHER_WEIGHT",
    "OUTLIER_SIGMAS",
    "PLATEAU_TOLERANCE",
    "QUIET_SIDE",
    "QUIET_TRANSITION",
    "REPEATED_SIGMAS",
    "RIM_ODDS",
    "RIM_STD",
    "ROUNDED_NOISE",
    "STRUCTURE_OUTLIER_SIGMAS",
    "STRUCTURE_SIGMAS",
    "TAIL_LOG_AMPLITUDE",
    "TAIL_WIDTH",
    "TRAIL_LIKE_RIM_ODDS",
    "TRAIL_LIKE_WIDTHS",
    "TREND_LOG_AMPLITUDE",
    "TREND_LOG_AMPLITUDE_STD",
]

# The prior of the line spread function, LSF (lsf_prior.py).
FAMILY_LOG_AMPLITUDES: Final = {
    **otf_families.FAMILY_LOG_AMPLITUDES,
    "shifted": -3.0,
    "processed": -3.0,
}
"""Expected amplitude of every family relative to that of its own population: as in the plane, and
few products are interpolated at one phase or processed twice. What is scattered or aberrated
departs along directions of these."""
DETAIL: Final = (0.7, 0.17)
"""Fine structure of the peak: extent L and smoothness l of its process, in widths."""
DETAIL_LOG_AMPLITUDE: Final = -3.0
TAIL_LOG_AMPLITUDE: Final = -5.0
TAIL_WIDTH: Final = 1.0
"""Half width of the 1/u^2 tail: diffraction's noise-free error .002 (benchmarks/accuracy.py)."""
LOG_AMPLITUDE: Final[Floats] = np.array(
    [*FAMILY_LOG_AMPLITUDES.values(), DETAIL_LOG_AMPLITUDE, TAIL_LOG_AMPLITUDE]
)
LOG_AMPLITUDE_STD: Final = 2.0
"""Within a factor of 7 either way: narrower ones make Gaussian sensors pay for what they do not
have (MTF at Nyquist, 40 px, SNR 100: RMS .0060 at 1.2, .0056 at 2)."""
FAMILY_WEIGHTS: Final = {"telescope": 3.0, "restored": 2.0, "aberrated": 0.3, "deferred": 0.3}
"""How often sensors of a family are expected, those of the others once (sensor_density.py).
Compensated telescopes are one family and most products: counted once, light kernels over them pass
for halos (40 px, SNR 100, strengths of .1 to .4: 84 % of the intervals of RER hold, then 91). Coma
looks like a strip along the border and is rarer: of 159 strips 30, 29 and
25 stay unnoticed at a weight of one, .3 and none. Deferred charge does, too."""
MAX_SENSOR_MISFIT: Final = 20.0
"""Chi-square by which the density of sensors may follow the pixels less than the normal prior,
which has some five more degrees of freedom."""
OTHER_WEIGHT: Final = 0.05
"""How often a sensor is like none of the families, in units of the kernels of one size of one
family."""
KERNEL_SCALES: Final = (0.3, 0.7)
"""Size of the kernels of the density of sensors relative to its family: that of a sensor like those
that were drawn, and of one unlike them."""
KERNEL_LOG_WIDTH: Final = 0.12
"""Standard deviation of the logarithm of the width: sensors of other blur say less."""
KERNEL_FLOOR: Final = 1e-3
"""Least standard deviation of a coordinate of a family: families of one cause vary in few."""
MAX_RESAMPLED_POWER: Final = 2.5
"""Largest power of the noise of resampled products, over that of white noise: texture has more."""
MISFIT: Final = 3e-4
"""Residuals below this share of the contrast are the model's own, not noise."""
NOISE_FLOOR: Final = 2e-4
"""The smallest noise that is told from the arithmetic's and the model's own."""
BORDER_STRIP: Final = 1.2
"""Standard deviation of a strip along the border of textured ground, narrower than the blur, over
that of the texture: ground at its border is not quite that beside it. Of 600 clean edges of
landscapes (eleven families of sensors) 96 % of the intervals at Nyquist and of RER hold then;
without it 94 and 90 %, and 2.3 % of the edges called good, whatever lies beside them, are off by
more than 3 deviations, with it .8."""
BROAD_PRIOR: Final = 10.0
"""Width of a prior that says nothing of the LSF, relative to the sum over the families of the
second moments of the sensors that were drawn: of what the pixels alone say chi-square at the true
OTF is then .7 of its freedom over all families (at 3 it is .5; of the normal prior itself 1 to 50,
sharpened sensors being far from it)."""
APERTURE_PX: Final = (1.0, 0.18)
"""Mean and standard deviation of the detector's aperture: fill factors are near one."""
CURVATURE_STD_PER_PX: Final = 1e-3
"""Curvature of lines beyond that of the first fit (bend.py): radii of 1000 px and more."""
NEAR_GROUND_STEPS: Final[Floats] = np.array([1.2, 1.6, 2, 2.5, 3, 3.5, 4, 4.75, 5.5, 6.25, 7])
FAR_GROUND_STEPS: Final[Floats] = np.array([8.2, 10, 13, 17, 23])
"""Where the ground beside a target may have steps, in widths: from where the blur ends
(ground_steps.py)."""
GROUND_LOG_AMPLITUDE: Final = -6.0
"""Random walk of the ground: .25 % of the height per root of a width, within a factor of 7."""
TREND_LOG_AMPLITUDE: Final = -2.5
TREND_LOG_AMPLITUDE_STD: Final = 0.5
"""Trends of the plateaus (gradients.py): 8 % of the height, larger than any on purpose, and known
within a factor of 1.6. An amplitude that may vanish does so where a slope is too weak to be seen,
and the slope is then taken for a halo."""
HALO_SHARE: Final = 0.2
"""Standard deviation of a pulse's halo relative to itself (pulse_halo.py): fits are wrong by 0 to
28 % of it over halos of 1.5 to 4 px, diffraction and defocus (benchmarks/pulse.py)."""
HALO_WIDTH_PX2: Final = 0.6
"""Standard deviation of a pulse's width by its uncertain halo: so much times the uncertain share of
the light, over the width. Of 60 pulses of 3 px behind diffraction 83 % of the intervals held
without, behind halos 92."""

# Which pixels are used (trim.py, find_edges.py, find_pulse.py, edge.py, many_edges.py).
PLATEAU_TOLERANCE: Final = 0.12
MAX_TOLERANCE: Final = 0.22
NEAR_TOLERANCE: Final = 0.3
"""How far the mean of 3 x 3 pixels may leave its plateau: at least, on the roughest background, and
within 1.5 widths (benchmarks/trials.py)."""
MIN_ROWS: Final = 8
"""Rows of an edge with plateaus on both sides: one cycle of phases at 7 degrees."""
MIN_SNR: Final = 3.0
"""Height over noise, and over the plateaus' roughness, below which there is no edge."""
MIN_FITTED_HEIGHT: Final = 0.1
"""Height of the fitted response over that of the first fit, below which there is no step: of the
random regions of benchmarks/fuzz.py those below had no 50 % point, or an MTF of ten."""
MIN_PHASES: Final = 1.5
"""Sub-pixel phases below which nothing is measured: the profile has gaps of two thirds of a pixel,
those of an edge at 45 degrees .71. Of 1100 edges and pulses with 1.5 to 2, behind sensors of all
families, 93 to 98 % of the intervals hold, as of others; of edges along the grid 91 %."""
MIN_STRENGTH_SHARE: Final = 0.1
MIN_CONTRAST_SHARE: Final = 0.8
"""Of all edges of a target: weakest segment that is tried, and lowest contrast that is kept,
relative to the strongest: those of the target's border with its surroundings are lower."""
MAX_CORRECTED_WIDTH: Final = 0.15
"""A fitted pulse width further from the stated one is another width: the fit starts again there."""

# Checks (edge_checks.py, pixel_checks.py, structure_checks.py, pulse_checks.py).
OUTLIER_SIGMAS: Final = 4.5
"""Beyond: an outlier. Of Gaussian noise one pixel in 150 000."""
CHANGE_SIGMAS: Final = 4.0
"""Chi-square of the parts along an edge, in its deviations: of 200 clean edges none lies beyond."""
STRUCTURE_SIGMAS: Final = 3.0
GRADIENT_SIGMAS: Final = 3.5
REPEATED_SIGMAS: Final = 5.0
STRUCTURE_OUTLIER_SIGMAS: Final = 4.0
"""Structure, slopes and repeated residuals below so many deviations are chance: at these, 200 of
200 clean simulated edges pass every check (tests of false targets)."""
NONLINEAR_LOG_ODDS: Final = 0.7
"""Natural logarithm of the odds of a curve or a shoulder over none (nonlinearity.py): of edges of
30 to 60 px at SNR 30 to 500 behind fifteen kinds of sensors .2 % lie beyond, of those with trails
of .15 to .4 px as many, and 98 % of those behind a gamma of 1.3."""
RIM_ODDS, TRAIL_LIKE_RIM_ODDS, TRAIL_LIKE_WIDTHS = 0.2, 0.01, 1.3
RIM_STD: Final = 0.15
"""Strips along an edge (rim.py): prior odds of one; of one narrower than so many widths that widens
the edge, as charge trails do (of 93 edges behind a trail 5 are called doubtful, of others none);
standard deviation of its height, in contrasts."""
MIN_CONTRAST_SNR: Final = 20.0
MIN_TRUSTED_SNR: Final = 10.0
MAX_NOISE_CORRELATION: Final = 0.9
MAX_OUTLIER_SHARE: Final = 0.03
"""Contrast over the plateaus' variation, correlation and outliers that straight targets may have:
over 3300 edges of landscapes lower contrast and more correlation come with no more errors
(benchmarks/verdicts.py), as the intervals allow for both; below an SNR of 10 what is taken for an
edge in decimated scenes and clouds is structure (benchmarks/real_edges.py)."""
MAX_ANGLE_BY_ROWS_DEG: Final = 30.0
"""Of methods that work row by row (KOMPSAT-3 draft 3d)."""
MIN_PILED_PIXELS: Final = 20
MIN_SIDE_PIXELS: Final = 24
"""Pixels of a side that clipping, and slopes, are judged by."""
MIN_SPECTRUM_PIXELS: Final = 250
"""Pixels of a side that tell the power of its noise to a quarter. Of an edge of 200 a side in a
Sentinel-2 band MTF at Nyquist was off by 3 deviations from that of a pair of bands."""
QUIET_SIDE: Final = 1e-4
QUIET_TRANSITION: Final = 2e-3
"""Noise of a side and of the transition below which an image has none: nothing to clip."""
ROUNDED_NOISE: Final = 1.25
"""Noise over that of rounding below which an image has hardly any other: .2 steps add a fifth."""
MAX_FINE_STEP: Final = 1e-4
"""Steps of the image's numbers that curves do not resolve."""
APERTURE_TAIL_PX: Final = 0.1
"""The LSF of an aperture falls as a / s^2: a is .065 px for a cutoff of 1 c/px, .1 for .65."""
