"""The result of a measurement of bars: readings and one optical transfer function (OTF)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from acutance.curves import Estimate, Response
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.geometry.angles import axis_difference
from acutance.geometry.bar_group import Bars
from acutance.geometry.line import Orientation
from acutance.targets.measurement import Measurement
from acutance.targets.periodic.bars_readings import GroupReading
from acutance.targets.periodic.periodic_details import PeriodicDetails
from acutance.targets.record import rounded
from acutance.targets.slices import OtfSlices

__all__ = ["BarsDetails", "BarsGroup", "BarsMeasurement", "GroupProfile"]

_MAX_OFF_NORMAL_DEG = 30.0
"""An axis further from every normal than this was not measured."""


@dataclass(frozen=True)
class BarsGroup(ShortRepr):
    """The result of one group of bars.

    Attributes
    ----------
    bars : Bars
        Where it is, in pixels of the whole image.
    period_px : Estimate
        Its period.
    mtf : Estimate
        MTF at its frequency along its normal, from the joint fit.
    reading : GroupReading
        The plain reading: a sinusoid, and the contrast of the square bars.
    coltman : float
        MTF from the contrasts of all groups of this direction by Coltman's series.
    """

    bars: Bars
    period_px: Estimate
    mtf: Estimate
    reading: GroupReading
    coltman: float

    @property
    def freq_cpp(self) -> float:
        """Frequency of the bars in cycles per pixel."""
        return self.bars.freq_cpp

    def to_dict(self) -> dict[str, Any]:
        """Place, MTF and plain readings, for JSON."""
        reading = self.reading
        return {
            **self.bars.to_dict(),
            "period_px": self.period_px.to_dict(),
            "freq_cpp": self.freq_cpp,
            "mtf": self.mtf.to_dict(),
            "modulation": Estimate(reading.modulation, reading.modulation_std).to_dict(),
            "ctf": Estimate(reading.ctf, reading.ctf_std).to_dict(),
            "coltman_mtf": self.coltman if math.isfinite(self.coltman) else None,
        }


@dataclass(frozen=True, eq=False)
class GroupProfile(ShortRepr):
    """The pixels of one group along its normal.

    Attributes
    ----------
    across_px : (n,) array
        Distance along the normal from the centre of the group.
    value, fitted : (n,) arrays
        Level and fitted level: 0 is the background, 1 a wide bar.
    """

    across_px: Floats
    value: Floats
    fitted: Floats


@dataclass(frozen=True, eq=False)
class BarsDetails(PeriodicDetails):
    """The heavy half of a measurement of bars: pixels and residuals, and the groups' profiles.

    Attributes
    ----------
    profiles : tuple of GroupProfile
        In the order of the groups.
    """

    profiles: tuple[GroupProfile, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class BarsMeasurement(Measurement):
    """A measurement of groups of bars.

    Parameters
    ----------
    groups : tuple of BarsGroup
        In the order they were stated or found.
    directions_deg : tuple of float
        Measured directions, across the bars, from the column axis towards the row axis; the one
        nearest to across track first.
        Other directions follow from the prior, which all sensors have in common.
    contrast : Estimate
        Bars minus background, before the sensor.
    """

    groups: tuple[BarsGroup, ...]
    directions_deg: tuple[float, ...]
    contrast: Estimate
    details: BarsDetails | None = None

    @cached_property
    def normal_response(self) -> Response:
        """The curves and numbers along the normal that is nearest to across track."""
        return self.response_at(self.directions_deg[0])

    @property
    def measured_directions(self) -> tuple[Orientation, ...]:
        """Those of "across" and "along" that lie within 30 degrees of a normal.

        Bars of one direction that is far from both measure the nearer one best.
        """
        off = {
            name: min(axis_difference(axis, normal) for normal in self.directions_deg)
            for name, axis in self.axes_deg.items()
        }
        nearest = min(off.values())
        return tuple(name for name in off if off[name] <= max(_MAX_OFF_NORMAL_DEG, nearest))

    def is_first_direction(self, group: BarsGroup) -> bool:
        """Whether a group's normal is nearer to the first direction than to any other."""
        off = [axis_difference(group.bars.normal_deg, normal) for normal in self.directions_deg]
        return off[0] == min(off)

    @cached_property
    def slices(self) -> OtfSlices:
        """Slices of the OTF in the directions across the bars, the only ones measured."""
        return OtfSlices.of_otf2d(self.otf, self.directions_deg)

    def target_document(self) -> dict[str, Any]:
        """Groups and directions, for JSON."""
        along_normal = self.normal_response
        curve = along_normal.mtf.to_dict()
        return {
            "directions_deg": list(self.directions_deg),
            "contrast": self.contrast.to_dict(),
            "normal": {
                "angle_deg": self.directions_deg[0],
                **{name: one.to_dict() for name, one in along_normal.metrics().items()},
                "mtf": {name: rounded(values) for name, values in curve.items()},
            },
            "groups": [group.to_dict() for group in self.groups],
        }
