"""The MTF of any result as CSV."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from acutance.curves import Mtf, Response
from acutance.report.comparison import Comparison, Result, as_result
from acutance.report.labels import csv_column
from acutance.report.tables.measurement import mtf_freqs_cpp
from acutance.targets import TargetResult

if TYPE_CHECKING:
    from acutance.targets.measurement import Measurement

__all__ = ["csv"]


def csv(result: Result) -> str:
    """The MTF of any result as CSV, from 0 to 1 cycles per pixel in steps of 0.02.

    Columns are freq_cpp, mtf, std, low95, high95, and freq_cpm (cycles per metre) where the GSD
    is known. Before them stands the direction, if the result has more than one: "across",
    "along", of bars also "normal", of a star "mean". A direction that the target does not show
    (along, of bars across) is left out, as in text and page. Of several measurements the first
    columns are the number, the method and the direction. A ratio of two sensors' MTFs is called
    mtf_low_over_mtf_high.

    Parameters
    ----------
    result : Measurement, TargetResult, Comparison or sequence of Measurement
    """
    found = as_result(result)
    if isinstance(found, TargetResult | Comparison):
        return _csv_of_many(found.measurements)
    curves = _curves(found)
    named = len(curves) > 1
    in_metres = any(gsd_m is not None for _, gsd_m in curves.values())
    columns = (*(("direction",) if named else ()), *_columns(found, in_metres))
    lines = [",".join(columns)]
    for name, (mtf, gsd_m) in curves.items():
        prefix = (name,) if named else ()
        lines += [",".join((*prefix, *cells)) for cells in _cells(mtf, gsd_m, in_metres)]
    return "\n".join(lines) + "\n"


def _curves(measurement: Measurement) -> dict[str, tuple[Mtf, float | None]]:
    """The MTFs of a measurement by measured direction, with the GSD along each."""
    found: dict[str, tuple[Mtf, float | None]] = {
        name: (one.mtf, one.gsd_m) for name, one in _measured(measurement)
    }
    # Bars and stars have one curve more.
    normal, mean = (getattr(measurement, name, None) for name in ("normal_response", "mean_mtf"))
    if normal is not None:
        found["normal"] = normal.mtf, normal.gsd_m
    if mean is not None:
        found["mean"] = mean, None
    return found


def _measured(measurement: Measurement) -> Iterator[tuple[str, Response]]:
    """The directions that the target shows: a table has no words for one that it does not."""
    for name in measurement.measured_directions:
        yield name, measurement.directions[name]


def _csv_of_many(measurements: Sequence[Measurement]) -> str:
    """Several measurements in one table; freq_cpm where all of them know their GSD."""
    gsds = [one.gsd_m for each in measurements for _, one in _measured(each)]
    in_metres = None not in gsds
    first = measurements[0]
    lines = [",".join((first.kind, "method", "orientation", *_columns(first, in_metres)))]
    for number, measurement in enumerate(measurements, start=1):
        for direction, response in _measured(measurement):
            start = (str(number), measurement.method, direction)
            lines += [
                ",".join((*start, *cells))
                for cells in _cells(response.mtf, response.gsd_m, in_metres)
            ]
    return "\n".join(lines) + "\n"


def _columns(measurement: Measurement, in_metres: bool) -> tuple[str, ...]:
    columns = ("freq_cpp", csv_column(measurement), "std", "low95", "high95")
    return (*columns, "freq_cpm") if in_metres else columns


def _cells(mtf: Mtf, gsd_m: float | None, in_metres: bool) -> Iterator[tuple[str, ...]]:
    for freq in mtf_freqs_cpp():
        here = mtf(freq)
        numbers = (here.value, here.std, *here.interval(0.95))
        cells = (f"{freq:.2f}", *(f"{number:.6f}" for number in numbers))
        metres = "" if gsd_m is None else f"{freq / gsd_m:.6f}"
        yield (*cells, metres) if in_metres else cells
