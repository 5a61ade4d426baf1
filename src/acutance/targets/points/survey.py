"""Measured positions against surveyed ones, as in Tables 5.9 to 5.11 of the QuickBird report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.raster.image import AlongTrack

__all__ = ["SurveyErrors", "SurveyReference", "survey_errors"]

SurveyReference = Literal["mean", "first"]
_NEAREST_PX = 2.0
_MIN_POINTS = 2


@dataclass(frozen=True, eq=False)
class SurveyErrors(ShortRepr):
    """What is left between measured and surveyed positions after one common shift.

    Parameters
    ----------
    reference : {"mean", "first"}
        Whether the mean error is taken out, or that of the first source (as the report does).
    source : (n,) int array
        Which measured source, counted from 0.
    point : (n,) int array
        Which surveyed point, counted from 0.
    across_px, along_px : (n,) arrays
        Measured minus surveyed.
    gsd_m : (float, float) or None
        GSD across and along in metres.
    """

    reference: SurveyReference
    source: NDArray[np.intp]
    point: NDArray[np.intp]
    across_px: Floats
    along_px: Floats
    gsd_m: tuple[float, float] | None

    @property
    def rmse_px(self) -> tuple[float, float]:
        """Root mean square errors across and along in pixels."""
        return _rms(self.across_px), _rms(self.along_px)

    @property
    def errors_cm(self) -> tuple[Floats, Floats] | None:
        """Errors across and along in centimetres; ``None`` without a GSD."""
        if self.gsd_m is None:
            return None
        across_m, along_m = self.gsd_m
        return 100 * across_m * self.across_px, 100 * along_m * self.along_px

    @property
    def rmse_cm(self) -> tuple[float, float] | None:
        """Root mean square errors across and along in centimetres; ``None`` without a GSD."""
        errors = self.errors_cm
        return None if errors is None else (_rms(errors[0]), _rms(errors[1]))

    def to_dict(self) -> dict[str, Any]:
        """Errors of every point, and their root mean squares, for JSON."""
        errors, rmse = self.errors_cm, self.rmse_cm
        return {
            "reference": self.reference,
            "source": self.source.tolist(),
            "point": self.point.tolist(),
            "across_px": self.across_px.tolist(),
            "along_px": self.along_px.tolist(),
            "rmse_px": list(self.rmse_px),
            "across_cm": None if errors is None else errors[0].tolist(),
            "along_cm": None if errors is None else errors[1].tolist(),
            "rmse_cm": None if rmse is None else list(rmse),
        }


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def survey_errors(
    places: Floats,
    surveyed: Floats,
    *,
    pixel_m: tuple[float, float] | None = None,
    reference: SurveyReference = "mean",
    along_track: AlongTrack = "y",
) -> SurveyErrors:
    """Compare positions, each surveyed point with the measured source nearest to it.

    The survey may be off as a whole: its shift is found from all points first.

    Parameters
    ----------
    places, surveyed : (n, 2) and (m, 2) arrays
        Positions as (row, col) in pixels.
    pixel_m : (float, float), optional
        GSD from row to row and from column to column in metres.
    reference : {"mean", "first"}, optional
    along_track : {"y", "x"}, optional
        The image axis the satellite flew along.

    Raises
    ------
    OptionError
        If fewer than two points find a source within 2 px.
    """
    tree = cKDTree(places)
    shift = np.zeros(2)
    for _ in range(3):
        away, source = tree.query(surveyed + shift)
        near = away <= _NEAREST_PX
        if near.any():
            shift = np.median(places[source[near]] - surveyed[near], axis=0)
    away, source = tree.query(surveyed + shift)
    kept = np.flatnonzero(away <= _NEAREST_PX)
    if kept.size < _MIN_POINTS:
        raise OptionError(
            f"{kept.size} of {surveyed.shape[0]} surveyed positions lie within {_NEAREST_PX:g} px "
            f"of a measured source, at least {_MIN_POINTS} are needed: check their units and the "
            "region"
        )
    error = places[source[kept]] - surveyed[kept]
    error = error - (error[0] if reference == "first" else error.mean(axis=0))
    across, along = (1, 0) if along_track == "y" else (0, 1)
    gsd_m = None if pixel_m is None else (pixel_m[across], pixel_m[along])
    return SurveyErrors(reference, source[kept], kept, error[:, across], error[:, along], gsd_m)
