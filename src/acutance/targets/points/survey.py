"""Measured positions against surveyed ones, as in Tables 5.9 to 5.11 of the QuickBird report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.raster.image import AlongTrack

__all__ = ["SurveyErrors", "SurveyReference", "survey_errors"]

SurveyReference = Literal["mean", "first"]
_NEAREST_PX: Final = 2.0
_MIN_POINTS: Final = 2
_REACH_PX: Final = 20.0
"""A survey may be off by so much as a whole."""
_AS_NEAR_PX: Final = 0.1
"""Root mean square errors after two shifts that differ by less do not tell them apart."""


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
    shift_px : (float, float)
        What was taken out, across and along.
    rival_px : (float, float) or None
        Another shift that matches as many points as closely, as in a regular grid.
    """

    reference: SurveyReference
    source: NDArray[np.intp]
    point: NDArray[np.intp]
    across_px: Floats
    along_px: Floats
    gsd_m: tuple[float, float] | None
    shift_px: tuple[float, float]
    rival_px: tuple[float, float] | None = None

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
            "shift_px": list(self.shift_px),
            "rival_px": None if self.rival_px is None else list(self.rival_px),
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

    The survey may be off as a whole, by up to 20 px: its shift is the one after which most points
    have a source within 2 px, of several as close the smallest.

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
    best, rival = _common_shift(places, surveyed)
    kept, source = best.point, best.source
    if kept.size < _MIN_POINTS:
        raise OptionError(
            f"{kept.size} of {surveyed.shape[0]} surveyed positions lie within {_NEAREST_PX:g} px "
            f"of a measured source, at least {_MIN_POINTS} are needed, and no common shift of up "
            f"to {_REACH_PX:g} px brings half of them there: check their units and the region"
        )
    error = places[source] - surveyed[kept]
    shift = error[0] if reference == "first" else error.mean(axis=0)
    error = error - shift
    across, along = (1, 0) if along_track == "y" else (0, 1)
    return SurveyErrors(
        reference, source, kept, error[:, across], error[:, along],
        None if pixel_m is None else (pixel_m[across], pixel_m[along]),
        (float(shift[across]), float(shift[along])),
        None if rival is None else (float(rival[across]), float(rival[along])),
    )  # fmt: skip


class _Matched(NamedTuple):
    """Surveyed points that have a source nearby after a shift, (row, col)."""

    shift: Floats
    point: NDArray[np.intp]
    source: NDArray[np.intp]
    rms_px: float

    @property
    def matches(self) -> int:
        """How many sources are matched."""
        return np.unique(self.source).size

    @property
    def length_px(self) -> float:
        """Length of the shift."""
        return float(np.hypot(*self.shift))


def _common_shift(places: Floats, surveyed: Floats) -> tuple[_Matched, Floats | None]:
    """The shift that matches most points, and another one that does so as well."""
    tree = cKDTree(places)
    proposed = (places[np.newaxis] - surveyed[:, np.newaxis]).reshape(-1, 2)
    proposed = np.unique(np.rint(2 * proposed[np.hypot(*proposed.T) <= _REACH_PX]) / 2, axis=0)
    tried = [_matched(tree, surveyed, shift) for shift in (np.zeros(2), *proposed)]
    # A few points have a source somewhere after many a shift.
    least = max(_MIN_POINTS, 0.5 * min(len(places), len(surveyed)))
    likely = [one for one in tried if one.matches >= least] or tried[:1]
    most = max(one.matches for one in likely)
    settled = [_settled(tree, surveyed, one) for one in likely if one.matches == most]
    most = max(one.matches for one in settled)
    settled = [one for one in settled if one.matches == most]
    closest_px = min(one.rms_px for one in settled)
    close = [one for one in settled if one.rms_px <= closest_px + _AS_NEAR_PX]
    close.sort(key=lambda one: one.length_px)
    best = close[0]
    away = (one.shift for one in close if np.hypot(*(one.shift - best.shift)) > _NEAREST_PX)
    return best, next(away, None)


def _settled(tree: cKDTree, surveyed: Floats, found: _Matched) -> _Matched:
    """The same, the shift made the median of the differences of what is matched."""
    for _ in range(3):
        if found.point.size:
            shift = np.median(tree.data[found.source] - surveyed[found.point], axis=0)
            found = _matched(tree, surveyed, shift)
    return found


def _matched(tree: cKDTree, surveyed: Floats, shift: Floats) -> _Matched:
    away, source = tree.query(surveyed + shift)
    point = np.flatnonzero(away <= _NEAREST_PX)
    return _Matched(shift, point, source[point], _rms(away[point]) if point.size else 0.0)
