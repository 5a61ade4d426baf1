"""A sensor with a different blur each way, edges of it, and a filter made from them."""

import numpy as np
import pytest

import acutance as ac

SENSOR = ac.Sensor(
    [ac.optics.Gaussian(0.45), ac.optics.Detector(), ac.optics.Smear(0.8, "along")], gsd_m=0.7
)


@pytest.fixture(scope="session")
def sensor():
    return SENSOR


@pytest.fixture(scope="session")
def edges():
    """An edge across and one along, SNR 100."""
    rng = np.random.default_rng(4)
    found = []
    for orientation in ("across", "along"):
        pixels, _ = ac.simulate.edge(
            SENSOR, shape=(70, 70), angle_deg=6, snr=100, orientation=orientation, rng=rng
        )
        found.append(ac.measure_edge(ac.Image.from_array(pixels, gsd_m=0.7)))
    return found


@pytest.fixture(scope="session")
def sharpening(edges):
    """A filter of noise gain 1.8."""
    return ac.design_restoration(edges, noise_gain=1.8, size=11)
