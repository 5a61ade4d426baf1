"""What a caller may change of a measurement of points, and the limits its checks hold it to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.errors import OptionError
from acutance.targets.options import require_types
from acutance.targets.points.published import SdsuMirrorsOptions

__all__ = ["PointsLimits", "PointsOptions"]


@dataclass(frozen=True)
class PointsLimits:
    """Limits of the checks of point sources.

    Parameters
    ----------
    sources : float
        Least number of sources.
    peak_snr : float
        Least median peak over the background's noise.
    spacing_px : float
        Least distance of two sources.
    phase_gap_px : float
        Largest distance of any sub-pixel phase from the nearest one of a source.
    full_scale : float
        Largest pixel of a source, as a share of the detector's range.
    source_misfit : float
        Largest ratio of a source's residuals to the noise.
    ground : float
        Largest spread of the backgrounds about a plane, as a share of the median peak.
    correlated_noise : float
        Largest correlation of the noise between neighbouring pixels.
    outliers : float
        Largest share of outlying pixels.
    survey_px : float
        Largest root mean square distance from surveyed positions.
    """

    sources: float = 15.0
    peak_snr: float = 50.0
    spacing_px: float = 5.0
    phase_gap_px: float = 0.25
    full_scale: float = 0.9
    source_misfit: float = 1.5
    ground: float = 0.05
    correlated_noise: float = 0.1
    outliers: float = 0.02
    survey_px: float = 0.1

    def __post_init__(self) -> None:
        require_types(self)


@dataclass(frozen=True)
class PointsOptions:
    """Options of a measurement of points.

    Parameters
    ----------
    min_snr : float
        Least peak over the noise of a source that is used.
    min_distance_px : float
        Least distance to another source that is not much fainter.
    max_sources : int
        The brightest so many are used.
    radius_px : float
        Pixels up to this distance from a source are used.
    robust : bool
        Bound the weight of outlying pixels (method "psf-fit").
    limits : PointsLimits
        Limits of the checks.
    method_options : SdsuMirrorsOptions, optional
        Options of the published method.

    Raises
    ------
    OptionError
        If a number makes no sense.
    """

    min_snr: float = 10.0
    min_distance_px: float = 4.0
    max_sources: int = 150
    radius_px: float = 13.0
    robust: bool = True
    limits: PointsLimits = field(default_factory=PointsLimits)
    method_options: SdsuMirrorsOptions | None = None

    def __post_init__(self) -> None:
        require_types(self)
        bounds = {
            "min_snr": (self.min_snr, 1.0, 1e6),
            "min_distance_px": (self.min_distance_px, 0.0, 100.0),
            "max_sources": (self.max_sources, 1, 2000),
            "radius_px": (self.radius_px, 3.0, 40.0),
        }
        for name, (value, low, high) in bounds.items():
            if not low <= value <= high:
                raise OptionError(f"{name} is {value:g}: it has to be {low:g} to {high:g}")

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        chosen = self.method_options
        return {
            "min_snr": self.min_snr,
            "min_distance_px": self.min_distance_px,
            "max_sources": self.max_sources,
            "radius_px": self.radius_px,
            "robust": self.robust,
            "limits": dict(vars(self.limits)),
            "method_options": None if chosen is None else dict(vars(chosen)),
        }
