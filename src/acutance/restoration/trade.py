"""The trade: what kernels of one family give for the noise they cost."""

from __future__ import annotations

import numpy as np

from acutance.restoration.knobs import Turned, worst_overshoot
from acutance.restoration.niirs_change import niirs_changes

__all__ = ["trade_rows"]

_GAINS = np.geomspace(0.7, 8.0, 25)


def trade_rows(turned: Turned, snr: float | None) -> list[dict[str, float | None]]:
    """MTF at Nyquist, overshoot and change of NIIRS by rising noise gain.

    Parameters
    ----------
    turned : Turned
        A family of kernels on a sensor.
    snr : float or None
        Without it the change of NIIRS is None.
    """
    family = turned.family
    low, high = (family.noise_gain(float(family.weights[i])) for i in (-1, 0))
    return [_row(turned, float(gain), snr) for gain in _GAINS if low < gain < high]


def _row(turned: Turned, gain: float, snr: float | None) -> dict[str, float | None]:
    after = turned.responses(turned.family.weight_of_gain(gain))
    change = None if snr is None else niirs_changes(turned.unfiltered, after, snr, gain)[4].value
    across, along = (one.mtf_nyquist.value for one in after)
    return {
        "noise_gain": gain,
        "mtf_nyquist_across": across,
        "mtf_nyquist_along": along,
        "overshoot": worst_overshoot(after),
        "niirs_change": change,
    }
