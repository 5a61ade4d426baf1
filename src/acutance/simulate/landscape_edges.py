"""An edge of a landscape: all that is true of it, and what lies beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from acutance.curves import HasResponse, Response
from acutance.curves.grid import Floats
from acutance.geometry.line import Line, Orientation
from acutance.optics import Gaussian, Sensor
from acutance.simulate.noise import Noise
from acutance.simulate.parcel import Border

__all__ = ["LOOK_PX", "Beside", "BesideKind", "EdgeSide", "LandscapeEdge"]

BesideKind = Literal["rim", "gutter", "shadow", "road", "neighbour", "opposite", "image border"]
EdgeSide = Literal["dark", "bright"]

LOOK_PX = 40.0
"""What lies farther from an edge is not listed."""


@dataclass(frozen=True)
class Beside:
    """Something that lies along an edge.

    Parameters
    ----------
    kind : str
        "rim", "gutter" or "shadow" along this border; "road" or "neighbour", another parcel;
        "opposite", another border of the same parcel; "image border".
    side : {"dark", "bright"}
        Of the edge.
    near_px, far_px : float
        Between which distances from the edge it lies; the second is at most 40.
    contrast_share : float
        What it adds to the level on its side, as a share of the edge's contrast.
    """

    kind: BesideKind
    side: EdgeSide
    near_px: float
    far_px: float
    contrast_share: float


@dataclass(frozen=True, eq=False)
class LandscapeEdge(HasResponse):
    """One border in a landscape, and all that is true of it.

    ``response``, and with it ``mtf_nyquist``, ``rer``, ``fwhm_px`` and the curves, are those of the
    image along the normal: the sensor's times the softness of the border. `sensor_response` is the
    sensor's alone.

    Parameters
    ----------
    name : str
    ground_line : Line
        The border on the ground: its middle, the direction there from dark to bright, and the
        length that is free of corners.
    curvature_per_px : float
        One over its radius, above 0 when the centre lies on the bright side; 0 for a line.
    softness_px : float
        Standard deviation of the border's own Gaussian blur.
    dark, bright : float
        Levels on either side of the middle, without what lies beside.
    texture_dark, texture_bright : float
        Standard deviation of the texture on either side, in image units.
    beside : tuple of Beside
        What lies within 40 px on either side, the nearest first.
    sensor : Sensor
        The one at this place.
    noise : Noise, optional
        Noise that was added to the image.
    """

    name: str
    ground_line: Line
    curvature_per_px: float
    softness_px: float
    dark: float
    bright: float
    texture_dark: float
    texture_bright: float
    beside: tuple[Beside, ...]
    sensor: Sensor
    noise: Noise | None = None

    @property
    def contrast(self) -> float:
        """Difference of the levels on either side."""
        return self.bright - self.dark

    @property
    def radius_px(self) -> float:
        """Radius of the border; infinite for a line."""
        return math.inf if self.curvature_per_px == 0 else 1 / abs(self.curvature_per_px)

    @property
    def length_px(self) -> float:
        """Length that is free of corners."""
        return self.ground_line.length_px

    @property
    def orientation(self) -> Orientation:
        """The image axis the MTF belongs to."""
        return self.ground_line.orientation

    @property
    def snr(self) -> float:
        """Contrast over the mean standard deviation of the noise on both sides, without texture."""
        if self.noise is None:
            return math.inf
        std = float(np.mean(self.noise.std(np.array([self.dark, self.bright]))))
        return math.inf if std == 0 else self.contrast / std

    @property
    def clean_dark_px(self) -> float:
        """Distance on the dark side to the nearest thing beside the edge, at most 40."""
        return self._clean("dark")

    @property
    def clean_bright_px(self) -> float:
        """Distance on the bright side to the nearest thing beside the edge, at most 40."""
        return self._clean("bright")

    def _clean(self, side: EdgeSide) -> float:
        return min([one.near_px for one in self.beside if one.side == side], default=LOOK_PX)

    def kind(self, half_width_px: float = 20.0) -> BesideKind | Literal["clean"]:
        """What disturbs the edge most within a half width: of the highest contrast; or "clean"."""
        within = [one for one in self.beside if one.near_px < half_width_px]
        if not within:
            return "clean"
        return max(within, key=lambda one: abs(one.contrast_share)).kind

    def ends(self) -> Floats:
        """Both ends of the border on the ground, (2, 2) as (row, col)."""
        half = 0.5 * self.length_px
        return np.column_stack(self._border.point(np.array([-half, half])))

    def region(self, half_width_px: float = 20.0, *, clean: bool = False) -> Floats:
        """A rectangle around the edge, (4, 2) as (row, col); it may reach beyond the image.

        Parameters
        ----------
        half_width_px : float, optional
            Distance from the edge to its borders on either side.
        clean : bool, optional
            Leave out what lies beside the edge: no wider than the clean ground on either side.
        """
        dark = min(half_width_px, self.clean_dark_px) if clean else half_width_px
        bright = min(half_width_px, self.clean_bright_px) if clean else half_width_px
        half = 0.5 * self.length_px
        straight = replace(self._border, curvature_per_px=0.0)
        corners = [(-half, -dark), (half, -dark), (half, bright), (-half, bright)]
        return np.array([straight.point(along, across) for along, across in corners])

    @property
    def line(self) -> Line:
        """Where the image passes half way between the levels: off for an asymmetric sensor."""
        profile = self.system.profile(self.ground_line.normal_deg)
        return self.ground_line.moved(profile.half_px, 0.0)

    @cached_property
    def system(self) -> Sensor:
        """The sensor at this place and the softness of the border, as one."""
        if self.softness_px == 0:
            return self.sensor
        return replace(self.sensor, blocks=[*self.sensor.blocks, Gaussian(self.softness_px)])

    @cached_property
    def response(self) -> Response:
        """True curves of the image along the normal: sensor times softness."""
        return self.system.response_along(self.ground_line.normal_deg)

    @cached_property
    def sensor_response(self) -> Response:
        """True curves of the sensor alone along the normal."""
        return self.sensor.response_along(self.ground_line.normal_deg)

    @property
    def _border(self) -> Border:
        """The border with its normal to the bright side."""
        at = self.ground_line
        return Border(
            at.row, at.col, at.normal_deg, at.length_px, self.softness_px, self.curvature_per_px
        )
