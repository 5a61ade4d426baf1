"""How numbers, targets, methods and places are put into words: one place for every output."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from acutance.curves.metric_words import MetricWords, metric_words

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.targets.measurement import Measurement
    from acutance.targets.record import Record

__all__ = [
    "MISSING",
    "NumberWords",
    "count_edges",
    "csv_column",
    "describe_image",
    "describe_measurement",
    "describe_target",
    "flatten_options",
    "format_number",
    "measurement_metric_words",
    "provenance",
    "shorten_name",
    "spread_name",
    "title_of",
    "transfer_name",
    "word_estimate",
    "word_place",
    "word_softness",
    "write_fixed",
]

MISSING = "–"

_ROUNDING_STD, _MIN_STD, _NOTHING = 1e-9, 1e-6, 5e-5
"""Standard deviations below the first are rounding errors of the computer: numbers are exact."""
_RATIO = "MTF ratio low/high"

KIND_WORDS = {
    "edge": "Edge", "pulse": "Pulse", "points": "Point sources", "biresolution": "Pair of images",
    "bars": "Groups of bars", "star": "Siemens star", "combined": "Measurements combined",
    "scene": "Edges of a scene",
}  # fmt: skip
_COUNTED = {"sources": "source", "groups": "group", "parts": "measurement"}
"""What kinds consist of, by the names of their fields."""
_METHOD_WORDS = {
    "joint": "one fit of all pixels",
    "psf-fit": "one fit of all sources",
    "kernel-fit": "fit of the blur between them",
    "least-squares": "one sensor fitted to all",
    "population": "one sensor under all objects",
}


def measurement_metric_words(measurement: Measurement | Record, name: str) -> MetricWords:
    """The words of a metric of this measurement, which state where it is one of a ratio."""
    words = metric_words(name)
    if not measurement.is_ratio:
        return words
    if name == "mtf_nyquist":
        return MetricWords(
            f"{_RATIO} at Nyquist",
            words.unit,
            "Contrast of the low image over that of the high one at 0.5 cycles per low pixel.",
        )
    return replace(words, label=f"{words.label} of the ratio")


def transfer_name(measurement: Measurement | Record, own: str = "MTF") -> str:
    """The name of the transfer curve: `own`, or that of the ratio.

    Without a reference a pair of images gives MTF_low / MTF_high only. It looks like an MTF and
    is too large, so that every output has to call it by its name.
    """
    return _RATIO if measurement.is_ratio else own


def spread_name(measurement: Measurement, own: str) -> str:
    """The name of a spread function or of anything else that follows from the curves."""
    return f"{own} of the ratio low/high" if measurement.is_ratio else own


def csv_column(measurement: Measurement) -> str:
    """The column of the transfer in a CSV."""
    return "mtf_low_over_mtf_high" if measurement.is_ratio else "mtf"


@dataclass(frozen=True)
class NumberWords:
    """An estimate as text: every part with the digits its standard deviation deserves."""

    value: str
    std: str
    low: str
    high: str
    is_cut: bool = False

    @property
    def interval(self) -> str:
        """The 95 % interval, with a word where it was cut off at a bound."""
        return f"{self.short_interval} (cut off)" if self.is_cut else self.short_interval

    @property
    def short_interval(self) -> str:
        """The same without the word."""
        if self.low == MISSING:
            return MISSING
        low = "0" if self.is_cut and not self.low.strip("0.") else self.low
        return f"{low} … {self.high}"

    @property
    def value_and_std(self) -> str:
        """Value ± standard deviation."""
        return self.value if self.std == MISSING else f"{self.value} ± {self.std}"

    @property
    def three_lines(self) -> str:
        """Value, standard deviation and interval, one below the other."""
        if self.std == MISSING:
            return self.value
        return f"{self.value}\n± {self.std}\n{self.interval}"


def word_estimate(estimate: Estimate) -> NumberWords:
    """Write an estimate with two significant digits of its standard deviation.

    A number without a standard deviation, or with one that is but rounding, gets four decimals
    and no interval; 0 ± nearly nothing is 0. A standard deviation too small is a power of ten.
    """
    value, std = estimate.value, estimate.std
    if not math.isfinite(value):
        return NumberWords("undefined", MISSING, MISSING, MISSING)
    is_nothing = abs(value) + std < _NOTHING
    if is_nothing or not (math.isfinite(std) and std > _ROUNDING_STD * max(1.0, abs(value))):
        exact = "0" if is_nothing or abs(value) < _ROUNDING_STD else write_fixed(value)
        return NumberWords(exact, MISSING, MISSING, MISSING)
    digits = min(1 - math.floor(math.log10(std)), 7)
    low, high = estimate.interval(0.95)
    is_cut = low == estimate.lowest or high == estimate.highest
    if std < _MIN_STD:
        shown, least, most = (write_fixed(part, 6) for part in (value, low, high))
        return NumberWords(shown, f"{std:.0e}".replace("-", "−"), least, most, is_cut)
    shown, scatter, least, most = (write_fixed(part, digits) for part in (value, std, low, high))
    return NumberWords(shown, scatter, least, most, is_cut)


def write_fixed(value: float, digits: int = 4) -> str:
    """A number with fixed decimals, a real minus sign, and none before a zero.

    With fewer than 0 it is rounded to tens, hundreds and so on.
    """
    text = f"{value:.{digits}f}" if digits >= 0 else f"{round(value, digits):.0f}"
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


def title_of(result: Measurement | Record) -> str:
    """Target and method: "Edge, method spline", "Siemens star, one fit of all pixels"."""
    kind = KIND_WORDS.get(result.kind, result.kind.capitalize())
    return f"{kind}, {_METHOD_WORDS.get(result.method, f'method {result.method}')}"


def describe_target(measurement: Measurement) -> str:
    """The target itself, in one line: direction, angle, levels, SNR, as far as the kind has them.

    Levels are in the numbers of the image, DN.
    """
    parts = []
    line = getattr(measurement, "line", None)
    if line is not None:
        parts += _line_words(measurement)
    for name, word in _COUNTED.items():
        count = len(getattr(measurement, name, ()))
        if hasattr(measurement, name):
            parts.append(f"{count} {word}{'' if count == 1 else 's'}")
    if measurement.is_ratio:
        parts.append(f"{_RATIO} (not the low sensor's own MTF)")
    edges = getattr(measurement, "edges", None)
    parts += [] if edges is None else [f"{int(edges.used.sum())} of {edges.size} edges used"]
    if math.isfinite(measurement.snr):
        median = "" if edges is None else "median "
        parts.append(f"{median}SNR {format_number(measurement.snr, 3)}")
    return ", ".join(parts)


def describe_measurement(measurement: Measurement) -> str:
    """Target, method and `describe_target` in one line."""
    described = describe_target(measurement)
    return f"{title_of(measurement)}: {described}" if described else title_of(measurement)


def _line_words(measurement: Any) -> list[str]:
    """Direction, angle, length and levels of an edge or a pulse."""
    angle = word_estimate(measurement.angle_deg)
    parts = [f"{measurement.orientation} track", f"{angle.value_and_std}° to the grid"]
    if math.isfinite(measurement.line.length_px):
        parts.append(f"{measurement.line.length_px:.0f} px long")
    dark, bright = format_number(measurement.dark), format_number(measurement.bright)
    if measurement.width_px is None:
        parts.append(f"from {dark} to {bright} DN")
    else:
        parts.append(f"{bright} DN on a background of {dark} DN")
    return parts


def provenance(result: Measurement | Record, max_name: int | None = None) -> dict[str, str]:
    """Where the pixels came from, by name: file, band, region, GSD, satellite, dates.

    Parameters
    ----------
    result : Measurement or Record
    max_name : int, optional
        Longer names of files are shortened to so many characters.
    """
    image = result.image
    row, col, height, width = image.roi
    has_pixels = bool(height and width)
    # A combination has no pixels of its own.
    unnamed = "array in memory" if has_pixels else "several images"
    found = {"image": shorten_name(image.path or unnamed, max_name)}
    if has_pixels:
        found["band"] = image.band_label
        named = f"{image.region}, " if image.region else ""
        place = f"rows {row}–{row + height - 1}, columns {col}–{col + width - 1}"
        found["region"] = f"{named}{place}"
    if image.pixel_gsd_m is not None:
        found["GSD"] = _gsd_words(image.pixel_gsd_m, image.along_track)
        if image.file_gsd_m is not None:
            own = _gsd_words(image.file_gsd_m, image.along_track)
            found["GSD"] += f" (stated; the image's own is {own})"
    if image.linearized is not None:
        found["linearised"] = image.linearized
    if image.restored is not None:
        found["restored"] = "by acutance: the numbers are those of the restored product"
    if softness := word_softness(result.options):
        found["stated softness"] = softness
    if level := result.options.get("level_uncertainty"):
        found["stated level uncertainty"] = f"{format_number(100 * level)} %"
    if (centre := _rer_centre(result)) != "half":
        found["RER centre"] = f"the LSF's {centre}"
    for name, title in (("sensor", "satellite"), ("acquired", "acquired")):
        if result.options.get(name):
            found[title] = str(result.options[name])
    found["measured"] = result.measured_at.isoformat(sep=" ", timespec="minutes")[:16] + " UTC"
    return found


def _rer_centre(result: Measurement | Record) -> str:
    """About which centre RER is taken: the stated one, else that of the method."""
    stated = result.options.get("rer_centre")
    return stated or next(one.rer_centre for one in result.directions.values())


def _gsd_words(pixel_gsd_m: tuple[float, float], along_track: str) -> str:
    along, across = map(format_number, pixel_gsd_m)
    if along_track == "x":
        along, across = across, along
    return f"{along} m" if along == across else f"{across} m across, {along} m along"


def describe_image(
    result: Measurement | Record, max_name: int | None = None, without: Collection[str] = ()
) -> str:
    """`provenance` in one line, some of it left out."""
    plain = ("image", "region")
    return ", ".join(
        value if name in plain else f"{name} {value}"
        for name, value in provenance(result, max_name).items()
        if name not in without
    )


def word_softness(options: Mapping[str, Any]) -> str:
    """The softness of borders that options state: "0.05 ± 0.02 m"; nothing if they state none."""
    from acutance.curves import Estimate

    for unit in ("m", "px"):
        stated = options.get(f"target_softness_{unit}")
        if stated is not None:
            return f"{Estimate(stated['value'], stated['std'])} {unit}"
    return ""


def word_place(values: Mapping[str, Any]) -> str:
    """Where a candidate lies, as row and column; a dash where it is not known."""
    if not {"row", "col"} <= values.keys():
        return MISSING
    return f"row {values['row']:.0f}, column {values['col']:.0f}"


def flatten_options(options: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """The options as (dotted name, text) pairs, nested ones in their order."""
    for name, value in options.items():
        if isinstance(value, Mapping):
            yield from flatten_options(value, f"{prefix}{name}.")
        elif isinstance(value, float):
            yield f"{prefix}{name}", format_number(value)
        elif value is None or isinstance(value, bool):
            yield f"{prefix}{name}", {None: MISSING, True: "yes", False: "no"}[value]
        else:
            yield f"{prefix}{name}", str(value)
