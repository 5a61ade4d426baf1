"""Edges measured before and after a filter, beside the prediction."""

import numpy as np
import pytest

import acutance as ac


@pytest.fixture(scope="module")
def pair(sensor):
    """A tarp-like edge, before and after; SNR 400, so that it is told to a few thousandths."""
    filter = ac.design_restoration(sensor, snr=400, noise_gain=1.7)
    pixels, _ = ac.simulate.edge(
        sensor, shape=(120, 120), angle_deg=7, snr=400, rng=np.random.default_rng(1)
    )
    return filter, ac.Image.from_array(pixels), ac.Image.from_array(ac.restore(pixels, filter))


def test_measured_is_what_was_predicted(pair):
    filter, before, after = pair
    proof = ac.verify_restoration(before, after, filter, [(15, 15, 90, 90)])
    (edge,) = proof.edges
    assert abs(edge.off) < 0.01
    assert abs(edge.off) < 2 * np.hypot(edge.after.std, edge.predicted.std)
    assert edge.predicted.value > 1.3 * edge.before.value
    assert edge.noise_gain == pytest.approx(filter.noise_gain, rel=0.05)
    assert proof.to_dict()["edges"][0]["mtf_nyquist_after"]["value"] == edge.after.value


def test_an_image_that_was_not_filtered_does_not_pass(pair):
    filter, before, _ = pair
    (edge,) = ac.verify_restoration(before, before, filter, [(15, 15, 90, 90)]).edges
    assert abs(edge.off) > 10 * edge.after.std


def test_a_scene_is_verified_by_its_own_edges():
    sensor = ac.Sensor([ac.optics.Gaussian(0.5), ac.optics.Detector()])
    plain = dict.fromkeys(
        ("roofs", "roads", "discs", "rims", "gutters", "shadows", "side_roads", "neighbours"), 0.0
    )
    options = ac.simulate.LandscapeOptions(**plain, texture=(0.0, 0.0), curved=0.0, soft=0.0)
    pixels, _ = ac.simulate.landscape(
        sensor, shape=(320, 320), options=options, snr=200, rng=np.random.default_rng(3)
    )
    filter = ac.design_restoration(sensor, snr=200, noise_gain=1.6)
    before, after = (
        ac.Image.from_array(one.astype(float)) for one in (pixels, ac.restore(pixels, filter))
    )
    for edge in ac.verify_restoration(before, after, filter).edges:
        assert edge.name.endswith("edges")
        assert abs(edge.off) < 0.02
        assert edge.predicted.value > 1.3 * edge.before.value


def test_a_region_without_an_edge_is_named(pair):
    filter, before, after = pair
    proof = ac.verify_restoration(before, after, filter, [(15, 15, 90, 90), (0, 0, 20, 8)])
    assert len(proof.edges) == 1
    assert proof.rejected[0].startswith("region 2")
    with pytest.raises(ac.NoEdgeError, match="no edge could be measured"):
        ac.verify_restoration(before, after, filter, [(0, 0, 20, 8)])
