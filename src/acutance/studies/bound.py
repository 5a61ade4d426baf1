"""Cramér-Rao bounds of a planned target: the smallest errors of unbiased estimators.

Two bounds, for white noise:

- of a blur of known shape: the image is a Gaussian of unknown width through a pixel, on a line
  and between levels that are unknown too (and, of a pulse, with unknown width and fall). The
  inverse of that model's information matrix bounds every metric; it is optimistic, because no
  real system's shape is known.
- of a free line spread function (LSF): nothing is known of the LSF but that it ends within a
window. For an edge
  ``std M(f) = 2 pi f sqrt(W / (2 n)) / SNR``, for a pulse, whose response is divided by that of
  the ground, ``pi f / |sin(pi w f)| sqrt(W / (2 n)) / SNR``, with W the window's length and n
  the samples per pixel of distance: the rows over the cosine of the angle. A fitted line costs
  nothing to first order: a turn about the target's middle looks like no change of the LSF. A
  fitted width costs its own standard deviation, here the least it can have (that of the known
  shape), times what it does to the ratio of the spectra, ``M (pi f cot(pi w f) - 1 / w)``. A
  known shape is one of the free ones, so this bound is nowhere below the other.

Estimators that use the smoothness of real LSFs come below the second bound. Below the first come
those alone that know more than the image shows, and only where its noise is strong: ours knows
which LSFs sensors have.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import (
    require_choice,
    require_finite,
    require_kind,
    require_numbers,
    require_whole,
)
from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.direction import unit_vector
from acutance.curves.grid import FREQ_CPP, Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.optics import Sensor
from acutance.optics.sensor import TRUTH_DISTANCE_PX, require_sensor
from acutance.targets.straight.pulse_spectrum import width_sensitivity_per_px

__all__ = ["Design", "MetricBound", "equivalent_blur", "free_bound", "shape_bound"]

_STEP_PX = 1e-4
"""Of central differences by the width of the blur."""

_ZERO = 1e-9
"""A pulse whose spectrum is below this at Nyquist has no finite bound."""

_PIXELS_AT_ONCE = 100_000


@dataclass(frozen=True)
class Design:
    """A planned target.

    Parameters
    ----------
    target : {"edge", "pulse"}
    rows : int
        How many image rows cross it.
    angle_deg : float
        Tilt against the image's columns.
    width_px : float
        Of a pulse; an edge has none.
    cols : int
        Length of every row.

    Raises
    ------
    OptionError
        If one of them is of another kind.
    """

    target: Literal["edge", "pulse"]
    rows: int
    angle_deg: float
    width_px: float = math.nan
    cols: int = 40

    def __post_init__(self) -> None:
        require_choice(("edge", "pulse"), target=self.target)
        require_whole(1, rows=self.rows, cols=self.cols)
        require_numbers(angle_deg=self.angle_deg, width_px=self.width_px)


@dataclass(frozen=True)
class MetricBound:
    """Least standard deviations, in the units of the names; NaN where there is no such number."""

    mtf_nyquist: float
    rer: float
    fwhm_px: float
    width_px: float


def equivalent_blur(sensor: Sensor, angle_deg: float) -> GaussianPixel:
    """The Gaussian through a pixel whose LSF has the FWHM of the sensor's.

    Parameters
    ----------
    sensor : Sensor
    angle_deg : float

    Raises
    ------
    OptionError, ModelError
        If there is no sensor, or no finite angle.
    """
    require_sensor(sensor)
    wanted = sensor.response(angle_deg).fwhm_px.value
    low, high = 0.05, 8.0
    for _ in range(40):
        sigma = math.sqrt(low * high)
        narrow = _response(GaussianPixel(sigma)).fwhm_px.value < wanted
        low, high = (sigma, high) if narrow else (low, sigma)
    return GaussianPixel(math.sqrt(low * high))


def shape_bound(blur: GaussianPixel, design: Design, snr: float) -> MetricBound:
    """Bound of a blur of known shape, by the information matrix of all unknowns.

    Parameters
    ----------
    blur : GaussianPixel
    design : Design
    snr : float
        Height of the target over the noise's standard deviation.

    Raises
    ------
    OptionError, ModelError
        If an argument is of the wrong kind, or a number is not finite.
    """
    require_kind(GaussianPixel, blur=blur)
    require_kind(Design, design=design)
    require_finite(snr=snr)
    information = _information(blur, design)
    scale = np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information / np.outer(scale, scale))
    std = np.sqrt(np.diag(covariance)) / scale / snr
    by_sigma = (
        _numbers(GaussianPixel(blur.sigma_px + _STEP_PX))
        - _numbers(GaussianPixel(blur.sigma_px - _STEP_PX))
    ) / (2 * _STEP_PX)
    mtf, rer, fwhm = (np.abs(by_sigma) * std[4]).tolist()
    width = float(std[5]) if design.target == "pulse" else math.nan
    return MetricBound(mtf, rer, fwhm, width)


def free_bound(blur: GaussianPixel, design: Design, snr: float, window_px: float = 10.0) -> float:
    """Bound of the MTF at Nyquist with a free LSF, line and width.

    Parameters
    ----------
    blur : GaussianPixel
        The true LSF, not known to the estimator.
    design : Design
    snr : float
    window_px : float, optional
        Length of the window the LSF, or the pulse's response, lies in.

    Raises
    ------
    OptionError, ModelError
        If an argument is of the wrong kind, or a number is not finite.
    """
    require_finite(window_px=window_px)
    shape = shape_bound(blur, design, snr)
    samples = design.rows / math.cos(math.radians(design.angle_deg))
    per_edge = math.sqrt(window_px / (2 * samples)) / snr
    if design.target == "edge":
        return max(2 * math.pi * NYQUIST_CPP * per_edge, shape.mtf_nyquist)
    lobe = abs(math.sin(math.pi * design.width_px * NYQUIST_CPP))
    if lobe < _ZERO:
        return math.inf
    mtf = float(blur.otf(np.array([NYQUIST_CPP]))[0])
    by_width = mtf * float(width_sensitivity_per_px(design.width_px, NYQUIST_CPP))
    by_noise = math.pi * NYQUIST_CPP / lobe * per_edge
    return max(math.hypot(by_noise, by_width * shape.width_px), shape.mtf_nyquist)


def _information(blur: GaussianPixel, design: Design) -> Floats:
    """Information matrix of all unknowns at an SNR of 1, some rows of the image at a time."""
    at_once = max(1, _PIXELS_AT_ONCE // design.cols)
    parts = (
        _jacobian(blur, design, np.arange(first, min(first + at_once, design.rows)))
        for first in range(0, design.rows, at_once)
    )
    return np.asarray(sum(part @ part.T for part in parts))


def _jacobian(blur: GaussianPixel, design: Design, rows: NDArray[np.int_]) -> Floats:
    """Derivatives of some rows by level, height, offset, turn, sigma, and width and fall."""
    x, y = unit_vector(design.angle_deg)
    row = rows[:, None] - 0.5 * (design.rows - 1)
    col = np.arange(design.cols)[None, :] - 0.5 * (design.cols - 1)
    s = (x * col + y * row).ravel()
    t = (x * row - y * col).ravel()
    if design.target == "edge":
        esf, lsf, by_sigma, _ = blur.esf_and_slopes(s)
        return np.array([np.ones(s.size), esf, -lsf, lsf * t, by_sigma])
    half = 0.5 * design.width_px
    rise, rise_slope, rise_sigma, _ = blur.esf_and_slopes(s + half)
    down, down_slope, down_sigma, _ = blur.esf_and_slopes(s - half)
    slope = rise_slope - down_slope
    return np.array(
        [
            np.ones(s.size), rise - down, -slope, slope * t, rise_sigma - down_sigma,
            0.5 * (rise_slope + down_slope), -down,
        ]
    )  # fmt: skip


def _numbers(blur: GaussianPixel) -> Floats:
    response = _response(blur)
    return np.array([response.mtf_nyquist.value, response.rer.value, response.fwhm_px.value])


def _response(blur: GaussianPixel) -> Response:
    """The curves of a Gaussian through a pixel."""
    nothing = np.zeros((TRUTH_DISTANCE_PX.size, 0))
    return Response(
        Esf(TRUTH_DISTANCE_PX, blur.esf(TRUTH_DISTANCE_PX), nothing),
        Lsf(TRUTH_DISTANCE_PX, blur.lsf(TRUTH_DISTANCE_PX), nothing),
        Mtf(FREQ_CPP, blur.otf(FREQ_CPP).astype(complex), np.zeros((FREQ_CPP.size, 0), complex)),
    )
