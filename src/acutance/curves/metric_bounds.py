"""What the numbers of a measurement cannot fall below, and limits that ask nothing of them."""

from __future__ import annotations

from acutance.curves.response import METRICS

__all__ = ["limit_fault", "lowest_of"]

_SIGNED = ("rer", "giqe_h")
"""Numbers that may fall below 0."""


def lowest_of(metric: str) -> float | None:
    """What a number cannot fall below: 0 of an MTF or a width; None where there is no bound.

    Parameters
    ----------
    metric : str
        "mtf_nyquist"; names that are not in `METRICS` have no bound.
    """
    return 0.0 if metric in METRICS and metric not in _SIGNED else None


def limit_fault(metric: str, limit: float) -> str:
    """Why a limit cannot be tested, as every value or none keeps it; "" where it can.

    Parameters
    ----------
    metric : str
    limit : float
        A minimum or a maximum.
    """
    lowest = lowest_of(metric)
    if lowest is None or limit > lowest:
        return ""
    return f"{metric} is never below {lowest:g}; state a limit above"
