"""Options of the measurement of an edge or a pulse."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.arguments import require_types
from acutance.curves import Estimate
from acutance.curves.metrics import RerCentre
from acutance.targets.check import Limits, require_limits
from acutance.targets.straight.edge_checks import EDGE_CHECKS
from acutance.targets.straight.published import (
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuOptions,
    SdsuPulseOptions,
)
from acutance.targets.straight.pulse_checks import PULSE_CHECKS
from acutance.targets.straight.stated_target import require_stated, stated_number

__all__ = ["EdgeOptions", "MethodOptions", "PulseOptions"]

MethodOptions = SdsuOptions | KompsatOptions | Iso12233Options | FermiOptions


@dataclass(frozen=True)
class EdgeOptions:
    """Options of an edge measurement.

    Parameters
    ----------
    rer_centre : {"half", "peak"} or None
        What relative edge response (RER) is centred on; None leaves it to the method (the 50 %
        point, but the peak of the line spread function, LSF, for "kompsat-2014", step 9b).
    robust : bool
        Bound the weight of outlying pixels (method "spline").
    limits : mapping of str to float
        Limits of checks to be asked instead of those of the table, by name.
    method_options : SdsuOptions, KompsatOptions, Iso12233Options or FermiOptions, optional
        Options of a published method.
    target_softness_m, target_softness_px : Estimate or float, optional
        Standard deviation of the Gaussian profile of the target's own border, with its own
        standard deviation, in metres or pixels along the normal: the curves are those behind it.
    level_uncertainty : float
        Standard deviation of the true contrast of the target over the fitted one, as a share.
    """

    rer_centre: RerCentre | None = None
    robust: bool = True
    limits: Limits = field(default_factory=dict)
    method_options: MethodOptions | None = None
    target_softness_m: Estimate | float | None = None
    target_softness_px: Estimate | float | None = None
    level_uncertainty: float = 0.0

    def __post_init__(self) -> None:
        require_types(self)
        require_stated(self)
        require_limits(self.limits, EDGE_CHECKS, "EdgeOptions")

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        return _document(self)


@dataclass(frozen=True)
class PulseOptions:
    """Options of a pulse measurement.

    Parameters
    ----------
    rer_centre : {"half", "peak"} or None
        What RER is centred on; None is the 50 % point.
    robust : bool
        Bound the weight of outlying pixels (method "spline").
    limits : mapping of str to float
        Limits of checks to be asked instead of those of the table, by name.
    method_options : SdsuPulseOptions, optional
        Options of the published method.
    target_softness_m, target_softness_px : Estimate or float, optional
        Standard deviation of the Gaussian profile of the target's own border, with its own
        standard deviation, in metres or pixels along the normal: the curves are those behind it.
    level_uncertainty : float
        Standard deviation of the true contrast of the target over the fitted one, as a share.
    """

    rer_centre: RerCentre | None = None
    robust: bool = True
    limits: Limits = field(default_factory=dict)
    method_options: SdsuPulseOptions | None = None
    target_softness_m: Estimate | float | None = None
    target_softness_px: Estimate | float | None = None
    level_uncertainty: float = 0.0

    def __post_init__(self) -> None:
        require_types(self)
        require_stated(self)
        require_limits(self.limits, PULSE_CHECKS, "PulseOptions")

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        return _document(self)


def _document(options: EdgeOptions | PulseOptions) -> dict[str, Any]:
    chosen = options.method_options
    return {
        "rer_centre": options.rer_centre,
        "robust": options.robust,
        "limits": dict(options.limits),
        "method_options": None if chosen is None else dict(vars(chosen)),
        "target_softness_m": stated_number(options.target_softness_m),
        "target_softness_px": stated_number(options.target_softness_px),
        "level_uncertainty": options.level_uncertainty,
    }
