"""What the metrics are called wherever a person reads them: label, unit, meaning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

__all__ = ["METRIC_WORDS", "MetricWords", "metric_words"]


@dataclass(frozen=True)
class MetricWords:
    """What one metric is called.

    Parameters
    ----------
    label : str
    unit : str
        Empty for a pure number.
    meaning : str
        One sentence for a reader who does not know it.
    """

    label: str
    unit: str
    meaning: str

    @property
    def label_with_unit(self) -> str:
        """The label, with the unit in brackets where there is one."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def of(self, value: str) -> str:
        """A value in a sentence: its label before it, its unit behind."""
        return f"{self.label} {value} {self.unit}".rstrip()


METRIC_WORDS: Final = {
    "width_px": MetricWords("Width", "px", "Width of the pulse along its normal."),
    "width_m": MetricWords("Width on the ground", "m", "The same width in metres."),
    "prf_fwhm_px": MetricWords(
        "PRF FWHM", "px", "Full width of the pulse response function at half of its maximum."
    ),
    "prf_fwhm_m": MetricWords("PRF FWHM on the ground", "m", "The same width in metres."),
    "mtf_nyquist": MetricWords(
        "MTF at Nyquist", "", "Contrast left at 0.5 cycles per pixel, the sampling limit."
    ),
    "rer": MetricWords(
        "RER", "", "Relative edge response: rise of the edge over the central pixel."
    ),
    "fwhm_px": MetricWords("FWHM", "px", "Full width of the LSF at half of its maximum."),
    "fwhm_m": MetricWords("FWHM on the ground", "m", "The same width in metres."),
    "mtf50_cpp": MetricWords("MTF50", "c/px", "Lowest frequency where the MTF falls to 0.5."),
    "mtf30_cpp": MetricWords("MTF30", "c/px", "Lowest frequency where the MTF falls to 0.3."),
    "mtf_area": MetricWords("MTF area", "c/px", "Area under the MTF from 0 to Nyquist."),
    "edge_slope_per_px": MetricWords(
        "Edge slope 40–60 %", "1/px", "Mean slope of the ESF between its 40 and 60 % points."
    ),
    "half_extent_dark_px": MetricWords(
        "Half extent 5–50 %", "px", "Distance from the 5 to the 50 % point of the ESF."
    ),
    "half_extent_bright_px": MetricWords(
        "Half extent 50–95 %", "px", "Distance from the 50 to the 95 % point of the ESF."
    ),
    "overshoot": MetricWords("Overshoot", "", "Excess of the ESF over the bright plateau."),
    "undershoot": MetricWords("Undershoot", "", "Shortfall of the ESF under the dark plateau."),
    "giqe_h": MetricWords("GIQE H", "", "Edge height overshoot of the GIQE 4 equation."),
}


def metric_words(name: str) -> MetricWords:
    """The words of a metric; an unknown one is called by its name."""
    return METRIC_WORDS.get(name, MetricWords(name.replace("_", " "), "", ""))
