"""What is stated of a straight target because no pixel shows it: soft borders, uncertain levels.

A border painted soft blurs the image as the sensor does. Its profile is taken for a Gaussian of
standard deviation sigma along the normal, so

    measured OTF = OTF of the sensor * exp(-2 pi^2 f^2 sigma^2)

and the sensor's is the measured one divided by the border's. The edge and line spread functions
(ESF, LSF) are sharpened by the same filter up to 1 cycle per pixel; beyond, where hardly any light
of a pixel is left, the filter ends at 2 cycles per pixel. What enters is sigma^2: of a stated
sigma +- s its mean is sigma^2 + s^2, and its variance 4 sigma^2 s^2 + 2 s^4.

Levels that are wrong by a share of the contrast (a bidirectional reflectance that differs near the
border, light scattered into one side) multiply the transfer function (OTF) but for zero frequency,
and the rise of the ESF about its middle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np
from scipy.linalg import toeplitz

from acutance.curves import Esf, Estimate, Lsf, Response
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.targets.straight.error_causes import with_cause

__all__ = [
    "MAX_SOFTNESS_PX",
    "NOTHING_STATED",
    "SoftnessOptions",
    "StatedTarget",
    "border_gain",
    "require_softness",
    "require_stated",
    "stated_number",
    "stated_softness",
    "stated_target",
    "with_stated_target",
]

MAX_SOFTNESS_PX = 0.4
"""A softer border leaves less than half of the MTF at Nyquist: the sensor is not seen."""
_MAX_LEVEL = 0.2
_FULL_CPP, _HELD_CPP, _END_CPP = 1.0, 1.5, 2.0
_STEP_CPP = 0.005

Curve = TypeVar("Curve", Esf, Lsf)
AnyResponse = TypeVar("AnyResponse", bound=Response)


class SoftnessOptions(Protocol):
    """Options that hold how soft the border of a target is stated to be."""

    @property
    def target_softness_m(self) -> Estimate | float | None:
        """Standard deviation of the border's profile in metres."""
        ...

    @property
    def target_softness_px(self) -> Estimate | float | None:
        """The same in pixels."""
        ...


class _Options(SoftnessOptions, Protocol):
    """Options of a target that hold all that is stated of it."""

    @property
    def level_uncertainty(self) -> float: ...


@dataclass(frozen=True)
class StatedTarget:
    """What is known of a target beforehand, along its normal.

    Parameters
    ----------
    softness_px : Estimate, optional
        Standard deviation of the Gaussian profile of its borders, in pixels.
    level_uncertainty : float
        Standard deviation of its true contrast over the fitted one.
    """

    softness_px: Estimate | None = None
    level_uncertainty: float = 0.0

    @property
    def terms(self) -> tuple[str, ...]:
        """The terms it adds to the uncertainty budget, in the order of their columns."""
        softness = ("target_softness",) if self.softness_px is not None else ()
        return softness + (("level_uncertainty",) if self.level_uncertainty > 0 else ())

    def gain(self, freq_cpp: Floats) -> Floats:
        """By how much the transfer function of the sensor exceeds that of the image, (n,)."""
        return border_gain(freq_cpp, self.variance_px2.value)[0]

    @property
    def has_border(self) -> bool:
        """Whether a softness of the border was stated that is not 0 for certain."""
        return self.variance_px2.value > 0

    @property
    def variance_px2(self) -> Estimate:
        """Variance of the borders' profile, pixels squared."""
        if self.softness_px is None:
            return Estimate(0.0)
        sigma, std = self.softness_px.value, self.softness_px.std
        return Estimate(sigma**2 + std**2, math.sqrt(4 * sigma**2 * std**2 + 2 * std**4))


NOTHING_STATED = StatedTarget()


def require_softness(options: SoftnessOptions) -> None:
    """Refuse a softness out of range, or one given twice.

    Raises
    ------
    OptionError
    """
    name = type(options).__name__
    if options.target_softness_m is not None and options.target_softness_px is not None:
        raise OptionError(
            f"{name}: the softness of the border was given in pixels and in metres: give one"
        )
    for unit in ("m", "px"):
        given = getattr(options, f"target_softness_{unit}")
        if given is None:
            continue
        softness = _estimate(given)
        if not (0 <= softness.value < math.inf and 0 <= softness.std < math.inf):
            # An estimate in words leaves out a deviation that is no number.
            std = f" ± {softness.std:g}" if softness.std else ""
            raise OptionError(
                f"{name}: target_softness_{unit} is {softness.value:g}{std}: a standard deviation "
                "of the border's profile and its own, both 0 or more, are needed"
            )


def require_stated(options: _Options) -> None:
    """Refuse statements out of range, or one made twice.

    Raises
    ------
    OptionError
    """
    require_softness(options)
    if not 0 <= options.level_uncertainty <= _MAX_LEVEL:
        raise OptionError(
            f"{type(options).__name__}: level_uncertainty is {options.level_uncertainty:g}: give a "
            f"share of the contrast between 0 and {_MAX_LEVEL:g} (0.005 or, on the command line, "
            "0.5%)"
        )


def stated_softness(options: SoftnessOptions, gsd_m: float | None) -> StatedTarget:
    """The softness that options state, in pixels along a normal with that GSD.

    Raises
    ------
    OptionError
        If metres are stated without a GSD, or the border is too soft to see a sensor behind it.
    """
    softness = options.target_softness_px
    if options.target_softness_m is not None:
        if gsd_m is None:
            raise OptionError(
                "target_softness_m needs a GSD, and the image has none: give gsd_m (--gsd), or "
                "target_softness_px"
            )
        softness = _estimate(options.target_softness_m) * (1 / gsd_m)
    if softness is None:
        return NOTHING_STATED
    stated = StatedTarget(_estimate(softness))
    if math.sqrt(stated.variance_px2.value) > MAX_SOFTNESS_PX:
        raise OptionError(
            f"a border of standard deviation {softness} px is softer than {MAX_SOFTNESS_PX:g} px, "
            "and hides the sensor: check it and the GSD, or use a sharper target"
        )
    return stated


def stated_target(options: _Options, gsd_m: float | None) -> StatedTarget:
    """All that options state, in pixels along a normal with that GSD; see `stated_softness`."""
    softness = stated_softness(options, gsd_m).softness_px
    return StatedTarget(softness, options.level_uncertainty)


def stated_number(number: Estimate | float | None) -> dict[str, float] | None:
    """A stated number with its standard deviation, for JSON."""
    if number is None:
        return None
    return {"value": float(number), "std": number.std if isinstance(number, Estimate) else 0.0}


def with_stated_target(response: AnyResponse, stated: StatedTarget) -> AnyResponse:
    """The curves of the sensor, from those of the image of a target of which something is stated.

    Every statement is one more common cause of their errors, in the order of `StatedTarget.terms`.
    """
    if stated.softness_px is not None:
        response = _without_border(response, stated.variance_px2)
    if stated.level_uncertainty > 0:
        response = _with_uncertain_levels(response, stated.level_uncertainty)
    return response


def _estimate(given: Estimate | float) -> Estimate:
    return given if isinstance(given, Estimate) else Estimate(float(given))


def _without_border(response: AnyResponse, variance_px2: Estimate) -> AnyResponse:
    """The curves divided by a Gaussian border's transfer function."""
    v, std = variance_px2.value, variance_px2.std
    mtf = response.mtf
    gain, by_variance = border_gain(mtf.freq_cpp, v)
    sharper = replace(mtf, otf=mtf.otf * gain, factor=mtf.factor * gain[:, None])
    return replace(
        response,
        esf=_sharpened(response.esf, v, std),
        lsf=_sharpened(response.lsf, v, std),
        mtf=with_cause(sharper, by_variance * mtf.otf * std),
    )


def border_gain(freq_cpp: Floats, variance_px2: Floats | float) -> tuple[Floats, Floats]:
    """What a transfer function is multiplied by where a border is divided out, and its derivative.

    ``exp(2 pi^2 f^2 sigma^2)`` up to 1 c/px; beyond, where hardly any light of a pixel is left, the
    exponent grows ever less, is held from 1.5 c/px, and the gain is 1 again at 2 c/px.

    Parameters
    ----------
    freq_cpp : (n,) array
        0 or more.
    variance_px2 : float or (n,) array
        Variance of the border's profile.

    Returns
    -------
    gain, by_variance : (n,) arrays
    """
    over = np.clip(freq_cpp - _FULL_CPP, 0.0, _HELD_CPP - _FULL_CPP)
    power = 2 * np.pi**2 * (np.minimum(freq_cpp, _FULL_CPP) ** 2 + 2 * over - 2 * over**2)
    ends = np.clip((freq_cpp - _FULL_CPP) / (_END_CPP - _FULL_CPP), 0.0, 1.0)
    window = 0.5 + 0.5 * np.cos(np.pi * ends)
    grown = np.exp(power * variance_px2)
    return 1 + (grown - 1) * window, power * grown * window


def _sharpened(curve: Curve, variance_px2: float, std: float) -> Curve:
    """A spread function behind the filter, with the cause that the variance is uncertain."""
    step = float(curve.distance_px[1] - curve.distance_px[0])
    added, by_variance = _filters(curve.value.size, step, variance_px2)
    rows = np.asarray(curve.factor)
    sharper = replace(curve, value=curve.value + added @ curve.value, factor=rows + added @ rows)
    return with_cause(sharper, std * (by_variance @ curve.value))


def _filters(n: int, step_px: float, variance_px2: float) -> tuple[Floats, Floats]:
    """What the filter adds to n samples of a curve, (n, n), and its derivative by the variance.

    Beyond its ends a curve is level.
    """
    freq = np.arange(0.0, _END_CPP + _STEP_CPP / 2, _STEP_CPP)
    gain, by_variance = border_gain(freq, variance_px2)
    spectra = np.stack([gain - 1, by_variance])
    lags = np.arange(n) * step_px
    waves = np.cos(2 * np.pi * np.outer(lags, freq))
    waves[:, [0, -1]] *= 0.5
    added, by_variance = (
        _clamped(kernel) for kernel in 2 * _STEP_CPP * step_px * (waves @ spectra.T).T
    )
    return added, by_variance


def _clamped(kernel: Floats) -> Floats:
    """The convolution of a curve with level ends by a symmetric kernel, (n,), that sums to 0."""
    matrix = np.asarray(toeplitz(kernel))
    # What of the kernel lies beyond either end sees the end's value.
    beyond = -0.5 * kernel[0] - np.concatenate([[0.0], np.cumsum(kernel[1:])])
    matrix[:, 0] += beyond
    matrix[:, -1] += beyond[::-1]
    return matrix


def _with_uncertain_levels(response: AnyResponse, std: float) -> AnyResponse:
    """The curves of a target whose contrast is uncertain by a share."""
    esf, lsf, mtf = response.esf, response.lsf, response.mtf
    return replace(
        response,
        esf=with_cause(esf, std * (esf.value - 0.5)),
        lsf=with_cause(lsf, std * lsf.value),
        mtf=with_cause(mtf, np.where(mtf.freq_cpp > 0, std * mtf.otf, 0.0)),
    )
