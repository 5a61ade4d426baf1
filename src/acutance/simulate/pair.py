"""The same ground seen by two sensors of different GSD: a pair for the bi-resolution method."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from acutance.arguments import (
    require_finite,
    require_optional,
    require_place,
    require_rng,
)
from acutance.curves import Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import ModelError
from acutance.geometry.line import Orientation
from acutance.optics import Rescaled, Sensor
from acutance.optics.block import Block, Transfer
from acutance.optics.sensor import require_sensor
from acutance.simulate.ground import alias_bands
from acutance.simulate.ground_of_pair import PairGround, pair_ground
from acutance.simulate.limits import require_shape
from acutance.simulate.native_grid import NativeGrid
from acutance.simulate.noise import Noise, noise_of_snr

__all__ = ["PairTruth", "pair"]

MARGIN_PX = 32
"""Ground rendered beyond the low image on every side: light scattered further comes back from
the other side. That of a telescope falls like 1 / r^3, and from 8 px away, at SNR 400, it made
MTF(.25) and RER .002 too high."""

MAX_SAMPLES = 40_000_000

Complexes = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class PairTruth(ShortRepr):
    """The truth of a simulated pair: the result of a perfect measurement.

    Frequencies and distances are in pixels of the low image.

    Parameters
    ----------
    sensor : Sensor
        The one of the low image.
    reference : Sensor
        The one of the high image, in its own pixels.
    ratio : float
        GSD of the low image over that of the high one.
    shift_px : (float, float)
        By how much, (row, col) in low pixels, the low image's content is displaced.
    gain, offset : float
        Of the low image's radiometry against the high one's.
    noise_low, noise_high : Noise, optional
        Noise that was added to either image.
    """

    sensor: Sensor
    reference: Sensor
    ratio: float
    shift_px: tuple[float, float]
    gain: float
    offset: float
    noise_low: Noise | None = None
    noise_high: Noise | None = None

    @property
    def reference_in_low_px(self) -> Block:
        """The reference sensor in pixels of the low image."""
        return Rescaled(self.reference, self.ratio)

    def ratio_otf(self, u: Floats, v: Floats) -> Transfer:
        """OTF of the low sensor over that of the reference: the pair alone determines it."""
        return np.asarray(self.sensor.otf(u, v) / self.reference_in_low_px.otf(u, v))

    def response(self, orientation: Orientation = "across") -> Response:
        """True curves of the low sensor, across or along."""
        return self.sensor.response(0.0, orientation)

    def to_dict(self) -> dict[str, Any]:
        """The geometry and the true curves of both directions, for JSON."""
        directions: dict[str, Any] = {}
        for orientation, angle in (("across", 0.0), ("along", math.pi / 2)):
            found = self.response("across" if angle == 0.0 else "along")
            numbers = {name: number.value for name, number in found.metrics().items()}
            freq: Floats = found.mtf.freq_cpp[found.mtf.freq_cpp <= self.ratio / 2]
            quotient = np.abs(self.ratio_otf(freq * math.cos(angle), freq * math.sin(angle)))
            directions[orientation] = {
                **numbers,
                "mtf": {
                    "freq_cpp": np.round(found.mtf.freq_cpp, 6).tolist(),
                    "value": found.mtf.value.tolist(),
                },
                "mtf_over_reference": {
                    "freq_cpp": np.round(freq, 6).tolist(),
                    "value": quotient.tolist(),
                },
            }
        return {
            "kind": "biresolution",
            "ratio": self.ratio,
            "shift_px": list(self.shift_px),
            "gain": self.gain,
            "offset": self.offset,
            **directions,
        }


def pair(
    sensor: Sensor,
    reference: Sensor,
    *,
    ratio: float = 2.0,
    shape: tuple[int, int] = (128, 128),
    shift_px: tuple[float, float] = (0.0, 0.0),
    gain: float = 1.0,
    offset: float = 0.0,
    ground: PairGround | None = None,
    dark: float = 200.0,
    bright: float = 1200.0,
    snr: float | None = None,
    noise_low: Noise | None = None,
    noise_high: Noise | None = None,
    native: NativeGrid | None = None,
    rng: np.random.Generator,
) -> tuple[Floats, Floats, PairTruth]:
    """Two images of one landscape, and the truth about them.

    The ground is a Fourier series, so both images are exact: its coefficients times either OTF,
    at the pixels' own places, with all aliasing. Pixel corners of the two images coincide.

    Parameters
    ----------
    sensor, reference : Sensor
        Of the low and of the high image, each in its own pixels.
    ratio : float, optional
        GSD of the low image over that of the high one, in quarters: 2, 2.5, 2.75.
    shape : (rows, cols), optional
        Of the low image.
    shift_px : (float, float), optional
        Displacement (row, col) of the low image's content in low pixels: an error of the
        registration.
    gain, offset : float, optional
        The low image is ``gain * radiance + offset``.
    ground : PairGround, optional
    dark, bright : float, optional
        Levels of the darkest and of the brightest field in the high image.
    snr : float, optional
        ``bright - dark`` over the standard deviation of white noise added to both images.
    noise_low, noise_high : Noise, optional
        Full descriptions, instead of `snr`, in units of either image.
    native : NativeGrid, optional
        The grid that either sensor samples on, in pixels of its product: both images are
        interpolated from there, noise and all, and the truth is that of the products.
    rng : numpy.random.Generator
        Draws the ground and the noise.

    Returns
    -------
    low : (rows, cols) array
    high : (rows * ratio, cols * ratio) array
    truth : PairTruth

    Raises
    ------
    ModelError
        If the ratio is no number of quarters above 1, the low image has no contrast or is shifted
        by more than half of it, or the images are too large to be rendered at once.
    OptionError
        If an argument is of the wrong kind.
    """
    for one in (sensor, reference):
        require_sensor(one)
    require_shape(shape)
    drawn = require_rng(rng, "a landscape")
    require_optional(PairGround, ground=ground)
    require_optional(NativeGrid, native=native)
    require_optional(Noise, noise_low=noise_low, noise_high=noise_high)
    require_place(shift_px=shift_px)
    require_finite(ratio=ratio, gain=gain, offset=offset, dark=dark, bright=bright)
    _require_contrast_and_overlap(gain, dark, bright, shift_px, shape)
    quarters = _quarters(ratio)
    wide = _with_margin(shape, quarters, ratio)
    fine = (wide[0] * quarters, wide[1] * quarters)
    radiance = pair_ground(fine, quarters, ground or PairGround(), drawn)
    spectrum = fft.fft2(dark + (bright - dark) * radiance)
    added_low = noise_of_snr(gain * (bright - dark), snr, noise_low)
    added_high = noise_of_snr(bright - dark, snr, noise_high)
    high_shape = (math.floor(shape[0] * ratio + 1e-9), math.floor(shape[1] * ratio + 1e-9))
    # Samples of the ground in a pixel: `quarters` in one of the low image, 4 of the high one.
    low = _image(
        spectrum, sensor, quarters, quarters, shape, native, added_low, drawn,
        gain=gain, offset=offset, shift_px=shift_px,
    )  # fmt: skip
    high = _image(spectrum, reference, 4, quarters, high_shape, native, added_high, drawn)
    truth = PairTruth(
        _of_product(sensor, native), _of_product(reference, native), ratio, shift_px, gain,
        offset, added_low, added_high,
    )  # fmt: skip
    return low, high, truth


def _require_contrast_and_overlap(
    gain: float,
    dark: float,
    bright: float,
    shift_px: tuple[float, float],
    shape: tuple[int, int],
) -> None:
    if gain == 0 or dark == bright:
        raise ModelError(
            f"gain is {gain:g}, dark {dark:g} and bright {bright:g}: this leaves no contrast; the "
            "gain cannot be 0, and the levels have to differ"
        )
    if not all(abs(moved) <= 0.5 * size for moved, size in zip(shift_px, shape, strict=True)):
        raise ModelError(
            f"the images are shifted by {shift_px[0]:g} rows and {shift_px[1]:g} columns of "
            f"{shape[0]} by {shape[1]}: at most half of the image is possible"
        )


def _quarters(ratio: float) -> int:
    """The ratio in quarters: so many samples of the ground lie along a low pixel."""
    quarters = round(4 * ratio)
    if not (1 < ratio <= 16 and abs(4 * ratio - quarters) < 1e-9):
        raise ModelError(f"the ratio is {ratio:g}, it has to be 1.25 to 16 in steps of a quarter")
    return quarters


def _with_margin(shape: tuple[int, int], quarters: int, ratio: float) -> tuple[int, int]:
    """Low pixels of ground that is rendered: the image's and a margin on every side."""
    rows, cols = (_whole(size + 2 * MARGIN_PX, quarters) for size in shape)
    if rows * cols * quarters**2 > MAX_SAMPLES:
        raise ModelError(
            f"{shape[0]} by {shape[1]} pixels at ratio {ratio:g} need more than "
            f"{MAX_SAMPLES:,} samples of the ground: render a smaller pair"
        )
    return rows, cols


def _image(
    spectrum: Complexes,
    sensor: Sensor,
    samples: int,
    quarters: int,
    shape: tuple[int, int],
    native: NativeGrid | None,
    noise: Noise | None,
    rng: np.random.Generator,
    *,
    gain: float = 1.0,
    offset: float = 0.0,
    shift_px: tuple[float, float] = (0.0, 0.0),
) -> Floats:
    """The ground blurred by a sensor, `samples` of it in a pixel; its margin cut off."""
    whole = tuple(size // samples for size in spectrum.shape)
    first = MARGIN_PX * quarters // samples
    inner = slice(first, first + shape[0]), slice(first, first + shape[1])
    if native is not None:
        scene = gain * _blurred(spectrum, sensor, samples, shift_px) + offset
        return native.product(scene, samples, whole, noise, rng)[inner]
    image = gain * _seen(spectrum, sensor, samples, whole, shift_px)[inner] + offset
    return image if noise is None else noise.added_to(image, rng)


def _of_product(sensor: Sensor, native: NativeGrid | None) -> Sensor:
    if native is None:
        return sensor
    return Sensor([*sensor.blocks, native], sensor.gsd_m, sensor.gsd_along_m)


def _whole(size: int, quarters: int) -> int:
    """The next size whose ground is quick to transform and holds whole pixels of both images."""
    while fft.next_fast_len(size) != size or (size * quarters) % 4:
        size += 1
    return size


def _seen(
    spectrum: Complexes,
    sensor: Sensor,
    samples: int,
    shape: tuple[int, ...],
    shift_px: tuple[float, float],
) -> Floats:
    """An image of `shape` pixels of `samples` ground samples each, all alias bands folded in."""
    rows, cols = shape
    reach = min(alias_bands(sensor) + 0.5, samples / 2)
    down, across = (_orders(size, samples, reach) for size in shape)
    v, u = down[:, None] / rows, across[None, :] / cols
    # The first pixel's centre lies half a pixel from the corner, the first sample's half a sample.
    place = 0.5 - 0.5 / samples
    turn_down = np.exp(2j * math.pi * v * (place - shift_px[0]))
    turn_across = np.exp(2j * math.pi * u * (place - shift_px[1]))
    part = spectrum[np.ix_(down % spectrum.shape[0], across % spectrum.shape[1])]
    part = part * sensor.otf(u, v) * turn_down * turn_across
    folded = np.zeros((rows, part.shape[1]), complex)
    np.add.at(folded, down % rows, part)
    image = np.zeros((rows, cols), complex)
    np.add.at(image.T, across % cols, folded.T)
    return np.asarray(fft.ifft2(image).real / samples**2)


def _blurred(
    spectrum: Complexes, sensor: Sensor, samples: int, shift_px: tuple[float, float]
) -> Floats:
    """The ground as a sensor blurs it, not yet sampled: `samples` of these in a pixel."""
    v, u = (fft.fftfreq(size) * samples for size in spectrum.shape)
    turn_down = np.exp(-2j * math.pi * v[:, None] * shift_px[0])
    turn_across = np.exp(-2j * math.pi * u * shift_px[1])
    otf = sensor.otf(u, v[:, None])
    return np.asarray(fft.ifft2(spectrum * otf * turn_down * turn_across).real)


def _orders(size: int, samples: int, reach: float) -> NDArray[np.intp]:
    """Orders of the Fourier series that a sensor passes, each once."""
    most = min(math.ceil(reach * size), size * samples // 2 - 1)
    return np.arange(-most, most + 1)
