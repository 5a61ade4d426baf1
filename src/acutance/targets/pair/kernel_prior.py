"""The prior of a kernel's coefficients: its processes, and the families of sensors.

The processes of `kernel_basis` allow anything smooth. The families of sensors
(`acutance.numerics.otf_families`) are directions in which optics make the low sensor's transfer
depart from a Gaussian through a pixel; the kernel's are those over the reference's transfer, as
combinations of the basis' own functions. Either have amplitudes that the data decide.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.combined_prior import CombinedPrior
from acutance.numerics.gaussian_pixel import FWHM_OF_SIGMA
from acutance.numerics.marginal_likelihood import Prior
from acutance.numerics.otf_families import family_directions
from acutance.numerics.otf_modes import ProcessModes
from acutance.numerics.stacked import stacked
from acutance.targets.pair import tuned
from acutance.targets.pair.kernel_basis import KernelBasis
from acutance.targets.pair.reference_otf import ReferenceOtf

__all__ = ["kernel_prior"]

_STEP_CPP: Final = 0.04
_HIGHEST_CPP: Final = 1.5
_NEXT_TO_ZERO_CPP: Final = (0.001, 0.004, 0.01)
_ANGLES: Final = 24
_LEFT: Final = 1e-3
"""What the basis may leave of a family's direction, relative to coefficients of one."""
_MIN_REFERENCE: Final = 0.1
"""Transfer of the reference by which directions are divided at least."""


def kernel_prior(basis: KernelBasis, gain: float, reference: ReferenceOtf | None) -> CombinedPrior:
    """Prior of the coefficients about the parametric kernel of a gain.

    Parameters
    ----------
    basis : KernelBasis
    gain : float
    reference : ReferenceOtf or None
        The high image's own transfer; where it is not known it is taken to be one.
    """
    families = _family_coefficients(basis, reference)
    own = basis.log_amplitude.size
    _, family, log_amplitude = family_directions()
    mean = np.zeros(basis.size + family.size)
    mean[0] = gain
    stds = [tuned.LOG_AMPLITUDE_STD, tuned.FAMILY_LOG_AMPLITUDE_STD]
    prior = Prior(
        block=np.concatenate([basis.blocks, own + family]).astype(float),
        scale=np.append(basis.scale, np.ones(family.size)),
        mean=mean,
        log_amplitude=np.append(basis.log_amplitude, log_amplitude),
        log_amplitude_std=np.repeat(stds, [own, log_amplitude.size]),
        height=abs(gain),
        noise_floor=1e-3,
    )
    return CombinedPrior(prior, np.hstack([np.eye(basis.size), families]))


def _family_coefficients(basis: KernelBasis, reference: ReferenceOtf | None) -> Floats:
    """The families' directions as coefficients of the basis, (k, r), by least squares."""
    u, v = _nodes(basis)
    own = np.ones(u.size, complex) if reference is None else reference.otf(u, v)
    size = np.maximum(np.abs(own), _MIN_REFERENCE)
    states = ProcessModes(_low_width_px(basis, reference)).otf_modes(u, v)
    wanted = states @ family_directions().states * (np.conj(own) / size**2)[:, None]
    functions = stacked(basis.transfer(u, v) * basis.centring(u, v)[:, None])
    gram = functions.T @ functions + _LEFT**2 * np.eye(basis.size)
    return np.asarray(np.linalg.solve(gram, functions.T @ stacked(wanted)))


def _nodes(basis: KernelBasis) -> tuple[Floats, Floats]:
    """Frequencies (n,) over half a turn, within the band of the taps.

    Those next to zero count more: every curve is divided by the value there.
    """
    bands = 0.5 * basis.grid.across.per_px, 0.5 * basis.grid.down.per_px
    highest = min(math.hypot(*bands), _HIGHEST_CPP)
    freq = np.append(np.repeat(_NEXT_TO_ZERO_CPP, 4), np.arange(_STEP_CPP / 2, highest, _STEP_CPP))
    angle = math.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
    u, v = (np.outer(freq, wave(angle)).ravel() for wave in (np.cos, np.sin))
    inside = (np.abs(u) <= bands[0]) & (np.abs(v) <= bands[1])
    return u[inside], v[inside]


def _low_width_px(basis: KernelBasis, reference: ReferenceOtf | None) -> float:
    """FWHM of the Gaussian with the low sensor's variance: the kernel's and the reference's."""
    variance = 0.5 * (basis.down.variance_px2 + basis.across.variance_px2) + 1 / 12
    if reference is not None:
        some, none = np.array([0.05]), np.zeros(1)
        both = reference.otf(some, none), reference.otf(none, some)
        transfer = math.sqrt(float(np.abs(both[0] * both[1])[0]))
        variance += max(-math.log(transfer) / (2 * math.pi**2 * 0.05**2), 0.0)
    return FWHM_OF_SIGMA * math.sqrt(max(variance, 1 / 12))
