"""Options of a combination, and the limits of its checks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.targets.check import Limits, require_limits
from acutance.targets.combine.checks import COMBINE_CHECKS
from acutance.targets.combine.sensor_forms import FORMS
from acutance.targets.combine.sensor_terms import TERMS

__all__ = ["CombineOptions"]


@dataclass(frozen=True)
class CombineOptions:
    """Options of a combination.

    Parameters
    ----------
    detector_px : (float, float)
        Width of the detector across and along, in pixels.
    forms : tuple of tuples of str
        Sensors that are tried: the names of their terms besides the detector.
    limits : mapping of str to float
        Limits of checks to be asked instead of those of the table, by name.

    Raises
    ------
    OptionError
        If a number makes no sense.
    """

    detector_px: tuple[float, float] = (1.0, 1.0)
    forms: tuple[tuple[str, ...], ...] = FORMS
    limits: Limits = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_types(self)
        require_limits(self.limits, COMBINE_CHECKS, "CombineOptions")
        if not all(0 < size <= 4 for size in self.detector_px):
            raise OptionError(
                f"detector_px is {self.detector_px}: it has to be two widths, across and along, "
                "above 0 and up to 4 px"
            )
        terms = {name for form in self.forms for name in form}
        if not self.forms or any(form[:1] != ("gaussian",) for form in self.forms):
            raise OptionError("forms: give at least one, each beginning with gaussian")
        if unknown := terms - set(TERMS):
            raise OptionError(f"forms: there is no {', '.join(unknown)}, only {', '.join(TERMS)}")

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        return {
            "detector_px": list(self.detector_px),
            "forms": [list(one) for one in self.forms],
            "limits": dict(self.limits),
        }
