"""Parts of a scene whose objects have a softness in common disagree: what that adds is stated."""

import numpy as np
import pytest
from bare_ground import all_of_softness

import acutance as ac
from acutance import simulate
from acutance.scan.parts import equal_parts
from acutance.scan.stated_objects import behind_objects

SENSOR = simulate.reference_systems()["gaussian"]


def half(softness_px, seed):
    """Half a scene, all of whose objects have one softness."""
    options = all_of_softness(softness_px, density_per_mpx=90)
    rng = np.random.default_rng(seed)
    return simulate.landscape(SENSOR, shape=(900, 450), snr=100, options=options, rng=rng)[0]


@pytest.fixture(scope="module")
def scanned(few_forms):
    """A scan of two halves, and what its parts say; not how well forms describe the sensor."""

    def scan(left_px, right_px):
        with few_forms():
            return ac.scan_scene(np.hstack([half(left_px, 1), half(right_px, 2)]))

    return scan


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
def alike(scanned):
    return scanned(0.0, 0.0)


def test_parts_that_agree_add_nothing(alike):
    found = check_of(alike)
    assert found.passed
    assert found.value < 0.02
    assert alike.details.parts.chi_square.expected == 24


def test_a_part_of_soft_objects_is_a_term_of_the_budget(alike, scanned):
    scene = scanned(0.45, 0.0)
    found = check_of(scene)
    assert not found.passed
    assert found.severity == "note"
    assert scene.verdict.word == "usable"
    expected = float(np.abs(SENSOR.otf(np.array([0.5]), np.zeros(1)))[0])
    terms = {(term.direction, term.name): term.std["mtf_nyquist"] for term in scene.budget}
    for name in ("across", "along"):
        mtf, number = getattr(scene, name).mtf, getattr(scene, name).mtf_nyquist
        assert abs(number.value - expected) < 3 * number.std
        assert number.std > getattr(alike, name).mtf_nyquist.std
        # Of the modulus: the number is without its bias by noise in quadrature, here 3e-6 of it.
        modulus = float(np.abs(mtf.otf[np.searchsorted(mtf.freq_cpp, 0.5 - 1e-9)]))
        assert terms[name, "parts_scatter"] == pytest.approx(found.value * modulus, rel=1e-9)
        assert number.value == pytest.approx(modulus, rel=1e-4)
        every = [std for (direction, _), std in terms.items() if direction == name]
        assert np.linalg.norm(every) == pytest.approx(number.std)
    assert ("across", "target_softness") not in terms


def smeared(axis, seed):
    """A ninth of a scene, smeared along one axis."""
    sensor = ac.Sensor([*SENSOR.blocks, ac.optics.Smear(0.8, axis)])
    rng, options = np.random.default_rng(seed), all_of_softness(0.0, density_per_mpx=120)
    return simulate.landscape(sensor, shape=(300, 300), snr=100, options=options, rng=rng)[0]


def test_parts_that_differ_in_the_softer_direction_widen_both(alike, few_forms):
    # No smooth surface over the field follows this; that of a checkerboard some do.
    across, along = "across", "along"
    axes = ((across, along, along), (along, across, across), (across, across, along))
    rows = [[smeared(axes[i][j], 20 + 3 * i + j) for j in range(3)] for i in range(3)]
    with few_forms():
        scene = ac.scan_scene(np.block(rows))
    parts = scene.details.parts
    assert parts.chi_square.value > 3 * parts.chi_square.expected
    assert parts.errors_px2[1] > max(0.001, 3 * alike.details.parts.errors_px2[1])
    terms = {(term.direction, term.name): term.std["mtf_nyquist"] for term in scene.budget}
    for name in ("across", "along"):
        assert terms[name, "parts_scatter"] > terms[name, "fit"]


def test_of_few_edges_it_is_not_asked():
    rng = np.random.default_rng(3)
    options = all_of_softness(0.0, density_per_mpx=90)
    image, _ = simulate.landscape(SENSOR, shape=(300, 300), snr=100, options=options, rng=rng)
    found = check_of(ac.scan_scene(image))
    assert found.value == 0.0
    assert "too few to ask" in found.message


class Level:
    """A sensor of half the light at all frequencies but zero."""

    band_cpp = 1.0

    def otf(self, u, v):
        return np.where((u == 0) & (v == 0), 1.0, 0.5).astype(complex)

    def factor(self, u, v):
        return np.zeros((u.size, 1), complex)


def test_the_scatter_is_an_error_of_the_blur_in_all_directions():
    rows = np.array([[0.01, 0.0, 0.0]])
    found = behind_objects(Level(), ac.ScanOptions(), None, {"parts_scatter": rows})
    assert not found.is_stated
    turn = np.radians([0.0, 40.0, 90.0])
    u, v = 0.3 * np.cos(turn), 0.3 * np.sin(turn)
    np.testing.assert_allclose(found.otf(u, v), 0.5)
    std = np.linalg.norm(found.factor(u, v), axis=1)
    np.testing.assert_allclose(std, 0.5 * 2 * np.pi**2 * 0.3**2 * 0.01)
    light = found.with_errors(["target_softness"])
    assert not light.factor(u, v).any()


def test_errors_of_one_direction_are_none_of_the_other():
    # As much all around as across more than along: twice as much across, nothing along.
    rows = np.array([[0.01, 0.01, 0.0], [0.0, 0.0, 0.02]])
    found = behind_objects(Level(), ac.ScanOptions(), None, {"shared_softness": rows})
    u, v = 0.3 * np.cos(np.radians([0, 90, 45])), 0.3 * np.sin(np.radians([0, 90, 45]))
    std = np.abs(found.factor(u, v)) / (0.5 * 2 * np.pi**2 * 0.3**2)
    errors = std[:, -2:]
    np.testing.assert_allclose(errors[:, 0], [0.02, 0.0, 0.01], atol=1e-12)
    np.testing.assert_allclose(errors[:, 1], [0.0, 0.0, 0.02], atol=1e-12)
