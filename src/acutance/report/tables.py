"""The MTF as a table on a regular grid of frequencies, and as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from acutance.curves import Estimate

if TYPE_CHECKING:
    from acutance.targets.measurement import Measurement

__all__ = ["MtfRow", "mtf_csv", "mtf_csv_of_many", "mtf_rows"]

STEP_CPP = 0.02


@dataclass(frozen=True)
class MtfRow:
    """The MTF at one frequency.

    Parameters
    ----------
    freq_cpp : float
    freq_cpm : float or None
        The frequency in cycles per metre; ``None`` without a GSD.
    mtf : Estimate
    """

    freq_cpp: float
    freq_cpm: float | None
    mtf: Estimate


def mtf_rows(measurement: Measurement, step_cpp: float = STEP_CPP) -> tuple[MtfRow, ...]:
    """The MTF from 0 to 1 cycles per pixel in steps of `step_cpp`."""
    gsd_m = measurement.response.gsd_m
    freqs = np.linspace(0.0, 1.0, round(1.0 / step_cpp) + 1)
    return tuple(
        MtfRow(float(freq), None if gsd_m is None else float(freq) / gsd_m, measurement.mtf(freq))
        for freq in freqs
    )


def mtf_csv(measurement: Measurement) -> str:
    """The MTF as CSV: frequency, value, standard deviation and 95 % interval.

    Columns are freq_cpp, mtf, std, low95, high95, and freq_cpm (cycles per metre) when the GSD
    is known; the frequency runs from 0 to 1 cycles per pixel in steps of 0.02.
    """
    lines = [",".join(_header(measurement))]
    lines += [",".join(cells) for cells in _cells(measurement)]
    return "\n".join(lines) + "\n"


def mtf_csv_of_many(measurements: Sequence[Measurement]) -> str:
    """Several MTFs as one CSV, with the target, method and orientation put first.

    The first column, edge or pulse, counts the measurements from 1. The column freq_cpm is there
    when all of them know their GSD.
    """
    in_metres = all(one.response.gsd_m is not None for one in measurements)
    columns = _header(measurements[0])[: 6 if in_metres else 5]
    lines = [",".join((measurements[0].kind, "method", "orientation", *columns))]
    for number, one in enumerate(measurements, start=1):
        start = (str(number), one.method, one.orientation)
        lines += [",".join((*start, *cells[: len(columns)])) for cells in _cells(one)]
    return "\n".join(lines) + "\n"


def _header(measurement: Measurement) -> tuple[str, ...]:
    columns = ("freq_cpp", "mtf", "std", "low95", "high95")
    return columns if measurement.response.gsd_m is None else (*columns, "freq_cpm")


def _cells(measurement: Measurement) -> list[tuple[str, ...]]:
    found = []
    for row in mtf_rows(measurement):
        low, high = row.mtf.interval(0.95)
        numbers = (row.mtf.value, row.mtf.std, low, high)
        cells = (f"{row.freq_cpp:.2f}", *(f"{number:.6f}" for number in numbers))
        found.append(cells if row.freq_cpm is None else (*cells, f"{row.freq_cpm:.6f}"))
    return found
