"""What a kernel does to detail beyond Nyquist, which the samples show at lower frequencies."""

from __future__ import annotations

import numpy as np

from acutance.curves import OtfModel
from acutance.curves.grid import Floats
from acutance.restoration.filtered_otf import kernel_otf
from acutance.restoration.scene_spectrum import NaturalScene, SceneSpectrum, StiffScene

__all__ = ["aliased_share"]

_FREQUENCIES = 48
_LOWEST_CPP = 0.05
_ANY_CONTRAST = 1.0


def aliased_share(model: OtfModel, scene: SceneSpectrum, kernel: Floats) -> tuple[float, float]:
    """Share of the power of fine detail that is aliased, before and after a kernel.

    A kernel amplifies what was folded at Nyquist as it does the frequency it was folded to: no
    kernel tells them apart. Detail coarser than 20 px is left out, since its power has no end.

    Parameters
    ----------
    model : OtfModel
    scene : SceneSpectrum
        One that ends at Nyquist is replaced by a natural one.
    kernel : (m, m) array
    """
    own = NaturalScene(_ANY_CONTRAST) if isinstance(scene, StiffScene) else scene
    grid = (np.arange(_FREQUENCIES) + 0.5) / _FREQUENCIES - 0.5
    u, v = (axis.ravel() for axis in np.meshgrid(grid, grid))
    fine = np.hypot(u, v) > _LOWEST_CPP
    u, v = u[fine], v[fine]
    true = _power(model, own, u, v)
    folded = sum(_power(model, own, u + i, v + j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j)
    gain = np.abs(kernel_otf(kernel, u, v)) ** 2
    before = float(np.sum(folded) / np.sum(true + folded))
    return before, float(np.sum(gain * folded) / np.sum(gain * (true + folded)))


def _power(model: OtfModel, scene: SceneSpectrum, u: Floats, v: Floats) -> Floats:
    return np.asarray(scene.power(u, v) * np.abs(model.otf(u, v)) ** 2)
