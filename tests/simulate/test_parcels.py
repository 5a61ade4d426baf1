"""Parcels: exact against closed forms and against fine squares, in place and in shape."""

import numpy as np
import pytest

from acutance.errors import ModelError
from acutance.optics import Detector, Gaussian, Sensor
from acutance.simulate import (
    Border,
    Parcel,
    Patch,
    SideStrip,
    reference_systems,
    render_parcels,
    render_patches,
    render_raster,
)
from acutance.simulate.landscape_objects import polygon
from acutance.simulate.parcel_image import fine_samples, reach_of_light

SYSTEMS = reference_systems()
SHARP = Sensor([Gaussian(0.3), Detector()])


def rectangle(turn_deg, width, height, row, col, contrast=100.0):
    normals = turn_deg + 90.0 * np.arange(4)
    found = polygon("roof", normals, 0.5 * np.array([width, height] * 2), contrast)
    return found.moved(row, col)


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("turn", [0.0, 6.0, 33.0])
def test_a_rectangle_agrees_with_the_closed_form_of_its_spectrum(name, turn):
    """Two renderers that share nothing: soft samples, and sinc functions in all alias bands."""
    sensor, shape = SYSTEMS[name], (160, 160)
    found, _ = render_parcels(
        sensor, [rectangle(turn, 40.0, 50.0, 80.3, 79.6)], shape, subpixels=fine_samples(sensor)
    )
    patch = Patch(80.3, 79.6, 40.0, 50.0, turn, 100.0)
    expected = render_patches(sensor, [patch], shape, margin_px=0)
    # Corners too; the closed form leaves out alias bands below 1e-5 of the contrast.
    np.testing.assert_allclose(found, expected, atol=2e-3)


@pytest.mark.parametrize("softness", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("sensor", [SHARP, SYSTEMS["asymmetric"]], ids=["sharp", "asymmetric"])
def test_softness_is_a_gaussian_of_the_sensor(sensor, softness):
    parcel = rectangle(17.0, 60.0, 60.0, 60.2, 59.7)
    soft = tuple(
        Border(one.row, one.col, one.normal_deg, one.length_px, softness) for one in parcel.borders
    )
    parcel = Parcel("field", parcel.row, parcel.col, soft, 100.0)
    found, _ = render_parcels(sensor, [parcel], (120, 120), subpixels=fine_samples(sensor))
    whole = Sensor([*sensor.blocks, Gaussian(softness)]) if softness > 0 else sensor
    rows, cols = np.indices(found.shape)
    for border in soft:
        along, across = border.along_and_across(rows, cols)
        near = (np.abs(along) < 15) & (np.abs(across) < 12)
        esf = whole.profile(border.normal_deg).esf(across[near])
        # 4e-6 of the contrast: 1e-5 of the MTF at Nyquist.
        np.testing.assert_allclose(found[near], 100 * esf, atol=4e-4)


@pytest.mark.parametrize("curvature", [1 / 300, -1 / 300, 1 / 40])
def test_an_arc_lies_where_fine_squares_show_it(curvature):
    """Ground drawn in squares of 1/20 px, an independent renderer: the place agrees to .001 px."""
    sensor, size, fine = SYSTEMS["gaussian"], 48, 20
    border = Border(23.7, 22.2, 12.0, 90.0, 0.0, curvature)
    found, _ = render_parcels(sensor, [Parcel("field", 23.7, 40.0, (border,), 100.0)], (size, size))
    places = (np.arange(size * fine) + 0.5) / fine - 0.5
    inside = border.distance(places[:, None], places[None, :])
    squares = np.clip(0.5 + fine * inside, 0.0, 1.0)
    expected = 100 * render_raster(sensor, squares, fine)
    rows, cols = np.indices(found.shape)
    near = np.abs(border.distance(rows, cols)) < 1.5
    near[:14], near[-14:], near[:, :8], near[:, -8:] = False, False, False, False
    slope = 100 * sensor.profile(12.0).lsf(0.0)
    assert near.sum() > 40
    assert np.max(np.abs(found - expected)[near]) / slope < 1e-3


def test_points_of_an_arc_lie_on_it_and_parts_belong_to_it():
    arc = Border(50.0, 60.0, 130.0, 80.0, 0.0, 1 / 300)
    along = np.linspace(-40, 40, 17)
    rows, cols = arc.point(along)
    np.testing.assert_allclose(arc.distance(rows, cols), 0.0, atol=1e-10)
    np.testing.assert_allclose(arc.distance(*arc.point(along, 7.5)), 7.5)
    steps = np.hypot(np.diff(rows), np.diff(cols))
    np.testing.assert_allclose(steps, 600 * np.sin(5 / 600))
    part = arc.part(10.0, 40.0)
    assert part.length_px == 30.0
    np.testing.assert_allclose(part.point(15.0), arc.point(40.0))
    np.testing.assert_allclose(part.distance(0.0, 0.0), arc.distance(0.0, 0.0))
    line = Border(50.0, 60.0, 130.0, 80.0)
    np.testing.assert_allclose(line.distance(*line.point(along, -3.0)), -3.0)
    bent = Border(50.0, 60.0, 130.0, 80.0, 0.0, 1e-9)
    np.testing.assert_allclose(bent.distance(10.0, 20.0), line.distance(10.0, 20.0), atol=1e-5)


@pytest.mark.parametrize(("near", "far"), [(0.0, 2.0), (-6.0, -3.5), (3.0, 4.2)])
def test_a_strip_lies_at_its_place(near, far):
    sensor, shape = SYSTEMS["gaussian"], (120, 120)
    bare = rectangle(20.0, 60.0, 60.0, 60.0, 60.0)
    strip = SideStrip(2, "rim", near, far, -9.0)
    with_it = Parcel("roof", 60.0, 60.0, bare.borders, 100.0, strips=(strip,))
    added = render_parcels(sensor, [with_it], shape)[0] - render_parcels(sensor, [bare], shape)[0]
    border = bare.borders[2]
    along, across = border.along_and_across(*np.indices(shape))
    kept = np.abs(along) < 20
    esf = sensor.profile(border.normal_deg).esf
    expected = -9.0 * (esf(across - near) - esf(across - far))
    np.testing.assert_allclose(added[kept], expected[kept], atol=1e-4)


def test_a_parcel_slopes_about_its_centre():
    parcel = rectangle(30.0, 40.0, 40.0, 50.0, 48.0)
    sloping = Parcel("field", 50.0, 48.0, parcel.borders, 100.0, 0.5, -0.25)
    image, covers = render_parcels(SYSTEMS["gaussian"], [sloping], (100, 100))
    assert image[50, 48] == pytest.approx(100.0, abs=1e-4)
    assert image[55, 46] == pytest.approx(103.0, abs=1e-3)
    assert covers[0, 50, 48] == pytest.approx(1.0)
    assert covers[0, 0, 0] == pytest.approx(0.0, abs=1e-12)


def test_sharper_sensors_are_drawn_finer_and_far_light_is_followed_farther():
    assert fine_samples(SYSTEMS["gaussian"]) == 4
    assert fine_samples(Sensor([Gaussian(0.2), Detector()])) == 6
    assert fine_samples(Sensor([Detector()])) == 8
    assert reach_of_light(SYSTEMS["gaussian"]) == 24
    assert reach_of_light(SYSTEMS["diffraction"]) == 64


def test_impossible_parcels_are_refused():
    border = Border(5.0, 5.0, 0.0, 10.0)
    with pytest.raises(ModelError, match="has no width"):
        SideStrip(0, "rim", 2.0, 2.0, 1.0)
    with pytest.raises(ModelError, match="follows border 1"):
        Parcel("field", 0.0, 0.0, (border,), 1.0, strips=(SideStrip(1, "rim", 0.0, 2.0, 1.0),))
    with pytest.raises(ModelError, match="without borders"):
        Parcel("field", 0.0, 0.0, (), 1.0)
    assert polygon("field", np.array([0.0, 90.0, 100.0, 180.0, 270.0]),
                   np.array([10.0, 10.0, 50.0, 10.0, 10.0]), 1.0) is None  # fmt: skip
