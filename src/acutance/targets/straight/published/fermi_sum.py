"""A sum of Fermi functions: edge, line spread and transfer function in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats

__all__ = ["FermiSum", "fit_profile"]

Complexes = NDArray[np.complex128]

_NARROWEST_PX, _WIDEST_PX = 0.02, 10.0


@dataclass(frozen=True, eq=False)
class FermiSum:
    """``sum_k amplitude_k / (1 + exp(-(x - centre_k) / width_k))``.

    Gradients are with respect to (amplitude, centre, log width), K columns each.

    Parameters
    ----------
    amplitude : (K,) array
        In the image's units; negative terms make over- and undershoot.
    centre_px, width_px : (K,) arrays
    """

    amplitude: Floats
    centre_px: Floats
    width_px: Floats

    @property
    def contrast(self) -> float:
        """Bright minus dark level."""
        return float(self.amplitude.sum())

    @property
    def centroid_px(self) -> float:
        """Centroid of the line spread function."""
        return float(self.amplitude @ self.centre_px) / self.contrast

    def _rise(self, x: Floats) -> tuple[Floats, Floats]:
        u = (x[:, None] - self.centre_px) / self.width_px
        return u, 0.5 * (1.0 + np.tanh(u / 2))

    def value(self, x: Floats) -> Floats:
        """The sum at `x` (n,), 0 far on the dark side."""
        return np.asarray(self._rise(x)[1] @ self.amplitude)

    def slope(self, x: Floats) -> Floats:
        """Derivative by x, (n,): the line spread function times the contrast."""
        _, rise = self._rise(x)
        return np.asarray((rise * (1 - rise) / self.width_px) @ self.amplitude)

    def bend(self, x: Floats) -> Floats:
        """Second derivative by x, (n,)."""
        _, rise = self._rise(x)
        return np.asarray((rise * (1 - rise) * (1 - 2 * rise) / self.width_px**2) @ self.amplitude)

    def value_gradient(self, x: Floats) -> Floats:
        """Gradient of `value`, (n, 3 K)."""
        u, rise = self._rise(x)
        steep = self.amplitude * rise * (1 - rise)
        return np.asarray(np.hstack((rise, -steep / self.width_px, -steep * u)))

    def slope_gradient(self, x: Floats) -> Floats:
        """Gradient of `slope`, (n, 3 K)."""
        u, rise = self._rise(x)
        bump = rise * (1 - rise) / self.width_px
        turn = bump * (1 - 2 * rise)
        return np.hstack(
            (
                bump,
                -self.amplitude * turn / self.width_px,
                -self.amplitude * (bump + turn * u),
            )
        )

    def transfer(self, freq_cpp: Floats) -> Complexes:
        """Fourier transform of `slope`, (m,): ``contrast`` at frequency 0.

        One term with width c gives z / sinh z, z = 2 pi^2 c f, times the phase of its centre.
        """
        _, decay, phase = self._waves(freq_cpp)
        return np.asarray((decay * phase) @ self.amplitude)

    def transfer_gradient(self, freq_cpp: Floats) -> Complexes:
        """Gradient of `transfer`, (m, 3 K)."""
        z, decay, phase = self._waves(freq_cpp)
        wave = decay * phase
        with np.errstate(divide="ignore", invalid="ignore"):
            log_slope = np.where(z > 1e-6, 1.0 - z / np.tanh(z), 0.0)
        shift = -2j * np.pi * freq_cpp[:, None]
        return np.hstack((wave, self.amplitude * wave * shift, self.amplitude * wave * log_slope))

    def _waves(self, freq_cpp: Floats) -> tuple[Floats, Floats, Complexes]:
        z = 2 * np.pi**2 * freq_cpp[:, None] * self.width_px
        with np.errstate(divide="ignore", invalid="ignore"):
            decay = np.where(z > 1e-6, z / np.sinh(np.minimum(z, 700.0)), 1.0)
        return z, decay, np.exp(-2j * np.pi * freq_cpp[:, None] * self.centre_px)

    @classmethod
    def from_vector(cls, vector: Floats) -> FermiSum:
        """From (amplitude, centre, log width), K numbers each."""
        amplitude, centre, log_width = vector.reshape(3, -1)
        limits = np.log(_NARROWEST_PX), np.log(_WIDEST_PX)
        return cls(amplitude, centre, np.exp(np.clip(log_width, *limits)))

    def to_vector(self) -> Floats:
        """(amplitude, centre, log width), (3 K,)."""
        return np.concatenate((self.amplitude, self.centre_px, np.log(self.width_px)))


def fit_profile(x: Floats, y: Floats, weight: Floats) -> tuple[float, FermiSum]:
    """One Fermi function on a level by weighted least squares.

    Parameters
    ----------
    x, y, weight : (n,) arrays
        Distances, values and how often each counts.

    Returns
    -------
    level : float
        The dark plateau.
    fermi : FermiSum
        With one term.
    """
    from scipy.optimize import least_squares

    root = np.sqrt(weight)
    low, high = float(y[x <= np.quantile(x, 0.1)].mean()), float(y[x >= np.quantile(x, 0.9)].mean())

    def residual(unknown: Floats) -> Floats:
        model = unknown[0] + FermiSum.from_vector(unknown[1:]).value(x)
        return np.asarray(root * (model - y))

    def jacobian(unknown: Floats) -> Floats:
        gradient = FermiSum.from_vector(unknown[1:]).value_gradient(x)
        return np.asarray(root[:, None] * np.hstack((np.ones((x.size, 1)), gradient)))

    start = np.array([low, high - low, 0.0, np.log(0.3)])
    found = least_squares(residual, start, jac=jacobian, method="lm", x_scale="jac")
    return float(found.x[0]), FermiSum.from_vector(found.x[1:])
