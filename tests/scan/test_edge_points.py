"""Edge points and segments: where edges are, to fractions of a pixel."""

import math

import numpy as np
import pytest

from acutance import simulate
from acutance.raster import Box
from acutance.scan.edge_points import edge_points, gradient
from acutance.scan.pieces import pieces, region_box
from acutance.scan.segments import find_segments
from acutance.scan.windows import windows

SENSOR = simulate.reference_systems()["gaussian"]


def segments_of(image, min_length_px=15.0):
    points = edge_points(gradient(image))
    return list(find_segments(points, image.shape, min_length_px))


@pytest.mark.parametrize("angle_deg", [3.0, 17.0, 44.0])
@pytest.mark.parametrize("polarity", ["rising", "falling"])
def test_an_edge_is_one_segment_on_its_line(angle_deg, polarity):
    rng = np.random.default_rng(2)
    image, truth = simulate.edge(
        SENSOR, angle_deg=angle_deg, polarity=polarity, shape=(80, 80), snr=50, rng=rng
    )
    (found,) = segments_of(image)
    turn = (found.line.normal_deg - truth.line.normal_deg + 180) % 360 - 180
    assert abs(turn) < 0.5
    assert abs(float(truth.line.normal_distance(found.line.row, found.line.col))) < 0.15
    assert found.stop_px - found.start_px > 65


def test_edge_points_lie_between_pixels_on_the_line():
    image, truth = simulate.edge(SENSOR, angle_deg=10, shape=(60, 60))
    points = edge_points(gradient(image))
    away = truth.line.normal_distance(points.row, points.col)
    assert float(np.sqrt(np.mean(away**2))) < 0.06


def test_the_noise_of_the_ground_is_found():
    rng = np.random.default_rng(1)
    assert gradient(rng.normal(0, 7, (200, 200))).pixel_noise == pytest.approx(7, rel=0.05)


def test_noise_alone_has_no_edges():
    rng = np.random.default_rng(1)
    assert segments_of(rng.normal(0, 7, (300, 300))) == []


def test_missing_pixels_make_no_edges():
    rng = np.random.default_rng(4)
    image = rng.normal(100, 1, (80, 80))
    image[20:50, 30:60] = np.nan
    assert segments_of(image) == []
    assert segments_of(np.full((40, 40), np.nan)) == []


def test_a_square_has_four_segments_and_no_corners():
    scene = np.zeros((120, 120))
    row, col = np.mgrid[:120, :120] - 60.0
    turned = math.radians(12)
    along, across = (
        np.cos(turned) * row + np.sin(turned) * col,
        np.cos(turned) * col - np.sin(turned) * row,
    )
    scene = 100 / (1 + np.exp(3 * (np.maximum(abs(along), abs(across)) - 30)))
    found = segments_of(scene)
    assert len(found) == 4
    assert all(45 < one.stop_px - one.start_px < 61 for one in found)


def test_pieces_cover_what_lies_in_the_core_once():
    image, _ = simulate.edge(SENSOR, angle_deg=20, shape=(200, 200), snr=100,
                             rng=np.random.default_rng(0))  # fmt: skip
    (whole,) = segments_of(image)
    length = 0.0
    for window in windows(Box(0, 0, 200, 200), 70, (200, 200), 20.0):
        for one in pieces(whole, window.core, 5.0, 40.0):
            assert one.stop_px - one.start_px <= 40.0
            inside = (
                window.core.row - 1 <= one.line.row <= window.core.row + window.core.height,
                window.core.col - 1 <= one.line.col <= window.core.col + window.core.width,
            )
            assert all(inside)
            length += one.stop_px - one.start_px
    assert length == pytest.approx(whole.stop_px - whole.start_px, abs=12)


def test_windows_cover_a_box_once():
    count = np.zeros((300, 500), int)
    for window in windows(Box(20, 30, 250, 410), 128, (300, 500), 20.0):
        count[window.core.slices] += 1
        assert max(window.core.shape) <= 128
        assert window.whole.intersection(Box(0, 0, 300, 500)) == window.whole
    assert count[20:270, 30:440].all()
    assert count.max() == 1
    assert count.sum() == 250 * 410


@pytest.mark.parametrize(("half_width_px", "margin_px"), [(20.0, 32), (60.0, 60)])
def test_windows_reach_as_far_as_the_regions_of_their_edges(half_width_px, margin_px):
    for window in windows(Box.whole((1300, 1300)), 650, (1300, 1300), half_width_px):
        reach = window.core.grown(margin_px).intersection(Box.whole((1300, 1300)))
        assert window.whole == reach


@pytest.mark.parametrize(
    ("shape", "count"), [((500, 500), 1), ((1000, 1000), 4), ((2048, 2000), 16), ((9000, 300), 9)]
)
def test_windows_of_small_images_are_smaller_so_that_all_processes_have_some(shape, count):
    assert len(list(windows(Box.whole(shape), 1024, shape, 20.0))) == count


def test_the_region_of_a_piece_holds_it_with_ground_on_both_sides():
    image, _ = simulate.edge(SENSOR, angle_deg=30, shape=(120, 120))
    (segment,) = segments_of(image)
    (piece,) = pieces(segment, Box(40, 40, 40, 40), 5.0, 64.0)
    box = region_box(piece, 20.0, Box(0, 0, 120, 120))
    x, y = piece.line.normal
    for along in (piece.start_px, piece.stop_px):
        for away in (-19.0, 19.0):
            row = piece.line.row + along * x + away * y
            col = piece.line.col - along * y + away * x
            assert box.row <= row < box.row + box.height
            assert box.col <= col < box.col + box.width
