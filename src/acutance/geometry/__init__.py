"""Lines, bars and stars in the image plane, in pixels: rows downwards, columns to the right."""

from acutance.geometry.bar_group import Bars
from acutance.geometry.line import Line, Orientation
from acutance.geometry.star_geometry import SiemensStar

__all__ = ["Bars", "Line", "Orientation", "SiemensStar"]
