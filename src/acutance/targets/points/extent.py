"""How much wider than the common PSF each source is: galaxies that pass for points at first.

Sizes of spots by moments come from few pixels each, and neighbours disturb them. Once the likely
points are fitted by one PSF, what each needs beyond it is a number with a standard deviation: the
variance of a Gaussian that its image would have to be blurred with.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.targets.points import tuned
from acutance.targets.points.first_fit import own_columns
from acutance.targets.points.points_fit import PointsFit
from acutance.targets.points.population import densest_sharpest

__all__ = ["excess_variances", "same_extent"]


def excess_variances(fit: PointsFit) -> tuple[Floats, Floats]:
    """Variance of every source beyond that of the common PSF, as a share of it.

    Returns
    -------
    excess, std : (k,) arrays
        To first order, and its standard deviation by the noise, correlated as it is.
    """
    stamps, blur = fit.stamps, fit.model.blur
    slopes = blur.slopes(*stamps.offsets(fit.places))
    own = own_columns(stamps, fit.places, fit.fluxes, slopes[:3])
    wider = (slopes.by_xx + slopes.by_yy) * fit.fluxes[stamps.owner]
    residual, noise = fit.residual, fit.pixel_noise
    row, col = (one.astype(np.intp) for one in (stamps.row, stamps.col))
    excess, std = np.empty((2, fit.fluxes.size))
    for k, (begin, end) in enumerate(zip(stamps.starts[:-1], stamps.starts[1:], strict=True)):
        level = np.maximum(noise[begin:end], 1e-300)
        columns, alone = own[begin:end] / level[:, None], wider[begin:end] / level
        alone = alone - columns @ np.linalg.lstsq(columns, alone, rcond=None)[0]
        power = max(float(alone @ alone), 1e-300)
        excess[k] = float(alone @ (residual[begin:end] / level)) / power
        rows, cols = (one[begin:end] - one[begin:end].min() for one in (row, col))
        std[k] = math.sqrt(fit.correlation.seen_by(alone, rows, cols) / power)
    variance = sum(0.5 * (width / FWHM_OF_SIGMA) ** 2 for width in blur.widths_px)
    return excess / variance, std / variance


def same_extent(excess: Floats, std: Floats) -> NDArray[np.bool_] | None:
    """Which sources have the extent of the sharpest consistent ones.

    Parameters
    ----------
    excess, std : (k,) arrays
        As `excess_variances` gives them.

    Returns
    -------
    (k,) bool array or None
        None where the sources whose extent is well determined have no extent in common.
    """
    size, doubt = 1 + excess[:, None], np.hypot(std, tuned.EXTENT_TOLERANCE)[:, None]
    precise = std < tuned.PRECISE_SIZE
    middle = densest_sharpest(size[precise], doubt[precise]) if precise.any() else None
    if middle is None:
        return None
    same = (np.abs(size - middle) < tuned.SAME_SIZE_SIGMAS * doubt)[:, 0]
    return same if (same & precise).sum() >= 0.5 * precise.sum() else None
