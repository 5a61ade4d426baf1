"""Standard deviations mean what they say: the scatter of many draws about the truth."""

import numpy as np
import pytest

import acutance.simulate as sim
from acutance.targets.straight.fit_edge import fit_edge
from acutance.targets.straight.pixels import EdgePixels

SYSTEMS = sim.reference_systems()
NAMES = ("mtf_nyquist", "rer", "fwhm_px", "angle")
LOWEST, HIGHEST = 0.88, 1.12
"""Bounds on the root mean square of error over standard deviation."""


@pytest.fixture(scope="module")
def errors():
    """Errors in standard deviations, (draws, len(NAMES)), pooled over systems and angles."""
    rng = np.random.default_rng(21)
    found = []
    for draw in range(50 * len(SYSTEMS)):
        sensor = list(SYSTEMS.values())[draw % len(SYSTEMS)]
        angle_deg, snr = (6.0, 12.0, 20.0, 35.0)[draw // 8 % 4], (50.0, 100.0)[draw // 32 % 2]
        image, truth = sim.edge(
            sensor,
            angle_deg=angle_deg,
            shape=(40, 40),
            offset_px=rng.uniform(-0.5, 0.5),
            snr=snr,
            rng=rng,
        )
        fit = fit_edge(EdgePixels(image, truth.line.moved(0.1, 0.2), 200, 1200, 0.6, 1000 / snr))
        row = []
        for name in NAMES[:3]:
            estimate = getattr(fit.response, name)
            row.append((estimate.value - getattr(truth, name).value) / estimate.std)
        row.append((fit.line.normal_deg - truth.line.normal_deg) / fit.line.angle_std_deg)
        found.append(row)
    return np.array(found)


def test_scatter_is_the_standard_deviation(errors):
    scatter = float(np.sqrt(np.mean(errors**2)))
    assert LOWEST < scatter < HIGHEST
    # The bounds notice standard deviations wrong by a quarter.
    assert scatter / 0.8 > HIGHEST
    assert scatter / 1.25 < LOWEST


@pytest.mark.parametrize("column", range(len(NAMES)), ids=NAMES)
def test_scatter_of_every_number(errors, column):
    assert 0.7 < float(np.sqrt(np.mean(errors[:, column] ** 2))) < 1.2


@pytest.mark.parametrize("column", range(len(NAMES)), ids=NAMES)
def test_intervals_hold_the_truth(errors, column):
    # 400 draws: 95 % within three binomial standard deviations, 1.1 % each.
    assert 0.915 < np.mean(np.abs(errors[:, column]) < 1.96) <= 0.995


def test_errors_are_not_one_sided(errors):
    assert np.all(np.abs(errors.mean(axis=0)) < 0.35)


@pytest.mark.parametrize(("system", "slope"), [("gaussian", 0.02), ("sharpened", -0.01)])
def test_ground_that_slopes_across_the_edge_is_told_from_a_halo(system, slope):
    """A rise of 1 or 2 % of the height over 50 px, too weak for any check to see."""
    rng = np.random.default_rng(8)
    across = np.arange(48) - 24.0
    errors = []
    for _ in range(40):
        image, truth = sim.edge(
            SYSTEMS[system],
            angle_deg=rng.uniform(4, 12),
            shape=(48, 48),
            offset_px=rng.uniform(-0.5, 0.5),
            snr=100.0,
            rng=rng,
        )
        image = image + slope * 1000 * across / 50
        found = fit_edge(EdgePixels(image, truth.line.moved(0.1, 0.2), 200, 1200, 0.6, 10)).response
        errors.append((found.rer.value - truth.rer.value) / found.rer.std)
    # Without trends in the model the mean is 2.5 to 3.3 standard deviations off.
    assert abs(np.mean(errors)) < 1.5
    assert np.sqrt(np.mean(np.square(errors))) < 2.0
