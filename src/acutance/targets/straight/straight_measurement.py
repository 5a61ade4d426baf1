"""The result of a straight target: numbers and curves along its normal, the line, the pixels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import MAIN_NUMBERS, Estimate, Mtf
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.geometry.line import Line, Orientation
from acutance.targets.document_fields import WrittenLater
from acutance.targets.measurement import Measurement
from acutance.targets.slices import SLICE_FREQ_CPP, OtfSlices
from acutance.targets.straight.error_causes import FitCauses
from acutance.targets.straight.lsf import SplineResponse
from acutance.targets.straight.pixels_alone import PixelsAlone
from acutance.targets.straight.stated_target import NOTHING_STATED, StatedTarget
from acutance.targets.uncertainty_budget import BudgetTerm, budget_rows

__all__ = ["StraightDetails", "StraightMeasurement"]


@dataclass(frozen=True, eq=False)
class StraightDetails(ShortRepr):
    """The pixels of a measurement by their distance along the normal.

    Parameters
    ----------
    pixels : (rows, cols) array
        Of the region; unusable pixels are NaN.
    used : (rows, cols) bool array
        Which pixels entered the fit.
    distance_px : (n,) array
        Normal distance of the used pixels, in row-major order; 0 at the 50 % point.
    value : (n,) array
        Their edge response, normalised to 0 (dark plateau) .. 1 (bright plateau).
    residual : (n,) array
        Value minus the fitted edge spread function (ESF), same scale.
    causes : FitCauses, optional
        What the uncertainty of the fit consists of; published methods do not separate it.
    pixels_alone : PixelsAlone, optional
        What the pixels say, the prior apart; published methods have no prior.
    families : mapping of str to float, optional
        Probability of every family of sensors (`acutance.optics.FAMILIES`, and "plain").
    """

    pixels: Floats
    used: NDArray[np.bool_]
    distance_px: Floats
    value: Floats
    residual: Floats
    causes: FitCauses | None = None
    pixels_alone: PixelsAlone | None = None
    families: Mapping[str, float] | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class StraightMeasurement(Measurement):
    """A measurement of an edge or a pulse.

    Parameters
    ----------
    line : Line
        The edge, or the rising side of a pulse, in pixels of the whole image.
    dark, bright : float
        Plateau levels in the image's units; of a pulse its background and its own level.
    width_px : Estimate, optional
        Width of a pulse along the normal.
    prf_fwhm_px : Estimate, optional
        Width of the pulse response function at half of its maximum, along the normal.
    stated_width_px : float, optional
        Width of a pulse as it was stated; ``None`` where it was guessed from the image.
    stated : StatedTarget
        What was stated of the target because no pixel shows it; the curves allow for it.
    """

    line: Line
    dark: float
    bright: float
    width_px: Estimate | None = None
    prf_fwhm_px: Estimate | None = None
    stated_width_px: float | None = None
    stated: StatedTarget = NOTHING_STATED

    @property
    def normal_deg(self) -> float:
        """Direction of the normal, from the column axis (0) towards the row axis (90)."""
        return self.line.normal_deg

    @property
    def angle_deg(self) -> Estimate:
        """Acute angle between the edge and the nearer image axis."""
        return Estimate(self.line.angle_deg, self.line.angle_std_deg)

    @cached_property
    def slices(self) -> OtfSlices:
        """The OTF along the normal, its covariance, and what the pixels alone say of it."""
        if self._is_light:
            return self.record.slices
        return _slices(self.mtf, self.normal_deg, self._pixels_alone, self.stated)

    def plane_document(self) -> WrittenLater:
        """The slices, worked out when they are read: no pixels are held for it."""
        few = self.mtf.near(SLICE_FREQ_CPP)
        return WrittenLater(
            partial(_plane_document, few, self.normal_deg, self._pixels_alone, self.stated)
        )

    @property
    def _pixels_alone(self) -> PixelsAlone | None:
        """What the pixels say, the prior apart; published methods have no prior."""
        if self.details is None or not isinstance(self.response, SplineResponse):
            return None
        alone: PixelsAlone | None = self.details.pixels_alone
        return alone

    def _budget(self) -> tuple[BudgetTerm, ...]:
        return _budget_rows(self.orientation, self._variances())

    def budget_document(self) -> WrittenLater:
        """The rows of the budget, made when they are read: their variances alone are held."""
        return WrittenLater(partial(_budget_document, self.orientation, self._variances()))

    def _variances(self) -> dict[str, Floats]:
        """What causes of the fit, then what was stated of the target, give to the main numbers."""
        terms, rows = self.stated.terms, self.response.main_rows
        fitted = rows.shape[1] - len(terms)
        own, stated = rows[:, :fitted], rows[:, fitted:]
        return self._own_variances(own) | dict(zip(terms, stated.T**2, strict=True))

    def _own_variances(self, rows: Floats) -> dict[str, Floats]:
        """What fit and halo give to the main numbers of these rows, (3,) by term."""
        causes: FitCauses | None = None if self.details is None else self.details.causes
        if causes is None:
            latent = self.response.esf.latent
            errors = rows if latent is None else rows @ latent[: rows.shape[1]]
            name = "fit" if isinstance(self.response, SplineResponse) else "row_scatter"
            return {name: np.einsum("ij,ij->i", errors, errors)}
        columns = causes.design.shape[0]
        fitted, halo = rows[:, :columns], rows[:, columns:]
        halos = {"halo": halo[:, 0] ** 2} if halo.size else {}
        return causes.variances(fitted) | halos

    @property
    def width_m(self) -> Estimate | None:
        """Width of a pulse along the normal in metres, where the GSD is known."""
        return self._in_metres(self.width_px)

    @property
    def prf_fwhm_m(self) -> Estimate | None:
        """Width of the pulse response function in metres, where the GSD is known."""
        return self._in_metres(self.prf_fwhm_px)

    def _in_metres(self, number: Estimate | None) -> Estimate | None:
        gsd_m = self.response.gsd_m
        return None if number is None or gsd_m is None else number * gsd_m

    def pulse_numbers(self) -> dict[str, Estimate]:
        """Widths of a pulse and of its response by name, with a GSD also in metres."""
        names = ("width_px", "width_m", "prf_fwhm_px", "prf_fwhm_m")
        numbers = {name: getattr(self, name) for name in names}
        return {name: number for name, number in numbers.items() if number is not None}

    def target_document(self) -> dict[str, Any]:
        """Line, levels and, of a pulse, its widths, for JSON."""
        widths: dict[str, Any] = {
            name: number.to_dict() for name, number in self.pulse_numbers().items()
        }
        if self.width_px is not None:
            widths["stated_width_px"] = self.stated_width_px
        return {
            "line": {**self.line.to_dict(), "orientation": self.orientation},
            "angle_deg": self.angle_deg.to_dict(),
            "dark": self.dark,
            "bright": self.bright,
            **widths,
        }


def _slices(
    mtf: Mtf, normal_deg: float, alone: PixelsAlone | None, stated: StatedTarget
) -> OtfSlices:
    """The OTF along the normal, its covariance, and what the pixels alone say of it.

    What is stated of the target, and a pulse's halo, are errors that the prior has no part in.
    """
    slices = OtfSlices.of_curve(mtf, normal_deg)
    if alone is None:
        return slices
    freq_cpp = slices.freq_cpp
    others = mtf.near(freq_cpp).factor[:, alone.columns.shape[0] :]
    found = alone.likelihood(freq_cpp, stated.gain(freq_cpp)).with_errors(others)
    return replace(slices, likelihood=found)


def _budget_rows(
    orientation: Orientation, variances: Mapping[str, Floats]
) -> tuple[BudgetTerm, ...]:
    """The rows of terms that give the main numbers some variances, (3,) each."""
    stds = {
        name: dict(zip(MAIN_NUMBERS, np.sqrt(found).tolist(), strict=True))
        for name, found in variances.items()
    }
    return budget_rows(orientation, stds)


def _budget_document(
    orientation: Orientation, variances: Mapping[str, Floats]
) -> list[dict[str, Any]]:
    return [row.to_dict() for row in _budget_rows(orientation, variances)]


def _plane_document(
    mtf: Mtf, normal_deg: float, alone: PixelsAlone | None, stated: StatedTarget
) -> dict[str, Any]:
    return _slices(mtf, normal_deg, alone, stated).to_dict()
