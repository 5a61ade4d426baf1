"""A whole site: every target where its truth says, and measurable."""

import numpy as np
import pytest

from acutance.errors import ModelError
from acutance.optics import preset
from acutance.simulate import (
    EdgeTarps,
    Noise,
    Patch,
    Point,
    PulseTarp,
    add_patches,
    brookings,
    edge,
    pulse,
    reference_systems,
    render_patches,
    render_site,
    stamp,
    tarp_region,
    tarp_rows,
    texture,
)

GENERIC = preset("generic-2005")
SKEWED = reference_systems()["asymmetric"]
SHAPE = (120, 130)


@pytest.mark.parametrize("normal", [6.0, 96.0, -170.0])
def test_a_tarp_in_a_site_is_the_simulated_edge(normal):
    tarps = EdgeTarps("e", 60.3, 64.8, normal, 40.0, 200.0, 1200.0)
    scene = render_site(SKEWED, [tarps], SHAPE, ground=500.0)
    truth = scene.edges[0].truth
    profile = SKEWED.profile(normal)
    distance = truth.line.normal_distance(*np.indices(SHAPE))
    along = np.abs(truth.line.tangent_distance(*np.indices(SHAPE)))
    inside = (np.abs(distance) < 12) & (along < 10)
    expected = 200 + 1000 * profile.esf(distance + profile.half_px)
    np.testing.assert_allclose(scene.image[inside], expected[inside], atol=2e-2)
    assert truth.mtf_nyquist == SKEWED.response_along(normal).mtf_nyquist


def test_a_pulse_tarp_in_a_site_is_the_simulated_pulse():
    tarp = PulseTarp("p", 59.5, 64.5, 6.0, 3.0, 80.0, 1200.0)
    scene = render_site(GENERIC, [tarp], SHAPE, ground=430.0)
    expected, truth = pulse(GENERIC, shape=SHAPE, dark=430.0, length_px=80.0)
    np.testing.assert_allclose(scene.image, expected, atol=1e-2)
    found = scene.targets[0].truth
    assert found.line.normal_distance(truth.line.row, truth.line.col) == pytest.approx(0.0)
    assert (found.width_px, found.left, found.level) == (3.0, 430.0, 1200.0)
    assert found.to_dict()["width_px"] == 3.0


def test_windows_give_what_the_whole_image_gives():
    patches = [Patch(50.2, 60.7, 20.0, 30.0, 8.0, 700.0), Patch(70.0, 40.0, 9.0, 9.0, 0.0, 200.0)]
    canvas = np.zeros(SHAPE)
    add_patches(canvas, GENERIC, patches)
    np.testing.assert_allclose(canvas, render_patches(GENERIC, patches, SHAPE), atol=1e-3)


def test_points_and_patches_together_are_the_sum_of_each_alone():
    shapes = [
        Point(12.3, 20.1, 900.0),
        Patch(15.0, 30.0, 8.0, 5.0, 10.0, 60.0),
        Point(20.0, 9.6, 400.0),
    ]
    alone = sum(render_patches(GENERIC, [one], SHAPE) for one in shapes)
    np.testing.assert_allclose(render_patches(GENERIC, shapes, SHAPE), alone, atol=1e-9)


def test_a_stamp_is_cut_at_the_borders():
    canvas = np.zeros((4, 5))
    stamp(canvas, np.ones((3, 3)), -1, 3)
    stamp(canvas, np.ones((3, 3)), 10, 10)
    assert canvas.sum() == 4
    assert canvas[:2, 3:].min() == 1


def test_the_campaign_holds_every_kind_of_target():
    scene = brookings(GENERIC, np.random.default_rng(1))
    assert scene.image.shape == (300, 260)
    assert [one.name for one in scene.edges] == ["vertical", "horizontal"]
    assert [one.kind for one in scene.targets] == ["pulse", "bars", "star", "points"]
    assert {one.truth.orientation for one in scene.edges} == {"across", "along"}
    boxes = [one.region for one in (*scene.edges, *scene.targets)]
    for region in boxes:
        assert region.min() >= 0
        assert np.all(region.max(axis=0) <= np.array(scene.image.shape) - 1)
    mirrors = scene.targets[3].truth
    for (row, col), _ in zip(mirrors.positions, mirrors.fluxes, strict=True):
        near = scene.image[round(row) - 1 : round(row) + 2, round(col) - 1 : round(col) + 2]
        assert near.max() > 430 + 350
    with pytest.raises(ModelError, match="2 to 14"):
        brookings(GENERIC, np.random.default_rng(1), turn_deg=30.0)


def test_the_campaign_is_the_generators_own():
    images = [brookings(GENERIC, np.random.default_rng(seed)).image for seed in (1, 1, 2)]
    assert np.array_equal(images[0], images[1])
    assert not np.array_equal(images[0], images[2])


def test_texture_ends_where_the_tarps_begin():
    rng = np.random.default_rng(3)
    tarps = [EdgeTarps("e", 60.0, 64.0, 6.0, 40.0, 200.0, 1200.0)]
    rough = render_site(GENERIC, tarps, SHAPE, texture_std=30.0, rng=rng)
    flat = render_site(GENERIC, tarps, SHAPE)
    difference = rough.image - flat.image
    assert np.abs(difference[50:70, 40:56]).max() < 1e-2
    assert np.std(difference[:, :15]) == pytest.approx(30.0, rel=0.15)


def test_a_wide_texture_has_no_seams():
    field = texture(GENERIC, (1100, 1300), 14.0, 1.5, np.random.default_rng(4))
    assert field.shape == (1100, 1300)
    assert np.std(field) == pytest.approx(14.0, rel=0.01)
    # The first two tiles meet at row and column 992.
    seam = field[:, 985:1000]
    assert np.std(seam) == pytest.approx(14.0, rel=0.05)
    steps = np.std(np.diff(field, axis=1), axis=0)
    assert np.max(np.abs(steps / np.median(steps) - 1)) < 0.15


def test_a_wide_texture_of_coarse_grain_has_none_either():
    rng = np.random.default_rng(5)
    fields = [texture(GENERIC, (400, 1300), 1.0, 20.0, rng) for _ in range(2)]
    steps = np.sqrt(np.mean([np.diff(field, axis=1) ** 2 for field in fields], axis=(0, 1)))
    assert np.max(steps) < 2 * np.median(steps)


def test_rows_of_tarps_fill_an_image():
    tarps = tarp_rows((400, 300), 12)
    assert len(tarps) == 12
    seen = []
    scene = render_site(
        GENERIC,
        tarps,
        (400, 300),
        noise=Noise(read=5.0),
        rng=np.random.default_rng(5),
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen[-1] == (12, 12)
    assert (len(scene.edges), len(scene.targets)) == (8, 4)
    reference, _ = edge(GENERIC, noise=None)
    assert scene.image.max() == pytest.approx(reference.max(), abs=30)
    assert all(tarp_region(one).shape == (4, 2) for one in tarps)


def test_what_does_not_fit_is_refused():
    far = EdgeTarps("far", 5.0, 60.0, 6.0, 40.0, 200.0, 1200.0)
    with pytest.raises(ModelError, match="the target far reaches"):
        render_site(GENERIC, [far], SHAPE)
    with pytest.raises(ModelError, match="without rng"):
        render_site(GENERIC, [], SHAPE, texture_std=5.0)
    with pytest.raises(ModelError, match="90 are needed"):
        tarp_rows((200, 200), 12)
    with pytest.raises(ModelError, match="side_px"):
        EdgeTarps("small", 5.0, 60.0, 6.0, 4.0, 200.0, 1200.0)
    with pytest.raises(ModelError, match="dark is 1200 and bright 200: dark has to be lower; turn"):
        EdgeTarps("exchanged", 60.0, 60.0, 6.0, 40.0, 1200.0, 200.0)
