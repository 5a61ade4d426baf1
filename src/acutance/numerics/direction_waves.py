"""Values of a few directions carried to others, by the smoothest waves all around."""

from __future__ import annotations

import numpy as np

from acutance.curves.grid import Floats

__all__ = ["between_directions"]

_ORDERS = np.arange(7)
_WEIGHTS: Floats = np.asarray(0.25**_ORDERS, float)
"""Of the waves: slow ones first."""


def between_directions(known_deg: Floats, wanted_deg: Floats, *, odd: bool) -> Floats:
    """Weights (n, m) with which values of m directions give those of n others.

    Parameters
    ----------
    known_deg : (m,) array
    wanted_deg : (n,) array
    odd : bool
        Whether opposite directions have opposite values, as the imaginary parts of a transfer
        function, or equal ones, as its real parts: waves of odd or of even order.
    """
    known, wanted = np.radians(known_deg), np.radians(wanted_deg)
    orders = 2 * _ORDERS + odd

    def waves(difference: Floats) -> Floats:
        return np.asarray(np.cos(difference[..., None] * orders) @ _WEIGHTS)

    among = waves(known[:, None] - known)
    return np.asarray(waves(wanted[:, None] - known) @ np.linalg.pinv(among, hermitian=True))
