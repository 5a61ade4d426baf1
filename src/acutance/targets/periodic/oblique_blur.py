"""The mean blur of bars as a mixture: along the axes of the image, or turned.

Two sets of bars at right angles, tilted by some degrees, determine the blur along their normals and
leave open how it is turned between them, on which the curves exactly across and along depend.
Detectors, motion, filters and apertures lie along the axes of the image, most sensors have no term
xy in the covariance of their blur; some have. Both are weighed by their marginal likelihoods.

The posterior with xy = 0 is that of the turned blur under this condition, and the likelihoods
differ by how much likelier the pixels make xy = 0 than the prior does (J. M. Dickey, Ann. Math.
Stat. 42, 204, 1971): there is nothing to be fitted anew.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from acutance.targets.periodic.otf_model import FittedOtf
from acutance.targets.periodic.tuned import TURNED_SHARE

__all__ = ["aligned_or_turned"]

_XY: Final = 2
"""Which of the mean's modes is that of the covariance xy."""


def aligned_or_turned(turned: FittedOtf, prior_std: float) -> FittedOtf:
    """The mean of both, with the covariance of the mixture.

    Parameters
    ----------
    turned : FittedOtf
        The OTF with xy free, about a round mean.
    prior_std : float
        Prior standard deviation of its coefficient.
    """
    row = turned.beta_factor[_XY]
    std = float(np.linalg.norm(row))
    if not std > 0:
        return turned
    off = float(turned.beta[_XY]) / std
    odds = TURNED_SHARE / (1 - TURNED_SHARE) * std / prior_std * math.exp(min(0.5 * off**2, 600.0))
    share = odds / (1 + odds)
    # What all coefficients have in common with xy, and how much of it the mixture keeps.
    common = turned.beta_factor @ row / std
    kept = math.sqrt(share + share * (1 - share) * off**2)
    return replace(
        turned,
        beta=turned.beta - (1 - share) * off * common,
        beta_factor=turned.beta_factor - (1 - kept) * np.outer(common, row / std),
    )
