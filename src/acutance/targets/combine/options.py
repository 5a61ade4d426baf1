"""What a caller may change of a combination, and the limits its checks hold it to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.errors import OptionError
from acutance.targets.combine.sensor_forms import FORMS, TERMS
from acutance.targets.options import require_types

__all__ = ["CombineLimits", "CombineOptions"]


@dataclass(frozen=True)
class CombineLimits:
    """Limits of the checks of a combination.

    Parameters
    ----------
    agreement : float
        Least chance of a larger chi-square, of all measurements and of any single one.
    plain_sensor : float
        Least chance of a larger chi-square about the best plain sensor.
    directions : float
        Least number of directions that differ by 15 degrees.
    failed_inputs : float
        Largest number of measurements with a failed check of their own.
    shared_targets : float
        Largest number of pairs that measured the same pixels.
    assumed_covariance : float
        Largest number of measurements without covariance.
    unknown_gsd : float
        Largest number of measurements without a GSD, where others have one.
    """

    agreement: float = 0.01
    plain_sensor: float = 0.01
    directions: float = 3.0
    failed_inputs: float = 0.0
    shared_targets: float = 0.0
    assumed_covariance: float = 0.0
    unknown_gsd: float = 0.0

    def __post_init__(self) -> None:
        require_types(self)


@dataclass(frozen=True)
class CombineOptions:
    """Options of a combination.

    Parameters
    ----------
    detector_px : (float, float)
        Width of the detector across and along, in pixels.
    forms : tuple of tuples of str
        Sensors that are tried: the names of their terms besides the detector.
    limits : CombineLimits
        Limits of the checks.

    Raises
    ------
    OptionError
        If a number makes no sense.
    """

    detector_px: tuple[float, float] = (1.0, 1.0)
    forms: tuple[tuple[str, ...], ...] = FORMS
    limits: CombineLimits = field(default_factory=CombineLimits)

    def __post_init__(self) -> None:
        require_types(self)
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
            "limits": dict(vars(self.limits)),
        }
