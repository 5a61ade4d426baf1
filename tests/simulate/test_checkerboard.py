"""Scenes of patches: exact edges and corners, truths and regions that belong to them."""

import numpy as np
import pytest
from scipy.special import erf

from acutance.errors import ModelError
from acutance.optics import Detector, Exponential, Gaussian, Sensor
from acutance.simulate import (
    Noise,
    Patch,
    Strip,
    checkerboard,
    reference_systems,
    render_edge,
    render_patches,
    render_strip,
    site,
    texture,
)

SENSOR = Sensor([Gaussian(0.4), Detector()])
SKEWED = Sensor([Gaussian(0.35), Exponential(0.4, "across"), Detector()])


def test_corners_of_a_patch_are_integrals_over_pixels():
    """A round Gaussian separates in the frame of the patch, whatever its turn."""
    patch = Patch(15.3, 17.8, 12.0, 9.0, 7.0, 100.0)
    found = render_patches(SENSOR, [patch], (32, 36))
    nodes, weights = np.polynomial.legendre.leggauss(10)
    rows, cols = np.indices((32, 36))
    expected = np.zeros((32, 36))
    turn = np.radians(7.0)

    def between(x, width):
        low, high = x + width / 2, x - width / 2
        return 0.5 * (erf(low / (0.4 * np.sqrt(2))) - erf(high / (0.4 * np.sqrt(2))))

    for dy, wy in zip(nodes / 2, weights / 2, strict=True):
        for dx, wx in zip(nodes / 2, weights / 2, strict=True):
            y, x = rows + dy - 15.3, cols + dx - 17.8
            p, q = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
            expected += 100 * wy * wx * between(p, 12.0) * between(q, 9.0)
    np.testing.assert_allclose(found, expected, atol=2e-4)


def test_a_strip_is_an_endless_patch():
    strip = Strip(20.0, 22.0, 68.0, 6.0, 50.0)
    found = render_strip(SENSOR, strip, (40, 44))
    patch = Patch(20.0, 22.0, 6.0, 70.0, 68.0, 50.0)
    np.testing.assert_allclose(
        found[15:26, 15:30], render_patches(SENSOR, [patch], (40, 44))[15:26, 15:30], atol=1e-3
    )
    assert found.max() == pytest.approx(50.0, abs=1e-6)


@pytest.mark.parametrize("sensor", [SENSOR, SKEWED], ids=["symmetric", "asymmetric"])
@pytest.mark.parametrize("turn", [7.0, -8.0, 30.0])
def test_every_edge_has_its_truth(sensor, turn):
    scene = checkerboard(sensor, turn_deg=turn, ground=420.0)
    rows, cols = np.indices(scene.image.shape)
    assert {e.name: e.truth.orientation for e in scene.edges} == {
        "right": "along",
        "left": "along",
        "upper": "across",
        "lower": "across",
    }
    for e in scene.edges:
        line = e.truth.line
        near = (np.abs(line.normal_distance(rows, cols)) < 9) & (
            np.abs(line.tangent_distance(rows, cols)) < 5
        )
        expected = render_edge(sensor, line, scene.image.shape, e.truth.dark, e.truth.bright)
        assert near.sum() > 100
        np.testing.assert_allclose(scene.image[near], expected[near], atol=0.01)
        assert e.truth.mtf_nyquist == sensor.response_along(line.normal_deg).mtf_nyquist


def inside(region, rows, cols):
    """Which pixels lie in a convex polygon whose corners go round clockwise on the screen."""
    kept = np.ones(rows.shape, bool)
    for (r0, c0), (r1, c1) in zip(region, np.roll(region, -1, axis=0), strict=True):
        kept &= (c1 - c0) * (rows - r0) - (r1 - r0) * (cols - c0) >= 0
    return kept


@pytest.mark.parametrize("turn", [7.0, -8.0])
def test_regions_hold_one_edge_and_nothing_else(turn):
    scene = checkerboard(SENSOR, turn_deg=turn, ground=420.0)
    rows, cols = np.indices(scene.image.shape)
    for e in scene.edges:
        kept = inside(e.region, rows, cols)
        expected = render_edge(SENSOR, e.truth.line, scene.image.shape, 200.0, 1200.0)
        assert kept.sum() > 900
        np.testing.assert_allclose(scene.image[kept], expected[kept], atol=0.1)
        assert e.region.mean(axis=0) == pytest.approx([e.truth.line.row, e.truth.line.col])


def test_texture_stays_off_the_board_and_has_its_strength():
    rng = np.random.default_rng(2)
    rough = checkerboard(SENSOR, texture_std=14.0, rng=rng).image - checkerboard(SENSOR).image
    assert np.max(np.abs(rough[45:75, 45:75])) < 0.01
    assert np.std(rough[:25]) == pytest.approx(14.0, rel=0.15)
    field = texture(SENSOR, (400, 400), 5.0, 1.5, rng)
    assert np.std(field) == pytest.approx(5.0, rel=0.05)
    assert np.mean(field[:, 1:] * field[:, :-1]) / np.var(field) > 0.8


def test_site_is_a_scene_for_every_reference_system():
    scene = site(reference_systems()["gaussian"], np.random.default_rng(7))
    again = site(reference_systems()["gaussian"], np.random.default_rng(7))
    np.testing.assert_array_equal(scene.image, again.image)
    assert scene.image.shape == (180, 160)
    assert len(scene.edges) == 4
    assert all(e.truth.noise == Noise(read=8.0) for e in scene.edges)
    road = scene.image[150:166, 70:90].max()
    assert road > 430 + 200


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"tile_px": 70.0}, "use smaller tiles or a larger image"),
        ({"tile_px": 8.0}, "at least 16 px"),
        ({"turn_deg": 60.0}, "turned by 60"),
        ({"texture_std": 3.0}, "without rng"),
        ({"dark": 1200.0, "bright": 200.0}, "dark is 1200 and bright 200: dark has to be lower"),
        ({"dark": 700.0, "bright": 700.0}, "dark has to be lower"),
    ],
)
def test_impossible_boards_are_refused(arguments, words):
    with pytest.raises(ModelError, match=words):
        checkerboard(SENSOR, **arguments)


def test_too_fine_a_texture_is_refused():
    with pytest.raises(ModelError, match="grain_px"):
        texture(SENSOR, (20, 20), 1.0, 0.2, np.random.default_rng(1))
