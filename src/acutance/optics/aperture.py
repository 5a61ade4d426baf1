"""Blur made by the telescope: aperture, aberrations, stray light."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from acutance.curves.grid import Floats
from acutance.optics.block import Transfer, require

__all__ = [
    "Defocus",
    "Diffraction",
    "ExponentialHalo",
    "Gaussian",
    "Halo",
    "WavefrontError",
    "aperture_transfer",
    "defocused_transfer",
]

_PLACES = 4096
"""Of the plane at once: the quadrature needs some fifty numbers for each."""


@dataclass(frozen=True)
class Gaussian:
    """A Gaussian point spread function: ``exp(-2 pi^2 (sigma_x^2 u^2 + sigma_y^2 v^2))``.

    Parameters
    ----------
    sigma_px : float
        Standard deviation in pixels, at least 0; along the column axis, and along the row axis
        too unless `sigma_along_px` is given.
    sigma_along_px : float, optional
        Standard deviation along the row axis.
    """

    sigma_px: float
    sigma_along_px: float | None = None

    def __post_init__(self) -> None:
        require(self, sigma_px=self.sigma_px)
        if self.sigma_along_px is not None:
            require(self, sigma_along_px=self.sigma_along_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        along = self.sigma_px if self.sigma_along_px is None else self.sigma_along_px
        power = (self.sigma_px * np.asarray(u)) ** 2 + (along * np.asarray(v)) ** 2
        return np.exp(-2 * math.pi**2 * power)


@dataclass(frozen=True)
class Halo:
    """A sharp core with part of the light in a broad Gaussian: scatter, ghosts, adjacency.

    Parameters
    ----------
    fraction : float
        Part of the light that goes to the halo, 0 to 1.
    sigma_px : float
        Standard deviation of the halo in pixels. Above some 100 px the halo no longer fits
        on the plateaus of any target and acts as a loss of contrast only.
    """

    fraction: float
    sigma_px: float

    def __post_init__(self) -> None:
        require(self, 0.0, 1.0, fraction=self.fraction)
        require(self, sigma_px=self.sigma_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        return (1 - self.fraction) + self.fraction * Gaussian(self.sigma_px).otf(u, v)


@dataclass(frozen=True)
class ExponentialHalo:
    """A sharp core with part of the light around it, falling like ``exp(-r / decay)``: scatter.

    The transform of the exponential in the plane: ``(1 - p) + p (1 + (2 pi decay f)^2)^(-3/2)``.
    It is steeper at its middle and reaches farther than a Gaussian of the same width, which along
    an axis is ``sqrt(3) decay``.

    Parameters
    ----------
    fraction : float
        Part p of the light that goes to the halo, 0 to 1.
    decay_px : float
        Distance in pixels over which the halo falls to 1/e.
    """

    fraction: float
    decay_px: float

    def __post_init__(self) -> None:
        require(self, 0.0, 1.0, fraction=self.fraction)
        require(self, decay_px=self.decay_px)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        square = (2 * math.pi * self.decay_px) ** 2 * (np.asarray(u) ** 2 + np.asarray(v) ** 2)
        return np.asarray((1 - self.fraction) + self.fraction * (1 + square) ** -1.5)


@dataclass(frozen=True)
class Diffraction:
    """A perfect circular aperture, with a central obscuration if there is one.

    Out of focus, use `Defocus` alone: it holds this block, and the OTF of the curved pupil is not
    the product of the two.

    The optical transfer function (OTF) is the autocorrelation of the annular pupil: the overlap of
    two discs, minus twice that of a disc with an obscuration, plus that of two obscurations (the
    closed form of O'Neill, J. Opt. Soc. Am. 46, 285, 1956).

    Parameters
    ----------
    cutoff_cpp : float
        Diameter / wavelength, expressed in cycles per pixel: D p / (lambda f) for a pixel pitch
        p and a focal length f. Nothing passes beyond it.
    obscuration : float, optional
        Diameter of the obscuration over that of the aperture, 0 to below 1.
    """

    cutoff_cpp: float
    obscuration: float = 0.0

    def __post_init__(self) -> None:
        require(self, above=True, cutoff_cpp=self.cutoff_cpp)
        require(self, 0.0, 0.99, obscuration=self.obscuration)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        nu = np.asarray(np.hypot(u, v) / self.cutoff_cpp)
        inside = nu < 1
        if nu.ndim == 0 or inside.all():
            return aperture_transfer(nu, self.obscuration)
        otf = np.zeros(nu.shape)
        otf[inside] = aperture_transfer(nu[inside], self.obscuration)
        return otf


def aperture_transfer(nu: Floats, obscuration: Floats | float) -> Floats:
    """The transfer of apertures in focus, `Diffraction`.

    Parameters
    ----------
    nu : (...) array
        Frequencies over the cut-off frequency.
    obscuration : (...) array or float
        Diameter of the obscuration over that of the aperture, 0 to below 1.
    """
    # Unit pupil radius: the discs' centres are 2 nu apart.
    shift, hole = 2 * nu, np.asarray(obscuration)
    if not np.any(hole):
        return _overlap(1.0, 1.0, shift) / math.pi
    area = _overlap(1.0, 1.0, shift) - 2 * _overlap(1.0, hole, shift)
    return np.asarray((area + _overlap(hole, hole, shift)) / (math.pi * (1 - hole**2)))


def _overlap(big: Floats | float, small: Floats | float, shift: Floats) -> Floats:
    """Area common to two discs of radii `big` >= `small` whose centres are `shift` apart."""
    d = np.minimum(np.maximum(shift, np.maximum(big - small, 1e-300)), big + small)
    x = np.minimum(np.maximum((d**2 + big**2 - small**2) / (2 * d), -big), big)
    y = np.minimum(np.maximum(d - x, -small), small)
    chord = np.sqrt(np.maximum(big**2 - x**2, 0.0))
    area = big**2 * np.arccos(x / big) + small**2 * np.arccos(y / small) - d * chord
    inside = math.pi * small**2
    return np.where(shift >= big + small, 0.0, np.where(shift <= big - small, inside, area))


@dataclass(frozen=True)
class Defocus:
    """A circular aperture out of focus, diffraction included: use it instead of `Diffraction`.

    The autocorrelation of a pupil with the phase of a defocus W20, as one exact integral over
    the place x across the overlap of the two pupils (Hopkins, Proc. R. Soc. A 231, 91, 1955)::

        H(nu) = 4 / (pi (1 - e^2)) * integral_0^X (a(x) - b(x)) cos(8 pi W nu x) dx

    in units of the pupil's radius, with half the chord ``a = sqrt(1 - (x + nu)^2)`` of the
    farther pupil minus that of the nearer obscuration, ``b = sqrt(e^2 - (x - nu)^2)`` where it is
    real. The overlap ends at X, the pupil's rim at ``1 - nu`` or the place ``(1 - e^2) / (4 nu)``
    where the obscuration crosses it, whichever comes first. By Gauss-Legendre quadrature; the
    error is below 1e-10. Beyond some 0.6 waves it is negative over part of the band (reversed
    contrast).

    Parameters
    ----------
    waves : float
        Wavefront error at the rim of the pupil against its centre (W20), in wavelengths.
    cutoff_cpp : float
        Cut-off frequency of the aperture in cycles per pixel, as in `Diffraction`.
    obscuration : float, optional
        Diameter e of the obscuration over that of the aperture, 0 to below 1.
    """

    waves: float
    cutoff_cpp: float
    obscuration: float = 0.0

    def __post_init__(self) -> None:
        require(self, -20.0, 20.0, waves=self.waves)
        require(self, above=True, cutoff_cpp=self.cutoff_cpp)
        require(self, 0.0, 0.99, obscuration=self.obscuration)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        nu = np.asarray(np.hypot(u, v) / self.cutoff_cpp)
        otf = np.zeros(nu.shape)
        inside = nu < 1
        otf[inside] = defocused_transfer(nu[inside], self.waves, self.obscuration)
        return otf


def defocused_transfer(
    nu: Floats, waves: Floats | float, obscuration: Floats | float = 0.0
) -> Floats:
    """The transfer of apertures out of focus, `Defocus`.

    Parameters
    ----------
    nu : (...) array
        Frequencies over the cut-off frequency.
    waves : (...) array or float
    obscuration : (...) array or float
    """
    at, hole = np.minimum(nu, 1.0), np.asarray(obscuration)
    end = np.minimum(1 - at, (1 - hole**2) / (4 * np.maximum(at, 1e-9)))
    area = _half_disc(1.0, waves, at, -at, end)
    if np.any(hole):
        area = area - _half_disc(hole, waves, at, at, end)
    return np.asarray(area * (4 / (math.pi * (1 - hole**2))))


def _half_disc(
    radius: Floats | float, waves: Floats | float, nu: Floats, centre: Floats, end: Floats
) -> Floats:
    """Integral of half the chord of a disc, times the cosine of the phase, from 0 to `end`."""
    # By the angle on the disc's rim, in which the chord has no infinite slope at its ends.
    first = np.arccos(np.clip((end - centre) / radius, -1.0, 1.0))
    span = np.arccos(np.clip(-centre / radius, -1.0, 1.0)) - first
    nodes, weights = _legendre(16 + math.ceil(8 * float(np.max(np.abs(waves)))))
    radius, phase, centre = (
        np.broadcast_to(one, span.shape).reshape(-1, 1)
        for one in (radius, 8 * math.pi * waves * nu, centre)
    )
    from_first, half = first.reshape(-1, 1), 0.5 * span.reshape(-1, 1)
    total = np.empty(span.size)
    for start in range(0, span.size, _PLACES):
        some = slice(start, start + _PLACES)
        theta = from_first[some] + half[some] * (nodes + 1)
        x = centre[some] + radius[some] * np.cos(theta)
        wave = np.cos(phase[some] * x)
        total[some] = ((radius[some] * np.sin(theta)) ** 2 * wave) @ weights
    return np.asarray(0.5 * span * total.reshape(span.shape))


@cache
def _legendre(order: int) -> tuple[Floats, Floats]:
    """Nodes and weights of the quadrature; orders are few, and they take long."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return nodes, weights


@dataclass(frozen=True)
class WavefrontError:
    """Random figure errors of the mirrors, after Hufnagel and Shannon.

    ``exp(-(2 pi w)^2 (1 - exp(-(f / (l f_c))^2)))``, the statistical OTF of a random wavefront
    with a Gaussian autocorrelation (Shannon, The Art and Science of Optical Design, 1997).

    Parameters
    ----------
    rms_waves : float
        Root mean square wavefront error w in wavelengths.
    correlation : float
        Correlation length l as a fraction of the pupil's diameter, where the autocorrelation
        has fallen to 1/e.
    cutoff_cpp : float
        Cut-off frequency f_c of the aperture in cycles per pixel.
    """

    rms_waves: float
    correlation: float
    cutoff_cpp: float

    def __post_init__(self) -> None:
        require(self, rms_waves=self.rms_waves)
        require(self, above=True, correlation=self.correlation, cutoff_cpp=self.cutoff_cpp)

    def otf(self, u: Floats, v: Floats) -> Transfer:
        shift = np.hypot(u, v) / (self.correlation * self.cutoff_cpp)
        return np.exp(-((2 * math.pi * self.rms_waves) ** 2) * -np.expm1(-(shift**2)))
