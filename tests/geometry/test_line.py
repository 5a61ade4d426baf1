"""Straight edges in the image plane."""

import math

import numpy as np
import pytest

from acutance.geometry import Line


def test_distances_along_the_normal_and_along_the_line():
    line = Line(10.0, 20.0, 30.0)
    row, col = 10.0 + 2 * 0.5 - 3 * math.sqrt(0.75), 20.0 + 2 * math.sqrt(0.75) + 3 * 0.5
    assert line.normal_distance(row, col) == pytest.approx(2.0)
    assert line.tangent_distance(row, col) == pytest.approx(-3.0)
    np.testing.assert_allclose(line.normal_distance([10.0, 12.0], [20.0, 20.0]), [0.0, 1.0])


@pytest.mark.parametrize(
    ("normal_deg", "orientation", "angle_deg"),
    [
        (6, "across", 6),
        (-174, "across", 6),
        (84, "along", 6),
        (-96, "along", 6),
        (44, "across", 44),
    ],
)
def test_the_nearer_axis(normal_deg, orientation, angle_deg):
    line = Line(0.0, 0.0, normal_deg)
    assert line.orientation == orientation
    assert line.angle_deg == pytest.approx(angle_deg, abs=1e-12)


def test_a_moved_line_keeps_its_direction_in_range():
    moved = Line(5.0, 6.0, 179.0, length_px=40.0).moved(2.0, 3.0)
    assert moved.normal_deg == pytest.approx(-178.0)
    assert moved.length_px == 40.0
    x, y = Line(5.0, 6.0, 179.0).normal
    assert (moved.col, moved.row) == (6.0 + 2 * x, 5.0 + 2 * y)


def test_a_line_without_length_has_none_in_json():
    assert Line(1.0, 2.0, 3.0).to_dict()["length_px"] is None
