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
    "APERTURE_STD",
    "BARS_NOISE_FLOOR",
    "FREE_LEVEL_LOG_AMPLITUDE",
    "LOG_AMPLITUDE",
    "LOG_AMPLITUDE_STD",
    "MAX_RAISED",
    "PLACE_STD_PERIODS",
    "QUIET_SNR",
    "ROUNDNESS_STD",
    "SCATTERED_STD",
    "STAR_FINEST_CPP",
    "STAR_NOISE_FLOOR",
]

LOG_AMPLITUDE: Final[Floats] = math.log(3.0) + np.array([-4.6, -2.8, -4.3, -5.9, -4.0, -5.6, -4.0])
"""Prior amplitudes of the processes' round states (3), of the others (3) and of the tail."""

LOG_AMPLITUDE_STD: Final = 1.2
"""How far the data may move a log amplitude."""

FREE_LEVEL_LOG_AMPLITUDE: Final[Floats] = np.array([0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0])
"""Added to those of halo and tail where no levels are stated."""

APERTURE_STD: Final = 0.18
"""How far the two widths of a detector differ from one pixel."""

ROUNDNESS_STD: Final = 0.4
"""How far bars' mean blur may differ between directions, relative to its variance."""

PLACE_STD_PERIODS: Final = 0.3
"""How well a group's place is known before the fit, in periods."""

SCATTERED_STD: Final = 1.0
"""How far the light that bars' ends and neighbours scatter may differ from the last fit's."""

BARS_NOISE_FLOOR: Final = 1e-3
STAR_NOISE_FLOOR: Final = 2e-4
"""The smallest noise, relative to the contrast: what the models leave of images without noise."""

STAR_FINEST_CPP: Final = 1.3
"""Pixels that see finer spokes than this are left out: the printed centre may end there."""

MAX_RAISED: Final = 3.0
"""No restoration raises the contrast of coarse spokes more: the fit of another wave does."""

QUIET_SNR: Final = 500.0
"""Above this ratio of contrast to noise an image has no noise, and residuals are the model's."""
