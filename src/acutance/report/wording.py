"""How numbers, methods and verdicts are put into words: one place for every face."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.targets import Measurement2d
    from acutance.targets.measurement import Check, Measurement

__all__ = [
    "METRIC_WORDS",
    "MISSING",
    "MetricWords",
    "NumberWords",
    "count_edges",
    "count_failed_checks",
    "describe_image",
    "describe_line",
    "describe_plane",
    "describe_plane_image",
    "flatten_options",
    "format_number",
    "metric_words",
    "numbers_of",
    "shorten_name",
    "split_message",
    "verdict",
    "word_estimate",
    "word_place",
    "write_fixed",
]

MISSING = "–"
SMALLEST_STD = 1e-6


@dataclass(frozen=True)
class MetricWords:
    """How one metric is called.

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


METRIC_WORDS = {
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


def numbers_of(measurement: Measurement) -> dict[str, Estimate]:
    """All numbers by name: the metrics, and before them the widths of a pulse."""
    return {**measurement.pulse_numbers(), **measurement.metrics()}


def metric_words(name: str) -> MetricWords:
    """The words of a metric; an unknown one is called by its name."""
    return METRIC_WORDS.get(name, MetricWords(name.replace("_", " "), "", ""))


@dataclass(frozen=True)
class NumberWords:
    """An estimate as text: every part with the digits its standard deviation deserves."""

    value: str
    std: str
    low: str
    high: str

    @property
    def interval(self) -> str:
        """The 95 % interval."""
        return MISSING if self.low == MISSING else f"{self.low} … {self.high}"

    @property
    def value_and_std(self) -> str:
        """Value ± standard deviation."""
        return self.value if self.std == MISSING else f"{self.value} ± {self.std}"


def word_estimate(estimate: Estimate) -> NumberWords:
    """Write an estimate with two significant digits of its standard deviation.

    A truth, which has no standard deviation, gets four decimals and no interval. A standard
    deviation too small for decimals is written as a power of ten.
    """
    if not math.isfinite(estimate.value):
        return NumberWords("undefined", MISSING, MISSING, MISSING)
    if not (math.isfinite(estimate.std) and estimate.std > 0):
        return NumberWords(f"{estimate.value:.4f}", MISSING, MISSING, MISSING)
    digits = min(max(0, 1 - math.floor(math.log10(estimate.std))), 7)
    low, high = estimate.interval(0.95)
    if estimate.std < SMALLEST_STD:
        value, least, most = (write_fixed(part, 6) for part in (estimate.value, low, high))
        return NumberWords(value, f"{estimate.std:.0e}".replace("-", "−"), least, most)
    parts = (estimate.value, estimate.std, low, high)
    return NumberWords(*(write_fixed(part, digits) for part in parts))


def write_fixed(value: float, digits: int = 4) -> str:
    """A number with fixed decimals, a real minus sign, and none before a zero."""
    text = f"{value:.{digits}f}"
    return (
        text.replace("-", "−") if any(digit in text for digit in "123456789") else text.strip("-")
    )


def format_number(value: float, digits: int = 4) -> str:
    """A plain number with `digits` significant digits, without a needless exponent."""
    if not math.isfinite(value):
        return MISSING
    if value != 0 and not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{digits - 1}e}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value)))) if value else 0
    text = f"{value:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def count_edges(count: int) -> str:
    """ "1 edge", "2 edges"."""
    return f"{count} edge" if count == 1 else f"{count} edges"


def shorten_name(name: str, most: int | None) -> str:
    """A name of at most `most` characters: a longer one keeps its beginning and its end."""
    if most is None or len(name) <= most:
        return name
    end = 2 * most // 3
    return f"{name[: most - end - 1]}…{name[-end:]}"


def describe_image(measurement: Measurement, most_name: int | None = None) -> str:
    """Where the pixels came from, in one line; names longer than `most_name` are shortened."""
    image = measurement.image
    row, col, height, width = image.roi
    parts = [shorten_name(image.path or "array in memory", most_name), f"band {image.band}"]
    parts.append(f"rows {row}–{row + height - 1}, columns {col}–{col + width - 1}")
    gsd_m = measurement.response.gsd_m
    if gsd_m is not None:
        parts.append(f"GSD {format_number(gsd_m)} m along the normal")
    return ", ".join(parts)


def describe_plane(measurement: Measurement2d) -> str:
    """What a 2-D measurement is, in one line: target, method, SNR."""
    parts = [f"{measurement.kind.capitalize()} by {measurement.method}"]
    if measurement.is_ratio:
        parts.append("MTF ratio low/high (not the low sensor's own MTF)")
    if math.isfinite(measurement.snr):
        parts.append(f"SNR {format_number(measurement.snr, 3)}")
    return ", ".join(parts)


def describe_plane_image(measurement: Measurement2d, most_name: int | None = None) -> str:
    """Where the pixels of a 2-D measurement came from, in one line; see `describe_image`."""
    image = measurement.image
    row, col, height, width = image.roi
    if height and width:
        parts = [shorten_name(image.path or "array in memory", most_name), f"band {image.band}"]
        parts.append(f"rows {row}–{row + height - 1}, columns {col}–{col + width - 1}")
    else:
        # A combination has no pixels of its own.
        parts = [shorten_name(image.path or "several images", most_name)]
    gsd_m = measurement.otf.gsd_m
    if gsd_m is not None:
        same = format_number(gsd_m[0]) == format_number(gsd_m[1])
        across = "" if same else f" along, {format_number(gsd_m[1])} m across"
        parts.append(f"GSD {format_number(gsd_m[0])} m{across}")
    return ", ".join(parts)


def describe_line(measurement: Measurement) -> str:
    """The target itself, in one line: angle, length, levels and noise."""
    angle = word_estimate(measurement.angle_deg)
    parts = [f"angle {angle.value_and_std}°"]
    if math.isfinite(measurement.line.length_px):
        parts.append(f"{measurement.line.length_px:.0f} px long")
    dark, bright = measurement.samples.dark, measurement.samples.bright
    if measurement.width_px is None:
        parts.append(f"from {format_number(dark)} to {format_number(bright)}")
    else:
        parts.append(f"{format_number(bright)} on {format_number(dark)}")
    parts.append(f"SNR {format_number(measurement.snr, 3)}")
    return ", ".join(parts)


def count_failed_checks(measurements: Sequence[Measurement | Measurement2d]) -> str:
    """How many checks passed or failed, as a sentence."""
    total = sum(len(one.checks) for one in measurements)
    failed = sum(len(one.failed_checks) for one in measurements)
    if total == 0:
        return "No checks were made."
    if failed:
        return f"{failed} of {total} checks failed."
    return "The only check passed." if total == 1 else f"All {total} checks passed."


def verdict(measurements: Sequence[Measurement | Measurement2d]) -> str:
    """What the checks say, with the names of those that failed."""
    counted = count_failed_checks(measurements)
    names = sorted({check.name for one in measurements for check in one.failed_checks})
    if not names:
        return counted
    return f"{counted[:-1]} ({', '.join(names)}): read what they say before using the numbers."


def word_place(values: Mapping[str, Any]) -> str:
    """Where a candidate lies, as row and column; a dash where nobody said."""
    if not {"row", "col"} <= values.keys():
        return MISSING
    return f"row {values['row']:.0f}, column {values['col']:.0f}"


def split_message(check: Check) -> tuple[str, str]:
    """The message of a check, and the source of its limit where brackets at the end name one."""
    message = check.message.strip()
    if not message.endswith((")", "]", ").", "].")):
        return message, ""
    body = message.rstrip(".")
    opening = body.rfind("(" if body.endswith(")") else "[")
    if opening <= 0:
        return message, ""
    return body[:opening].rstrip(), body[opening + 1 : -1]


def flatten_options(options: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """The options as (dotted name, text) pairs, nested ones in their order."""
    for name, value in options.items():
        if isinstance(value, Mapping):
            yield from flatten_options(value, f"{prefix}{name}.")
        elif isinstance(value, float):
            yield f"{prefix}{name}", format_number(value)
        else:
            yield f"{prefix}{name}", str(value)
