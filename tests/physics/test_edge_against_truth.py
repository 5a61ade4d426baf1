"""The reference edge method against simulated truth: exact without noise, honest with it.

Every statistical claim has a fixed seed and a bound that a broken estimator fails. Full runs of
the same comparisons: benchmarks/accuracy.py and benchmarks/interval_coverage.py.
"""

import math

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate

SYSTEMS = simulate.reference_systems()
COMBINATIONS = [(o, p) for o in ("across", "along") for p in ("rising", "falling")]
METRICS = {
    "mtf_nyquist": lambda response: response.mtf_nyquist,
    "mtf_025": lambda response: response.mtf(0.25),
    "rer": lambda response: response.rer,
    "fwhm_px": lambda response: response.fwhm_px,
}


def mtf_error(found, truth):
    """The largest error of the MTF from 0 to Nyquist."""
    half = truth.mtf.freq_cpp <= 0.5
    value = np.interp(truth.mtf.freq_cpp[half], found.mtf.freq_cpp, found.mtf.value)
    return np.max(np.abs(value - truth.mtf.value[half]))


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("angle_deg", [2.0, 6.0, 7.125, 14.036, 18.435, 26.565, 43.0])
def test_noise_free_edge_is_measured_exactly(name, angle_deg):
    # Tangents of 1/8, 1/4, 1/3 and 1/2 repeat the same sample phases: nothing may ring there.
    orientation, polarity = COMBINATIONS[(round(angle_deg) + len(name)) % 4]
    image, truth = simulate.edge(
        SYSTEMS[name],
        angle_deg=angle_deg,
        orientation=orientation,
        polarity=polarity,
        shape=(60, 60),
    )
    found = ac.measure_edge(image)
    assert mtf_error(found, truth) <= {"diffraction": 0.006, "sharpened": 0.003}.get(name, 0.001)
    # Tails like 1/x^2 leave the region, and slopes of the ground might hide them: it does not
    # determine the plateaus' height exactly.
    far = name in ("diffraction", "sharpened")
    assert abs(found.rer.value - truth.rer.value) <= (0.004 if far else 0.001)
    assert abs(found.fwhm_px.value - truth.fwhm_px.value) <= 0.015
    assert found.orientation == truth.orientation


def random_edges(draws, *, seed, size_px, snr, angle_deg, systems, **options):
    """Images of edges in random places and directions, with their truths."""
    for draw in range(draws):
        rng = np.random.default_rng([seed, draw])
        orientation, polarity = COMBINATIONS[int(rng.integers(4))]
        side = int(rng.integers(size_px[0], size_px[1] + 1))
        yield simulate.edge(
            systems[draw % len(systems)],
            angle_deg=float(rng.uniform(*angle_deg) * rng.choice([-1, 1])),
            orientation=orientation,
            polarity=polarity,
            shape=(side, side),
            offset_px=float(rng.uniform(-1, 1)),
            snr=float(np.exp(rng.uniform(*np.log(snr)))),
            rng=rng,
            **options,
        )


@pytest.mark.parametrize(
    ("size_px", "snr", "bar"),
    [(20, 100, 0.0083), (40, 100, 0.0060), (100, 100, 0.0041), (40, 50, 0.0105)],
)
def test_rms_error_at_nyquist_stays_by_the_bar(size_px, snr, bar):
    draws = 150
    error = [
        ac.measure_edge(image).mtf_nyquist.value - truth.mtf_nyquist.value
        for image, truth in random_edges(
            draws, seed=2, size_px=(size_px, size_px), snr=(snr, snr), angle_deg=(5, 20),
            systems=[SYSTEMS["gaussian"]],
        )
    ]  # fmt: skip
    # The RMS of so few draws scatters by 1 / sqrt(2 n): two of that are allowed for. A spline
    # without its prior has .0087 to .0109 at 40 px and SNR 100.
    allowed = bar * (1 + 2 / math.sqrt(2 * draws))
    assert np.sqrt(np.mean(np.square(error))) < allowed
    assert abs(np.mean(error)) < 3 * bar / math.sqrt(draws)


@pytest.fixture(scope="module")
def pooled_z():
    """Errors over their standard deviations, (400, metrics), over all systems."""
    z = []
    for image, truth in random_edges(
        400, seed=3, size_px=(30, 60), snr=(50, 150), angle_deg=(2, 43),
        systems=list(SYSTEMS.values()),
    ):  # fmt: skip
        found = ac.measure_edge(image)
        estimates = [(metric(found.response), metric(truth)) for metric in METRICS.values()]
        z.append([(estimate.value - true.value) / estimate.std for estimate, true in estimates])
    return np.array(z)


@pytest.mark.parametrize("metric", METRICS)
def test_intervals_hold_the_truth_as_often_as_they_say(pooled_z, metric):
    inside = np.abs(pooled_z[:, list(METRICS).index(metric)]) < 1.959964
    # Three binomial standard deviations of 400 draws about 93 and 97 %: 3.8 and 2.6 points.
    assert 0.892 < inside.mean() < 0.996


@pytest.mark.parametrize("metric", METRICS)
def test_standard_deviations_have_the_size_of_the_errors(pooled_z, metric):
    z = pooled_z[:, list(METRICS).index(metric)]
    # The interval above alone would let deviations pass that are a fifth too large. Those of
    # M(.25) and RER hold what slopes of the ground may hide, which these images do not have.
    lowest = 0.65 if metric in ("mtf_025", "rer") else 0.8
    assert lowest < z.std() < 1.2
    assert abs(z.mean()) < 0.35
    assert np.mean(np.abs(z) > 4) < 0.01


def test_intervals_hold_with_noise_that_grows_with_the_signal():
    inside = []
    for draw in range(100):
        rng = np.random.default_rng([4, draw])
        noise = simulate.Noise(read=3.0, shot_gain=0.25)
        image, truth = simulate.edge(
            list(SYSTEMS.values())[draw % len(SYSTEMS)], angle_deg=float(rng.uniform(2, 43)),
            shape=(45, 45), noise=noise, rng=rng,
        )  # fmt: skip
        low, high = ac.measure_edge(image).mtf_nyquist.interval(0.95)
        inside.append(low < truth.mtf_nyquist.value < high)
    assert np.mean(inside) > 0.90 - 3 * math.sqrt(0.9 * 0.1 / 100)


def test_intervals_hold_for_a_resampled_image():
    inside = []
    for draw in range(100):
        rng = np.random.default_rng([5, draw])
        image, truth = simulate.edge(
            list(SYSTEMS.values())[draw % len(SYSTEMS)], angle_deg=float(rng.uniform(2, 43)),
            shape=(45, 45), snr=80, regrid=simulate.Regrid(*rng.uniform(-0.5, 0.5, 2)), rng=rng,
        )  # fmt: skip
        low, high = ac.measure_edge(image).mtf_nyquist.interval(0.95)
        inside.append(low < truth.mtf_nyquist.value < high)
    assert np.mean(inside) > 0.90 - 3 * math.sqrt(0.9 * 0.1 / 100)


def test_standard_deviation_falls_with_the_noise():
    image, _ = simulate.edge(
        SYSTEMS["gaussian"], shape=(40, 40), snr=50, rng=np.random.default_rng(6)
    )
    quieter, _ = simulate.edge(
        SYSTEMS["gaussian"], shape=(40, 40), snr=200, rng=np.random.default_rng(6)
    )
    stds = [ac.measure_edge(one).mtf_nyquist.std for one in (image, quieter)]
    # At the lower one more kinds of sensors are possible, too.
    assert 2.0 < stds[0] / stds[1] < 6.0


def test_asymmetric_system_keeps_its_phase():
    # A trail towards higher columns: along a rising edge the phase has one sign, and a falling
    # edge, seen along its own normal, has the opposite one.
    sensor = ac.Sensor([optics.Gaussian(0.3), optics.Exponential(0.6, "across"), optics.Detector()])
    for polarity in ("rising", "falling"):
        image, truth = simulate.edge(sensor, angle_deg=5, polarity=polarity, shape=(60, 60))
        found, true = ac.measure_edge(image).mtf.otf, truth.mtf.otf
        half = true.size // 2 + 1
        np.testing.assert_allclose(found[:half], true[:half], atol=2e-3)
        assert abs(true[half - 1].imag) > 0.01
