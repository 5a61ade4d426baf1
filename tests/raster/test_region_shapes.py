"""Boxes and polygons: which pixels they hold."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acutance.errors import RegionError
from acutance.raster import Box, Region


def test_a_box_cuts_an_array():
    image = np.arange(20).reshape(4, 5)
    assert image[Box(1, 2, 2, 3).slices].tolist() == [[7, 8, 9], [12, 13, 14]]
    assert Box(np.int64(1), 2, 2, 3).as_tuple() == (1, 2, 2, 3)
    assert Box(1, 2, 2, 3).shape == (2, 3)
    assert Box(5, 5, 2, 2).grown(3) == Box(2, 2, 8, 8)


@pytest.mark.parametrize("numbers", [(0, 0, 0, 5), (0, 0, 5, -1), (0.5, 0, 3, 3), ("1", 0, 3, 3)])
def test_a_box_that_means_nothing_is_refused(numbers):
    with pytest.raises(RegionError):
        Box(*numbers)


def test_boxes_intersect():
    assert Box(0, 0, 10, 10).intersection(Box(5, -3, 10, 7)) == Box(5, 0, 5, 4)
    assert Box(0, 0, 10, 10).intersection(Box(10, 0, 2, 2)) is None


def test_a_box_beyond_the_image_says_what_is_inside():
    Box(0, 0, 10, 20).require_inside((10, 20))
    with pytest.raises(RegionError, match="part inside is 5,0,5,20 "):
        Box(5, 0, 10, 20).require_inside((10, 20))
    with pytest.raises(RegionError, match="lies outside the image of 10 rows x 20 columns"):
        Box(10, 0, 1, 1).require_inside((10, 20))


def test_the_region_of_a_box_holds_exactly_its_pixels():
    box = Box(3, 4, 5, 6)
    region = Region.from_box(box)
    assert region.box((100, 100)) == box
    mask = region.mask(box.grown(2))
    assert mask.sum() == 30
    assert mask[2:-2, 2:-2].all()


def test_a_polygon_holds_the_centres_inside_it():
    diamond = Region(np.array([[0.0, 5.0], [5.0, 10.0], [10.0, 5.0], [5.0, 0.0], [0.0, 5.0]]))
    assert len(diamond.vertices) == 4
    box = Box(-1, -1, 13, 13)
    row, col = np.mgrid[-1:12, -1:12]
    distance = abs(row - 5) + abs(col - 5)
    mask = diamond.mask(box)
    assert mask[distance < 5].all()
    assert not mask[distance > 5].any()


def test_polygons_that_share_a_side_share_no_pixel():
    left = Region(np.array([[0.0, 0.0], [0.0, 5.0], [9.0, 2.0], [9.0, 0.0]]))
    right = Region(np.array([[0.0, 5.0], [0.0, 9.0], [9.0, 9.0], [9.0, 2.0]]))
    both = Region(np.array([[0.0, 0.0], [0.0, 9.0], [9.0, 9.0], [9.0, 0.0]]))
    box = Box(-1, -1, 12, 12)
    assert not (left.mask(box) & right.mask(box)).any()
    assert np.array_equal(left.mask(box) | right.mask(box), both.mask(box))
    assert both.mask(box).sum() == 81


def test_a_hole_is_left_out():
    outline = Region.from_box(Box(0, 0, 10, 10)).vertices
    hole = Region.from_box(Box(3, 4, 2, 3)).vertices
    mask = Region(outline, (hole,)).mask(Box(0, 0, 10, 10))
    assert mask.sum() == 94
    assert not mask[3:5, 4:7].any()


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.floats(-20, 40), st.floats(-20, 40)), min_size=3, max_size=9, unique=True)
)
def test_the_mask_is_that_of_the_even_odd_rule(corners):
    try:
        region = Region(np.array(corners))
    except RegionError:
        return
    box = Box(-3, 2, 12, 15)
    mask = region.mask(box)
    for row, col in [(-3, 2), (0, 9), (4, 3), (8, 16), (5, 10)]:
        inside = False
        for (r0, c0), (r1, c1) in zip(corners, corners[1:] + corners[:1], strict=True):
            if (r0 <= row) != (r1 <= row):
                inside ^= c0 + (row - r0) / (r1 - r0) * (c1 - c0) <= col
        assert mask[row - box.row, col - box.col] == inside


@settings(deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(-20, 40), st.floats(-20, 40)), min_size=3, max_size=7, unique=True
    ),
    st.sampled_from([0.5, 3.0, 11.0]),
)
def test_a_margin_holds_what_is_near_any_side(corners, margin_px):
    try:
        region = Region(np.array(corners), margin_px=margin_px)
    except RegionError:
        return
    box = Box(-3, 2, 12, 15)
    places = np.stack(np.mgrid[-3:9, 2:17], axis=-1).astype(float)
    distance = np.full(box.shape, np.inf)
    for first, last in zip(region.vertices, np.roll(region.vertices, -1, axis=0), strict=True):
        step, away = last - first, places - first
        along = np.clip(away @ step / max(step @ step, 1e-300), 0.0, 1.0)
        distance = np.minimum(distance, np.linalg.norm(away - along[..., None] * step, axis=-1))
    expected = Region(region.vertices).mask(box) | (distance <= margin_px)
    is_clear = np.abs(distance - margin_px) > 1e-6
    assert np.array_equal(region.mask(box)[is_clear], expected[is_clear])


def test_a_margin_widens_the_outline_and_narrows_holes():
    outline = Region.from_box(Box(20, 30, 40, 10)).vertices
    hole = Region.from_box(Box(30, 32, 20, 6)).vertices
    region = Region(outline, (hole,), margin_px=2.0)
    box = region.box((100, 100))
    assert box == Box(18, 28, 44, 14)
    mask = region.mask(box)
    assert mask[0, 2:-2].all()
    assert mask[2:-2, [0, -1]].all()
    assert not mask[0, [0, -1]].any()
    assert np.argwhere(~mask[4:-4, 4:-4]).min(axis=0).tolist() == [10, 2]
    assert Region(outline, margin_px=2.0).box((50, 50)) == Box(18, 28, 32, 14)
    with pytest.raises(RegionError, match="margin of a region is -1 px"):
        Region(outline, margin_px=-1.0)


def test_a_region_is_cut_at_the_border_and_refused_outside():
    region = Region.from_box(Box(-5, 8, 10, 10))
    assert region.box((20, 12)) == Box(0, 8, 5, 4)
    with pytest.raises(RegionError, match="outside the image"):
        region.box((20, 5))
    with pytest.raises(RegionError, match="holds no pixel centre"):
        Region(np.array([[1.2, 1.2], [1.2, 1.8], [1.8, 1.5]])).box((20, 20))
    with pytest.raises(RegionError, match="holds no pixel centre"):
        Region(np.array([[0.1, 0.2], [9.0, 9.3], [9.2, 9.4]])).box((20, 20))


def test_the_box_of_a_whole_scene_needs_little_memory():
    region = Region.from_box(Box(0, 0, 40_000, 40_000))
    assert region.box((40_000, 40_000)) == Box(0, 0, 40_000, 40_000)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([[0, 0], [1, 1]], "2 corners"),
        ([[0, 0], [1, 1], [2, 2], [0, 0]], "one line"),
        ([[0, 0], [0, np.nan], [2, 2]], "finite"),
        ([0, 1, 2], "pairs"),
        ([[0, 0, 0], [1, 1, 1], [2, 0, 1]], "pairs"),
    ],
)
def test_an_outline_without_an_inside_is_refused(corners, message):
    with pytest.raises(RegionError, match=message):
        Region(np.array(corners, dtype=float))


def test_a_region_does_not_follow_the_array_it_was_made_from():
    corners = np.array([[0.0, 0.0], [0.0, 4.0], [4.0, 0.0]])
    region = Region(corners)
    corners += 10
    assert region.box((20, 20)).row == 0
    with pytest.raises(ValueError, match="read-only"):
        region.vertices[0, 0] = 3


@pytest.mark.parametrize("order", [(0, 1, 3, 2), (0, 2, 1, 3), (1, 3, 2, 0)])
def test_four_corners_out_of_their_order_are_refused(order: tuple[int, ...]) -> None:
    around = np.array([[2.0, 3.0], [2.0, 30.0], [25.0, 33.0], [20.0, 1.0]])
    Region(around)
    Region(around[::-1])
    with pytest.raises(RegionError, match="cross: give its corners in the order"):
        Region(around[list(order)])


def test_four_corners_with_a_notch_are_a_region() -> None:
    Region(np.array([[0.0, 0.0], [0.0, 30.0], [30.0, 30.0], [10.0, 20.0]]))
