"""Edges measured before and after a filter, beside the prediction."""

import dataclasses

import numpy as np
import pytest

import acutance as ac
from acutance.report import proof_text


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
        assert edge.normal_deg is None
        assert abs(edge.off) < 0.02
        assert edge.predicted.value > 1.3 * edge.before.value


def test_a_region_without_an_edge_is_named(pair):
    filter, before, after = pair
    proof = ac.verify_restoration(before, after, filter, [(15, 15, 90, 90), (0, 0, 20, 8)])
    assert len(proof.edges) == 1
    assert proof.rejected[0].startswith("region 2")
    with pytest.raises(ac.NoEdgeError, match="no edge could be measured"):
        ac.verify_restoration(before, after, filter, [(0, 0, 20, 8)])


@pytest.mark.parametrize("method", ["spline", "iso12233"])
def test_what_agrees_is_said_to_and_what_does_not_is_not(pair, method):
    filter, before, after = pair
    regions = {"long": (15, 15, 90, 90), "short": (30, 30, 60, 60)}
    proof = ac.verify_restoration(before, after, filter, regions, method=method)
    assert [edge.name for edge in proof.edges] == ["long", "short"]
    assert {edge.method for edge in proof.edges} == {method}
    assert proof.agrees
    assert proof.sentence.startswith("agrees with the prediction: 2 edges within")
    wrong = ac.verify_restoration(before, before, filter, regions, method=method)
    assert not wrong.agrees
    assert wrong.sentence.startswith("does not agree with the prediction: ")
    assert f"{abs(wrong.worst.deviations):.1f} deviations" in wrong.sentence
    assert not wrong.to_dict()["agrees"]
    for edge in (*proof.edges, *wrong.edges):
        assert edge.difference.value == pytest.approx(edge.after.value - edge.predicted.value)


def test_noise_that_is_not_white_does_not_agree(sensor):
    """Of resampled products SNR falls by less than the noise gain, and nothing was said."""
    filter = ac.design_restoration(sensor, snr=100, noise_gain=1.8)
    light, _ = ac.simulate.edge(sensor, shape=(100, 100), angle_deg=7, snr=None)
    noise = np.random.default_rng(6).normal(size=light.shape)
    smooth = sum(np.roll(noise, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)) / 3.0
    scale = np.ptp(light) / 100.0
    for own, agrees in ((noise, True), (smooth, False)):
        image = light + scale * own
        before, after = (ac.Image.from_array(one) for one in (image, ac.restore(image, filter)))
        proof = ac.verify_restoration(before, after, filter, {"roof": (10, 10, 80, 80)})
        (edge,) = proof.edges
        assert edge.white_noise_gain == filter.noise_gain
        assert proof.noise_agrees == agrees == proof.to_dict()["noise_agrees"]
        text = proof_text(proof)
        assert f"{edge.noise_gain:.2f} (1.80)" in text
        assert (" in sharpness, not in noise" in text) != agrees
        if agrees:
            assert edge.noise_off == pytest.approx(0, abs=0.1)
            assert proof.notes == ()
        else:
            assert edge.noise_off < -0.2
            (note,) = proof.notes
            assert f"note: {note}" in text
            words = f"roof: SNR is divided by {edge.noise_gain:.2f}, and white noise is amplified"
            assert note.startswith(words)
            assert "resampled or compressed" in note
    sharp = dataclasses.replace(edge, snr_after=edge.snr_before / 3.0)
    (note,) = dataclasses.replace(proof, edges=(sharp,)).notes
    assert "sharpened before" in note
    silent = dataclasses.replace(edge, snr_before=np.inf)
    assert dataclasses.replace(proof, edges=(silent,)).noise_agrees


def test_an_image_of_another_sensor_is_named(pair):
    filter, before, after = pair
    proof = ac.verify_restoration(before, after, filter, [(15, 15, 90, 90)])
    assert proof.notes == ()
    wide = ac.simulate.reference_systems()["wide"]
    for_another = ac.design_restoration(wide, snr=100, noise_gain=1.6)
    restored = ac.Image.from_array(ac.restore(before.read(), for_another))
    proof = ac.verify_restoration(before, restored, for_another, [(15, 15, 90, 90)])
    assert proof.agrees
    (note,) = proof.notes
    assert "the filter was designed for" in note
    assert proof.to_dict()["notes"] == [note]
    turned = dataclasses.replace(proof.edges[0], before=proof.edges[0].designed * 0.2)
    assert "soft themselves" in dataclasses.replace(proof, edges=(turned,)).notes[0]


@pytest.mark.parametrize("orientation", ["across", "along"])
def test_a_slanted_edge_of_a_smeared_sensor_is_of_its_own(orientation):
    optics = ac.optics
    sensor = ac.Sensor([optics.Gaussian(0.35), optics.Detector(), optics.Smear(1.2, "along")])
    filter = ac.design_restoration(sensor, snr=100, noise_gain=1.6)
    image, _ = ac.simulate.edge(
        sensor, angle_deg=38, orientation=orientation, shape=(80, 80), snr=200,
        rng=np.random.default_rng(5),
    )  # fmt: skip
    before, after = (
        ac.Image.from_array(np.asarray(one)) for one in (image, ac.restore(image, filter))
    )
    proof = ac.verify_restoration(before, after, filter, [(2, 2, 76, 76)])
    assert proof.notes == ()
    assert abs(proof.edges[0].unlike_design) < 2


@pytest.mark.parametrize("track", ["y", "x"])
def test_the_design_is_that_of_the_edge_on_the_grid_whatever_the_image_calls_it(track):
    """By the name of the image's direction the edge was 11 deviations unlike its own design."""
    optics = ac.optics
    sensor = ac.Sensor([optics.Gaussian(0.35), optics.Detector(), optics.Smear(1.2, "along")])
    filter = ac.design_restoration(sensor, snr=100, noise_gain=1.6, size=9)
    image, _ = ac.simulate.edge(
        sensor, angle_deg=7, shape=(60, 60), snr=200, rng=np.random.default_rng(5)
    )
    before, after = (
        ac.Image.from_array(np.asarray(one), along_track=track)
        for one in (image, ac.restore(image, filter))
    )
    (edge,) = ac.verify_restoration(before, after, filter, [(2, 2, 56, 56)]).edges
    assert edge.designed.value == pytest.approx(filter.before.across.mtf_nyquist.value, rel=0.02)
    assert abs(edge.unlike_design) < 2


def test_two_lines_share_no_error(pair):
    filter, before, after = pair
    regions = [(15, 15, 90, 90)]
    (edge,) = ac.verify_restoration(before, after, filter, regions, method="iso12233").edges
    assert edge.turned_deg < 0.1
    moved = dataclasses.replace(edge, turned_deg=1.5)
    apart = np.hypot(edge.after.std, edge.predicted.std)
    assert edge.difference.std < apart < moved.difference.std


def test_more_edges_may_be_farther_off(pair):
    filter, before, after = pair
    one = ac.verify_restoration(before, after, filter, [(15, 15, 90, 90)])
    assert one.limit == pytest.approx(1.96, abs=0.005)
    two = ac.verify_restoration(before, after, filter, [(15, 15, 90, 90), (30, 30, 60, 60)])
    assert two.limit == pytest.approx(2.236, abs=0.005)


def test_differences_are_within_their_deviations(sensor):
    """Of 20 differences a method at SNR 40 and 200 some 19 are within two deviations."""
    rng, found = np.random.default_rng(11), {"spline": [], "iso12233": []}
    for snr in (40, 200):
        filter = ac.design_restoration(sensor, snr=snr, noise_gain=1.6)
        for _ in range(10):
            pixels, _ = ac.simulate.edge(
                sensor, shape=(60, 60), angle_deg=rng.uniform(4, 10), snr=snr, rng=rng
            )
            sharp = ac.restore(pixels, filter)
            pair = [ac.Image.from_array(one) for one in (pixels, sharp)]
            for method, own in found.items():
                proof = ac.verify_restoration(*pair, filter, [(5, 5, 50, 50)], method=method)
                own.append(proof.edges[0].deviations)
    for own in found.values():
        assert np.mean(np.abs(own) < 2) >= 0.9
        assert np.sqrt(np.mean(np.square(own))) > 0.3


def test_an_image_of_few_edges_is_verified_by_these(pair):
    """They are too few for a scan to tell the sensor by, which is not asked for."""
    filter, before, after = pair
    (edge,) = ac.verify_restoration(before, after, filter).edges
    assert 1 <= edge.count < 8
    assert edge.name.endswith(", 1 edge" if edge.count == 1 else f", {edge.count} edges")
    assert (edge.normal_deg is None) == (edge.count > 1)
    assert abs(edge.off) < 2 * np.hypot(edge.after.std, edge.predicted.std)


def test_an_image_without_edges_says_how_to_name_some(pair):
    filter = pair[0]
    flat = ac.Image.from_array(np.random.default_rng(2).normal(100, 1, (120, 120)))
    with pytest.raises(ac.NoEdgeError, match="name regions with edges"):
        ac.verify_restoration(flat, flat, filter)


def test_a_method_that_cuts_lobes_errs_by_what_its_deviation_says():
    """The draft of KOMPSAT-3 keeps 1 px of plateau beyond the inflection points of the LSF."""
    sensor = ac.Sensor([ac.optics.Gaussian(0.7), ac.optics.Detector()])
    filter = ac.design_restoration(sensor, snr=100, noise_gain=2.2)
    pixels, _ = ac.simulate.edge(
        sensor, shape=(110, 110), angle_deg=7, snr=100, rng=np.random.default_rng(1)
    )
    pair = (ac.Image.from_array(one) for one in (pixels, ac.restore(pixels, filter)))
    proof = ac.verify_restoration(*pair, filter, [(15, 15, 80, 80)], method="kompsat-2014")
    (edge,) = proof.edges
    assert edge.off > 0.07
    assert abs(edge.deviations) < 2.2
