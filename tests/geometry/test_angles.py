"""Directions and axes: wrapping, differences, the angle to the grid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from acutance.geometry.angles import (
    angle_to_grid,
    axis_difference,
    direction_difference,
    is_nearer_columns,
    wrap_axis,
    wrap_direction,
)

ANGLES = st.integers(-7200, 7200).map(lambda tenths: tenths / 8)


@pytest.mark.parametrize(
    ("angle", "direction", "axis"),
    [(0, 0, 0), (180, 180, 0), (-180, 180, 0), (190, -170, 10), (-90, -90, -90), (90, 90, -90)],
)
def test_wrapping(angle, direction, axis):
    assert wrap_direction(float(angle)) == direction
    assert wrap_axis(float(angle)) == axis


@given(ANGLES, st.integers(-3, 3))
def test_whole_turns_change_no_direction_and_half_turns_no_axis(angle, turns):
    assert wrap_direction(angle + 360.0 * turns) == wrap_direction(angle)
    assert wrap_axis(angle + 180.0 * turns) == wrap_axis(angle)
    assert -180 < wrap_direction(angle) <= 180
    assert -90 <= wrap_axis(angle) < 90


@pytest.mark.parametrize(
    ("one", "other", "directions", "axes"),
    [(10, 350, 20, 20), (0, 180, 180, 0), (95, -80, 175, 5), (-179, 179, 2, 2), (30, 120, 90, 90)],
)
def test_differences_are_the_same_both_ways(one, other, directions, axes):
    for a, b in ((one, other), (other, one)):
        assert direction_difference(float(a), float(b)) == directions
        assert axis_difference(float(a), float(b)) == axes


def test_arrays_of_directions():
    np.testing.assert_array_equal(direction_difference(np.array([10.0, 200.0]), 350.0), [20, 150])
    np.testing.assert_array_equal(axis_difference(np.array([10.0, 200.0]), 350.0), [20, 30])


@pytest.mark.parametrize(
    ("direction", "angle", "nearer_columns"),
    [(0, 0, True), (-6, 6, True), (44, 44, True), (46, 44, False), (96, 6, False), (174, 6, True)],
)
def test_the_angle_to_the_grid(direction, angle, nearer_columns):
    assert angle_to_grid(float(direction)) == pytest.approx(angle, abs=1e-12)
    assert is_nearer_columns(float(direction)) is nearer_columns
