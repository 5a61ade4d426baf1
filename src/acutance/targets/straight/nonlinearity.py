"""Image values that are not proportional to light: the curvature of their characteristic.

With u the linear image between the plateaus (0 dark, 1 bright), the values are modelled as

    v = u + c u (1 - u)                                                 a curve
    v = u + k ((1 - u0) u - max(u - u0, 0)^2 / (1 - u0))                a shoulder

A power law, a logarithm or a film curve is the former to second order; soft saturation, which
bends near the bright level only, the latter. Light spreads by one line spread function (LSF)
whether it comes from the dark or from the bright side. Two things show a characteristic that is
not straight:

- the shape: the sum of an edge and its mirror image (`mirror_sum`), which is zero behind an even
  LSF, has a part that follows u. It is weighed against an odd part of the LSF, as trails and coma
  give. A small odd part of low order cannot be told from a curve by one edge. A pulse shows both
  polarities: its LSF may have any shape (`curved_model`);
- the noise of the target's two levels (`side_noise`), which a curve of slope g multiplies by g.

Both are weighed by their likelihoods, with the unknowns integrated out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np
from scipy.special import log_ndtr

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.compiled import compiled
from acutance.optics.population import UNEVEN_FAMILIES
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.curved_model import (
    AMPLITUDE_STEPS,
    CURVATURE_STD,
    CurvedModel,
    MeanProfile,
    Solved,
    first_blur,
    solve,
)
from acutance.targets.straight.fit_edge import SplineEdge
from acutance.targets.straight.mirror_sum import EVEN, USUAL, MirrorSum, Weighed
from acutance.targets.straight.side_noise import SideNoise
from acutance.targets.straight.step_profile import Profile

__all__ = ["Curvature", "find_curvature", "gamma_of"]

_MAX_CURVATURE: Final = 0.7
"""A gamma of 3; where more were needed it is no curve but an asymmetric LSF."""
_MAX_SHOULDER: Final = 0.45
"""At .5 the brightest values no longer grow with the light."""
_SHOULDERS: Final[Floats] = np.array([0.6, 0.7, 0.8])
"""Where a shoulder may begin."""
_BEGINS: Final[Floats] = np.append(0.0, _SHOULDERS)
_MAX_FOLDS, _SETTLED_PX, _MIN_LOG_ODDS = 5, 0.02, -1.0
"""An edge is folded anew about the middle of the linear image, where a curve is not unlikely."""
_MIN_IMPLIED: Final = 0.2
"""Curvature that the noise alone implies, from which on an edge is folded about its middle too."""
_AMPLITUDE_STDS: Final[Floats] = np.array([CURVATURE_STD, 0.25, 0.25, 0.25])
"""Prior of c and of every k."""
_MIN_GAIN: Final = 0.1
"""Of log likelihood, by shape and noise, below which the odds of a curve cannot become large."""
_MIN_SIGMAS, _MIN_GAIN_OF_PULSES = 1.2, 1.0
"""Of c of a pulse in the first, linear step, and of log likelihood by its noise: where both are
below, the odds of a curve cannot become large."""
_HIGHER_ORDERS: Final = 0.1
_MAX_STEPS: Final = 5
_MAX_STEP: Final = 0.3
_SETTLED_SIGMAS: Final = 0.2
_PRIOR_LOG_ODDS_OF_PULSES: Final = -math.log(3)

_EVEN, _ODD, _LOW_ODD, _LOW_ODD_UNEVEN = 0.5, 0.1, 0.1, 0.3
_LOW_ODD_STD: Final = 0.25
"""Of linear sensors: an even LSF, any odd part, one of low order that looks like a curve, and one
where the fit has found an uneven family; the curvature that a low one looks like: .25 is coma of
.02 waves rms or a trail of .18 px."""
_BRIGHTENS: Final = 0.9
"""Of the curves, those that lift the middle, as gammas above 1, square roots and logarithms do."""
_PRIOR_SHOULDER: Final = 0.5
"""Of the characteristics that are not straight, those with a shoulder."""
_GRID: Final[Floats] = np.linspace(-4.0, 4.0, 41)
_NORMAL: Final[Floats] = np.exp(-0.5 * _GRID**2)
_NEGLIGIBLE: Final = 1e-12
_MIN_SLOPE: Final = 1e-3


@dataclass(frozen=True)
class Curvature:
    """How the characteristic of an image curves.

    Parameters
    ----------
    value, std : float
        c, or k of a shoulder, and its standard deviation.
    log_odds : float
        Natural logarithm of the likelihood of a curve, or a shoulder, over that of neither.
    shoulder : float, optional
        Where a shoulder begins, u0; 0 of a curve.
    """

    value: float
    std: float
    log_odds: float
    shoulder: float = 0.0

    @property
    def departure(self) -> float:
        """Largest distance of the characteristic from a straight line, for a value of one."""
        if self.shoulder == 0:
            return 0.25
        rest = 1 - self.shoulder
        return rest * (self.shoulder + 0.25 * rest**2)


NO_CURVATURE: Final = Curvature(0.0, math.inf, -math.inf)


def find_curvature(data: CheckData, profile: Profile, sign: float = 1.0) -> Curvature:
    """The curvature that the pixels of a straight target show.

    Parameters
    ----------
    data : CheckData
    profile : Profile
        The steps of the target.
    sign : float, optional
        -1 of a dark pulse, whose values are negated.
    """
    try:
        return _of_edge(data) if profile.is_edge else _of_pulse(data, profile, sign)
    except TargetError:
        return NO_CURVATURE


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


def _of_edge(data: CheckData) -> Curvature:
    """The curve or the shoulder that an edge shows, the likelier one.

    The linear image is odd about its own middle, which is not the 50 % point of the values.
    """
    noise = SideNoise.of(data)
    if not _may_curve(MirrorSum.of(data), noise):
        return NO_CURVATURE
    starts = [0.0]
    if noise is not None and abs(noise.curvature) > _MIN_IMPLIED:
        starts.append(_middle_px(data, Curvature(noise.curvature, 0.0, 0.0)))
    found = [_settled(data, noise, middle_px) for middle_px in starts]
    return max(found, key=lambda one: one.log_odds)


def _may_curve(mirrored: MirrorSum, noise: SideNoise | None) -> bool:
    """Whether shape and noise together may outweigh a linear sensor: those of most edges do not."""
    weighed = mirrored.weighed(_bends(mirrored.half), USUAL)
    precision = weighed.power[0] + _AMPLITUDE_STDS**-2.0
    gain = weighed.pull[0] ** 2 / precision - np.log(precision * _AMPLITUDE_STDS**2)
    most = 0.5 * float(gain.max()) + (0.0 if noise is None else noise.max_gain)
    return most > _MIN_GAIN


def _settled(data: CheckData, noise: SideNoise | None, middle_px: float) -> Curvature:
    """What an edge shows that is folded about the middle of its linear image, from a first one."""
    linear = _log_linear(data)
    for _ in range(_MAX_FOLDS):
        found = _folded(MirrorSum.of(data, middle_px), noise, linear)
        moved_px = _middle_px(data, found) - middle_px
        if found.log_odds < _MIN_LOG_ODDS or abs(moved_px) < _SETTLED_PX:
            break
        middle_px += moved_px
    return found


def _middle_px(data: CheckData, found: Curvature) -> float:
    """Where the linear image passes one half."""
    esf = data.fit.response.esf
    near = np.abs(esf.distance_px) < 0.5 * data.fwhm_px
    half = 0.5 + found.value * (0.25 if found.shoulder == 0 else 0.5 * (1 - found.shoulder))
    return float(np.interp(half, esf.value[near], esf.distance_px[near]))


def _log_linear(data: CheckData) -> Floats:
    """Of linear sensors: an even LSF, any odd part, one that looks like a curve, (3,)."""
    families = data.fit.families if isinstance(data.fit, SplineEdge) else {}
    uneven = sum(families.get(name, 0.0) for name in UNEVEN_FAMILIES)
    return np.asarray(np.log([_EVEN, _ODD, _LOW_ODD + _LOW_ODD_UNEVEN * uneven]))


def _folded(mirrored: MirrorSum, noise: SideNoise | None, log_linear: Floats) -> Curvature:
    """The likelier of curve and shoulder behind a folded edge, against linear sensors."""
    weighed = mirrored.weighed(_bends(mirrored.half))
    value, value_std, shape = _amplitudes(weighed)
    # Shoulders bend one way.
    shape[1:] += math.log(2) + log_ndtr(value[1:] / value_std[1:])
    even, odd = np.logaddexp.reduceat(weighed.log_evidence, [0, EVEN])
    # The models are the second order of a curve: the rest may cost a tenth of what they explain.
    whole = shape + _HIGHER_ORDERS * np.maximum(shape - even, 0)
    shape = np.maximum(shape, np.minimum(whole, odd))
    amplitude = value[:, None] + value_std[:, None] * _GRID
    density = _densities(amplitude)
    allowed = np.sum(density, axis=1)
    density[0] *= 2 * np.where(amplitude[0] > 0, _BRIGHTENS, 1 - _BRIGHTENS)
    if noise is not None:
        density *= noise.likelihood(_slopes(amplitude, noise))
    total = np.sum(density, axis=1)
    curved = shape + np.log(total / allowed) + _log_prior()
    # An odd part that looks like a curve: of sensors it is smaller than of curves.
    rarer = _log_normal(float(value[0]), _LOW_ODD_STD) - _log_normal(float(value[0]), CURVATURE_STD)
    linear = np.array([even, odd, shape[0] + rarer]) + log_linear
    log_odds = float(np.logaddexp.reduce(curved) - np.logaddexp.reduce(linear))
    best = int(np.argmax(curved))
    mean, spread = _mean_and_std(amplitude[best], density[best])
    return Curvature(mean, spread, log_odds, float(_BEGINS[best]))


def _mean_and_std(amplitude: Floats, density: Floats) -> tuple[float, float]:
    """Of amplitudes of some density, (m,)."""
    own = density / density.sum()
    mean = float(own @ amplitude)
    return mean, math.sqrt(float(own @ (amplitude - mean) ** 2))


@cache
def _log_prior() -> Floats:
    """Of a curve, and of every shoulder, where the characteristic is not straight, (k,)."""
    shoulders = np.full(_SHOULDERS.size, _PRIOR_SHOULDER / _SHOULDERS.size)
    return np.asarray(np.log(np.append(1 - _PRIOR_SHOULDER, shoulders)))


@compiled
def _bends(half: Floats) -> Floats:
    """What a curve and shoulders of unit size add to the sum of mirror images, (k, n)."""
    found = np.empty((1 + _SHOULDERS.size, half.size))
    for i in range(half.size):
        found[0, i] = 2 * half[i] * (1 - half[i])
        for k in range(_SHOULDERS.size):
            rest = 1 - _SHOULDERS[k]
            bright = max(half[i] - _SHOULDERS[k], 0.0)
            dark = max(1 - half[i] - _SHOULDERS[k], 0.0)
            found[1 + k, i] = rest - (bright * bright + dark * dark) / rest
    return found


def _slopes(amplitude: Floats, noise: SideNoise) -> Floats:
    """Slope of characteristics at the brighter level over that at the darker one, (k, m).

    Of a curve and the shoulders, or of the first k of them.
    """
    begins = _BEGINS[: len(amplitude), None]
    rest = 1 - begins
    at_dark, at_bright = (
        np.maximum(1 + amplitude * (rest - 2 * np.maximum(level - begins, 0) / rest), _MIN_SLOPE)
        for level in (noise.dark, noise.bright)
    )
    return np.asarray(at_bright / at_dark)


def _densities(amplitude: Floats) -> Floats:
    """Weights of the amplitudes, (k, m): normal, of shoulders those that bend down alone."""
    allowed = (amplitude > 0) & (amplitude < _MAX_SHOULDER)
    allowed[0] = np.abs(amplitude[0]) < _MAX_CURVATURE
    return np.where(allowed, _NORMAL, _NEGLIGIBLE)


def _amplitudes(weighed: Weighed) -> tuple[Floats, Floats, Floats]:
    """Amplitudes of curve and shoulders behind an even LSF, their deviations, and log evidence.

    Amplitudes are those at the ground that suits the curve best; (k,) each.
    """
    precision = weighed.power[:EVEN] + _AMPLITUDE_STDS**-2.0
    mean = weighed.pull[:EVEN] / precision
    gain = 0.5 * (weighed.pull[:EVEN] * mean - np.log(precision * _AMPLITUDE_STDS**2))
    evidence = weighed.log_evidence[:EVEN, None] + gain
    best = np.argmax(evidence, axis=0), np.arange(precision.shape[1])
    return mean[best], precision[best] ** -0.5, np.logaddexp.reduce(evidence)


def _of_pulse(data: CheckData, profile: Profile, sign: float) -> Curvature:
    """The curve that a pulse shows, against any LSF.

    Looked for only if the first step to it is longer than chance, or the noise shows one.
    """
    linear, straight = _straight_pulse(data, profile)
    first = _curved(linear, linear.response(straight.beta), 0.0, straight)
    noise = SideNoise.of_pulse(data, sign)
    unlikely = noise is None or noise.max_gain < _MIN_GAIN_OF_PULSES
    if unlikely and abs(first.beta[-1]) < _MIN_SIGMAS * first.last_std:
        return NO_CURVATURE
    return _with_noise(_likeliest(linear, straight, first), noise)


def _straight_pulse(data: CheckData, profile: Profile) -> tuple[CurvedModel, Solved]:
    """The model about the response that explains a pulse best without a curve, and this."""
    blur = first_blur(data, profile)
    linear = CurvedModel.about(MeanProfile.of(data, blur.width_px), blur, profile)
    straight = _straight(linear, None)
    # A second time about the fitted response, not about that of the first fit.
    linear = linear.renewed(straight.beta)
    return linear, _straight(linear, straight)


def _straight(linear: CurvedModel, earlier: Solved | None, most: int = AMPLITUDE_STEPS) -> Solved:
    """A pulse without a curve."""
    no_curve = np.arange(linear.block.size) < linear.block.size - 1
    return solve(linear.normal(linear.mean, 0.0), linear, no_curve, 0.0, earlier, most)


def _curved(
    linear: CurvedModel, u: Floats, c: float, earlier: Solved, most: int = AMPLITUDE_STEPS
) -> Solved:
    """A pulse with a curve, about a linear image and a curvature."""
    everything = np.ones(linear.block.size, bool)
    return solve(linear.normal(u, c), linear, everything, c, earlier, most)


def _likeliest(linear: CurvedModel, straight: Solved, curved: Solved) -> Curvature:
    """The likeliest curve on the way from a first step, and its odds by the shape of the pulse.

    Where steps do not settle, the shape tells nothing for it: ground that no model has, not a
    curve, may draw them away.
    """
    c, found, settled = 0.0, NO_CURVATURE, False
    for _ in range(_MAX_STEPS):
        step = float(curved.beta[-1])
        c = min(max(c + min(max(step, -_MAX_STEP), _MAX_STEP), -_MAX_CURVATURE), _MAX_CURVATURE)
        log_odds = curved.log_evidence - straight.log_evidence + _PRIOR_LOG_ODDS_OF_PULSES
        found = max(found, Curvature(c, curved.last_std, log_odds), key=lambda one: one.log_odds)
        settled = abs(step) < _SETTLED_SIGMAS * curved.last_std
        if settled:
            break
        u = linear.response(curved.beta)
        linear = linear.renewed(curved.beta)
        # The same renewal and amplitudes may explain more without a curve.
        again = _straight(linear, curved, most=2)
        straight = max(straight, again, key=lambda one: one.log_evidence)
        curved = _curved(linear, u, c, curved, most=2)
    if settled and abs(c) < _MAX_CURVATURE:
        return found
    return replace(found, log_odds=min(found.log_odds, _PRIOR_LOG_ODDS_OF_PULSES))


def _with_noise(shape: Curvature, noise: SideNoise | None) -> Curvature:
    """What a pulse shows by its shape and by its noise."""
    amplitude = (shape.value + shape.std * _GRID)[None]
    density = _densities(amplitude)
    if noise is not None:
        density *= noise.likelihood(_slopes(amplitude, noise))
    gain = math.log(float(density.sum()) / float(_NORMAL.sum()))
    return Curvature(*_mean_and_std(amplitude[0], density[0]), shape.log_odds + gain)


def _log_normal(x: float, std: float) -> float:
    return -0.5 * (x / std) ** 2 - math.log(std)
