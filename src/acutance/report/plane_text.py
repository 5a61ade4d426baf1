"""A 2-D measurement in letters: text for a terminal, CSV, and the JSON document."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from acutance.report.quantity import csv_column, plane_metric_words
from acutance.report.tables import STEP_CPP
from acutance.report.text import align_columns
from acutance.report.wording import (
    describe_plane,
    describe_plane_image,
    format_number,
    verdict,
    word_estimate,
)

if TYPE_CHECKING:
    from acutance.curves import Response
    from acutance.targets import Measurement2d

__all__ = ["plane_csv", "plane_document", "plane_text"]


def plane_text(measurement: Measurement2d, blocks: Sequence[str] = ()) -> str:
    """A 2-D measurement as text: where, the numbers across and along, the checks.

    Parameters
    ----------
    measurement : Measurement2d
    blocks : sequence of str, optional
        Paragraphs of the method's own, put before the checks.

    Returns
    -------
    str
        Several lines, without a newline at the end.
    """
    across, along = measurement.across.metrics(), measurement.along.metrics()
    numbers: list[tuple[str, ...]] = [("", "across", "along", "")]
    for name in across:
        words = plane_metric_words(measurement, name)
        cells = (word_estimate(one[name]).value_and_std for one in (across, along))
        numbers.append((words.label, *cells, words.unit))
    parts = [
        f"{describe_plane(measurement)}\n  {describe_plane_image(measurement)}",
        align_columns(numbers, "lrrl"),
        *blocks,
    ]
    if measurement.checks:
        checks = [
            ("ok" if one.passed else "FAILED", one.name, format_number(one.value), one.limit)
            for one in measurement.checks
        ]
        parts.append(align_columns(checks, "llrl"))
    complaints = [f"  {check.name}: {check.message}" for check in measurement.failed_checks]
    parts.append("\n".join([verdict([measurement]), *complaints]))
    return "\n\n".join(parts)


def plane_csv(measurement: Measurement2d) -> str:
    """The MTF across and along as CSV, in steps of 0.02 cycles per pixel.

    Columns are direction, freq_cpp, mtf, std, low95, high95, and freq_cpm (cycles per metre) when
    the GSD is known. Where the curves are a ratio of two sensors', the column of the MTF is called
    mtf_low_over_mtf_high.
    """
    metres = measurement.across.gsd_m is not None
    header = ("direction", "freq_cpp", csv_column(measurement), "std", "low95", "high95")
    lines = [",".join((*header, "freq_cpm") if metres else header)]
    for direction, response in (("across", measurement.across), ("along", measurement.along)):
        lines += [f"{direction},{cells}" for cells in _curve_rows(response)]
    return "\n".join(lines) + "\n"


def _curve_rows(response: Response) -> list[str]:
    rows = []
    for freq in np.linspace(0.0, 1.0, round(1.0 / STEP_CPP) + 1).tolist():
        here = response.mtf(freq)
        cells = [f"{freq:.2f}"]
        cells += [f"{number:.6f}" for number in (here.value, here.std, *here.interval(0.95))]
        if response.gsd_m is not None:
            cells.append(f"{freq / response.gsd_m:.6f}")
        rows.append(",".join(cells))
    return rows


def plane_document(measurement: Measurement2d, *, covariance: bool = False) -> dict[str, Any]:
    """The document ``acutance/measurement/1`` of a 2-D measurement.

    With `covariance`, the curves of both directions get their factors, as
    `acutance.report.measurement_document` describes them; the two share their k variables.
    """
    document = measurement.to_dict()
    if covariance:
        for name, response in (("across", measurement.across), ("along", measurement.along)):
            transfer = response.mtf.otf_factor
            document[name]["mtf"] |= {
                "factor_real": transfer.real.tolist(),
                "factor_imag": transfer.imag.tolist(),
            }
            document[name]["lsf"] |= {"factor": response.lsf.covariance_factor.tolist()}
            document[name]["esf"] |= {"factor": response.esf.covariance_factor.tolist()}
    return document
