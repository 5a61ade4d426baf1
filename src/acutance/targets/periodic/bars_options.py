"""Options of a measurement of bars."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from acutance.arguments import require_types
from acutance.errors import OptionError
from acutance.geometry.bar_group import Bars
from acutance.targets.check import Limits, require_limits
from acutance.targets.periodic.bars_checks import BARS_CHECKS
from acutance.targets.periodic.stated_contrast import Levels, stated_levels

__all__ = ["BarsOptions"]


@dataclass(frozen=True)
class BarsOptions:
    """Options of a measurement of bars.

    Parameters
    ----------
    groups : tuple of Bars
        Where the groups are, in pixels of the whole image, to a quarter of their period; they
        are searched for if there are none.
    count : int, optional
        Bars in a group, for the search; counted unless given.
    dark, bright : float, optional
        Levels of background and bars before the sensor, from wide patches of the same materials, in
        image units. Without them the contrast is fitted.
    level_std : float
        Standard deviation of ``bright - dark``.
    robust : bool
        Bound the weight of outlying pixels.
    limits : mapping of str to float
        Limits of the checks, where they differ from those of `acutance.targets.QUESTIONS`.

    Raises
    ------
    OptionError
        If a value is of another kind, or contradicts another.
    """

    groups: tuple[Bars, ...] = ()
    count: int | None = None
    dark: float | None = None
    bright: float | None = None
    level_std: float = 0.0
    robust: bool = True
    limits: Limits = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_types(self)
        require_limits(self.limits, BARS_CHECKS, "BarsOptions")
        stated_levels(self.dark, self.bright, self.level_std)
        if self.count is not None and not 2 <= self.count <= 40:
            raise OptionError(
                f"{self.count} bars in a group: give 2 to 40; a single bar is a pulse "
                "(measure_pulse, acutance pulse)"
            )
        if self.count is not None and self.groups:
            raise OptionError(
                f"count={self.count} is for the search of groups, and groups are stated, each with "
                "its own: leave one of them out"
            )
        for number, one in enumerate(self.groups, 1):
            if one.count < 2:
                raise OptionError(
                    f"group {number} has {one.count} bar: at least 2 are needed; a single bar is "
                    "a pulse (measure_pulse, acutance pulse)"
                )
            if not (1.2 <= one.period_px <= 100 and one.length_px >= 6):
                raise OptionError(
                    f"group {number} has a period of {one.period_px:g} px and bars of "
                    f"{one.length_px:g} px: give periods of 1.2 to 100 px and bars of at least "
                    "6 px"
                )

    @property
    def levels(self) -> Levels | None:
        """Both levels, if they are known."""
        return stated_levels(self.dark, self.bright, self.level_std)

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        return {
            "groups": [one.to_dict() for one in self.groups],
            "count": self.count,
            "dark": self.dark,
            "bright": self.bright,
            "level_std": self.level_std,
            "robust": self.robust,
            "limits": dict(self.limits),
        }
