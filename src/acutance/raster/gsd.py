"""The ground sampling distance: how far apart two neighbouring pixels lie on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real

from acutance.curves.direction import gsd_along
from acutance.errors import OptionError

__all__ = ["GSD_RANGE_M", "GSD_TAGS", "Gsd", "gsd_in_words"]

GSD_RANGE_M = (0.005, 100_000.0)
"""No image of the Earth's surface has other pixels: centimetres or degrees look like metres."""

GSD_TAGS = ("ACUTANCE_GSD_ROW_M", "ACUTANCE_GSD_COL_M")
"""Metadata of a file that was written with a GSD: metres from row to row, column to column."""


@dataclass(frozen=True)
class Gsd:
    """Ground sampling distance of an image at one place.

    Parameters
    ----------
    row_m : float
        Metres on the ground from one row to the next. Positive.
    col_m : float
        Metres on the ground from one column to the next. Positive.

    Raises
    ------
    OptionError
        If a distance is not a positive, finite number.
    """

    row_m: float
    col_m: float

    def __post_init__(self) -> None:
        for axis, value in (("rows", self.row_m), ("columns", self.col_m)):
            if not isinstance(value, Real):
                raise OptionError(
                    f"a GSD of {value!r} between {axis} is no number: give metres, for example "
                    "Gsd(0.7, 0.7)"
                )
            if not (math.isfinite(value) and value > 0.0):
                raise OptionError(
                    f"a GSD of {value:g} m between {axis} means nothing: "
                    "give a positive number of metres, for example 0.7 (gsd_m, --gsd)"
                )
        # Files and documents are written of plain numbers: the repr of numpy's is none.
        object.__setattr__(self, "row_m", float(self.row_m))
        object.__setattr__(self, "col_m", float(self.col_m))

    @classmethod
    def square(cls, gsd_m: float) -> Gsd:
        """The same distance between rows and between columns."""
        return cls(gsd_m, gsd_m)

    @classmethod
    def given(cls, gsd_m: float | Gsd | None) -> Gsd | None:
        """What a caller gave: one distance for both, a `Gsd`, or nothing.

        Raises
        ------
        OptionError
            If it is something else, or no GSD of an image of the Earth's surface (`GSD_RANGE_M`).
        """
        if gsd_m is None:
            return None
        if isinstance(gsd_m, Gsd):
            return gsd_m.required_in_range()
        if isinstance(gsd_m, bool) or not isinstance(gsd_m, Real):
            raise OptionError(
                f"gsd_m is {gsd_m!r}: give a positive number of metres, or Gsd(row_m, col_m) where "
                "pixels are not square"
            )
        return cls.square(gsd_m).required_in_range()

    def required_in_range(self) -> Gsd:
        """The same, if an image of the Earth's surface can have it.

        Raises
        ------
        OptionError
            If it is smaller or larger than any (`GSD_RANGE_M`).
        """
        low, high = GSD_RANGE_M
        for value in (self.row_m, self.col_m):
            if not low <= value <= high:
                raise OptionError(
                    f"a GSD of {value:g} m was stated, and images of the Earth's surface have "
                    f"{low:g} to {high:g} m: give metres (gsd_m, --gsd)"
                )
        return self

    def along_normal(self, normal_deg: float) -> float:
        """Metres per pixel for distances along an edge's normal; see `curves.gsd_along`.

        Parameters
        ----------
        normal_deg : float
            Direction of the normal in the image, from the column axis towards the row axis.

        Returns
        -------
        float
            Metres; `col_m` at 0 degrees, `row_m` at 90 degrees.
        """
        return gsd_along((self.row_m, self.col_m), normal_deg)


def gsd_in_words(pixel_gsd_m: tuple[float, float]) -> str:
    """A GSD as messages have it: "0.7 m", both sides where they differ by more than a thousandth.

    Parameters
    ----------
    pixel_gsd_m : (float, float)
        Metres from row to row and from column to column.
    """
    row_m, col_m = pixel_gsd_m
    if math.isclose(row_m, col_m, rel_tol=1e-3):
        return f"{col_m:.4g} m"
    return f"{row_m:.4g} m between rows, {col_m:.4g} m between columns"
