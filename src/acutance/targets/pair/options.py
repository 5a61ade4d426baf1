"""What a caller may change of a bi-resolution measurement, and the limits of its checks."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from acutance.errors import OptionError
from acutance.targets.options import require_types

__all__ = ["BiresolutionLimits", "BiresolutionOptions"]


@dataclass(frozen=True)
class BiresolutionLimits:
    """Limits of the checks. `acutance.targets.pair.checks` says where each comes from.

    Parameters
    ----------
    ratio : float
        Least ratio of the GSDs.
    reference_mtf : float
        Least MTF of the reference at the low image's Nyquist frequency; a reference that was not
        given has none.
    reference_directions : float
        Least number of directions in which a reference was measured.
    correlation : float
        Least correlation of the low image with the blurred high one, local means left out.
    coherence : float
        Least squared coherence at the low image's Nyquist frequency, across and along.
    pixels : float
        Least number of low pixels used.
    left_out : float
        Largest share of low pixels left out as clouds, changes or defects.
    registration_px : float
        Largest standard deviation of the local shifts, in low pixels.
    shift_px : float
        Largest displacement of the low image as a whole, in low pixels.
    residual_correlation : float
        Largest correlation between neighbouring residuals.
    inflation : float
        Largest factor by which regions scatter more than white residuals explain.
    saturation : float
        Largest share of low pixels at the end of the scale.
    iteration_change : float
        Largest relative change of the residual in the parametric fit's last step, in units of the
        threshold asked for.
    """

    ratio: float = 2.0
    reference_mtf: float = 0.5
    reference_directions: float = 2.0
    correlation: float = 0.9
    coherence: float = 0.1
    pixels: float = 2000.0
    left_out: float = 0.2
    registration_px: float = 0.1
    shift_px: float = 3.0
    residual_correlation: float = 0.2
    inflation: float = 2.0
    saturation: float = 0.001
    iteration_change: float = 1.0

    def __post_init__(self) -> None:
        require_types(self)


@dataclass(frozen=True)
class BiresolutionOptions:
    """Options of a bi-resolution measurement.

    Parameters
    ----------
    stop_change : float
        Relative change of the residual below which the parametric fit ends (Li et al., 5.3: "a
        threshold level to be fixed by the user").
    max_steps : int
        Iterations of the parametric fit at most.
    max_shift_px : int
        The largest error of registration that is looked for, in low pixels.
    reach_px : float or None
        How far the free kernel goes, in low pixels; None leaves it to the size of the region.
    max_pixels : int
        Low pixels used at most: of a larger scene, tiles spread evenly over it.
    robust : bool
        Leave out what fits badly: clouds, changes, defects.
    noise_high : float or None
        Standard deviation of the high image's noise, in its units; None estimates it.
    limits : BiresolutionLimits
        Limits of the checks.
    """

    stop_change: float = 1e-4
    max_steps: int = 30
    max_shift_px: int = 8
    reach_px: float | None = None
    max_pixels: int = 500_000
    robust: bool = True
    noise_high: float | None = None
    limits: BiresolutionLimits = field(default_factory=BiresolutionLimits)

    def __post_init__(self) -> None:
        require_types(self)
        reach = 4.0 if self.reach_px is None else self.reach_px
        noise = 0.0 if self.noise_high is None else self.noise_high
        asked = (
            ("stop_change", self.stop_change, 0 < self.stop_change < 1, "between 0 and 1"),
            ("max_steps", self.max_steps, self.max_steps >= 1, "at least 1"),
            ("max_shift_px", self.max_shift_px, 0 <= self.max_shift_px <= 64, "0 to 64"),
            ("reach_px", reach, 2 <= reach <= 12, "2 to 12"),
            ("max_pixels", self.max_pixels, self.max_pixels >= 4096, "at least 4096"),
            ("noise_high", noise, 0 <= noise < math.inf, "at least 0"),
        )
        for name, value, sensible, text in asked:
            if not sensible:
                raise OptionError(f"{name} is {value:g}, it has to be {text}")

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        return {**vars(self), "limits": dict(vars(self.limits))}
