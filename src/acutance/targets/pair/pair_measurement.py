"""What a bi-resolution measurement holds: curves, geometry, and the map of regions."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

from acutance.curves import Estimate, Otf2d
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.geometry.line import Orientation
from acutance.targets.measurement import Measurement
from acutance.targets.pair.gaussian_fit import GaussianFit, GaussianStep
from acutance.targets.pair.grid import PairGrid
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.kernel_otf import KernelOtf
from acutance.targets.pair.local import LocalFit, ResidualMap
from acutance.targets.pair.spectral_ratio import PairSpectra
from acutance.targets.record import ImageInfo, rounded, strict_json
from acutance.targets.uncertainty_budget import BudgetTerm, budget_rows, main_stds

__all__ = ["BiresolutionMeasurement", "Coherence", "PairDetails"]

_DIGITS = 4


@dataclass(frozen=True, eq=False)
class Coherence(ShortRepr):
    """Squared coherence of both images along the axes of the pixels.

    Parameters
    ----------
    windows : int
        That were averaged.
    columns, rows : ((n,) array, (n,) array)
        Frequencies in cycles per low pixel and squared coherence, from column to column (0 degrees)
        and from row to row (90).
    """

    windows: int
    columns: tuple[Floats, Floats]
    rows: tuple[Floats, Floats]

    @classmethod
    def of(cls, spectra: PairSpectra) -> Coherence:
        """The coherence of averaged spectra."""
        return cls(spectra.windows, spectra.along_axis("across"), spectra.along_axis("along"))


@dataclass(frozen=True, eq=False)
class PairDetails:
    """The heavy half of a bi-resolution measurement.

    Parameters
    ----------
    gaussian : GaussianFit
        The parametric fit.
    fit : KernelFit
        The kernel behind the OTF.
    pixel_fit : KernelFit
        The fit to the pixels (the same, unless the method is "spectral-ratio").
    spectra : PairSpectra or None
        Averaged spectra with the coherence.
    residuals : ResidualMap
    """

    gaussian: GaussianFit
    fit: KernelFit
    pixel_fit: KernelFit
    spectra: PairSpectra | None
    residuals: ResidualMap


@dataclass(frozen=True, eq=False, kw_only=True)
class BiresolutionMeasurement(Measurement):
    """A measurement of a sensor against a finer image of the same ground.

    Frequencies and distances are in pixels of the low image.

    Parameters
    ----------
    high : ImageInfo
        The reference.
    grid : PairGrid
        How the images lie on each other.
    shift_px : (Estimate, Estimate)
        Displacement (rows, columns) of the low image's content against that geometry.
    gain, offset : float
        Of the low image against the blurred high one.
    steps : tuple of GaussianStep
        The iterations of the parametric fit.
    used, left_out : int
        Low pixels that were used, and those that do not fit the rest: clouds, changes, defects.
    share_read : float
        Share of the usable low pixels that was read.
    residual_std : float
        Robust standard deviation of the residuals, in units of the low image.
    high_noise : float
        Standard deviation of the noise in a pixel of the high image that was allowed for.
    coherence : Coherence or None
        ``None`` where the region has no two windows for spectra.
    local : LocalFit
        How the regions of the map differ from the common kernel.
    reference_known : bool
        Whether the reference's own MTF was divided out. If not, the curves are MTF_low / MTF_high.
    details : PairDetails or None
    """

    high: ImageInfo
    grid: PairGrid
    shift_px: tuple[Estimate, Estimate]
    gain: float
    offset: float
    steps: tuple[GaussianStep, ...]
    used: int
    left_out: int
    share_read: float
    residual_std: float
    high_noise: float
    coherence: Coherence | None
    local: LocalFit
    reference_known: bool
    details: PairDetails | None = None

    @property
    def ratio(self) -> tuple[float, float]:
        """Ratio of the GSDs along (rows, columns)."""
        return self.grid.down.ratio, self.grid.across.ratio

    @property
    def is_ratio(self) -> bool:
        """Whether the curves are MTF_low / MTF_high, as no reference was given."""
        return not self.reference_known

    def local_mtf_nyquist(self, direction: Orientation) -> tuple[Floats, Floats]:
        """MTF at Nyquist of every region of the map, and its standard deviation.

        The common MTF times what the region's additional blur leaves of it.

        Parameters
        ----------
        direction : {"across", "along"}
            Across or along track.
        """
        variance = (
            self.local.variance_across_px2
            if self._axis(direction) == "columns"
            else self.local.variance_down_px2
        )
        response = self.directions[direction]
        mtf = response.mtf_nyquist.value * np.exp(-0.5 * np.pi**2 * variance)
        return mtf, mtf * 0.5 * np.pi**2 * self.local.variance_std_px2

    def coherence_of(self, direction: Orientation) -> tuple[Floats, Floats] | None:
        """Frequencies and squared coherence across or along track; ``None`` without spectra."""
        return None if self.coherence is None else getattr(self.coherence, self._axis(direction))

    def _axis(self, direction: Orientation) -> Literal["columns", "rows"]:
        """The axis of the pixels that lies across or along track."""
        return "columns" if (direction == "across") == (self.image.along_track == "y") else "rows"

    def _budget(self) -> tuple[BudgetTerm, ...]:
        """Rows of the pixels, of the reference's noise and own MTF, and of light from beyond."""
        if not (isinstance(self.transfer, Otf2d) and isinstance(self.transfer.model, KernelOtf)):
            return super()._budget()
        model, gsd_m = self.transfer.model, self.transfer.gsd_m
        causes = {term: Otf2d(model.by(term), gsd_m) for term in model.terms}
        return tuple(
            row
            for name in self.measured_directions
            for row in budget_rows(name, {
                term: main_stds(one.response(self.axes_deg[name])) for term, one in causes.items()
            })
        )  # fmt: skip

    def target_document(self) -> dict[str, Any]:
        """Geometry, registration, radiometry, iterations, coherence and the map, for JSON."""
        return {
            "quantity": "mtf_low" if self.reference_known else "mtf_low_over_mtf_high",
            "high": self.high.to_dict(),
            "ratio": {
                "rows": self.ratio[0], "columns": self.ratio[1], "from": self.grid.source,
            },
            "shift_px": {
                name: one.to_dict()
                for name, one in zip(("rows", "columns"), self.shift_px, strict=True)
            },
            "gain": self.gain,
            "offset": self.offset,
            "residual_std": self.residual_std,
            "high_noise": self.high_noise,
            "pixels": {
                "used": self.used, "left_out": self.left_out, "share_read": self.share_read,
            },
            "iterations": [
                {
                    "residual": float(f"{step.residual:.6g}"),
                    "change": float(f"{step.change:.3g}") if math.isfinite(step.change) else None,
                    "shift_px": rounded(step.shift_px), "variance_px2": rounded(step.variance_px2),
                }
                for step in self.steps
            ],
            "coherence": self._coherence_document(),
            "map": self._map_document(),
        }  # fmt: skip

    def _coherence_document(self) -> dict[str, Any] | None:
        if self.coherence is None:
            return None
        found: dict[str, Any] = {"windows": self.coherence.windows}
        for direction in ("across", "along"):
            freq, value = getattr(self.coherence, self._axis(direction))
            found[direction] = {"freq_cpp": rounded(freq), "value": rounded(value, _DIGITS - 1)}
        return found

    def _map_document(self) -> dict[str, Any]:
        maps = {one.name: getattr(self.local, one.name) for one in fields(self.local)}
        for direction in ("across", "along"):
            mtf, std = self.local_mtf_nyquist(direction)
            maps |= {f"mtf_nyquist_{direction}": mtf, f"mtf_nyquist_{direction}_std": std}
        counts = {"pixels": maps.pop("pixels").tolist()}
        written: dict[str, Any] = strict_json(
            {name: rounded(values, _DIGITS - ("_std" in name)) for name, values in maps.items()}
        )
        return written | counts
