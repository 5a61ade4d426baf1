"""Finding sources, and naming what is none."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from acutance import optics, simulate
from acutance.errors import TargetError
from acutance.targets.points.detect import find_spots, sort_spots
from acutance.targets.points.match_places import match_spots
from acutance.targets.points.stamps import cut_stamps

SENSOR = optics.Sensor([optics.Gaussian(0.45), optics.Detector()])
PLACES = np.array(
    [[20.3, 20.1], [20.7, 60.4], [60.2, 20.6], [60.4, 60.3], [100.1, 20.2], [100.6, 60.7]]
)


@pytest.fixture
def scene():
    image, _ = simulate.points(
        SENSOR, positions=PLACES, shape=(120, 80), snr=60, rng=np.random.default_rng(4)
    )
    return image


def sorted_by_reason(image, saturation=None):
    spots, residual, noise = find_spots(image)
    kept, rejected, _ = sort_spots(
        image, residual, spots,
        saturation=saturation, noise=noise, min_snr=10.0, min_distance_px=4.0,
    )  # fmt: skip
    return kept, {(round(one.row), round(one.col)): one.reason for one in rejected}


def test_all_sources_are_found_where_they_are(scene):
    kept, _ = sorted_by_reason(scene)
    found = np.array(sorted((one.row, one.col) for one in kept))
    assert found.shape == PLACES.shape
    assert np.abs(found - PLACES).max() < 0.35


def test_what_is_no_point_is_rejected_by_name(scene):
    image = scene.copy()
    image[40, 40] += 5000.0
    image[80, 40:45] += 900.0
    blend, _ = simulate.points(SENSOR, positions=[[40.0, 10.2], [42.4, 10.3]], shape=(120, 80))
    image += blend - 200.0
    image[0:3, 30:33] += 800.0
    image[19:22, 59:62] = 3000.0
    kept, reasons = sorted_by_reason(image, saturation=3000.0)
    assert reasons[40, 40] == "hot pixel"
    assert {reasons[place] for place in reasons if place[0] == 80} == {"cosmic ray"}
    assert {reasons[place] for place in reasons if place[1] == 10} == {"blended"}
    assert reasons[1, 31] == "edge"
    assert "saturated" in reasons.values()
    assert len(kept) == len(PLACES) - 1


def test_twelve_bits_in_sixteen_are_clipped_where_values_pile_up(scene):
    limit = float(np.rint(np.percentile(scene, 99.8)))
    clipped = np.minimum(np.rint(scene), limit)
    kept, reasons = sorted_by_reason(clipped, saturation=65535.0)
    assert "saturated" in reasons.values()
    assert len(kept) < len(PLACES)


def test_a_narrow_track_is_a_cosmic_ray(scene):
    image = scene.copy()
    for i in range(3):
        image[80 + i, 40] += 900.0
    _, reasons = sorted_by_reason(image)
    assert reasons[81, 40] == "cosmic ray"


@pytest.mark.parametrize("sigma_px", [0.3, 0.45, 0.8])
def test_no_source_is_rejected_for_its_phase_or_its_noise(sigma_px):
    """A source between two pixels looks twice as wide as one in the middle of a pixel."""
    sensor = optics.Sensor([optics.Gaussian(sigma_px), optics.Detector()])
    for seed in range(5):
        rng = np.random.default_rng(seed)
        layout = simulate.mirror_columns((12.0, 12.0)) + rng.uniform(0, 1, (1, 2))
        image, _ = simulate.points(sensor, positions=layout, snr=50, rng=rng)
        kept, reasons = sorted_by_reason(image)
        assert len(kept) == len(layout), reasons


def test_two_places_of_one_source_are_one_source(scene):
    spots, missing = match_spots(find_spots(scene)[0], np.array([[20.0, 20.0], [20.9, 20.4]]))
    assert len(spots) == 1
    assert [one.reason for one in missing] == ["no source"]


def test_a_place_without_light_is_said_to_be_empty(scene):
    spots, missing = match_spots(find_spots(scene)[0], np.array([[20.0, 20.0], [50.0, 40.0]]))
    assert len(spots) == 1
    assert [one.reason for one in missing] == ["no source"]


def test_flat_and_broken_images_hold_nothing():
    flat = np.full((40, 40), 7.0)
    assert find_spots(flat)[0] == ()
    holes = np.full((40, 40), np.nan)
    holes[:12, :12] = 3.0
    assert find_spots(holes)[0] == ()


def test_grass_under_a_source_makes_it_no_hot_pixel():
    sharp = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])
    for seed in range(6):
        rng = np.random.default_rng(seed)
        image, _ = simulate.points(sharp, positions=PLACES, shape=(120, 80), snr=60, rng=rng)
        grass = gaussian_filter(rng.standard_normal(image.shape), 3.0)
        _, reasons = sorted_by_reason(image + 25.0 * grass / grass.std())
        near = [np.abs(PLACES - place).max(axis=1).min() < 2 for place in reasons]
        assert not any(near), reasons


def test_a_spot_whose_light_is_gone_is_no_division_by_zero(scene):
    # Found by fuzz.py, seed 12, draw 652: clipping takes what stood above the background.
    spots, residual, noise = find_spots(scene)
    sorted_spots = sort_spots(
        scene, np.minimum(residual, 0.0), spots,
        saturation=None, noise=noise, min_snr=10.0, min_distance_px=4.0,
    )  # fmt: skip
    assert {one.reason for one in sorted_spots.rejected} == {"hot pixel"}
    assert all("hold 0 % of the brightest" in one.message for one in sorted_spots.rejected)


def test_a_source_without_a_pixel_is_refused(scene):
    # Found by fuzz.py, seed 12, draws 287 and 1713.
    with pytest.raises(TargetError, match=r"row 20\.3, column 20\.1 has no pixel of its own"):
        cut_stamps(np.where(np.indices(scene.shape)[1] < 40, np.nan, scene), PLACES[:2], 8.0)


@pytest.mark.parametrize("toward", range(0, 360, 40))
def test_places_are_matched_to_a_pixel_and_a_half_in_every_direction(scene, toward):
    """From the centroid: the brightest pixel is up to .7 px from it."""
    angle = np.radians(toward)
    spots, missing = match_spots(
        find_spots(scene)[0], PLACES + 1.45 * np.array([np.sin(angle), np.cos(angle)])
    )
    assert len(spots) == len(PLACES)
    assert missing == ()


def test_a_place_too_far_from_the_light_is_told_how_far_that_is(scene):
    missing = match_spots(find_spots(scene)[0], PLACES[:1] + np.array([2.4, 0.0]))[1]
    assert re.search(r"is 2\.[345] px away, places are needed to 1\.5 px", missing[0].message)
    empty = match_spots(find_spots(scene)[0], np.array([[40.0, 40.0]]))[1]
    assert "no light stands out" in empty[0].message


@pytest.mark.parametrize("snr", [None, 60.0])
def test_a_source_halfway_between_pixels_is_found_once(snr):
    """Both pixels are as bright as one another, without noise or rounded to few steps."""
    places = PLACES.copy()
    places[:3] = [[20.3, 20.5], [20.5, 60.5], [60.5, 20.0]]
    image, _ = simulate.points(
        SENSOR, positions=places, shape=(120, 80), snr=snr, rng=np.random.default_rng(4)
    )
    for step in (1e-9, 25.0):
        kept, _ = sorted_by_reason(step * np.rint(image / step))
        assert len(kept) == len(places)
