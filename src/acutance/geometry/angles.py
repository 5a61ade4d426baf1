"""Angles between directions that have no sign, as normals of bars and axes have none."""

from __future__ import annotations

__all__ = ["angle_between_deg", "turn_deg"]


def turn_deg(one_deg: float, other_deg: float) -> float:
    """The turn from one direction to another, -90 up to 90 degrees."""
    return (other_deg - one_deg + 90.0) % 180.0 - 90.0


def angle_between_deg(one_deg: float, other_deg: float) -> float:
    """The angle between two directions, 0 to 90 degrees."""
    return abs(turn_deg(one_deg, other_deg))
