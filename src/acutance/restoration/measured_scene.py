"""The power spectrum of a scene, measured in its image: blur and noise divided out."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import minimize

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.errors import ImageError
from acutance.raster import Box, Image
from acutance.restoration.scene_spectrum import NaturalScene

__all__ = ["measured_scene"]

_WINDOW_PX = 128
_MAX_WINDOWS = 144
_MIN_WINDOWS = 4
_LOWEST_CPP = 3 / _WINDOW_PX
_MIN_USABLE = 0.999
_EXPONENTS = (1.0, 5.0)


def measured_scene(image: Image, model: OtfModel) -> NaturalScene:
    """The natural scene whose blurred and sampled spectrum, with white noise, an image has.

    Windows spread over the image are tapered, and their periodograms averaged on a logarithmic
    scale, so that a few bright or busy windows do not stand for all. Scene, exponent and noise are
    those of largest likelihood (Whittle).

    Parameters
    ----------
    image : Image
    model : OtfModel
        Of the sensor that took it.

    Raises
    ------
    ImageError
        If fewer than four windows of 128 by 128 pixels hold data throughout.
    """
    power = _mean_periodogram(image)
    v, u = np.meshgrid(np.fft.fftfreq(_WINDOW_PX), np.fft.rfftfreq(_WINDOW_PX), indexing="ij")
    own = (np.hypot(u, v) >= _LOWEST_CPP) & (u > 0) & (u < 0.5)
    u, v, power = u[own], v[own], power[own]
    gain = _folded_gains(model, u, v)

    def cost(point: Floats) -> float:
        log_noise, log_contrast, exponent = point
        if not _EXPONENTS[0] <= exponent <= _EXPONENTS[1]:
            return math.inf
        scene = NaturalScene(math.exp(log_contrast), float(exponent))
        expected = math.exp(log_noise) * (1 + _blurred(scene, gain, u, v))
        return float(np.sum(np.log(expected) + power / expected))

    quiet = math.log(float(np.percentile(power, 2)))
    start = np.array([quiet, 0.5 * (math.log(float(power.sum() / power.size)) - quiet) + 1.0, 2.0])
    found = minimize(cost, start, method="Nelder-Mead", options={"maxiter": 800, "xatol": 1e-3})
    _, log_contrast, exponent = found.x
    return NaturalScene(math.exp(log_contrast), float(exponent), image.path or "an image")


def _mean_periodogram(image: Image) -> Floats:
    """Geometric mean of the windows' periodograms, white noise of variance 1 giving 1."""
    taper = np.hanning(_WINDOW_PX + 1)[:-1]
    taper2d = np.outer(taper, taper)
    taper2d /= math.sqrt(float(np.mean(taper2d**2)))
    logs = []
    for box in _windows(image.shape):
        pixels = image.read(box)
        usable = np.isfinite(pixels)
        if usable.mean() < _MIN_USABLE:
            continue
        level = float(pixels[usable].mean())
        values = (np.where(usable, pixels, level) - level) * taper2d
        values -= taper2d * (values.sum() / taper2d.sum())
        power = np.abs(np.fft.rfft2(values)) ** 2 / values.size
        if power.max() > 0:
            logs.append(np.log(np.maximum(power, power.max() * 1e-18)))
    if len(logs) < _MIN_WINDOWS:
        raise ImageError(
            f"{len(logs)} windows of {_WINDOW_PX} by {_WINDOW_PX} pixels with data were found in "
            f"the image, at least {_MIN_WINDOWS} are needed to measure the scene: take the natural "
            "one"
        )
    # The mean logarithm of a periodogram is lower than that of its expectation by Euler's constant.
    return np.asarray(np.exp(np.mean(logs, axis=0) + np.euler_gamma))


def _windows(shape: tuple[int, int]) -> list[Box]:
    """Windows spread over an image."""
    rows, cols = (size // _WINDOW_PX for size in shape)
    if rows * cols == 0:
        return []
    step = max(1, math.ceil(math.sqrt(rows * cols / _MAX_WINDOWS)))
    return [
        Box(row * _WINDOW_PX, col * _WINDOW_PX, _WINDOW_PX, _WINDOW_PX)
        for row in range(0, rows, step)
        for col in range(0, cols, step)
    ]


def _folded_gains(model: OtfModel, u: Floats, v: Floats) -> dict[tuple[int, int], Floats]:
    return {(i, j): np.abs(model.otf(u + i, v + j)) ** 2 for i in (-1, 0, 1) for j in (-1, 0, 1)}


def _blurred(
    scene: NaturalScene, gain: dict[tuple[int, int], Floats], u: Floats, v: Floats
) -> Floats:
    """Power of the scene in the image, that of the noise being 1."""
    return np.asarray(sum(scene.power(u + i, v + j) * own for (i, j), own in gain.items()))
