"""By how much a kernel changes the NIIRS: before and after share their errors."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from acutance.curves import Estimate, Response, metrics
from acutance.curves.grid import Floats
from acutance.restoration.giqe import GiqeInputs, giqe

__all__ = ["giqe_readings", "niirs_changes"]

_ANY_GSD_M = 1.0
_STEP = 1e-4


def niirs_changes(
    before: Sequence[Response], after: Sequence[Response], snr: float, noise_gain: float
) -> dict[int, Estimate]:
    """NIIRS after a kernel minus that before it, by version of the equation.

    The ground sampling distance cancels, and so does most of what ratings scatter about the
    equation: the deviation is that of the measurement alone. Version 4 takes the coefficients of
    its lower branch on both sides, so that its jump at an RER of 0.9 is no gain. Version 5, made
    for images before sharpening, takes the SNR after the kernel.

    Parameters
    ----------
    before, after : sequences of Response
        Across and along; their factors share the latent variables.
    snr : float
        Before the kernel.
    noise_gain : float
    """
    values, rows = giqe_readings((*before, *after))

    def change(numbers: Floats, version: int) -> float:
        old, new = numbers[:4], numbers[4:]
        own_snr = snr / noise_gain if version == 5 else snr
        gain = 1.0 if version == 5 else noise_gain
        return _niirs(new, own_snr, gain, version) - _niirs(old, snr, 1.0, version)

    found = {}
    for version in (3, 4, 5):
        # To both sides: version 5 has a kink where the RERs across and along are equal.
        slopes = np.array([
            (change(values + step, version) - change(values - step, version)) / (2 * _STEP)
            for step in _STEP * np.eye(values.size)
        ])  # fmt: skip
        std = float(np.linalg.norm(slopes @ rows))
        found[version] = Estimate(change(values, version), std)
    return found


def giqe_readings(responses: Sequence[Response]) -> tuple[Floats, Floats]:
    """RER and H of every response, (2 n,), and what the latent variables add to them, (2 n, k)."""
    found = [
        reading
        for one in responses
        for reading in (metrics.rer(one.esf, one.lsf), metrics.giqe_h(one.esf))
    ]
    width = responses[0].esf.factor.shape[1]
    return (
        np.array([one.value for one in found]),
        np.array([np.broadcast_to(one.row, width) for one in found]).reshape(len(found), width),
    )


def _niirs(numbers: Floats, snr: float, noise_gain: float, version: int) -> float:
    """NIIRS of RER and H across, RER and H along."""
    rer, height = numbers[0::2], numbers[1::2]
    giqe_h = math.sqrt(float(height[0] * height[1]))
    if version == 4:
        # Its lower branch, continued.
        log_rer = 0.5 * math.log10(float(rer[0] * rer[1]))
        return 2.817 * log_rer - 0.656 * giqe_h - 0.344 * noise_gain / snr
    inputs = GiqeInputs(
        _ANY_GSD_M, float(rer[0]), float(rer[1]), snr, giqe_h=giqe_h, noise_gain=noise_gain
    )
    return giqe(inputs, version)
