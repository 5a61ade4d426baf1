"""Options of a measurement of a star."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.targets.check import Limits, require_limits
from acutance.targets.periodic.star_checks import STAR_CHECKS
from acutance.targets.periodic.star_waves import Wave
from acutance.targets.periodic.stated_contrast import Levels, stated_levels

__all__ = ["StarOptions"]


@dataclass(frozen=True)
class StarOptions:
    """Options of a star measurement.

    Parameters
    ----------
    wave : {"sine", "square"}
        Form of the spokes.
    dark, bright : float, optional
        Levels of dark and bright spokes before the sensor, from wide patches of the same
        materials, in image units. Without them the contrast is fitted, which the spokes at the
        rim allow to some per cent only.
    level_std : float
        Standard deviation of ``bright - dark``.
    centre : (float, float), optional
        (row, col) of the centre to some pixels, where it is not to be searched for.
    inner_px : float, optional
        Pixels nearer to the centre are left out.
    robust : bool
        Bound the weight of outlying pixels.
    limits : mapping of str to float
        Limits of the checks, where they differ from those of `acutance.targets.QUESTIONS`.

    Raises
    ------
    OptionError
        If a value is of another kind, or contradicts another.
    """

    wave: Wave = "sine"
    dark: float | None = None
    bright: float | None = None
    level_std: float = 0.0
    centre: tuple[float, float] | None = None
    inner_px: float | None = None
    robust: bool = True
    limits: Limits = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_types(self)
        require_limits(self.limits, STAR_CHECKS, "StarOptions")
        stated_levels(self.dark, self.bright, self.level_std)
        if self.inner_px is not None and not 0 <= self.inner_px < math.inf:
            raise OptionError(f"inner_px (--inner) is {self.inner_px:g}, it has to be 0 or more")
        if self.centre is not None and not all(map(math.isfinite, self.centre)):
            raise OptionError(
                f"centre (--centre) is {self.centre}, it has to be two finite numbers"
            )

    @property
    def levels(self) -> Levels | None:
        """Both levels, if they are known."""
        return stated_levels(self.dark, self.bright, self.level_std)

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        chosen = {name: value for name, value in vars(self).items() if name != "limits"}
        return {**chosen, "limits": dict(self.limits)}
