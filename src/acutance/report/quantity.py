"""What the curves of a 2-D measurement are called: a sensor's own, or a ratio of two sensors'.

Without a reference a pair of images tells but MTF_low / MTF_high. It looks like an MTF and is too
large, so every face has to call it by its name.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from acutance.report.wording import MetricWords, metric_words

if TYPE_CHECKING:
    from acutance.targets import Measurement2d

__all__ = ["csv_column", "plane_metric_words", "spread_name", "transfer_name"]

RATIO = "MTF ratio low/high"


def transfer_name(measurement: Measurement2d, own: str = "MTF") -> str:
    """The name of the transfer curve: `own`, or that of the ratio."""
    return RATIO if measurement.is_ratio else own


def spread_name(measurement: Measurement2d, own: str) -> str:
    """The name of a spread function or of anything else that follows from the curves."""
    return f"{own} of the ratio low/high" if measurement.is_ratio else own


def csv_column(measurement: Measurement2d) -> str:
    """The column of the transfer in a CSV."""
    return "mtf_low_over_mtf_high" if measurement.is_ratio else "mtf"


def plane_metric_words(measurement: Measurement2d, name: str) -> MetricWords:
    """The words of a metric, which say where it is one of a ratio."""
    words = metric_words(name)
    if not measurement.is_ratio:
        return words
    if name == "mtf_nyquist":
        return MetricWords(
            f"{RATIO} at Nyquist",
            words.unit,
            "Contrast of the low image over that of the high one at 0.5 cycles per low pixel.",
        )
    return replace(words, label=f"{words.label} of the ratio")
