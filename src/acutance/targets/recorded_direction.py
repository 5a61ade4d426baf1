"""One direction of a recorded measurement: numbers and curves, read by name from its document."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from acutance.curves import MAIN_NUMBERS, METRICS, Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError

__all__ = ["RecordedDirection"]


@dataclass(frozen=True, eq=False)
class RecordedDirection(ShortRepr):
    """Numbers and curves of one direction, as a document holds them.

    A number that the document does not have, as one that a paper did not print, is undefined.

    Parameters
    ----------
    document : mapping
        The part of the document: numbers, and the curves "mtf", "lsf" and "esf".
    """

    document: Mapping[str, Any]

    @cached_property
    def numbers(self) -> dict[str, Estimate]:
        """All numbers there are by name, in the order a report prints them.

        Raises
        ------
        OptionError
            If one of them is none.
        """
        return {
            name: _number(name, self.document[name])
            for name in METRICS
            if self.document.get(name) is not None
        }

    @property
    def rer_centre(self) -> str:
        """About which centre RER is taken: "half" or "peak"; of older documents "half"."""
        return str(self.document.get("rer_centre", "half"))

    @property
    def mtf_nyquist(self) -> Estimate:
        """MTF at 0.5 cycles per pixel."""
        return self._number("mtf_nyquist")

    @property
    def rer(self) -> Estimate:
        """Relative edge response."""
        return self._number("rer")

    @property
    def fwhm_px(self) -> Estimate:
        """Full width of the LSF at half maximum, pixels."""
        return self._number("fwhm_px")

    @property
    def fwhm_m(self) -> Estimate | None:
        """FWHM in metres; ``None`` without a GSD."""
        return self.numbers.get("fwhm_m")

    @property
    def mtf50_cpp(self) -> Estimate:
        """Lowest frequency where the MTF falls to 0.5."""
        return self._number("mtf50_cpp")

    @property
    def mtf30_cpp(self) -> Estimate:
        """Lowest frequency where the MTF falls to 0.3."""
        return self._number("mtf30_cpp")

    @property
    def mtf_area(self) -> Estimate:
        """Area under the MTF from 0 to Nyquist (cycles per pixel)."""
        return self._number("mtf_area")

    @property
    def edge_slope_per_px(self) -> Estimate:
        """Mean slope of the ESF between 40 and 60 %."""
        return self._number("edge_slope_per_px")

    @property
    def half_extent_dark_px(self) -> Estimate:
        """Distance from the 5 to the 50 % point."""
        return self._number("half_extent_dark_px")

    @property
    def half_extent_bright_px(self) -> Estimate:
        """Distance from the 50 to the 95 % point."""
        return self._number("half_extent_bright_px")

    @property
    def overshoot(self) -> Estimate:
        """Largest excess of the ESF over the bright plateau."""
        return self._number("overshoot")

    @property
    def undershoot(self) -> Estimate:
        """Largest shortfall of the ESF under the dark plateau."""
        return self._number("undershoot")

    @property
    def giqe_h(self) -> Estimate:
        """Edge height overshoot H of GIQE 4."""
        return self._number("giqe_h")

    def _number(self, name: str) -> Estimate:
        return self.numbers.get(name, Estimate(math.nan, math.nan))

    def has_curve(self, name: str) -> bool:
        """Whether the document has a curve: a table that was printed has numbers alone."""
        return self.document.get(name) is not None

    def curve(self, name: str) -> tuple[Floats, Floats, Floats]:
        """Places, values and standard deviations of a curve, (n,) each.

        Parameters
        ----------
        name : {"mtf", "lsf", "esf"}

        Raises
        ------
        OptionError
            If the document does not have it.
        """
        if not self.has_curve(name):
            raise OptionError(f"the document has no {name.upper()}, numbers alone")
        found = self.document[name]
        place = "freq_cpp" if name == "mtf" else "distance_px"
        at, value, std = (np.array(found[key], float) for key in (place, "value", "std"))
        return at, value, std

    def summary(self) -> str:
        """The three main numbers, as far as they are there."""
        there = [name for name in MAIN_NUMBERS if name in self.numbers]
        return ", ".join(f"{name} {self.numbers[name]}" for name in there) or "no main number"


def _number(name: str, document: Any) -> Estimate:
    """A number of a document.

    Raises
    ------
    OptionError
        Names what is written there instead.
    """
    try:
        return Estimate.from_dict(document)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise OptionError(
            f"{name} is {document!r:.80}, no value with its standard deviation"
        ) from error
