"""Errors of repeated measurements, and the SNR from which they stay below a limit."""

from __future__ import annotations

import math

import numpy as np

from acutance.curves.grid import Floats
from acutance.studies.table import Cell

__all__ = ["error_columns", "falling_fit", "minimum_snr", "word_minimum"]


def error_columns(name: str, value: Floats, truth: float) -> dict[str, Cell]:
    """Mean, bias, scatter and rms error of one condition's draws, in percent of the truth.

    Parameters
    ----------
    name : str
        Of the estimator; the columns' names begin with it.
    value : (n,) array
        ``nan`` where the estimator refused. Where it refused more than half, the rest is luck
        and there are no numbers.
    truth : float
    """
    known = value[np.isfinite(value)]
    error = 100 * (known / truth - 1)
    some = 2 * known.size >= max(value.size, 1)
    several = some and known.size > 1
    return {
        f"{name}_mean": float(known.mean()) if some else math.nan,
        f"{name}_bias_percent": float(error.mean()) if some else math.nan,
        f"{name}_std_percent": float(error.std(ddof=1)) if several else math.nan,
        f"{name}_rms_percent": float(np.sqrt(np.mean(error**2))) if some else math.nan,
        f"{name}_refused": int(value.size - known.size),
    }


def falling_fit(value: Floats) -> Floats:
    """The sequence nearest to `value` that never rises, (n,): pooled adjacent violators."""
    means: list[float] = []
    counts: list[int] = []
    for one in value:
        means.append(float(one))
        counts.append(1)
        while len(means) > 1 and means[-1] > means[-2]:
            count = counts[-1] + counts[-2]
            mean = (means[-1] * counts[-1] + means[-2] * counts[-2]) / count
            means[-2:], counts[-2:] = [mean], [count]
    return np.repeat(means, counts)


def minimum_snr(snr: Floats, rms_percent: Floats, limit_percent: float) -> float:
    """The least SNR at which the rms error has come below a limit.

    The mean square error is made to fall with the SNR first, so that the luck of single levels
    does not decide.

    Parameters
    ----------
    snr, rms_percent : (n,) arrays
        In any order; levels without a number are left out.
    limit_percent : float

    Returns
    -------
    float
        ``nan`` if no level is good enough, the lowest level if all are.
    """
    known = np.isfinite(snr) & np.isfinite(rms_percent)
    order = np.argsort(snr[known])
    levels = snr[known][order]
    square = falling_fit(rms_percent[known][order] ** 2)
    good = np.flatnonzero(square <= limit_percent**2)
    return float(levels[good[0]]) if good.size else math.nan


def word_minimum(least: float, snr: Floats) -> str:
    """What to say of a minimum SNR that `minimum_snr` found among some levels."""
    if math.isfinite(least):
        return f"an SNR of {least:.0f}"
    return f"more than the SNR of {snr.max():.0f} that was tried"
