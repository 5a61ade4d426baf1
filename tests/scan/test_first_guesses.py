"""First guesses of the sensor of a scene: some are of one direction, some of all."""

import numpy as np
from bare_ground import small_scene

import acutance as ac
from acutance import simulate
from acutance.scan.first_guesses import sensor_guesses
from acutance.scan.window_edges import UsedEdge

FREQ_CPP = np.arange(1, 11) * 0.1
NORMAL_DEG = np.array([-60.0, 0.0, 60.0])


def edge_of(axis_deg, softness_px):
    """An edge behind a Gaussian; nothing but its own OTF is asked of it."""
    otf = np.exp(-2 * np.pi**2 * softness_px**2 * FREQ_CPP**2).astype(complex)
    return UsedEdge(axis_deg, FREQ_CPP, otf, np.zeros((20, 1)), np.zeros(1))


def test_guesses_have_every_direction_and_no_imaginary_part():
    edges = [edge_of(float(axis), 0.4) for axis in np.linspace(-89, 89, 25)]
    for guess in sensor_guesses(edges, NORMAL_DEG):
        assert guess.shape == (3, 20)
        np.testing.assert_allclose(guess[:, :10], [np.abs(edges[0].otf)] * 3)
        assert not guess[:, 10:].any()


def test_one_guess_is_of_the_ideal_edges_where_a_direction_has_none():
    """Six of forty objects are ideal, all in two directions; nothing is as sharp in the third."""
    rng = np.random.default_rng(4)
    softness_px = np.concatenate([np.full(6, 0.4), rng.uniform(0.6, 2.0, 34)])
    axis_deg = np.concatenate([[-60.0, 0.0] * 3, rng.uniform(55, 65, 34)])
    edges = [edge_of(*one) for one in zip(axis_deg.tolist(), softness_px.tolist(), strict=True)]
    ideal = np.abs(edges[0].otf)
    off = [np.abs(guess[:, :10] - ideal).max() for guess in sensor_guesses(edges, NORMAL_DEG)]
    assert min(off) < 0.01


def test_few_edges_with_few_ideal_objects_give_the_sensor(monkeypatch):
    """The likeliest start leads there: that of others leads there, too, is no help."""
    monkeypatch.setattr("acutance.scan.first_sensor._MOST_FOLLOWED", 1)
    sensor = simulate.reference_systems()["gaussian"]
    scene = ac.scan_scene(small_scene(sensor, 480, 0.75, (77, 2)))
    truth = abs(sensor.otf(np.array([0.5]), np.array([0.0]))[0])
    for number in (scene.across.mtf_nyquist, scene.along.mtf_nyquist):
        assert abs(number.value - truth) < 3 * number.std
        assert number.std < 0.03
