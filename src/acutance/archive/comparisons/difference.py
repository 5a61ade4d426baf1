"""How much two groups differ, and whether they do, in numbers and in a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal

from acutance.archive.comparisons.degrees import LEVEL
from acutance.archive.comparisons.pairing import MIN_IMAGES, Basis
from acutance.curves import Estimate
from acutance.curves.metric_words import metric_words

__all__ = ["ABSOLUTE", "Answer", "Difference", "gsds_differ", "is_of_pixels"]

Answer = Literal["differ", "agree", "cannot be told"]

_BASIS_WORDS: Final[dict[str, str]] = {
    "measurement": "measured together in",
    "target": "measured on the same targets of",
    "image": "measured side by side in",
}
_FALLS_WITH_SHARPNESS: Final = ("fwhm_px", "fwhm_m", "half_extent_dark_px", "half_extent_bright_px")
_RISES_WITH_SHARPNESS: Final = (
    "mtf_nyquist", "rer", "mtf50_cpp", "mtf30_cpp", "mtf_area", "edge_slope_per_px",
)  # fmt: skip
_OF_PROCEDURE: Final = ("method", "kind")
"""What differs here is the number, and not how sharp something is."""
ABSOLUTE: Final = ("overshoot", "undershoot")
"""Numbers near 0, over which nothing can be divided: parts of the edge's height themselves."""
_SAME_GSD: Final = 0.02


def is_of_pixels(metric: str) -> bool:
    """Whether a number belongs to the pixels, and not to the ground."""
    return metric in (*_RISES_WITH_SHARPNESS, *_FALLS_WITH_SHARPNESS) and metric != "fwhm_m"


def gsds_differ(one_m: float, other_m: float) -> bool:
    """Whether two GSDs are known and are not those of one product."""
    return abs(one_m / other_m - 1) > _SAME_GSD


@dataclass(frozen=True, kw_only=True)
class Difference:
    """The first group minus the second.

    Attributes
    ----------
    of : str
        Sensor, band, product level and direction, as far as they are not compared.
    metric, by, first, second : str
    difference : Estimate
        With what does not average out: that of both groups, as independent.
    relative : Estimate
        The same over the mean of both; of overshoot and undershoot the difference itself.
    probability : float
        That the first is larger; ``nan`` where no deviation is known.
    systematic_std : float
        Part of the deviation of `difference` that does not average out.
    scatter : float or None
        Of the differences between images, beyond their stated deviations; None of different images.
    basis : {"measurement", "target", "image", "targets", "means"}
        What both have in common: one measurement, the targets of an image, the images, the targets
        of different images, nothing.
    images : (int, int)
        Of the first and of the second; the same ones but for the last two.
    measurements : (int, int)
    margin : float
        Relative difference below which groups are said to agree.
    gsds_m : (float, float)
        Median GSDs in metres; ``nan`` where they are not known.
    notes : tuple of str
        What has to be known of it, in sentences.
    """

    of: str
    metric: str
    by: str
    first: str
    second: str
    difference: Estimate
    relative: Estimate
    probability: float
    systematic_std: float
    scatter: float | None
    basis: Basis
    images: tuple[int, int]
    measurements: tuple[int, int]
    margin: float
    gsds_m: tuple[float, float]
    notes: tuple[str, ...] = ()

    @property
    def answer(self) -> Answer:
        """Differ: the 95 % interval does not hold 0. Agree: it lies within the margin.

        One or two images that hold both do not show what an image does to one of them, nor does
        one image of each show how images scatter: the interval is that of these images, and the
        answer that it cannot be told.
        """
        low, high = self.relative.interval(LEVEL)
        if self._is_of_few_images:
            return "cannot be told"
        if low > 0 or high < 0:
            return "differ"
        return "agree" if max(-low, high) <= self.margin else "cannot be told"

    @property
    def is_of_different_images(self) -> bool:
        """Whether each group has images of its own."""
        return self.basis in ("targets", "means")

    @property
    def _is_of_few_images(self) -> bool:
        if self.is_of_different_images:
            return max(self.images) < 2
        return self.images[0] < MIN_IMAGES

    @property
    def sentence(self) -> str:
        """The answer in one sentence."""
        return f"{f'{self.of}: ' if self.of else ''}{self._answer_words}; {self._basis_words}."

    @property
    def summary(self) -> str:
        """The answer, and what has to be known of it."""
        return " ".join((self.sentence, *self.notes))

    @property
    def _answer_words(self) -> str:
        differ = self.answer == "differ"
        label = metric_words(self.metric).label
        sign = -1 if differ and self.relative.value < 0 else 1
        relative = sign * self.relative
        low, high = (100 * end for end in relative.interval(LEVEL))
        digits = 2 if high - low < 1 else 1
        ends = f"95 %: {low:+.{digits}f} to {high:+.{digits}f} %{self._unit_words}"
        if differ:
            less = f", less than {100 * self.margin:g} %" if high / 100 <= self.margin else ""
            unsigned = ends.replace("+", "")
            size = f"{100 * relative} %{self._unit_words}{less}"
            return f"{self._larger_words} by {size} ({label}, {unsigned})"
        pair = f"{self.first} and {self.second}"
        if low != low:
            return f"whether {pair} differ cannot be told ({label}, without deviations)"
        ends = f"{label}, {self.first} minus {self.second}, {ends}"
        if self.answer == "agree":
            return f"{pair} agree within {100 * self.margin:g} %{self._unit_words} ({ends})"
        if self._is_of_few_images:
            is_one = not self.is_of_different_images and self.images[0] == 1
            these = "this image" if is_one else "these images"
            return f"whether {pair} differ cannot be told of so few images ({ends} in {these})"
        return f"whether {pair} differ cannot be told yet ({ends})"

    @property
    def _unit_words(self) -> str:
        """What the per cent of an absolute difference are of."""
        return " of the contrast" if self.metric in ABSOLUTE else ""

    @property
    def _larger_words(self) -> str:
        larger, smaller = self.first, self.second
        if self.relative.value < 0:
            larger, smaller = smaller, larger
        if self.by in _OF_PROCEDURE:
            return f"{larger} is above {smaller}"
        if is_of_pixels(self.metric) and gsds_differ(*self.gsds_m):
            return f"{larger} is larger per pixel than {smaller}"
        if self.metric in _RISES_WITH_SHARPNESS:
            return f"{larger} is sharper than {smaller}"
        if self.metric in _FALLS_WITH_SHARPNESS:
            return f"{smaller} is sharper than {larger}"
        return f"{larger} is larger than {smaller}"

    @property
    def _basis_words(self) -> str:
        one, other = self.images
        if self.basis == "targets":
            return f"measured on the same targets in {one} and in {other} images"
        if self.basis == "means":
            return f"means of {one} and of {other} images"
        return f"{_BASIS_WORDS[self.basis]} {one} image{'s' if one > 1 else ''}"

    def to_dict(self) -> dict[str, Any]:
        """All fields for JSON."""
        return {
            "of": self.of, "metric": self.metric, "by": self.by, "first": self.first,
            "second": self.second, "answer": self.answer, "difference": self.difference.to_dict(),
            "relative": self.relative.to_dict(),
            "probability": None if self.probability != self.probability else self.probability,
            "systematic_std": self.systematic_std, "scatter": self.scatter, "basis": self.basis,
            "images": list(self.images), "measurements": list(self.measurements),
            "margin": self.margin,
            "gsds_m": [None if one != one else one for one in self.gsds_m],
            "sentence": self.sentence, "notes": list(self.notes),
        }  # fmt: skip
