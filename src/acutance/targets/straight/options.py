"""What a caller may change of an edge measurement, and the limits its checks hold it to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.curves.metrics import RerCentre
from acutance.targets.options import require_types
from acutance.targets.straight.published import (
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuOptions,
    SdsuPulseOptions,
)

__all__ = ["EdgeLimits", "EdgeOptions", "MethodOptions", "PulseLimits", "PulseOptions"]

MethodOptions = SdsuOptions | KompsatOptions | Iso12233Options | FermiOptions


@dataclass(frozen=True)
class EdgeLimits:
    """Limits of the target checks; `edge_checks` says where each comes from.

    Parameters
    ----------
    contrast_snr : float
        Least ratio of contrast to noise.
    uniformity : float
        Least ratio of contrast to the structure of either plateau.
    angle_deg : float, optional
        Largest angle between edge and grid; by default 30 for the methods that work row by row,
        and any (45) for a fit along the normal.
    sample_phases : float
        Least number of sub-pixel phases.
    rows : float
        Least number of rows.
    straightness_px : float
        Largest departure of the edge from a line, rms, in pixels.
    steadiness : float
        Largest change of the blur along the edge, as the share of the MTF at Nyquist it moves.
    ragged_px : float
        Largest movement of the edge to and fro from pixel to pixel, rms, in pixels.
    lsf_width_px : float
        Least width of the LSF at half its maximum, in pixels.
    plateau_px : float
        Least width of either plateau in pixels.
    saturation : float
        Largest share of pixels at the detector's limit.
    quantisation : float
        Least noise of the plateaus, in steps of the image's numbers.
    gradient : float
        Largest slope of the ground far from the target, relative to a small aperture's tail.
    correlated_noise : float
        Largest correlation of the noise between neighbouring pixels.
    structure : float
        Largest structure beside the edge, as a share of the contrast.
    lopsided : float
        Largest difference of the light in the far feet of the LSF (edges).
    profile : float
        Largest rms of what the fit leaves alike all along the target, as a share of the contrast.
    outliers : float
        Largest share of outlying pixels.
    """

    contrast_snr: float = 50.0
    uniformity: float = 50.0
    angle_deg: float | None = None
    sample_phases: float = 3.0
    rows: float = 20.0
    straightness_px: float = 0.05
    steadiness: float = 0.05
    ragged_px: float = 0.05
    lsf_width_px: float = 0.5
    plateau_px: float = 7.0
    saturation: float = 0.001
    quantisation: float = 0.55
    gradient: float = 1.0
    correlated_noise: float = 0.1
    structure: float = 0.02
    lopsided: float = 0.01
    profile: float = 0.0005
    outliers: float = 0.02

    def __post_init__(self) -> None:
        require_types(self)


@dataclass(frozen=True)
class PulseLimits(EdgeLimits):
    """Limits of the target checks of a pulse: those of an edge, and five of its own.

    Parameters
    ----------
    width_px : float
        Least width of the pulse in pixels.
    width_sigmas : float
        Largest departure of the fitted width from the stated one, in standard deviations.
    zero_distance_cpp : float
        Least distance of Nyquist, MTF50 and MTF30 from a zero of the pulse's spectrum (method
        "sdsu-2005").
    parallel_deg : float
        Largest angle between the two sides.
    ground_step : float
        Largest difference of the two grounds, as a share of the pulse's height.
    """

    width_px: float = 2.0
    width_sigmas: float = 3.0
    zero_distance_cpp: float = 0.08
    parallel_deg: float = 0.5
    ground_step: float = 0.25


@dataclass(frozen=True)
class PulseOptions:
    """Options of a pulse measurement.

    Parameters
    ----------
    rer_centre : {"half", "peak"} or None
        What RER is centred on; None is the 50 % point.
    robust : bool
        Bound the weight of outlying pixels (method "spline").
    limits : PulseLimits
        Limits of the checks.
    method_options : SdsuPulseOptions, optional
        Options of the published method.
    """

    rer_centre: RerCentre | None = None
    robust: bool = True
    limits: PulseLimits = field(default_factory=PulseLimits)
    method_options: SdsuPulseOptions | None = None

    def __post_init__(self) -> None:
        require_types(self)

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        chosen = self.method_options
        return {
            "rer_centre": self.rer_centre,
            "robust": self.robust,
            "limits": dict(vars(self.limits)),
            "method_options": None if chosen is None else dict(vars(chosen)),
        }


@dataclass(frozen=True)
class EdgeOptions:
    """Options of an edge measurement.

    Parameters
    ----------
    rer_centre : {"half", "peak"} or None
        What RER is centred on; None leaves it to the method (the 50 % point, but the LSF's peak
        for "kompsat-2014", step 9b).
    robust : bool
        Bound the weight of outlying pixels (method "spline").
    limits : EdgeLimits
        Limits of the checks.
    method_options : SdsuOptions, KompsatOptions, Iso12233Options or FermiOptions, optional
        Options of a published method.
    """

    rer_centre: RerCentre | None = None
    robust: bool = True
    limits: EdgeLimits = field(default_factory=EdgeLimits)
    method_options: MethodOptions | None = None

    def __post_init__(self) -> None:
        require_types(self)

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        chosen = self.method_options
        return {
            "rer_centre": self.rer_centre,
            "robust": self.robust,
            "limits": dict(vars(self.limits)),
            "method_options": None if chosen is None else dict(vars(chosen)),
        }
