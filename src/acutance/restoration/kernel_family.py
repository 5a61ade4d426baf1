"""Kernels of least expected error, one for each weight of the noise.

An image is the scene blurred by the optical transfer function (OTF) O, sampled, and noise n. A
kernel h of few pixels turns it into an estimate of the scene as an ideal pixel sees it, D. Its
expected squared error

    E(h) = mean over f of |K O - D|^2 S + w |K|^2 N

(K the transfer of h, S and N the power of scene and noise, folded at Nyquist) is quadratic in the
kernel's elements: the kernel of a given size and sum 1 solves a system of linear equations, and is
better than any that was cut out of a larger one. What is not known of O enters by its second
moment: E|O|^2 = |mean|^2 + variance, so where the measurement is doubtful the kernel is timid.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.optimize import brentq

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.restoration.scene_spectrum import SceneSpectrum

__all__ = ["DESIRED", "Desired", "KernelFamily"]

Complexes = NDArray[np.complex128]
Desired = Callable[[Floats, Floats], Complexes]
"""The transfer that a kernel has to give: a function of frequencies across and along."""

_FREQUENCIES = 96
_VARIANCE_STEP_CPP = 1 / 24
_ORDERS = (-1, 0, 1)
"""Multiples of the sampling frequency that are folded back: further ones hold no light."""

_TRIED: Floats = np.geomspace(1e-8, 1e5, 131)
"""Weights of the noise that are tried, shares of the scene's mean power."""


def _pixel(u_cpp: Floats, v_cpp: Floats) -> Complexes:
    """Transfer of an ideal pixel: the mean over its area, and no other blur."""
    return np.asarray(np.sinc(u_cpp) * np.sinc(v_cpp) + 0j)


def _point(u_cpp: Floats, v_cpp: Floats) -> Complexes:
    """No blur at all up to Nyquist, and nothing beyond it: samples of points, not aliased."""
    return np.asarray(np.where((np.abs(u_cpp) <= 0.5) & (np.abs(v_cpp) <= 0.5), 1.0 + 0j, 0j))


DESIRED: dict[str, Desired] = {"pixel": _pixel, "point": _point}
"""What a restored image may be like."""


@dataclass(frozen=True, eq=False)
class KernelFamily(ShortRepr):
    """The kernels of one size, by weight of the noise.

    Parameters
    ----------
    size : int
    modes : (size^2, size^2 - 1) array
        Orthonormal kernels that sum to 0.
    power : (size^2 - 1,) array
        Power of the blurred scene in each mode, that of the noise being 1.
    wanted : (size^2 - 1,) array
        Covariance of each mode with what is desired.
    """

    size: int
    modes: Floats
    power: Floats
    wanted: Floats

    @classmethod
    def of(
        cls, model: OtfModel, scene: SceneSpectrum, size: int, desired: Desired = _pixel
    ) -> KernelFamily:
        """The family of a sensor, of a scene, and of what the kernel has to give."""
        image, cross = _covariances(model, scene, desired)
        reach = np.arange(size) - size // 2
        row, col = (axis.ravel() for axis in np.meshgrid(reach, reach, indexing="ij"))
        gram = image[row[:, None] - row, col[:, None] - col]
        flat = np.full(size**2, 1 / size**2)
        basis = _without_sum(size**2)
        power, turn = np.linalg.eigh(basis.T @ gram @ basis)
        modes = basis @ turn
        return cls(size, modes, np.maximum(power, 0.0), modes.T @ (cross[-row, -col] - gram @ flat))

    def kernel(self, weight: float) -> Floats:
        """The kernel of least expected error, (size, size), of sum 1.

        Parameters
        ----------
        weight : float
            Factor of the noise's power: above 1 for a smoother image than the best.
        """
        found = self.modes @ (self.wanted / (self.power + weight)) + 1 / self.size**2
        return np.asarray(found.reshape(self.size, self.size) / found.sum())

    def noise_gain(self, weight: float) -> float:
        """Standard deviation of white noise after the kernel over that before it."""
        weights = self.wanted / (self.power + weight)
        return math.sqrt(1 / self.size**2 + float(weights @ weights))

    @property
    def weights(self) -> Floats:
        """Weights of the noise from next to none to a flat kernel, rising; 1 is the noise there is.

        Where little is known of the noise, or there is next to none, 1 may lie beyond them.
        """
        return float(self.power.mean()) * _TRIED

    def weight_of_gain(self, noise_gain: float) -> float:
        """The weight whose kernel has a noise gain: the gain falls with every weight."""

        def excess(log_weight: float) -> float:
            return self.noise_gain(math.exp(log_weight)) - noise_gain

        low, high = (math.log(float(self.weights[i])) for i in (0, -1))
        return math.exp(float(brentq(excess, low, high, xtol=1e-12)))


def _covariances(model: OtfModel, scene: SceneSpectrum, desired: Desired) -> tuple[Floats, Floats]:
    """Covariance of the image without noise, and of image and desired image, by shift.

    (n, n) arrays; negative shifts count from the end.
    """
    n = _FREQUENCIES
    u, v = np.meshgrid(np.fft.rfftfreq(n), np.fft.fftfreq(n))
    own, both = np.zeros(u.shape), np.zeros(u.shape, complex)
    for order_u in _ORDERS:
        for order_v in _ORDERS:
            at = u + order_u, v + order_v
            flat_u, flat_v = (one.ravel() for one in at)
            otf = model.otf(flat_u, flat_v).reshape(u.shape)
            power = scene.power(*at)
            own += power * (np.abs(otf) ** 2 + _variance(model, *at))
            both += power * otf * np.conj(desired(flat_u, flat_v)).reshape(u.shape)
    # Any constant in both is without effect on kernels of one sum: so is zero frequency.
    own[0, 0], both[0, 0] = own[0, 1], both[0, 1]
    return np.fft.irfft2(own, (n, n)), np.fft.irfft2(both, (n, n))


def _variance(model: OtfModel, u_cpp: Floats, v_cpp: Floats) -> Floats:
    """Variance of the OTF, interpolated between frequencies up to 1 c/px, beyond them 0.

    It is smooth, and its factor is long: at every frequency it would cost more than all else.
    """
    count = math.ceil(1 / _VARIANCE_STEP_CPP)
    half = np.arange(count + 1) * _VARIANCE_STEP_CPP
    every = np.concatenate([-half[:0:-1], half])
    u, v = np.meshgrid(half, every)
    factor = model.factor(u.ravel(), v.ravel())
    variance = np.sum(np.abs(factor) ** 2, axis=1).reshape(u.shape)
    # The OTF of a real spread function: what is at (-u, -v) is at (u, v).
    flip = np.where(u_cpp < 0, -1.0, 1.0)
    places = flip * v_cpp / _VARIANCE_STEP_CPP + count, flip * u_cpp / _VARIANCE_STEP_CPP
    return np.asarray(map_coordinates(variance, places, order=1, mode="constant"))


def _without_sum(count: int) -> Floats:
    """An orthonormal basis of vectors (count,) that sum to 0, (count, count - 1).

    The columns of the reflection that turns the constant vector into the first axis.
    """
    normal = np.full(count, 1 / math.sqrt(count))
    normal[0] += 1
    return np.asarray(np.eye(count)[:, 1:] - np.outer(normal, normal[1:]) / normal[0])
