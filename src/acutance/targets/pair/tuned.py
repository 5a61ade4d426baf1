"""Numbers of the pair's estimators that were tuned, each with what it does and what set it.

The bench is the benchmark of bi-resolution in the documentation: eight systems, ratios 2 to 4.
Tolerances of iterations and properties of grids stand where they are used.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from acutance.curves.grid import Floats

__all__ = [
    "BLOCK_FOLLOWS",
    "BLOCK_NOISES",
    "BLOCK_OFF",
    "FAMILY_LOG_AMPLITUDE_STD",
    "FAR_SHARE",
    "FEW_BLOCKS_FOLLOW",
    "HALO_REACH_PX",
    "LEAKAGE",
    "LOG_AMPLITUDE",
    "LOG_AMPLITUDE_STD",
    "LONG_REACH_PX",
    "LONG_REACH_ROOM_PX",
    "LOST_WEIGHT",
    "MAX_INFLATION",
    "MAX_NOISE_SHARE",
    "MIN_MTF_OF_NOISE",
    "MIN_REGIONS",
    "NOISE_POWER_STD",
    "OVERLAP",
    "OWN_SHARE",
    "PARAMETER_STD",
    "QUIET_SHARE",
    "QUIET_TEXTURE",
    "SCALES_PX",
    "SHAPE_SHARE",
    "SHORT_REACH_PX",
    "TAIL_PX",
    "WEAK_SHARE",
]

SCALES_PX: Final = ((0.8, 0.3), (1.6, 0.7), (4.0, 1.8))
"""Extent L and smoothness l of CORE, FLANK and HALO, in low pixels. Every system of the bench needs
CORE; smear and diffraction need FLANK, scattered light needs HALO."""

TAIL_PX: Final = 0.5
"""Radius within which the 1/r^3 tail is flat, in low pixels."""

LOG_AMPLITUDE: Final[Floats] = np.log([0.1, 0.01, 0.001, 0.1])
"""Prior amplitudes relative to a kernel of volume 1: of CORE, FLANK and HALO per square pixel, of
the tail its own volume. Hyperpriors only: the data move them."""

LOG_AMPLITUDE_STD: Final = 0.7
"""How far the data may move them: within a factor of 2."""

FAMILY_LOG_AMPLITUDE_STD: Final = 2.0
"""How far the data may move the amplitude of a family of sensors."""

PARAMETER_STD: Final[Floats] = np.array([10.0, 1.0, 1.0, 1.0, 1.0, 0.3, 0.3, 1.0, 1.0, 1.0])
"""Volume, shifts (px), variances (px^2), widths of the detector (px); and how far the low image is
interpolated along rows, columns and both: 0 as it was sampled, 1 a product. All but the widths are
as good as free. Without the last three the kernel of interpolated products is too smooth: MTF(0.5)
is 0.010 to 0.016 wrong."""

LONG_REACH_PX: Final = 7.0
"""Reach of the taps where the region has room for it: HALO needs it."""

SHORT_REACH_PX: Final = 4.5
"""Reach elsewhere, and for registration: CORE and FLANK fit into it, HALO is left out."""

LONG_REACH_ROOM_PX: Final = 32
"""Side from which a region has room for the long reach. At 32 a quarter of its pixels is lost,
which costs less than a halo beyond the reach: without it M(.25) of systems with 2 to 15 % of
scattered light is .015 too low, and its intervals hold the truth in 19 %."""

HALO_REACH_PX: Final = 5.75
"""Reach from which HALO is fitted: with less, it cannot be separated from the tail."""

MAX_NOISE_SHARE: Final = 0.5
"""Share of a direction's power in the reference that may be taken for noise: where it is more, the
reference does not determine the direction, and dividing by what is left would make it up."""

NOISE_POWER_STD: Final = 0.3
"""Relative standard deviation of the reference's noise power, besides what may be texture."""

MIN_MTF_OF_NOISE: Final = 0.1
"""The smallest MTF at Nyquist that what is uncertain by noise is a share of: of one near zero it is
a large share, and a good number all the same."""

QUIET_SHARE: Final = 0.25
"""Share of blocks taken for quiet where the reference's noise is estimated."""

QUIET_TEXTURE: Final = 0.87
"""How much the excess of third over sixth differences counts beside the former, where blocks in
which it is read are chosen: in white noise it is then 0 on average (mean squares of blocks have
covariances of .031, .021 and .017). Noise of variance 100 is estimated as 87, and as 84 with blocks
chosen by sixth differences, where MTF(.5) at SNR 25 is .002 lower and held in 91 % for 94. The rest
is by how much the quietest quarter is quiet by chance: without it, MTF(.5) is .007 too high."""

LOST_WEIGHT: Final = 0.05
"""Weight below which a pixel is left out: 6.3 standard deviations. Clouds lie beyond."""

MIN_REGIONS: Final = 6
"""Regions from which their scatter is read: of fewer, the scatter of the scatter is over 60 %."""

OWN_SHARE: Final = 0.5
"""Share of the inflation at a frequency that is its own, the rest the mean over the band. 1 makes
deviations noisy, 0 leaves those of other colours, which look like a halo, too small."""

MAX_INFLATION: Final = 20.0
"""The largest inflation, of deviations: beyond it the check has failed for long."""

BLOCK_FOLLOWS: Final = 0.7
"""Correlation of a block from which it shows the same ground: such blocks state gain and noise."""

BLOCK_OFF: Final = 0.7
"""Residual of a block, relative to its model, from which it does not show the same ground."""

BLOCK_NOISES: Final = 5.0
"""How many times the noise that residual has to be besides."""

FEW_BLOCKS_FOLLOW: Final = 0.2
"""Share of the blocks with structure that have to follow: with fewer, this is no cloud."""

LEAKAGE: Final = 0.003
"""Relative error that a window's leakage leaves in a spectrum where both images agree perfectly."""

OVERLAP: Final = 4.0
"""Neighbouring frequencies and windows share their pixels: a tapered window holds a quarter as many
independent numbers as frequencies, and half overlapping windows as many as there are pixels."""

SHAPE_SHARE: Final = 0.06
"""What the basis cannot follow of a departure from the parametric kernel, relative to it. Without
noise the transfer of sensors drawn from all families is wrong by .02 to .09 of it, that of wide
halos by .2; no pixel shows it."""

FAR_SHARE: Final = 0.4
"""Standard deviation of the light beyond the taps over what the tail says of it: behind a telescope
it is true, of halos of 4 to 5 px it is .8 too much."""

WEAK_SHARE: Final = 0.15
"""Share of the gradients' power that counts as weak structure. At .3 and .5 fewer of the pairs
whose reference was filtered are named: 29 and 4 % of 24, instead of 38 %."""
