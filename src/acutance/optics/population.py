"""Sensors drawn at random, from broad ranges: what a sensor of unknown make may look like.

Priors are learned from these families, and benchmarks measure how estimators do over them. A
family has one cause of blur that a Gaussian through a pixel does not describe:

- "telescope": an aperture with a central obscuration, in focus, out of it or with wavefront error,
  and any jitter, smear and diffusion of charge;
- "halo": light in a broad Gaussian, 2 to 15 % of it;
- "trail": charge left behind, on one side;
- "smear": motion of .5 to 2.2 px during the exposure;
- "sharpened", "restored": compensation on the ground by kernels of 3 to 15 taps, set by hand or
  designed as Wiener filters (towards a point or a pixel, for this blur or another one), of a
  Gaussian blur and of a telescope's;
- "resampled", "shifted": a product interpolated, at all phases of its pixels or at a single one, as
  a small part of it is;
- "processed": compensated on the ground, then interpolated;
- "scatter": a halo behind a telescope, or one that falls like an exponential;
- "aberrated": a telescope out of alignment: coma and other aberrations of low order;
- "peaked": a blur that falls more slowly than a Gaussian from its middle on, as that of the air,
  of charge that spreads deep in a detector, or of a mount that is seldom still;
- "deferred": charge that is left to the next pixel.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from acutance.arguments import require_rng
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.optics.aberrations import Aberrations
from acutance.optics.aperture import (
    Defocus,
    Diffraction,
    ExponentialHalo,
    Gaussian,
    Halo,
    WavefrontError,
)
from acutance.optics.atmosphere import Moffat, Turbulence
from acutance.optics.block import Block
from acutance.optics.detector import ChargeDiffusion, Detector
from acutance.optics.electronics import Exponential, TransferLoss
from acutance.optics.interpolation import Interpolation
from acutance.optics.motion import Smear
from acutance.optics.processing import Resampling, Sharpening, Shift
from acutance.optics.sensor import Sensor

__all__ = ["FAMILIES", "UNEVEN_FAMILIES", "draw_sensor"]

_LOWEST_MTF, _HIGHEST_MTF = 0.01, 1.0
"""MTF at Nyquist beyond which there is nothing to measure, or no detector behind it."""
_SCATTERED = 0.02, 0.15
_HALO_PX, _DECAY_PX = (1.5, 5.0), (0.8, 4.0)
"""Standard deviation of Gaussian halos, and over what exponential ones fall: of those a Gaussian of
1.4 to 7 px is as wide."""
_PEAK_PX, _CLOSE_HALO_PX = (0.12, 0.6), (0.5, 1.5)
"""Over what an exponential blur falls, and standard deviation of a halo next to its core."""
_SPOT_PX, _FRIED_CPP = (0.3, 1.5), (0.8, 5.0)
"""Full width at half maximum of a spot that falls like a power, and frequency of turbulence: where
it takes 5 to 80 % of the MTF at Nyquist."""
_BY_HAND = 0.05, 0.8
"""Strength of kernels set by hand: light ones are as common as heavy ones, by their logarithm."""
_LEAST_SUM = 0.01
"""Of a kernel whose sum was to be one: few taps for a strong filter may sum to nothing."""


def draw_sensor(family: str, rng: np.random.Generator) -> Sensor:
    """Draw a sensor of a family, with an MTF at Nyquist between .01 and 1.

    Smear and trails act across; the others have the same blur in all directions, or nearly.

    Raises
    ------
    OptionError
        If there is no such family.
    ModelError
        Without a random generator.
    """
    rng = require_rng(rng, "a sensor by chance")
    if not isinstance(family, str) or family not in FAMILIES:
        raise OptionError(
            f"there is no family of sensors {family!r}: choose one of {', '.join(FAMILIES)}"
        )
    while True:
        sensor = Sensor(FAMILIES[family](rng))
        if _LOWEST_MTF < abs(sensor.otf(0.5, 0.0).item()) < _HIGHEST_MTF:
            return sensor


def _telescope(rng: np.random.Generator) -> list[Block]:
    cutoff_cpp, obscuration = _pupil(rng)
    blocks: list[Block] = []
    if rng.random() < 0.4:
        blocks.append(Defocus(rng.uniform(0.0, 0.45), cutoff_cpp, obscuration))
    else:
        blocks.append(Diffraction(cutoff_cpp, obscuration))
        if rng.random() < 0.5:
            wavefront = rng.uniform(0.0, 0.14), rng.uniform(0.1, 0.4)
            blocks.append(WavefrontError(*wavefront, cutoff_cpp))
    return [*blocks, *_behind_the_telescope(rng)]


def _aberrated(rng: np.random.Generator) -> list[Block]:
    cutoff_cpp, obscuration = _pupil(rng)
    waves = rng.normal(size=6)
    waves *= rng.uniform(0.03, 0.12) / np.linalg.norm(waves)
    return [Aberrations(cutoff_cpp, obscuration, *waves.tolist()), *_behind_the_telescope(rng)]


def _pupil(rng: np.random.Generator) -> tuple[float, float]:
    """Cut-off in cycles per pixel, and obscuration."""
    cutoff_cpp = rng.uniform(0.8, 2.2)
    return cutoff_cpp, rng.uniform(0.0, 0.6) if rng.random() < 0.8 else 0.0


def _behind_the_telescope(rng: np.random.Generator) -> list[Block]:
    """Jitter, smear, diffusion of charge and the detector."""
    blocks: list[Block] = [Gaussian(rng.uniform(0.0, 0.5))]
    if rng.random() < 0.5:
        blocks.append(Smear(rng.uniform(0.0, 1.2), "across"))
    if rng.random() < 0.3:
        blocks.append(ChargeDiffusion(rng.uniform(0.1, 0.6), rng.uniform(0.5, 2.0)))
    return [*blocks, Detector(rng.uniform(0.8, 1.0))]


def _plain(rng: np.random.Generator) -> list[Block]:
    return [Gaussian(rng.uniform(0.25, 0.8)), Detector(rng.uniform(0.85, 1.0))]


def _halo(rng: np.random.Generator) -> list[Block]:
    return [*_plain(rng), Halo(rng.uniform(*_SCATTERED), rng.uniform(*_HALO_PX))]


def _scatter(rng: np.random.Generator) -> list[Block]:
    is_plain = rng.random() < 0.4
    blocks = _plain(rng) if is_plain else _telescope(rng)
    fraction = rng.uniform(*_SCATTERED)
    if is_plain or rng.random() < 0.6:
        return [*blocks, ExponentialHalo(fraction, math.exp(rng.uniform(*np.log(_DECAY_PX))))]
    return [*blocks, Halo(fraction, rng.uniform(*_HALO_PX))]


def _peaked(rng: np.random.Generator) -> list[Block]:
    kind = rng.integers(5)
    if rng.random() < 0.3:
        blocks = _telescope(rng)
    elif kind < 2:
        blocks = _plain(rng)
    else:
        # What is blurred is all of the light: little else needs to be.
        blocks = [Gaussian(rng.uniform(0.0, 0.4)), Detector(rng.uniform(0.85, 1.0))]
    return [*blocks, _PEAKED[kind](rng)]


_PEAKED: tuple[Callable[[np.random.Generator], Block], ...] = (
    lambda rng: Halo(rng.uniform(0.1, 0.5), rng.uniform(*_CLOSE_HALO_PX)),
    lambda rng: ExponentialHalo(rng.uniform(0.3, 1.0), _between(_PEAK_PX, rng)),
    lambda rng: ExponentialHalo(1.0, _between(_PEAK_PX, rng)),
    lambda rng: Turbulence(_between(_FRIED_CPP, rng)),
    lambda rng: _moffat(_between(_SPOT_PX, rng), rng.uniform(2.0, 5.0)),
)


def _between(ends: tuple[float, float], rng: np.random.Generator) -> float:
    """A number whose logarithm is drawn evenly."""
    return math.exp(rng.uniform(*np.log(ends)))


def _moffat(fwhm_px: float, exponent: float) -> Moffat:
    return Moffat(0.5 * fwhm_px / math.sqrt(2 ** (1 / exponent) - 1), exponent)


def _trail(rng: np.random.Generator) -> list[Block]:
    return [*_plain(rng), Exponential(rng.uniform(0.1, 0.8), "across")]


def _deferred(rng: np.random.Generator) -> list[Block]:
    return [*_plain(rng), TransferLoss(rng.uniform(0.03, 0.45), "across")]


def _smear(rng: np.random.Generator) -> list[Block]:
    return [*_plain(rng), Smear(rng.uniform(0.5, 2.2), "across")]


def _sharpened(rng: np.random.Generator) -> list[Block]:
    return _compensated(_plain(rng), rng)


def _restored(rng: np.random.Generator) -> list[Block]:
    return _compensated(_telescope(rng), rng)


def _compensated(blocks: list[Block], rng: np.random.Generator) -> list[Block]:
    """A blur, and a kernel set by hand or designed for it, or for what it was thought to be."""
    if rng.random() < 0.5:
        strength = math.exp(rng.uniform(*np.log(_BY_HAND)))
        return [*blocks, Sharpening.both_axes(strength)]
    freq_cpp = np.linspace(0.0, 0.5, 101)
    if rng.random() < 0.5:
        blur = Sensor(blocks).otf(freq_cpp, 0.0).real
    else:
        sigma_px = rng.uniform(0.3, 0.8)
        blur = np.exp(-2 * (np.pi * sigma_px * freq_cpp) ** 2) * np.sinc(freq_cpp)
    return [*blocks, _wiener_kernel(freq_cpp, blur, rng)]


def _wiener_kernel(freq_cpp: Floats, blur: Floats, rng: np.random.Generator) -> Sharpening:
    """A Wiener filter towards a point or a pixel, cut to 3 to 15 taps by least squares.

    Noise over scene is the same at all frequencies, or rises as where a scene's power falls.
    """
    half = int(rng.integers(1, 8))
    aim = rng.choice([0.0, rng.uniform(), 1.0])
    desired = np.sinc(freq_cpp) ** aim
    rise = 0.0 if rng.random() < 0.4 else rng.uniform(1.0, 4.0)
    noise_power = 10 ** rng.uniform(-2.5, -0.7 + 0.3 * rise) * (2 * freq_cpp) ** rise
    wanted = desired * blur / (blur**2 + noise_power)
    cosines = 2 * np.cos(2 * np.pi * np.outer(freq_cpp, np.arange(half + 1)))
    cosines[:, 0] = 1.0
    taps = np.linalg.lstsq(cosines, wanted / wanted[0], rcond=None)[0]
    kernel = np.concatenate([taps[:0:-1], taps])
    if abs(kernel.sum()) < _LEAST_SUM:
        return _wiener_kernel(freq_cpp, blur, rng)
    return Sharpening(tuple(tuple(row) for row in np.outer(kernel, kernel).tolist()))


def _resampled(rng: np.random.Generator) -> list[Block]:
    blocks = _telescope(rng) if rng.random() < 0.6 else _plain(rng)
    if rng.random() < 0.3:
        return [*blocks, Resampling("bilinear")]
    return [*blocks, Resampling("cubic", rng.uniform(-0.75, -0.3))]


def _shifted(rng: np.random.Generator) -> list[Block]:
    blurs = (_telescope, _telescope, _plain, _halo)
    return [*blurs[rng.integers(4)](rng), _at_one_phase(rng)]


def _processed(rng: np.random.Generator) -> list[Block]:
    blocks = _restored(rng) if rng.random() < 0.6 else _sharpened(rng)
    if rng.random() < 0.5:
        return [*blocks, _at_one_phase(rng)]
    return [*blocks, Resampling("cubic", rng.uniform(-0.75, -0.3))]


def _at_one_phase(rng: np.random.Generator) -> Shift:
    kernel: Interpolation = "bilinear" if rng.random() < 0.25 else "cubic"
    row_px, col_px, a = rng.uniform((-0.5, -0.5, -0.75), (0.5, 0.5, -0.3)).tolist()
    return Shift(row_px, col_px, kernel, a)


FAMILIES: dict[str, Callable[[np.random.Generator], list[Block]]] = {
    "telescope": _telescope,
    "halo": _halo,
    "trail": _trail,
    "smear": _smear,
    "sharpened": _sharpened,
    "restored": _restored,
    "resampled": _resampled,
    "shifted": _shifted,
    "processed": _processed,
    "scatter": _scatter,
    "aberrated": _aberrated,
    "peaked": _peaked,
    "deferred": _deferred,
}
"""How to draw the blocks of a sensor of each family."""
UNEVEN_FAMILIES: Final = ("trail", "shifted", "processed", "aberrated", "deferred")
"""Those whose sensors' spread functions may differ from side to side."""
