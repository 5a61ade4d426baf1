"""The power spectrum of a scene, measured in its image: blur and noise divided out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.optimize import minimize

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ImageError
from acutance.raster import Box, Image
from acutance.restoration.scene_spectrum import NaturalScene

__all__ = ["MeasuredScene", "measured_scene"]

_WINDOW_PX = 128
_MAX_ALONG = 16
_MIN_WINDOWS = 4
_LOWEST_CPP = 3 / _WINDOW_PX
_MIN_USABLE = 0.999
_EXPONENTS = (1.0, 5.0)
_SMOOTHED = 4.0
"""Standard deviation, in steps of 1/128 c/px, of the mean over departures from the power law: with
7 the errors on landscapes are 1 to 3 % larger, with 12 they are 1 to 5 % larger."""
_TRUSTED = 0.02
"""Mean share of the signal below which a departure counts half: the power law then stands."""
_DEPARTURES = (0.2, 5.0)


@dataclass(frozen=True, eq=False)
class MeasuredScene(ShortRepr):
    """A natural scene, and where its power departs from the power law: streets have a direction.

    Parameters
    ----------
    natural : NaturalScene
    departure : (128, 128) array
        Factor of the power below Nyquist, by frequency along and across, zero first.
    """

    natural: NaturalScene
    departure: Floats

    def power(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Power per square cycle per pixel at any frequencies, over that of white noise."""
        places = np.mod(v_cpp, 1.0) * _WINDOW_PX, np.mod(u_cpp, 1.0) * _WINDOW_PX
        factor = map_coordinates(self.departure, places, order=1, mode="grid-wrap")
        inside = (np.abs(u_cpp) <= 0.5) & (np.abs(v_cpp) <= 0.5)
        return np.asarray(self.natural.power(u_cpp, v_cpp) * np.where(inside, factor, 1.0))

    def to_dict(self) -> dict[str, Any]:
        """What it is, for JSON."""
        return {**self.natural.to_dict(), "kind": "measured"}


def measured_scene(image: Image, model: OtfModel) -> MeasuredScene:
    """The scene whose blurred and sampled spectrum, with white noise, an image has.

    Windows spread over the image are tapered and their periodograms averaged. Contrast, exponent
    and noise are those of largest likelihood (Whittle); what the spectrum then departs from them is
    averaged over neighbouring frequencies, and counts where the scene stands out of the noise.

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
    v, u = np.meshgrid(*2 * (np.fft.fftfreq(_WINDOW_PX),), indexing="ij")
    gain = _folded_gains(model, u.ravel(), v.ravel())
    own = (np.hypot(u, v) >= _LOWEST_CPP).ravel()
    own_gain = {orders: one[own] for orders, one in gain.items()}
    natural, noise = _fitted(power.ravel()[own], own_gain, u.ravel()[own], v.ravel()[own], image)
    signal = _blurred(natural, gain, u.ravel(), v.ravel()).reshape(power.shape)
    excess = np.where(own.reshape(power.shape), power / noise - 1 - signal, 0.0)
    trust = (signal / (1 + signal)) ** 2 * own.reshape(power.shape)
    sums = (_smoothed(trust * excess / np.maximum(signal, 1e-12)), _smoothed(trust) + _TRUSTED)
    return MeasuredScene(natural, np.clip(1 + sums[0] / sums[1], *_DEPARTURES))


def _smoothed(values: Floats) -> Floats:
    return np.asarray(gaussian_filter(values, _SMOOTHED, mode="wrap"))


def _fitted(
    power: Floats, gain: dict[tuple[int, int], Floats], u: Floats, v: Floats, image: Image
) -> tuple[NaturalScene, float]:
    """The power law of largest likelihood, and the variance of the noise."""

    def cost(point: Floats) -> float:
        log_noise, log_contrast, exponent = point
        if not _EXPONENTS[0] <= exponent <= _EXPONENTS[1]:
            return math.inf
        scene = NaturalScene(math.exp(log_contrast), float(exponent))
        expected = math.exp(log_noise) * (1 + _blurred(scene, gain, u, v))
        return float(np.sum(np.log(expected) + power / expected))

    quiet = math.log(max(float(np.percentile(power, 2)), 1e-12 * float(power.max())))
    start = np.array([quiet, 0.5 * (math.log(float(power.mean())) - quiet) + 1.0, 2.0])
    found = minimize(cost, start, method="Nelder-Mead", options={"maxiter": 800, "xatol": 1e-3})
    log_noise, log_contrast, exponent = found.x
    natural = NaturalScene(math.exp(log_contrast), float(exponent), image.path or "an image")
    return natural, math.exp(log_noise)


def _mean_periodogram(image: Image) -> Floats:
    """Mean periodogram of the windows, (128, 128), white noise of variance 1 giving 1."""
    taper = np.hanning(_WINDOW_PX + 1)[:-1]
    taper2d = np.outer(taper, taper)
    taper2d /= math.sqrt(float(np.mean(taper2d**2)))
    powers = []
    for box in _windows(image.shape):
        pixels = image.read(box)
        usable = np.isfinite(pixels)
        if usable.mean() < _MIN_USABLE:
            continue
        level = float(pixels[usable].mean())
        values = (np.where(usable, pixels, level) - level) * taper2d
        values -= taper2d * (values.sum() / taper2d.sum())
        power = np.abs(np.fft.fft2(values)) ** 2 / values.size
        powers.append(power)
    if len(powers) < _MIN_WINDOWS:
        raise ImageError(
            f"{len(powers)} windows of {_WINDOW_PX} by {_WINDOW_PX} pixels with data were found in "
            f"the image, at least {_MIN_WINDOWS} are needed to measure the scene: take the natural "
            "one"
        )
    mean = np.asarray(np.mean(powers, axis=0))
    if not mean.max() > 0:
        raise ImageError("the image is the same everywhere: it has no spectrum to be measured")
    return mean


def _windows(shape: tuple[int, int]) -> list[Box]:
    """Windows spread over an image."""
    counts = [max(0, 2 * size // _WINDOW_PX - 1) for size in shape]
    if 0 in counts:
        return []
    some = [min(count, _MAX_ALONG) for count in counts]
    rows, cols = (
        np.linspace(0, size - _WINDOW_PX, count).astype(int).tolist()
        for size, count in zip(shape, some, strict=True)
    )
    return [Box(row, col, _WINDOW_PX, _WINDOW_PX) for row in rows for col in cols]


def _folded_gains(model: OtfModel, u: Floats, v: Floats) -> dict[tuple[int, int], Floats]:
    return {(i, j): np.abs(model.otf(u + i, v + j)) ** 2 for i in (-1, 0, 1) for j in (-1, 0, 1)}


def _blurred(
    scene: NaturalScene, gain: dict[tuple[int, int], Floats], u: Floats, v: Floats
) -> Floats:
    """Power of the scene in the image, that of the noise being 1."""
    return np.asarray(sum(scene.power(u + i, v + j) * own for (i, j), own in gain.items()))
