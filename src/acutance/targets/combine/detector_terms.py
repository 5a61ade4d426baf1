"""The last factors of every parametric sensor: charge that spreads, and a rectangular detector."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_terms import upright_smear, upright_smear_slopes
from acutance.targets.combine.term import Term

__all__ = ["DETECTOR_PARAMETERS", "detector_terms"]

DETECTOR_PARAMETERS = 2
"""Of diffusion and of the detector's fill."""
_FILL_STD = 0.12
"""Of the logarithm of a detector's width over the stated one: fill factors are near one."""
_DIFFUSION_MEAN, _DIFFUSION_STD = math.log(0.1), 1.0
"""Of the logarithm of the depth from which charge spreads, px: every detector has some."""


def detector_terms(detector_px: tuple[float, float]) -> dict[str, Term]:
    """Both, of a detector of a stated width across and along, in pixels."""
    log_px = np.log(detector_px)

    # A rectangle is a smear along both axes; both of its widths change with the fill.
    def detector(p: Floats, plane: Plane) -> Floats:
        return upright_smear(p + log_px, plane)

    def detector_slopes(p: Floats, plane: Plane) -> Floats:
        return np.asarray(upright_smear_slopes(p + log_px, plane).sum(axis=-2, keepdims=True))

    last = Term(detector, (0.0,), (_FILL_STD,), _fill_numbers, detector_slopes)
    return {"diffusion": _DIFFUSION, "detector": last}


def _fill_numbers(p: Floats) -> dict[str, float]:
    return {"detector_fill": math.exp(p[0])}


def _diffusion(p: Floats, plane: Plane) -> Floats:
    """Charge that spreads before it is collected: `acutance.optics.ChargeDiffusion`.

    A Gaussian where it takes little, of tails that fall more slowly.
    """
    return _sech(np.exp(p) * plane.waves)


def _diffusion_slopes(p: Floats, plane: Plane) -> Floats:
    travelled = np.exp(p) * plane.waves
    return np.asarray((-travelled * np.tanh(travelled) * _sech(travelled))[..., None, :])


def _diffusion_numbers(p: Floats) -> dict[str, float]:
    return {"diffusion_px": math.exp(p[0])}


def _sech(x: Floats) -> Floats:
    """One over the hyperbolic cosine, where that is too large as well."""
    falls = np.exp(-np.abs(x))
    return np.asarray(2 * falls / (1 + falls**2))


_DIFFUSION = Term(
    _diffusion, (_DIFFUSION_MEAN,), (_DIFFUSION_STD,), _diffusion_numbers, _diffusion_slopes
)
