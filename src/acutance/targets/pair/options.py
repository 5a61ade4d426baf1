"""What a caller may change of a bi-resolution measurement."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Final

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.targets.check import Limits, require_limits
from acutance.targets.pair.checks import PAIR_CHECKS

__all__ = ["MAX_SHIFT_PX", "BiresolutionOptions"]

MAX_SHIFT_PX: Final = 48
"""Half of the largest tile: beyond it, two tiles of the same place share too little."""


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
        The largest error of registration that is looked for, in low pixels: 48 at most, and half of
        the tiles of up to 96 pixels that a region is cut into.
    reach_px : float or None
        How far the free kernel goes, in low pixels; None leaves it to the size of the region.
    max_pixels : int
        Low pixels used at most: of a larger scene, tiles distributed evenly over it.
    robust : bool
        Leave out what fits badly: clouds, changes, defects.
    noise_high : float or None
        Standard deviation of the noise in a pixel of the high image, in its units; None estimates
        it.
    limits : mapping of str to float
        Limits of checks (`PAIR_CHECKS`), by name, instead of those of the table.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    stop_change: float = 1e-4
    max_steps: int = 30
    max_shift_px: int = 8
    reach_px: float | None = None
    max_pixels: int = 500_000
    robust: bool = True
    noise_high: float | None = None
    limits: Limits = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_types(self)
        require_limits(self.limits, PAIR_CHECKS, "BiresolutionOptions")
        reach = 4.0 if self.reach_px is None else self.reach_px
        noise = 0.0 if self.noise_high is None else self.noise_high
        asked = (
            ("stop_change", self.stop_change, 0 < self.stop_change < 1, "between 0 and 1"),
            ("max_steps", self.max_steps, self.max_steps >= 1, "at least 1"),
            (
                "max_shift_px",
                self.max_shift_px,
                0 <= self.max_shift_px <= MAX_SHIFT_PX,
                f"0 to {MAX_SHIFT_PX}",
            ),
            ("reach_px", reach, 2 <= reach <= 12, "2 to 12"),
            ("max_pixels", self.max_pixels, self.max_pixels >= 4096, "at least 4096"),
            ("noise_high", noise, 0 <= noise < math.inf, "at least 0"),
        )
        for name, value, sensible, text in asked:
            if not sensible:
                raise OptionError(f"{name} is {value:g}, it has to be {text}")

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        return {**vars(self), "limits": dict(self.limits)}
