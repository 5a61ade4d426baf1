"""The result of a combination: one sensor, each measurement next to it, and their agreement."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.combine.curves import ChiSquare
from acutance.targets.combine.inputs import direction_in_words
from acutance.targets.combine.weighted_forms import CombinedOtf
from acutance.targets.measurement import Measurement

__all__ = ["CombinedMeasurement", "CombinedPart"]


@dataclass(frozen=True, eq=False)
class CombinedPart(ShortRepr):
    """One measurement next to the combination of all.

    Parameters
    ----------
    name, kind, method : str
    path : str or None
        The file it was measured in.
    normal_deg : tuple of float
        Its direction, or several of a 2-D measurement.
    chi_square : ChiSquare
        Of its residuals.
    own, combined : Estimate
        MTF at Nyquist along its direction (across, if it has all): its own, and the combined.
    freq_cpp : (n,) array
    value, std, fitted, fitted_std : (m, n) arrays
        MTF by direction, its standard deviation, and the combined MTF there, with its own.
    """

    name: str
    kind: str
    method: str
    path: str | None
    normal_deg: tuple[float, ...]
    chi_square: ChiSquare
    own: Estimate
    combined: Estimate
    freq_cpp: Floats
    value: Floats
    std: Floats
    fitted: Floats
    fitted_std: Floats

    @property
    def has_all_directions(self) -> bool:
        """Whether it shows all directions."""
        return len(self.normal_deg) > 1

    @property
    def direction(self) -> str:
        """The direction of its slice, or that it has all."""
        return direction_in_words(self.normal_deg)

    def to_dict(self) -> dict[str, Any]:
        """Name, kind, directions and chi-square, for JSON."""
        return {
            "name": self.name,
            "kind": self.kind,
            "method": self.method,
            "path": self.path,
            "normal_deg": list(self.normal_deg),
            "mtf_nyquist": self.own.to_dict(),
            "combined_mtf_nyquist": self.combined.to_dict(),
            **_chi_square(self.chi_square),
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class CombinedMeasurement(Measurement):
    """The combination of measurements of one sensor; `details` is the `CombinedFit`.

    Parameters
    ----------
    parts : tuple of CombinedPart
        The measurements, in the order given.
    chi_square : ChiSquare
        Of all measurements: whether they agree.
    plain_sensor : ChiSquare
        Of all measurements about the best product of optical transfer function (OTF) blocks,
        without a correction.
    """

    parts: tuple[CombinedPart, ...]
    chi_square: ChiSquare
    plain_sensor: ChiSquare

    @property
    def sensor(self) -> CombinedOtf:
        """The forms of sensor with their weights."""
        return cast(CombinedOtf, self.otf.model)

    @cached_property
    def parameters(self) -> dict[str, Estimate]:
        """Parameters of the sensor of largest weight, by name with their units."""
        return self.sensor.numbers

    @property
    def birge_ratio(self) -> float:
        """Factor by which every standard deviation was widened: 1 where the measurements agree."""
        return self.sensor.birge_ratio

    def target_document(self) -> dict[str, Any]:
        """The sensor's parameters, the forms and what each measurement contributed."""
        best = self.sensor.best
        return {
            "sensor": {
                "form": best.form.name,
                "weight": best.weight,
                "detector_px": list(best.form.detector_px),
                "parameters": {name: one.to_dict() for name, one in self.parameters.items()},
            },
            "forms": [
                {"form": one.form.name, "departure": one.share, "weight": one.weight}
                for one in self.sensor.forms
            ],
            "departure": self.sensor.correction_share,
            "birge_ratio": self.birge_ratio,
            "agreement": _chi_square(self.chi_square),
            "plain_sensor": _chi_square(self.plain_sensor),
            "parts": [one.to_dict() for one in self.parts],
        }


def _chi_square(found: ChiSquare) -> dict[str, float | None]:
    """For JSON; what tells nothing has no chance of a larger one."""
    return {
        "chi_square": found.value,
        "degrees_of_freedom": found.expected,
        "p_value": found.p_value if math.isfinite(found.p_value) else None,
    }
