"""Numbers that were tuned on simulated bars and stars: what each is, and what set it.

"Benchmark" is `benchmarks/bars_star.py`: random stars and bars through eight kinds of sensors at
a contrast of 100 times the noise. Limits of the checks stand in `acutance.targets.check_table`.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.grid import Floats

__all__ = [
    "ABOUT_AS_WELL",
    "APERTURE_STD",
    "FAMILY_LOG_AMPLITUDE_STD",
    "FREE_LEVEL_LOG_AMPLITUDE",
    "FULL_HEIGHT",
    "LOG_AMPLITUDE",
    "LOG_AMPLITUDE_STD",
    "MAX_GROUP_REST",
    "MAX_RAISED",
    "MIN_LEVEL_SIGMAS",
    "MIN_STAR_STRENGTH",
    "NEIGHBOURS_STD",
    "NOISE_FLOOR",
    "PLACE_STD_PERIODS",
    "QUIET_SNR",
    "ROUNDNESS_STD",
    "STANDS_OUT",
    "STAR_FINEST_CPP",
    "STAR_SHAPE_SHARE",
    "SURE_DIRECTION",
    "TURNED_SHARE",
]

LOG_AMPLITUDE: Final[Floats] = math.log(3.0) + np.array([-4.6, -2.8, -4.3, -5.9, -4.0, -5.6, -4.0])
"""Prior amplitudes of the processes' round states (3), of the others (3) and of the tail.

Those along an edge, shared out over two dimensions: blur is mostly round. The benchmark's eight
systems gave errors over stated deviations of 0.77 (star) and 1.02 (bars, levels stated in both),
and 0.49 and 1.03 with fitted levels. Three times as much leaves the errors and widens a star's
contrast from 8.7 to 13.8 %, bars' from 0.61 to 0.81 %; a third raises the star's 0.49 to 1.11."""

LOG_AMPLITUDE_STD: Final = 1.2
"""How far the data may move a log amplitude, as along an edge."""

FAMILY_LOG_AMPLITUDE_STD: Final = 2.0
"""How far the data may move the amplitude of a family of sensors."""

FREE_LEVEL_LOG_AMPLITUDE: Final[Floats] = np.array([0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0])
"""Added to those of halo and tail where no levels are stated: nothing in the image then shows how
much light is scattered further than the widest spokes. Without it the errors over stated deviations
of a star's fitted level rise from 0.49 to 0.81 in the mean, and to 1.7 for the worst system."""

APERTURE_STD: Final = 0.18
"""How far the two widths of a detector differ from one pixel."""

ROUNDNESS_STD: Final = 0.4
"""How far bars' mean blur may differ between directions, relative to its variance."""

TURNED_SHARE: Final = 0.2
"""How often the blur of a sensor is expected to be turned against the axes of the image.

Ten groups in two sets at right angles, tilted by 4 and 8 degrees, one draw of each sensor: at 1 all
intervals of MTF(.25) and MTF(.5) across and along hold, with deviations at Nyquist of .019 and
.036. At .2 they are .009 and .016, and all hold of sensors along the axes, of ones turned by 12
degrees and of aberrated ones, 94 % of ellipses of .3 x .55 and .35 x .5 px at 20 to 45 degrees; of
those 72 % at .1."""

PLACE_STD_PERIODS: Final = 0.3
"""How well a group's place is known before the fit, in periods."""

NEIGHBOURS_STD: Final = 1.0
"""How far the light of neighbouring groups may differ from the last fit's, as a share of it."""

NOISE_FLOOR: Final = 1e-3
"""The smallest noise, relative to the contrast: what the models leave of sensors that none of their
functions follows exactly. Of stars behind diffraction with less noise than that the RER was .09 to
.44 too low at 2e-4, up to 12 deviations, and "good"; of five kinds of sensors all numbers are
within 2.1 deviations at 1e-3, and no further from the truth."""

STAR_FINEST_CPP: Final = 1.3
"""Pixels of finer spokes than this are left out: the printed centre may end there."""

STAR_SHAPE_SHARE: Final = 0.015
"""Standard deviation of what the prior does not know, over how far the transfer departs from a
Gaussian through a pixel. Set by 234 curves behind products that were sharpened, restored or
processed: 87 % of the intervals of MTF(0.5) held without, 94 % with it, and 93 and 98 % of those
of MTF(0.25); deviations are wider by 10 and 22 %, those of other sensors hardly."""

MAX_RAISED: Final = 3.0
"""No restoration raises the contrast of coarse spokes more: the fit of another wave does."""

MIN_LEVEL_SIGMAS: Final = 3.0
"""Deviations of the spokes' level above which it is one: a sine star fitted as a square wave ends
at 0.1 to 0.6, a true one at 10 and more."""

QUIET_SNR: Final = 500.0
"""Above this ratio of contrast to noise an image has no noise, and residuals are the model's."""

STANDS_OUT: Final = 0.2
"""A group of bars is where the smoothed image exceeds this share of its largest contrast."""

SURE_DIRECTION: Final = 0.15
"""Anisotropy of the gradients above which their direction is that of the bars, at a right angle
is not tried."""

ABOUT_AS_WELL: Final = 0.03
"""Share of a profile's variance by which another number of bars may explain it less."""

FULL_HEIGHT: Final = 0.8
"""A single bar is at least so high; finer bars than those resolved look like one of half of it."""

MAX_GROUP_REST: Final = 0.35
"""Share of a profile's variance that a group of bars may leave: edges and stars leave more."""

MIN_STAR_STRENGTH: Final = 0.25
"""Share of the rings' variance that the spokes of a star explain at least."""
