"""What a caller may change of a star measurement, and the limits its checks hold it to."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from acutance.errors import OptionError
from acutance.targets.options import require_types
from acutance.targets.periodic.clipped_and_outlying import known_levels
from acutance.targets.periodic.star_waves import Wave
from acutance.targets.periodic.stated_contrast import Levels

__all__ = ["StarLimits", "StarOptions"]


@dataclass(frozen=True)
class StarLimits:
    """Limits of the target checks of a star.

    Parameters
    ----------
    contrast_snr : float
        Least ratio of the spokes' contrast to noise.
    level : float
        Largest relative standard deviation of the spokes' contrast before the sensor: it scales
        the whole MTF.
    coarsest_cpp : float
        Largest frequency of the spokes at the rim.
    finest_cpp : float
        Least frequency of the spokes near the centre.
    sweep_deg : float
        Least angle of the star.
    wave : float
        Largest third harmonic that the stated wave does not explain, as a share of the contrast.
    saturation : float
        Largest share of pixels at the end of the scale.
    correlated_noise : float
        Largest correlation of the residuals between neighbouring pixels.
    outliers : float
        Largest share of outlying pixels.
    """

    contrast_snr: float = 50.0
    level: float = 0.01
    coarsest_cpp: float = 0.15
    finest_cpp: float = 0.5
    sweep_deg: float = 90.0
    wave: float = 0.01
    saturation: float = 0.001
    correlated_noise: float = 0.1
    outliers: float = 0.02

    def __post_init__(self) -> None:
        require_types(self)


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
    limits : StarLimits
        Limits of the checks.
    """

    wave: Wave = "sine"
    dark: float | None = None
    bright: float | None = None
    level_std: float = 0.0
    centre: tuple[float, float] | None = None
    inner_px: float | None = None
    robust: bool = True
    limits: StarLimits = field(default_factory=StarLimits)

    def __post_init__(self) -> None:
        require_types(self)
        known_levels(self.dark, self.bright, self.level_std)
        if self.inner_px is not None and not 0 <= self.inner_px < math.inf:
            raise OptionError(f"inner_px (--inner) is {self.inner_px:g}, it has to be 0 or more")
        if self.centre is not None and not all(map(math.isfinite, self.centre)):
            raise OptionError(
                f"centre (--centre) is {self.centre}, it has to be two finite numbers"
            )

    @property
    def levels(self) -> Levels | None:
        """Both levels, if they are known."""
        return known_levels(self.dark, self.bright, self.level_std)

    def to_dict(self) -> dict[str, Any]:
        """All options by name, for JSON."""
        chosen = {name: value for name, value in vars(self).items() if name != "limits"}
        return {**chosen, "limits": dict(vars(self.limits))}
