"""Tuned numbers of the points room: what each is, what set it, what it gave.

"Benchmark" is ``benchmarks/points.py`` (eleven systems, 20 mirrors at 80 times the noise). "At
twice" and "at half" give how far MTF and RER move, in standard deviations, and by how much these
change, at most in five scenes of ten mirrors (a Gaussian, a halo, diffraction, a charge trail with
shot noise, grass).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats

__all__ = [
    "APERTURE_STD",
    "BEND",
    "BRIGHTEST_OVER_DARK",
    "BRIGHT_SHARE",
    "BROAD_PX2",
    "COMPENSATED",
    "CONFUSED_SIGMAS",
    "COVERED_ELSE_PX",
    "COVERED_PX",
    "DENSE_SHARE",
    "DETERMINED_POWER",
    "EXTENDED_RATIO",
    "EXTENT_TOLERANCE",
    "FAMILY_LOG_AMPLITUDES",
    "FAMILY_WEIGHTS",
    "GROWTH_LOG_EVIDENCE",
    "HALO_GRID",
    "KERNEL_FLOOR",
    "KERNEL_FLOOR_SHARE",
    "KERNEL_LOG_RATIO",
    "KERNEL_LOG_WIDTH",
    "KERNEL_SCALES",
    "LIKE_SENSORS",
    "LIT_PX",
    "LOBE_PX",
    "LOBE_SHARE",
    "LOG_AMPLITUDE",
    "LOG_AMPLITUDE_STARTS",
    "LOG_AMPLITUDE_STD",
    "MAX_CONFUSED",
    "MAX_LEVERAGE",
    "MIN_COMPARED",
    "MIN_LACK_PX2",
    "MIN_NEIGHBOUR_SHARE",
    "MIN_ODD",
    "MIN_POINT_PX2",
    "MIN_POPULATION",
    "MIN_SIZE_STD_PX2",
    "MIN_TIED_SOURCES",
    "MIXED_SHARE",
    "MODEL_ERROR",
    "MOMENT_LENIENCE_PX2",
    "MOMENT_SIGMAS",
    "NARROW_RATIO",
    "NEGLIGIBLE_BEND",
    "NOISE_FLOOR",
    "NO_PAD_PX",
    "OTHER_WEIGHT",
    "PAD_CONTRAST",
    "PAD_LOG_EVIDENCE",
    "PAD_MIN_NOISE",
    "PAD_OPEN_LOG_EVIDENCE",
    "PAD_SIDES_PX",
    "PRECISE_SIZE",
    "PROCESSES",
    "SAME_SIZE_SIGMAS",
    "SAMPLED_PX2",
    "SHAPE_ERROR",
    "SHARP_PX2",
    "SHARP_TOLERANCE",
    "SIGNIFICANT_GROWTH",
    "SIZE_TOLERANCE",
    "STANDS_OUT",
    "SURE_OF_PADS",
    "TIMES_USUAL",
    "UNLIKE_SHARE",
    "WIDE_RATIO",
]

# Spots -------------------------------------------------------------------------------------------
STANDS_OUT: Final = 6.0
"""Smoothed light over its noise of a candidate: noise alone gives one in 10^9 pixels."""
LOBE_PX: Final = 6.0
LOBE_SHARE: Final = 0.05
"""A spot within so many pixels of one brighter than this ratio is a ring or a lobe of it, and
disturbs it no more: the first ring of an aperture obscured by a third holds less."""
MIN_NEIGHBOUR_SHARE: Final = 0.12
"""Light of a pixel's eight neighbours over its own below which it is a hot pixel: a Gaussian of
0.3 px in the middle of a pixel gives 0.22."""
MIN_COMPARED: Final = 4
"""Spots from which on their median shape judges each of them."""
NARROW_RATIO: Final = 0.75
WIDE_RATIO: Final = 1.9
"""Variances over the median along the minor axis (less: cosmic ray) and the major one (more:
blended); of simulated single mirrors 0.3 to 0.8 px wide none was rejected in 300."""
MIN_LACK_PX2: Final = 0.06
"""So much less than the median a cosmic ray's variance is in any case: where optics leave next to
none, ratios mean nothing."""
MOMENT_SIGMAS: Final = 3.0
MOMENT_LENIENCE_PX2: Final = 0.03
"""Doubt about a moment: so many standard deviations of its noise, and what optics that are not
Gaussian add to it or take away."""
UNLIKE_SHARE: Final = 0.05
TIMES_USUAL: Final = 3.0
"""A source is unlike the others where the common blur leaves so large a share of its peak, and so
many times what is usual: diffraction leaves up to 0.03 of every source."""
COVERED_PX: Final = {
    "saturated": 9.0, "blended": 4.0, "edge": 4.0, "hot pixel": 1.0, "cosmic ray": 3.0,
}  # fmt: skip
COVERED_ELSE_PX: Final = 2.5
"""Radius around a rejected spot whose pixels are left out, by the reason."""

# Population --------------------------------------------------------------------------------------
SIZE_TOLERANCE: Final = 0.02
MIN_SIZE_STD_PX2: Final = 0.003
"""What optics that are no Gaussian add to the scatter of variances: a share of them, and so much in
any case; of simulated stars behind six systems 1 to 2 % (benchmarks/sky.py, which set all of these
numbers)."""
SAMPLED_PX2: Final = 0.5
SHARP_PX2: Final = 0.2
SHARP_TOLERANCE: Final = 0.13
"""Variance of spots below which these scatter with their phase, and by how much from so far below
on: of an obscured aperture 1 % at 0.49 px², 9 % at 0.37 and 15 % at 0.30."""
PRECISE_SIZE: Final = 0.1
"""Deviation of a variance over itself up to which a spot takes part in the search."""
SAME_SIZE_SIGMAS: Final = 3.0
"""Two sizes agree within so many standard deviations."""
BROAD_PX2: Final = 0.9
"""Variance of points from which on they are compared under a broader window."""
MIN_POINT_PX2: Final = 0.13
"""Variance through a pixel (0.083 alone) below which only the densest place is one of points."""
DENSE_SHARE: Final = 0.1
"""Density over the largest one from which on a place among the sizes is dense."""
MIN_ODD: Final = 3
MIN_POPULATION: Final = 5
"""Spots of other sizes that make a field mixed, and spots of one size that make its points."""
EXTENDED_RATIO: Final = 1.35
MIXED_SHARE: Final = 0.2
"""A field is mixed where this share of the precise spots has variances so many times those of the
population: a camera whose PSF varies over its field has 1.5 at its corners, in few spots."""
EXTENT_TOLERANCE: Final = 0.015
"""The same as `SIZE_TOLERANCE`, of extents about a common blur."""
CONFUSED_SIGMAS: Final = 2.0
MAX_CONFUSED: Final = 0.15
"""Up to so many of its standard deviations an excess of size hides in a spot's noise, and largest
share of extended objects among the spots so hidden."""

# Noise -------------------------------------------------------------------------------------------
LIT_PX: Final = 12.0
"""Light of a source is followed into other sources' pixels up to this distance. At twice 0.1
deviations; at half 0.4, and deviations 12 % too small."""
NOISE_FLOOR: Final = 4e-4
"""Minimum noise over the brightest source's peak: what the density of sensors leaves of a sensor
that is none of them, which no residual shows. Of 20 mirrors behind eight systems the errors of
MTF(0.5), MTF(0.25), RER and FWHM are 1.4 deviations at SNR 3000, 1.3 at 10,000 and 1.1 without
noise; with 4e-5, which arithmetic and tables leave, 1.7, 3.7 and 6.2. At half 1.6 in all; at twice
1.0, but rings of apertures are taken for less. Up to an SNR of 1000 nothing changes."""
MODEL_ERROR: Final = 0.02
"""Share of a source's light in a pixel that may be left before the pixel counts as an outlier, for
fields over which the PSF differs; elsewhere nothing at twice and half."""
SHAPE_ERROR: Final = 0.004
"""Share of it that may be left before noise that grows with the light is looked for."""
BRIGHT_SHARE: Final = 0.03
MAX_LEVERAGE: Final = 0.9
SIGNIFICANT_GROWTH: Final = 2.0
"""Pixels brighter than this share of the brightest, of whose noise the fit took up less than that,
have to scatter so many standard deviations more than the others before growth is looked for: it
saves the search where there is none, and at twice and half nothing changes."""
BRIGHTEST_OVER_DARK: Final = (
    0.5, 1.5, 4.5, 13.5, 40.5, 121.5, 364.5, 1093.5, 3280.5, 9841.5,
)  # fmt: skip
"""Variances of the brightest pixel's noise beyond that of a dark one, over the latter, tried; the
grid shifted by a factor 2 gives 0.2 deviations with shot noise. Of 16 stars with a variance 1000
times that of a dark pixel the errors at Nyquist are 1.2 deviations; without the last three 1.9."""
GROWTH_LOG_EVIDENCE: Final = 2.0
"""Gain of log evidence from which on noise is taken to grow with the light. At half 0.2
deviations, at twice none."""
DETERMINED_POWER: Final = 0.02
"""Information over that of the prior, from which on a combination of coefficients takes part in
the search for that growth. At twice 0.2 deviations, at half none."""
MIN_TIED_SOURCES: Final = 6
"""Sources from which on their backgrounds are tied to a common plane, of which three determine it.
At twice, where none of the ten is tied, 1.2 deviations with a halo, and errors half as large
again."""

# Pads --------------------------------------------------------------------------------------------
PAD_SIDES_PX: Final = (3.0, 4.0, 5.0)
NO_PAD_PX: Final = 2.0
"""Sides of pads under the sources that are tried, and of squares that may as well be the PSF: of
defocused and of sharpened optics the latter are likelier in 30 of 30 images without pads."""
PAD_CONTRAST: Final = 0.03
"""Prior standard deviation of their contrast over the peak of the brightest source."""
PAD_MIN_NOISE: Final = 0.033
"""Noise over that contrast below which no pads are sought (a peak 1000 times the noise): what the
prior of a PSF that diffracts or is out of focus lacks shows there, and looks like a pad."""
PAD_LOG_EVIDENCE: Final = 2.5
PAD_OPEN_LOG_EVIDENCE: Final = 1.0
SURE_OF_PADS: Final = 0.95
"""Gain of log evidence at which pads are as likely as none, from which on they are thought of, and
the probability from which on they are part of the model. Of 72 images without pads, compensated
products apart, four reached 1 and none 2.5; pads of 3 px and 2 % of the peak under a Gaussian gain
4 to 6 at SNR 80, 10 to 12 at SNR 200."""

# Prior of the point spread function --------------------------------------------------------------
FAMILY_LOG_AMPLITUDES: Final = {
    "telescope": -0.5,
    "halo": 0.0,
    "trail": -3.0,
    "smear": -3.0,
    "sharpened": -3.0,
    "restored": -3.0,
    "resampled": -3.0,
    "shifted": -3.0,
    "processed": -3.0,
}
"""Expected amplitude of every family relative to that of its own population: light of every sensor
goes through an aperture and much of it is scattered, few have the other causes. Halos expected a
factor e^.5 smaller: of 20 mirrors behind a halo of 5 % at SNR 80, 87 % of the intervals of RER hold
for 90 %, and the RMS errors of Gaussians are 2 to 5 % smaller."""
PROCESSES: Final = ((1.2, 0.6, 5), (0.7, 0.2, 6))
"""Extent and smoothness in widths of the blur, and the largest order of the modes, of SHAPE and
DETAIL; extent and smoothness are those of an LSF's processes. Orders up to 8 and 9, twice the
directions, change nothing beyond the third digit, with noise and without."""
APERTURE_STD: Final = 0.06
"""Prior standard deviation of the detector's aperture, beyond what the families have of it. At
three times that the FWHM of Gaussians scatters twice as much."""
LOG_AMPLITUDE: Final[Floats] = np.array([*FAMILY_LOG_AMPLITUDES.values(), -5.0, -5.0, -5.0])
LOG_AMPLITUDE_STD: Final = 2.0
"""Amplitudes of the families, SHAPE, DETAIL and TAIL relative to the source's flux, within a factor
7 either way, as those of edges. Those of SHAPE and DETAIL a factor e larger change nothing."""
LOG_AMPLITUDE_STARTS: Final[Floats] = np.array(
    [
        [0.0, 0.0, -3.0, -3.0, -2.0, -2.0, -3.0, -3.0, -3.0, -5.0, -5.0, -4.5],
        [-0.5, -0.5, -3.0, 0.3, -3.0, -3.0, -3.0, -3.0, -3.0, -5.0, -5.0, -5.0],
    ]
)
"""From where the likeliest amplitudes are sought: light far out, and motion. Without the second,
smear of a narrow blur was taken for other things: FWHM wrong by up to ten deviations."""
HALO_GRID: Final = (-2.4, -1.6, -0.8, 0.0, 0.8)
"""Log amplitudes of the halos that are integrated over: at the likeliest one alone, halos that the
pixels neither show nor exclude were taken for absent; from -4 on, 80 % of those intervals hold."""

# Density of sensors ------------------------------------------------------------------------------
FAMILY_WEIGHTS: Final = {"telescope": 3.0}
"""How often sensors of a family are expected, those of the others once. Both files are learned
from the population before light kernels were as common as heavy ones: learned anew, mirrors in
products that are compensated and interpolated held in 75 % instead of 89 % (12 sensors, SNR 200).
Of products at one phase the files lack what is odd across and along: in the median .003 to .006, of
some .05, where pixels at SNR 200 see about .0001. Beyond .015 the intervals of six of seven such
sensors miss by 3 to 5 deviations."""
OTHER_WEIGHT: Final = 0.05
"""How often a sensor is like none of the families, on the same scale."""
LIKE_SENSORS: Final = 80
"""Most sensors that share a covariance of their kernels. With one covariance a family the errors of
diffracting sensors at SNR 80 are .0084 for .0065 at Nyquist, of a Gaussian .0073 for .0066."""
KERNEL_SCALES: Final = (0.2, 0.7, 2.0)
"""Size of the kernels relative to that covariance: for a sensor like those that were drawn, and for
ones less and less like them. Without the last the errors of restored sensors at SNR 200 are .013
for .008 at Nyquist; others change by some per cent."""
KERNEL_LOG_WIDTH: Final = 0.12
KERNEL_LOG_RATIO: Final = 0.15
"""Standard deviations of the logarithms of the mean width, and of the ratio of the widths across
and along: sensors of another blur say less."""
KERNEL_FLOOR: Final = 3e-4
KERNEL_FLOOR_SHARE: Final = 0.005
"""Least standard deviation of a coordinate among sensors: some vary in few ways. So much in any
case, and a share of how far they depart, which is what the coordinates lack. Restored sensors that
were not drawn are likeliest at a share of .003 to .004; at .004 their intervals hold 2 to 6 % less
often than at .006, where errors of sharpened products at SNR 200 are larger by a third."""

COMPENSATED: Final = ("sharpened", "restored")
"""Families whose PSF has lobes: of 32 such sensors without pads, two gained 6 and more by them."""

# Iteration ---------------------------------------------------------------------------------------
BEND: Final = 3.0
"""Half of a peak's curvature, in peaks per square pixel, of a rather sharp system: error of second
order of a source that moved by one pixel. At twice 1.7 deviations with a charge trail, at half
none."""
NEGLIGIBLE_BEND: Final = 0.15
"""Share of the noise that errors of second order may have when the fit ends; at twice and half
nothing."""
