"""What the measurements of bars and stars share: their details, and how they become light."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from acutance.curves import Otf2d
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.numerics.noise import robust_scale
from acutance.targets.measurement import Measurement
from acutance.targets.periodic.otf_model import FittedOtf
from acutance.targets.periodic.otf_packed import PackedOtf

__all__ = ["PeriodicDetails", "PeriodicMeasurement"]


@dataclass(frozen=True, eq=False)
class PeriodicDetails(ShortRepr):
    """The heavy half of a measurement of bars or of a star.

    Attributes
    ----------
    pixels : (rows, cols) array
        The region; NaN where there is nothing to use.
    residual : (rows, cols) array
        What the fit leaves of the pixels used (NaN elsewhere), image units.
    """

    pixels: Floats
    residual: Floats

    @property
    def noise(self) -> float:
        """Standard deviation of what the fit leaves, outliers aside, image units."""
        return robust_scale(self.residual[np.isfinite(self.residual)])


@dataclass(frozen=True, eq=False, kw_only=True)
class PeriodicMeasurement(Measurement):
    """A measurement of bars or of a star.

    Notes
    -----
    Of `without_details` the record, and so the document, is that of the whole measurement. Its
    covariance is rounded: deviations read from its curves again differ by 0.2 % at most.
    """

    def without_details(self) -> Self:
        """The same measurement without pixels and fits: light enough to be sent and kept."""
        light = super().without_details()
        if isinstance(self.otf.model, FittedOtf):
            packed = Otf2d(PackedOtf.of(self.otf.model), self.otf.gsd_m)
            light = replace(light, transfer=packed)
        vars(light)["record"] = self.record
        return light

    def __getstate__(self) -> dict[str, Any]:
        # A light measurement has the record of the whole one.
        light = {} if self.details is not None else {"record": self.record}
        return {**super().__getstate__(), **light}
