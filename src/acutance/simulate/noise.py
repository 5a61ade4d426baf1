"""What the detector and its electronics add to the signal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from acutance.arguments import require_floats, require_numbers, require_optional, require_rng
from acutance.curves.grid import Floats
from acutance.errors import ModelError, OptionError
from acutance.optics.block import require

__all__ = ["Noise", "noise_of_snr"]


@dataclass(frozen=True)
class Noise:
    """Random noise with variance ``read^2 + shot_gain * I``, then saturation and rounding.

    Parameters
    ----------
    read : float, optional
        Standard deviation of the signal-independent noise, in image units.
    shot_gain : float, optional
        Variance per unit of signal: image units per photo-electron. The noise is drawn from a
        normal distribution, which it follows above some 20 electrons.
    quantum : float, optional
        Step of the quantisation in image units (1 for whole digital numbers); 0 leaves it out.
    saturation : float, optional
        Level that the detector cannot exceed, in image units; it is rounded as every other, at most
        half a step of the quantisation upwards.
    """

    read: float = 0.0
    shot_gain: float = 0.0
    quantum: float = 0.0
    saturation: float | None = None

    def __post_init__(self) -> None:
        require(self, read=self.read, shot_gain=self.shot_gain, quantum=self.quantum)
        if self.saturation is not None:
            require(self, -math.inf, saturation=self.saturation)

    def std(self, signal: Floats) -> Floats:
        """Standard deviation of the random part where the signal is `signal`, same shape.

        Raises
        ------
        OptionError
            If the signal holds no numbers.
        """
        signal = require_floats("signal", signal)
        return np.sqrt(self.read**2 + self.shot_gain * np.maximum(signal, 0.0))

    def added_to(self, image: Floats, rng: np.random.Generator | None) -> Floats:
        """A noisy copy of `image`.

        Raises
        ------
        ModelError, OptionError
            If something is random and no generator was handed in, or the image holds no numbers.
        """
        image = np.asanyarray(image)
        if image.dtype.kind not in "biuf":
            raise OptionError(f"image is {image!r:.80}: it has to hold numbers")
        noisy = image
        if self.read > 0 or self.shot_gain > 0:
            drawn = require_rng(rng, "noise").standard_normal(image.shape)
            noisy = image + self.std(image) * drawn
        if self.saturation is not None:
            noisy = np.minimum(noisy, self.saturation)
        if self.quantum > 0:
            noisy = np.round(noisy / self.quantum) * self.quantum
        return np.array(noisy)


def noise_of_snr(
    contrast: float, snr: float | None, noise: Noise | None, darkest: float | None = None
) -> Noise | None:
    """The noise of a target: of a given SNR, of a full description, or both.

    With both, the SNR is that of the white noise, and the rest is as described.

    Parameters
    ----------
    contrast : float
    snr : float, optional
    noise : Noise, optional
    darkest : float, optional
        The lowest level of the target and its background.

    Raises
    ------
    ModelError
        If both set the strength of the white noise, the SNR is not above 0, or the lowest level is
        saturated or has no shot noise.
    OptionError
        If one of them is of the wrong kind.
    """
    require_optional(Noise, noise=noise)
    if noise is not None and darkest is not None:
        _require_darkest(noise, darkest)
    if snr is None:
        return noise
    require_numbers(snr=snr)
    if not snr > 0:
        raise ModelError(f"snr is {snr:g}, it has to be above 0")
    described = Noise() if noise is None else noise
    if described.read > 0:
        raise ModelError(
            f"snr is {snr:g} (--snr) and the noise has a read of {described.read:g} "
            "(--read-noise): both set the white noise, give one of them"
        )
    return replace(described, read=abs(contrast) / snr)


def _require_darkest(noise: Noise, darkest: float) -> None:
    """Refuse noise that the lowest level of an image cannot have."""
    if noise.saturation is not None and not noise.saturation > darkest:
        raise ModelError(
            f"saturation is {noise.saturation:g} and the lowest level {darkest:g}: every pixel "
            "would be saturated; give a saturation (--saturation) above the lowest level"
        )
    if noise.shot_gain > 0 and darkest < 0:
        raise ModelError(
            f"shot_gain is {noise.shot_gain:g} and the lowest level {darkest:g}: signal below 0 "
            "has no shot noise; give levels from 0 on, or leave the shot noise out (--shot-gain)"
        )
