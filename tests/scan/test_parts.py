"""Parts of a scene whose objects have a softness in common disagree, and widen its deviations."""

import numpy as np
import pytest
from bare_ground import all_of_softness

import acutance as ac
from acutance import simulate
from acutance.scan.parts import equal_parts

SENSOR = simulate.reference_systems()["gaussian"]


def half(softness_px, seed):
    """Half a scene, all of whose objects have one softness."""
    options = all_of_softness(softness_px, density_per_mpx=90)
    rng = np.random.default_rng(seed)
    return simulate.landscape(SENSOR, shape=(900, 450), snr=100, options=options, rng=rng)[0]


def scanned(left_px, right_px):
    return ac.scan_scene(np.hstack([half(left_px, 1), half(right_px, 2)]))


def check_of(scene):
    (found,) = (check for check in scene.checks if check.name == "parts_agree")
    return found


def test_parts_have_as_many_edges_each():
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-1, 1, (2, 147))
    parts = equal_parts(x, y)
    assert len(parts) == 9
    assert sorted(np.concatenate(parts).tolist()) == list(range(147))
    assert {part.size for part in parts} <= {16, 17}
    # The first three lie at the left, from top to bottom.
    assert x[parts[2]].max() < x[parts[3]].min()
    assert y[parts[0]].max() < y[parts[1]].min()
    assert len(equal_parts(x[:70], y[:70])) == 4
    assert equal_parts(x[:59], y[:59]) == []


@pytest.fixture(scope="module")
def alike():
    return scanned(0.0, 0.0)


def test_parts_that_agree_widen_nothing(alike):
    found = check_of(alike)
    assert found.passed
    assert found.value < 1.2
    assert alike.details.parts.expected == 8


def test_a_part_of_soft_objects_widens_all_deviations(alike):
    scene = scanned(0.45, 0.0)
    found = check_of(scene)
    assert not found.passed
    assert found.severity == "note"
    assert scene.verdict.word == "usable"
    assert found.value > 1.5
    unwidened = scene.details.combined.unwidened
    u, v = np.array([0.5]), np.zeros(1)
    ratio = np.linalg.norm(scene.details.otf.factor(u, v)) / np.linalg.norm(unwidened.factor(u, v))
    assert ratio == pytest.approx(found.value)
    expected = float(np.abs(SENSOR.otf(u, v))[0])
    for name in ("across", "along"):
        number = getattr(scene, name).mtf_nyquist
        assert abs(number.value - expected) < 3 * number.std
        assert number.std > getattr(alike, name).mtf_nyquist.std


def test_of_few_edges_it_is_not_asked():
    rng = np.random.default_rng(3)
    options = all_of_softness(0.0, density_per_mpx=90)
    image, _ = simulate.landscape(SENSOR, shape=(300, 300), snr=100, options=options, rng=rng)
    found = check_of(ac.scan_scene(image))
    assert found.value == 1.0
    assert "too few to ask" in found.message
