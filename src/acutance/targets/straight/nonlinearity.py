"""Image values that are not proportional to light: the curvature of their characteristic.

With u the linear image between the plateaus (0 dark, 1 bright), the values are modelled as

    v = u + c u (1 - u)

which a power law, a logarithm or a film curve is to second order. Light spreads by one line spread
function (LSF) whether it comes from the dark or from the bright side, so u(1 - u), which is even
about the edge where an even LSF gives what is odd, shows c. Two things show it:

- the shape: c against an even LSF, and against an odd part of the LSF as trails and coma give. A
  small odd part of low order cannot be told from c by one edge. A pulse shows both polarities: its
  LSF may have any shape;
- the noise: a curve of slope g' multiplies the noise of a side by g', so that ln of the ratio of
  the variances is 2 ln((1 - c) / (1 + c)) for white noise. Without a curve the brighter side has
  as much noise, or more by no more than photons make.

Both are weighed by their likelihoods, with the unknowns integrated out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import ndtr

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.noise import side_variances
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.curved_model import (
    CURVATURE_STD,
    CurvedModel,
    MeanProfile,
    first_blur,
    solve,
)
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.step_profile import Profile
from acutance.targets.straight.tuned import NOISE_FLOOR

__all__ = ["Curvature", "find_curvature", "gamma_of"]

_MAX_CURVATURE: Final = 0.7
"""A gamma of 3; where more were needed it is no curve but an asymmetric LSF."""
_MIN_SIGMAS: Final = 1.2
"""Of c in the first, linear step: below it no curve is looked for."""
_MAX_STEPS: Final = 5
_MAX_STEP: Final = 0.3
_SETTLED_SIGMAS: Final = 0.2
_LOPSIDED_WIDTHS: Final = 3.0
_MIN_SIDE_PIXELS: Final = 24
_HIGHER_ORDERS: Final = 0.1
_MIN_NOISE_SIGMAS: Final = 3.0
_MAX_LOG_RATIO: Final = 3.0
_MORE_THAN_PHOTONS: Final = 0.3

_PRIOR_EVEN, _PRIOR_ODD, _PRIOR_LOW_ODD = 0.5, 0.4, 0.1
_LOW_ODD_STD: Final = 0.25
"""Of linear sensors: an even LSF, any odd part, one of low order that looks like a curve; the
curvature it looks like: .25 is coma of .02 waves rms or a trail of .18 px."""
_WHITE, _PHOTONS = 0.6, 0.4
"""Of a sensor's noise on the two sides: equal, or growing with the light."""
_TEXTURE_SNR: Final = 60.0
"""Contrast over noise at which the noise is as likely the ground's, of any ratio; its odds fall
with the fourth power: 97 % at 26, as of paint on grass, 11 % at 100."""
_NOISE_BEFORE: Final = 0.85
"""Share of curves that the noise goes through; else it is added behind, as by compression."""
_TEXTURE_STD: Final = 1.5
_NOISE_STD: Final = 0.05
_GRID: Final[Floats] = np.linspace(-4.0, 4.0, 81)


@dataclass(frozen=True)
class Curvature:
    """The curvature of the characteristic of an image.

    Parameters
    ----------
    value, std : float
        c, and its standard deviation.
    log_odds : float
        Natural logarithm of the likelihood of a curve over that of none.
    """

    value: float
    std: float
    log_odds: float


NO_CURVATURE: Final = Curvature(0.0, math.inf, -math.inf)


def find_curvature(data: CheckData, profile: Profile) -> Curvature:
    """The curvature that the pixels of a straight target show.

    Parameters
    ----------
    data : CheckData
    profile : Profile
        The steps of the target.
    """
    ratio = _noise_ratio(data)
    unequal = ratio is not None and abs(ratio[0]) > _MIN_NOISE_SIGMAS * ratio[1]
    if len(profile.shares) == 1 and not (unequal or _is_lopsided(data)):
        return NO_CURVATURE
    try:
        shape = _shape(data, profile, unequal=unequal)
    except TargetError:
        return NO_CURVATURE
    if shape is None:
        return NO_CURVATURE
    if len(profile.shares) > 1:
        return Curvature(shape.value, shape.std, shape.curved - np.logaddexp(shape.odd, shape.even))
    return _with_noise(data, shape, ratio)


def gamma_of(curvature: float, curvature_std: float, dark: float, bright: float) -> str:
    """The power law of a curvature in words, if 0 is no light: "a gamma of 1.31 ± 0.08".

    Values are the 1 / gamma-th power of light. Empty where no such law bends so between the levels.
    """
    if not 0 < dark < bright:
        return ""
    gammas = np.exp(np.linspace(-1.5, 1.5, 301))
    levels = np.power.outer([dark, bright], gammas)
    middle = (0.5 * (levels[0] + levels[1])) ** (1 / gammas)
    bend = 4 * ((middle - dark) / (bright - dark) - 0.5)
    if not bend[0] < curvature < bend[-1]:
        return ""
    gamma, low, high = np.interp(
        [curvature, curvature - curvature_std, curvature + curvature_std], bend, gammas
    ).tolist()
    return f"a gamma of {gamma:.2f} ± {0.5 * (high - low):.2f}"


@dataclass(frozen=True)
class _Shape:
    """What the shape of the transition shows: c, and the log evidence of three models."""

    value: float
    std: float
    even: float
    odd: float
    curved: float


def _shape(data: CheckData, profile: Profile, *, unequal: bool) -> _Shape | None:
    """Compare an even LSF, one with an odd part, and a curve; of a pulse, any LSF and a curve.

    Where the two sides have no `unequal` noise, a curve is looked for only if the first step to it
    is longer than chance.
    """
    blur = first_blur(data, profile)
    measured = MeanProfile.of(data, blur.width_px)
    linear = CurvedModel.about(measured, blur, profile)
    everything = np.append(np.full(linear.odd.size, True), False)
    no_curve = (
        everything & np.append(~linear.odd, False) if len(profile.shares) == 1 else everything
    )
    curve = np.append(no_curve[:-1], True)
    even = solve(linear.normal(linear.mean, 0.0), linear, no_curve, 0.0)
    # A second time about the fitted response, not about that of the first fit.
    linear = linear.renewed(even.beta)
    normal = linear.normal(linear.mean, 0.0)
    even = solve(normal, linear, no_curve, 0.0, even)
    u = linear.response(even.beta)
    curved = solve(linear.normal(u, 0.0), linear, curve, 0.0, even)
    if abs(curved.beta[-1]) < _MIN_SIGMAS * curved.last_std and not unequal:
        return None
    odd = solve(normal, linear, everything, 0.0, even)
    c = 0.0
    for _ in range(_MAX_STEPS):
        step = float(curved.beta[-1])
        c = min(max(c + min(max(step, -_MAX_STEP), _MAX_STEP), -_MAX_CURVATURE), _MAX_CURVATURE)
        if abs(step) < _SETTLED_SIGMAS * curved.last_std:
            break
        u = linear.response(curved.beta)
        linear = linear.renewed(curved.beta)
        curved = solve(linear.normal(u, c), linear, curve, c, curved, most=2)
    if abs(c) >= _MAX_CURVATURE:
        return None
    # A parabola is the second order of a curve: the rest may cost a tenth of what it explains.
    explained = max(curved.log_evidence - even.log_evidence, 0.0)
    whole = curved.log_evidence + _HIGHER_ORDERS * explained
    whole = max(curved.log_evidence, min(whole, odd.log_evidence))
    return _Shape(c, curved.last_std, even.log_evidence, odd.log_evidence, whole)


def _is_lopsided(data: CheckData) -> bool:
    """Whether an edge shows any c against a Gaussian through a pixel: what it lacks is even.

    Most edges do not need the whole comparison.
    """
    if not isinstance(data.fit, SplineEdge):
        return True
    blur, s = data.fit.blur, -data.before
    near = np.abs(s) < _LOPSIDED_WIDTHS * blur.width_px
    u, lsf, by_sigma, _ = blur.esf_and_slopes(s[near])
    columns = np.stack([np.ones(u.size), u, lsf, by_sigma, u * (1 - u)])
    try:
        covariance = np.linalg.inv(columns @ columns.T)
    except np.linalg.LinAlgError:
        return True
    c = float(covariance[-1] @ (columns @ data.value[near]))
    return abs(c) > _MIN_SIGMAS * data.noise * math.sqrt(max(float(covariance[-1, -1]), 0.0))


def _noise_ratio(data: CheckData) -> tuple[float, float] | None:
    """Logarithm of bright over dark noise variance, and its deviation; none without noise."""
    dark, bright = side_variances(data.residual, data.value - data.residual)
    sides = [int(np.count_nonzero(side > data.far_px)) for side in (data.before, data.behind)]
    if min(dark, bright) <= NOISE_FLOOR**2 or min(sides) < _MIN_SIDE_PIXELS:
        return None
    chance = data.smoothness * (2 / sides[0] + 2 / sides[1])
    return math.log(bright / dark), math.hypot(_NOISE_STD, math.sqrt(chance))


def _with_noise(data: CheckData, shape: _Shape, ratio: tuple[float, float] | None) -> Curvature:
    """Weigh the shape with what the noise of the two sides shows."""
    # An odd part that looks like a curve of c: of sensors it is smaller than of curves.
    rarer = _log_normal(shape.value, _LOW_ODD_STD) - _log_normal(shape.value, CURVATURE_STD)
    low_odd = math.log(_PRIOR_LOW_ODD) + rarer + shape.curved
    linear = np.logaddexp(
        math.log(_PRIOR_EVEN) + shape.even,
        np.logaddexp(math.log(_PRIOR_ODD) + shape.odd, low_odd),
    )
    odds = shape.curved - float(linear)
    if ratio is None:
        return Curvature(shape.value, shape.std, odds)
    found, std = ratio
    widest = _most_photons(data.fit.dark, data.fit.bright)
    texture = 1 / (1 + (1 / (_TEXTURE_SNR * data.noise)) ** 4)
    c = np.clip(shape.value + shape.std * _GRID, -_MAX_CURVATURE, _MAX_CURVATURE)
    through = np.exp(-0.5 * _GRID**2) * _noise_density(
        found - 2 * np.log((1 - c) / (1 + c)), std, widest, texture
    )
    without = float(_noise_density(np.array([found]), std, widest, texture)[0])
    behind = np.exp(-0.5 * _GRID**2) * without
    density = _NOISE_BEFORE * through + (1 - _NOISE_BEFORE) * behind
    total = float(density.sum())
    odds += math.log(total / (without * float(np.exp(-0.5 * _GRID**2).sum())))
    value = float(density @ c) / total
    return Curvature(value, math.sqrt(float(density @ (c - value) ** 2) / total), odds)


def _most_photons(dark: float, bright: float) -> float:
    """Logarithm of the ratio of the sides' noise variances, if it is all from photons."""
    photons = math.log(bright / dark) if 0 < dark < bright else _MAX_LOG_RATIO
    return photons + _MORE_THAN_PHOTONS


def _noise_density(log_ratio: Floats, std: float, widest: float, texture: float) -> Floats:
    """Density of the logarithm of bright over dark noise variance, for linear values.

    `texture` is the chance that the noise is the ground's.
    """
    photons = (ndtr(log_ratio / std) - ndtr((log_ratio - widest) / std)) / widest
    sensor = _WHITE * _normal(log_ratio, std) + _PHOTONS * photons
    ground = _normal(log_ratio, math.hypot(_TEXTURE_STD, std))
    return np.asarray((1 - texture) * sensor + texture * ground)


def _normal(x: Floats, std: float) -> Floats:
    return np.asarray(np.exp(-0.5 * (x / std) ** 2) / (std * math.sqrt(2 * math.pi)))


def _log_normal(x: float, std: float) -> float:
    return -0.5 * (x / std) ** 2 - math.log(std)
