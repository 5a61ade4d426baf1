"""What a bi-resolution measurement holds: the curves, the kernel, and the evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.targets.measurement import ImageInfo
from acutance.targets.measurement2d import Measurement2d
from acutance.targets.pair.first_fit import BlurFit, BlurStep
from acutance.targets.pair.grid import PairGrid
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.local import LocalFit
from acutance.targets.pair.spectral_ratio import PairSpectra

__all__ = ["BiresolutionMeasurement"]


@dataclass(frozen=True, eq=False, kw_only=True)
class BiresolutionMeasurement(Measurement2d):
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
    blur : BlurFit
        The parametric fit with its iterations.
    fit : KernelFit
        The kernel behind the OTF.
    pixel_fit : KernelFit
        The fit to the pixels (the same, unless the method is "spectral-ratio").
    spectra : PairSpectra or None
        Averaged spectra with the coherence.
    local : LocalFit
        Departures of the regions of the map.
    residual : array
        Residuals in units of the low image, thinned to at most 384 pixels a side; NaN where left
        out.
    residual_step : int
        Low pixels from one of them to the next.
    share_read : float
        Share of the usable low pixels that was read.
    high_noise : float
        Standard deviation of the reference's noise that was allowed for.
    reference_known : bool
        Whether the reference's own MTF was divided out. If not, the curves are MTF_low / MTF_high.
    """

    high: ImageInfo
    grid: PairGrid
    shift_px: tuple[Estimate, Estimate]
    gain: float
    offset: float
    blur: BlurFit
    fit: KernelFit
    pixel_fit: KernelFit
    spectra: PairSpectra | None
    local: LocalFit
    residual: Floats
    residual_step: int
    share_read: float
    high_noise: float
    reference_known: bool

    @property
    def ratio(self) -> tuple[float, float]:
        """Ratio of the GSDs along (rows, columns)."""
        return self.grid.down.ratio, self.grid.across.ratio

    @property
    def is_ratio(self) -> bool:
        """Whether the curves are MTF_low / MTF_high, as no reference was given."""
        return not self.reference_known

    @property
    def steps(self) -> Sequence[BlurStep]:
        """The iterations of the parametric fit."""
        return self.blur.steps

    def local_mtf_nyquist(self, axis: str) -> tuple[Floats, Floats]:
        """MTF at Nyquist of every region of the map, and its standard deviation.

        The common MTF times what the region's additional blur leaves of it.

        Parameters
        ----------
        axis : {"across", "along"}
        """
        response = self.across if axis == "across" else self.along
        variance = (
            self.local.variance_across_px2 if axis == "across" else self.local.variance_down_px2
        )
        mtf = response.mtf_nyquist.value * np.exp(-0.5 * np.pi**2 * variance)
        return mtf, mtf * 0.5 * np.pi**2 * self.local.variance_std_px2

    def evidence(self) -> dict[str, Any]:
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
            "residual_std": self.pixel_fit.noise,
            "high_noise": self.high_noise,
            "pixels": {
                "used": self.pixel_fit.used, "left_out": self.pixel_fit.left_out,
                "share_read": self.share_read,
            },
            "iterations": [
                {
                    "residual": step.residual, "change": step.change,
                    "shift_px": list(step.shift_px), "variance_px2": list(step.variance_px2),
                }
                for step in self.steps
            ],
            "coherence": self._coherence(),
            "map": self._map(),
        }  # fmt: skip

    def _coherence(self) -> dict[str, Any] | None:
        if self.spectra is None:
            return None
        found: dict[str, Any] = {"windows": self.spectra.windows}
        for axis in ("across", "along"):
            freq, coherence = self.spectra.along_axis(axis)
            found[axis] = {"freq_cpp": freq.tolist(), "value": coherence.tolist()}
        return found

    def _map(self) -> dict[str, Any]:
        fields = {name: value.tolist() for name, value in vars(self.local).items()}
        for axis in ("across", "along"):
            mtf, std = self.local_mtf_nyquist(axis)
            fields[f"mtf_nyquist_{axis}"] = mtf.tolist()
            fields[f"mtf_nyquist_{axis}_std"] = std.tolist()
        return fields
