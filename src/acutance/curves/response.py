"""The response of a system in one direction: its three curves and their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, get_args

import numpy as np

from acutance.arguments import require_choice, require_kind, require_numbers
from acutance.curves import metrics
from acutance.curves.estimate import Estimate
from acutance.curves.grid import Floats
from acutance.curves.reading import Reading, estimates, stacked
from acutance.curves.rounded_rows import RoundedRows, principal_axes
from acutance.curves.short_repr import ShortRepr
from acutance.curves.spread import Esf, Lsf
from acutance.curves.transfer import Mtf, phasor

__all__ = ["MAIN_NUMBERS", "METRICS", "HasResponse", "PackedResponse", "Response"]


@dataclass(frozen=True, eq=False)
class Response(ShortRepr):
    """ESF, LSF and MTF of one direction, measured or true, and the metrics they hold.

    Parameters
    ----------
    esf, lsf, mtf : Esf, Lsf, Mtf
        The curves; their covariance factors share one set of latent variables.
    gsd_m : float, optional
        Ground sampling distance along the normal in metres.
    rer_centre : {"half", "peak"}, optional
        The point RER is centred on: the 50 % point, or the peak of the LSF.

    Raises
    ------
    OptionError
        If one of them is of another kind.
    """

    esf: Esf
    lsf: Lsf
    mtf: Mtf
    gsd_m: float | None = None
    rer_centre: metrics.RerCentre = "half"

    def __post_init__(self) -> None:
        require_kind(Esf, esf=self.esf)
        require_kind(Lsf, lsf=self.lsf)
        require_kind(Mtf, mtf=self.mtf)
        require_choice(get_args(metrics.RerCentre), rer_centre=self.rer_centre)
        if self.gsd_m is not None:
            require_numbers(gsd_m=self.gsd_m)

    @cached_property
    def _main_readings(self) -> tuple[Reading, ...]:
        return (
            metrics.mtf_at(self.mtf, metrics.NYQUIST_CPP),
            metrics.rer(self.esf, self.lsf, self.rer_centre),
            metrics.full_width(self.lsf),
        )

    @cached_property
    def main_rows(self) -> Floats:
        """What a unit of each latent variable adds to `MAIN_NUMBERS`, (3, k)."""
        return stacked(self._main_readings, self.esf.factor.shape[1])

    @cached_property
    def _main(self) -> dict[str, Estimate]:
        """`MAIN_NUMBERS`, their deviations by one product of matrices."""
        found = estimates(self._main_readings, self.main_rows, self.esf.latent)
        return dict(zip(MAIN_NUMBERS, found, strict=True))

    @cached_property
    def _further(self) -> dict[str, Estimate]:
        """All other numbers in pixels, in the same way."""
        esf, mtf = self.esf, self.mtf
        readings = (
            metrics.mtf_crossing(mtf, 0.5),
            metrics.mtf_crossing(mtf, 0.3),
            metrics.mtf_area(mtf),
            metrics.edge_slope(esf),
            metrics.half_extent(esf, "dark"),
            metrics.half_extent(esf, "bright"),
            metrics.overshoot(esf),
            metrics.undershoot(esf),
            metrics.giqe_h(esf),
        )
        found = estimates(readings, stacked(readings, esf.factor.shape[1]), esf.latent)
        return dict(zip(_FURTHER_NUMBERS, found, strict=True))

    @cached_property
    def mtf_nyquist(self) -> Estimate:
        """MTF at 0.5 cycles per pixel."""
        return self._main["mtf_nyquist"]

    @cached_property
    def rer(self) -> Estimate:
        """Relative edge response, about the centre `rer_centre`."""
        return self._main["rer"]

    @cached_property
    def fwhm_px(self) -> Estimate:
        """Full width of the LSF at half of its maximum, in pixels."""
        return self._main["fwhm_px"]

    @cached_property
    def fwhm_m(self) -> Estimate | None:
        """FWHM in metres; ``None`` without a GSD."""
        return None if self.gsd_m is None else self.fwhm_px * self.gsd_m

    @cached_property
    def mtf50_cpp(self) -> Estimate:
        """Lowest frequency where the MTF falls to 0.5."""
        return self._further["mtf50_cpp"]

    @cached_property
    def mtf30_cpp(self) -> Estimate:
        """Lowest frequency where the MTF falls to 0.3."""
        return self._further["mtf30_cpp"]

    @cached_property
    def mtf_area(self) -> Estimate:
        """Area under the MTF from 0 to Nyquist (cycles per pixel)."""
        return self._further["mtf_area"]

    @cached_property
    def edge_slope_per_px(self) -> Estimate:
        """Mean slope of the ESF between 40 and 60 %."""
        return self._further["edge_slope_per_px"]

    @cached_property
    def half_extent_dark_px(self) -> Estimate:
        """Distance from the 5 to the 50 % point."""
        return self._further["half_extent_dark_px"]

    @cached_property
    def half_extent_bright_px(self) -> Estimate:
        """Distance from the 50 to the 95 % point."""
        return self._further["half_extent_bright_px"]

    @cached_property
    def overshoot(self) -> Estimate:
        """Largest excess of the ESF over the bright plateau."""
        return self._further["overshoot"]

    @cached_property
    def undershoot(self) -> Estimate:
        """Largest shortfall of the ESF under the dark plateau."""
        return self._further["undershoot"]

    @cached_property
    def giqe_h(self) -> Estimate:
        """Edge height overshoot H of GIQE 4."""
        return self._further["giqe_h"]

    def summary(self) -> str:
        """The three main numbers."""
        return f"mtf_nyquist {self.mtf_nyquist}, rer {self.rer}, fwhm_px {self.fwhm_px}"

    def metrics(self) -> dict[str, Estimate]:
        """All numbers by name, in the order a report prints them."""
        found = {name: getattr(self, name) for name in METRICS}
        return {name: number for name, number in found.items() if number is not None}

    def with_numbers(self, numbers: Mapping[str, Estimate]) -> Self:
        """The same curves, with numbers that were read of them before their covariance was rounded.

        Parameters
        ----------
        numbers : mapping of str to Estimate
            By the names in `METRICS`; others are read from the curves.
        """
        stated = replace(self)
        vars(stated).update(numbers)
        return stated

    @property
    def covariance_factor(self) -> Floats:
        """Factor of the common covariance: rows of the ESF, of the LSF, of the OTF, (n, k).

        Of the optical transfer function (OTF) there are all components along itself first, whose
        deviations are those of the MTF, then all in quadrature.
        """
        turned = np.conj(phasor(self.mtf.otf))[:, None] * self.mtf.otf_factor
        spread = self.esf.covariance_factor, self.lsf.covariance_factor
        return np.concatenate([*spread, turned.real, turned.imag])

    def packed(self) -> Response:
        """The same curves in fewer bytes: their correlations are rounded, no standard deviation.

        Along principal axes few components of the rows are large.
        """
        factor = self.covariance_factor
        return PackedResponse.of(self, RoundedRows.of(factor @ principal_axes(factor)))


@dataclass(frozen=True, eq=False, kw_only=True)
class PackedResponse(Response):
    """Curves whose correlations were rounded. They are pickled in an eighth of the bytes.

    Parameters
    ----------
    rows : RoundedRows
        Of `covariance_factor`.
    """

    rows: RoundedRows

    @classmethod
    def of(cls, curves: Response, rows: RoundedRows) -> PackedResponse:
        """The values of `curves` with the covariance of `rows`."""
        n = curves.mtf.freq_cpp.size
        factor, along, quadrature = np.split(rows.factor(), [-2 * n, -n])
        esf, lsf = np.split(factor, [curves.esf.distance_px.size])
        return cls(
            Esf(curves.esf.distance_px, curves.esf.value, esf),
            Lsf(curves.lsf.distance_px, curves.lsf.value, lsf),
            replace(curves.mtf, factor=phasor(curves.mtf.otf)[:, None] * (along + 1j * quadrature),
                    latent=None),
            curves.gsd_m, curves.rer_centre, rows=rows,
        )  # fmt: skip

    def packed(self) -> PackedResponse:
        """Itself."""
        return self

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        esf, lsf, mtf = self.esf, self.lsf, self.mtf
        bare = Response(
            Esf(esf.distance_px, esf.value, np.zeros((esf.value.size, 0))),
            Lsf(lsf.distance_px, lsf.value, np.zeros((lsf.value.size, 0))),
            Mtf(mtf.freq_cpp, mtf.otf, np.zeros((mtf.otf.size, 0), complex)),
            self.gsd_m, self.rer_centre,
        )  # fmt: skip
        return PackedResponse.of, (bare, self.rows)


class HasResponse(ShortRepr):
    """Shortcuts of whatever holds a `response`: a measurement, or the truth of a simulation."""

    if TYPE_CHECKING:

        @property
        def response(self) -> Response: ...

    @property
    def esf(self) -> Esf:
        """Edge spread function along the normal."""
        return self.response.esf

    @property
    def lsf(self) -> Lsf:
        """Line spread function along the normal."""
        return self.response.lsf

    @property
    def mtf(self) -> Mtf:
        """The MTF; call it with a frequency in cycles per pixel."""
        return self.response.mtf

    @property
    def mtf_nyquist(self) -> Estimate:
        """MTF at 0.5 cycles per pixel."""
        return self.response.mtf_nyquist

    @property
    def rer(self) -> Estimate:
        """Relative edge response."""
        return self.response.rer

    @property
    def fwhm_px(self) -> Estimate:
        """Full width of the LSF at half maximum, pixels."""
        return self.response.fwhm_px

    @property
    def fwhm_m(self) -> Estimate | None:
        """FWHM of the LSF in metres; ``None`` without a GSD."""
        return self.response.fwhm_m

    @property
    def mtf50_cpp(self) -> Estimate:
        """Lowest frequency where the MTF falls to 0.5."""
        return self.response.mtf50_cpp

    @property
    def mtf30_cpp(self) -> Estimate:
        """Lowest frequency where the MTF falls to 0.3."""
        return self.response.mtf30_cpp

    @property
    def mtf_area(self) -> Estimate:
        """Area under the MTF from 0 to Nyquist (cycles per pixel)."""
        return self.response.mtf_area

    @property
    def edge_slope_per_px(self) -> Estimate:
        """Mean slope of the ESF between 40 and 60 %."""
        return self.response.edge_slope_per_px

    @property
    def half_extent_dark_px(self) -> Estimate:
        """Distance from the 5 to the 50 % point."""
        return self.response.half_extent_dark_px

    @property
    def half_extent_bright_px(self) -> Estimate:
        """Distance from the 50 to the 95 % point."""
        return self.response.half_extent_bright_px

    @property
    def overshoot(self) -> Estimate:
        """Largest excess of the ESF over the bright plateau."""
        return self.response.overshoot

    @property
    def undershoot(self) -> Estimate:
        """Largest shortfall of the ESF under the dark plateau."""
        return self.response.undershoot

    @property
    def giqe_h(self) -> Estimate:
        """Edge height overshoot H of GIQE 4."""
        return self.response.giqe_h

    def summary(self) -> str:
        """The main numbers of the response."""
        return self.response.summary()


MAIN_NUMBERS = ("mtf_nyquist", "rer", "fwhm_px")
_FURTHER_NUMBERS = (
    "mtf50_cpp",
    "mtf30_cpp",
    "mtf_area",
    "edge_slope_per_px",
    "half_extent_dark_px",
    "half_extent_bright_px",
    "overshoot",
    "undershoot",
    "giqe_h",
)
METRICS = (*MAIN_NUMBERS, "fwhm_m", *_FURTHER_NUMBERS)
