"""What a caller may change of a measurement of points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.targets.check import Limits, require_limits
from acutance.targets.points.checks import POINTS_CHECKS
from acutance.targets.points.published import SdsuMirrorsOptions

__all__ = ["PointsOptions"]


@dataclass(frozen=True)
class PointsOptions:
    """Options of a measurement of points.

    Parameters
    ----------
    min_snr : float
        Minimum peak, over the noise about it, of a bright spot that is fitted. The fit has noise of
        its own, and a source that is no point may then have a lower SNR.
    min_distance_px : float
        Minimum distance to another source that is not much fainter.
    max_sources : int
        The brightest so many are used.
    radius_px : float
        Pixels up to this distance from a source are used.
    robust : bool
        Bound the weight of outlying pixels (method "psf-fit").
    limits : mapping of str to float
        Limits of checks other than those of the table, by name.
    method_options : SdsuMirrorsOptions, optional
        Options of the published method.

    Raises
    ------
    OptionError
        If a number makes no sense, or no check has the name of a limit.
    """

    min_snr: float = 10.0
    min_distance_px: float = 4.0
    max_sources: int = 150
    radius_px: float = 13.0
    robust: bool = True
    limits: Limits = field(default_factory=dict)
    method_options: SdsuMirrorsOptions | None = None

    def __post_init__(self) -> None:
        require_types(self)
        require_limits(self.limits, POINTS_CHECKS, "PointsOptions")
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
            "limits": dict(self.limits),
            "method_options": None if chosen is None else dict(vars(chosen)),
        }
