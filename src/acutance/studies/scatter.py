"""Errors of repeated measurements, and the SNR from which they stay below a limit."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from acutance.arguments import require_floats, require_numbers
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.studies.result import Finding
from acutance.studies.table import Cell, Table

__all__ = [
    "error_columns",
    "falling_fit",
    "find_minimum",
    "find_refusal",
    "minimum_snr",
    "require_limit",
    "require_once",
]


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


def require_limit(limit_percent: float) -> None:
    """Refuse a limit that no error stays below.

    Parameters
    ----------
    limit_percent : float

    Raises
    ------
    OptionError
        If it is not above 0.
    """
    if limit_percent <= 0:
        raise OptionError(
            f"limit_percent is {limit_percent:g}: no error stays below it, it has to be above 0"
        )


def require_once(**levels: Sequence[object]) -> None:
    """Refuse levels of which one is named twice: its images would be counted twice.

    Parameters
    ----------
    **levels : sequence
        By the option's name.

    Raises
    ------
    OptionError
        If one is there again.
    """
    for name, values in levels.items():
        again = next((one for i, one in enumerate(values) if one in values[:i]), None)
        if again is not None:
            raise OptionError(f"{name} has {again} more than once: name every level once")


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

    Raises
    ------
    OptionError
        If they are no lists of numbers of one length, or the limit is no number.
    """
    snr, rms_percent = require_floats("snr", snr), require_floats("rms_percent", rms_percent)
    require_numbers(limit_percent=limit_percent)
    if snr.ndim != 1 or snr.shape != rms_percent.shape:
        raise OptionError(
            f"snr of shape {snr.shape} with rms_percent of shape {rms_percent.shape}: give two "
            "lists of one length"
        )
    known = np.isfinite(snr) & np.isfinite(rms_percent)
    order = np.argsort(snr[known])
    levels = snr[known][order]
    square = falling_fit(rms_percent[known][order] ** 2)
    good = np.flatnonzero(square <= limit_percent**2)
    return float(levels[good[0]]) if good.size else math.nan


def find_minimum(
    name: str,
    who: str,
    levels: Table,
    column: str,
    limit_percent: float,
    published: float | None = None,
) -> tuple[Finding, ...]:
    """The SNR from which an error stays below a limit; nothing where no level has that error.

    Parameters
    ----------
    name, who : str
        Of the finding, and what its sentence begins with: whose which error.
    levels : Table
        A row a level, with its ``snr``.
    column : str
        The error in percent.
    limit_percent : float
    published : float, optional
        What the paper printed.
    """
    error, snr = levels[column], levels["snr"]
    if not np.isfinite(error).any():
        return ()
    least = minimum_snr(snr, error, limit_percent)
    if not math.isfinite(least):
        needed = f"more than the SNR of {snr.max():.0f} that was tried"
    elif least == snr.min():
        needed = f"at most an SNR of {least:.0f}, the lowest that was tried"
    else:
        needed = f"an SNR of {least:.0f}"
    return (Finding(name, least, f"{who} needs {needed}", published),)


def find_refusal(name: str, who: str, levels: Table, trials: Table) -> tuple[Finding, ...]:
    """That an estimator refused too many images for an error of any level, and why.

    Parameters
    ----------
    name, who : str
        Of the estimator, as the columns' names begin, and in words.
    levels : Table
        With the columns of `error_columns`.
    trials : Table
        Every image, with the refusals in words.
    """
    if np.isfinite(levels[f"{name}_rms_percent"]).any():
        return ()
    refused = [str(words) for words in trials.columns[f"{name}_refusal"] if words]
    return (
        Finding(
            f"refused_{name}",
            len(refused),
            f"{who} refused {len(refused)} of {len(trials)} images, so there is no "
            f"error: {max(set(refused), key=refused.count)}",
        ),
    )
