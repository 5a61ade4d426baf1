"""Which edges of a scene are pieces of one border."""

import numpy as np
from bare_ground import small_scene

import acutance as ac
from acutance import simulate
from acutance.scan.borders import border_of_each
from acutance.scan.scene_edges import SceneEdges


def edges_at(*places):
    """Edges of 50 px at places (row, col, normal)."""
    names = ("row", "col", "normal_deg")
    return SceneEdges.of_rows([
        {**dict(zip(names, place, strict=True)), "length_px": 50.0} for place in places
    ])  # fmt: skip


def along(normal_deg, distance_px, offset_px=0.0):
    """A place so far along a line through (500, 500), and off it."""
    x, y = np.cos(np.radians(normal_deg)), np.sin(np.radians(normal_deg))
    return 500 + x * distance_px + y * offset_px, 500 - y * distance_px + x * offset_px, normal_deg


def numbers(*places):
    return border_of_each(edges_at(*places)).tolist()


def test_pieces_of_one_line_are_one_border_whatever_lies_between_them():
    assert numbers(along(30, 0), along(30, 50), along(30.5, 105), along(30, 210)) == [0, 0, 0, 0]


def test_the_other_side_the_next_row_and_what_is_far_away_are_borders_of_their_own():
    opposite = (*along(30, 50)[:2], -150)
    assert numbers(along(30, 0), opposite) == [0, 1]
    assert numbers(along(30, 0), along(30, 0, 6)) == [0, 1]
    assert numbers(along(30, 0), along(30, 300)) == [0, 1]
    assert numbers(along(30, 0), along(40, 50)) == [0, 1]


def test_a_line_whose_normal_has_the_angle_at_which_counting_begins():
    assert numbers(along(179.5, 0), along(-179.9, 50)) == [0, 0]


def test_no_edge_and_one_edge():
    assert numbers() == []
    assert numbers((1.0, 2.0, 3.0)) == [0]


def test_a_scan_of_few_ideal_borders_is_doubtful():
    """The sharpest of each direction agree with an uneven sensor, which is likelier."""
    sensor = simulate.reference_systems()["gaussian"]
    scene = ac.scan_scene(small_scene(sensor, 320, 0.9, (50, 320)))
    found = next(check for check in scene.checks if check.name == "ideal_borders")
    assert found.value < 4
    assert found.severity == "caution"
    assert "of 6 borders" in found.message
    assert scene.verdict.word == "doubtful"
