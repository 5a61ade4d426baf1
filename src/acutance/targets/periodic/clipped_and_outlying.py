"""What bars and stars have in common: levels stated by the caller, clipped and outlying pixels."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.targets.periodic.stated_contrast import Levels

__all__ = ["QUIET_SNR", "clipped_share", "known_levels", "outlier_share"]

QUIET_SNR = 500.0
"""Above this ratio of contrast to noise there is no noise to speak of in an image."""

_PILED_UP = 5


def known_levels(dark: float | None, bright: float | None, std: float) -> Levels | None:
    """Both levels of a target's materials, or None where neither was stated.

    Raises
    ------
    OptionError
        If there is but one, dark is not the lower one, or the standard deviation is negative or
        belongs to no levels.
    """
    if (dark is None) != (bright is None):
        raise OptionError(
            "one level was given: give dark and bright, or neither (--dark, --bright)"
        )
    if not 0 <= std < math.inf:
        raise OptionError(f"level_std (--level-std) is {std:g}, it has to be 0 or more")
    if dark is None or bright is None:
        if std > 0:
            raise OptionError(
                f"level_std (--level-std) is {std:g}, but no levels are stated: give dark and "
                "bright (--dark, --bright) with it"
            )
        return None
    if not -math.inf < dark < bright < math.inf:
        raise OptionError(f"dark is {dark:g} and bright {bright:g}: dark has to be the lower one")
    return Levels(dark, bright, std)


def clipped_share(values: Floats, saturation_level: float | None, snr: float) -> float:
    """Share of the pixels, (n,), that reach the detector's limit or pile up at an end.

    Piling up tells something only where noise should have spread the values: uniform ground in an
    image without noise is all one number.
    """
    share = 0.0
    if saturation_level is not None:
        share = float(np.mean(values >= saturation_level))
    if snr > QUIET_SNR:
        return share
    return max(share, _piled_up(values), _piled_up(-values))


def outlier_share(residual: Floats, weight: Floats, contrast: float) -> float:
    """Share of the pixels, (n,), that do not fit.

    What is below the noise of a quiet image is the arithmetic's and none of the target's.
    """
    return float(np.mean((weight < 0.5) & (np.abs(residual) > abs(contrast) / QUIET_SNR)))


def _piled_up(values: Floats) -> float:
    """Share of the values that equal the largest, where that is more than chance."""
    _, counts = np.unique(values, return_counts=True)
    last, before = int(counts[-1]), int(counts[-2]) if counts.size > 1 else 0
    return last / values.size if last >= _PILED_UP and last > 3 * before else 0.0
