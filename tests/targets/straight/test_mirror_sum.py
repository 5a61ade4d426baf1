"""The sum of an edge and its mirror image: zero behind an even blur, and what else it holds."""

import numpy as np
import pytest

import acutance as ac
from acutance.simulate import Noise, edge, reference_systems
from acutance.targets.straight.check_data import CheckData
from acutance.targets.straight.find_edges import find_segments
from acutance.targets.straight.fit_edge import fit_edge
from acutance.targets.straight.mirror_sum import EVEN, MirrorSum
from acutance.targets.straight.side_noise import SideNoise
from acutance.targets.straight.trim import trim

SYSTEMS = reference_systems()


def check_data(image):
    trimmed, _ = trim(image, next(iter(find_segments(image, 1))))
    return CheckData.of(trimmed, fit_edge(trimmed))


def light(system, seed, size=50):
    """An edge from 0 to 1 without noise."""
    rng = np.random.default_rng(seed)
    image, _ = edge(
        SYSTEMS[system], angle_deg=float(rng.uniform(4, 20)), shape=(size, size), dark=0.0,
        bright=1.0, noise=Noise(read=0.0), rng=rng,
    )  # fmt: skip
    return np.asarray(image)


def noisy(image, seed, snr=100.0):
    return 200 + 1000 * (image + np.random.default_rng((seed, 1)).normal(0, 1 / snr, image.shape))


def log_odds_of_odd(mirrored):
    """Log evidence of an LSF with an odd part over that of an even one."""
    found = mirrored.weighed(np.zeros((1, mirrored.value.size))).log_evidence
    return np.logaddexp.reduce(found[EVEN:]) - np.logaddexp.reduce(found[:EVEN])


@pytest.mark.parametrize("system", ["gaussian", "diffraction", "sharpened", "halo"])
def test_of_an_even_blur_it_is_noise(system):
    power, odds = [], []
    for seed in range(8):
        mirrored = MirrorSum.of(check_data(noisy(light(system, seed), seed)))
        # The first values of the sum hold the place, which is free; the noise of the others is
        # that of the pixels.
        far = slice(10, None)
        power.append(np.mean(mirrored.value[far] ** 2 / mirrored.variance[far]))
        odds.append(log_odds_of_odd(mirrored))
    assert 0.5 < np.mean(power) < 1.6
    assert np.mean(np.array(odds) > 1) <= 1 / 8


def test_an_odd_blur_shows():
    odds = [
        log_odds_of_odd(MirrorSum.of(check_data(noisy(light("asymmetric", seed), seed, 200.0))))
        for seed in range(6)
    ]
    assert np.median(odds) > 3


def test_the_even_part_of_the_blur_is_the_sensor_s():
    sensor = SYSTEMS["diffraction"]
    mirrored = MirrorSum.of(check_data(noisy(light("diffraction", 3), 3, 1000.0)))
    true = sensor.response_along(0.0)
    places = np.interp(mirrored.half, true.esf.value, true.esf.distance_px)
    assert np.interp(places[:10], true.lsf.distance_px, true.lsf.value) == pytest.approx(
        mirrored.lsf[:10], abs=0.02
    )


@pytest.mark.parametrize("curvature", [-0.2, 0.2])
def test_a_curve_is_found_with_its_size(curvature):
    values, stds = [], []
    for seed in range(12):
        u = light("sharpened", seed)
        mirrored = MirrorSum.of(check_data(noisy(u + curvature * u * (1 - u), seed)))
        found = mirrored.weighed((2 * mirrored.half * (1 - mirrored.half))[None])
        best = int(np.argmax(found.log_evidence[:EVEN]))
        values.append(found.pull[best, 0] / found.power[best, 0])
        stds.append(found.power[best, 0] ** -0.5)
    assert np.mean(values) == pytest.approx(curvature, abs=0.04)
    assert np.mean(stds) < 0.05


def test_noise_through_a_curve_implies_it():
    for curvature in (-0.3, 0.3):
        implied = []
        for seed in range(6):
            u = light("gaussian", seed) + np.random.default_rng(seed).normal(0, 0.01, (50, 50))
            noise = SideNoise.of(check_data(200 + 1000 * (u + curvature * u * (1 - u))))
            implied.append(noise.curvature)
        assert np.mean(implied) == pytest.approx(curvature, abs=0.03)


def test_equal_noise_gains_nothing_by_a_curve():
    for seed in range(4):
        noise = SideNoise.of(check_data(noisy(light("gaussian", seed), seed)))
        assert abs(noise.curvature) < 0.1
        slopes = np.array([[0.4], [1.0], [2.5]])
        gained = np.log(noise.likelihood(slopes))[:, 0]
        assert gained[1] == pytest.approx(0.0, abs=1e-9)
        assert max(gained[0], gained[2]) < -1
        assert noise.max_gain < 1.5


def test_no_noise_shows_nothing():
    assert SideNoise.of(check_data(200 + 1000 * light("gaussian", 0))) is None
    found = ac.measure_edge(200 + 1000 * light("gaussian", 0))
    assert next(one for one in found.checks if one.name == "nonlinearity").passed
