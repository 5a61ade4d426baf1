"""Of every kind and method: the measurement without its details is small and states the same."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import acutance as ac
from acutance.targets.kinds import KINDS

SENSOR = ac.simulate.reference_systems()["asymmetric"]
METHODS = [(kind.name, method) for kind in KINDS.values() for method in kind.methods]
RTOL = 1e-6
ROUNDED = {"points": 0.15, "biresolution": 0.06, "bars": 0.01, "star": 0.002, "combined": 0.001}
"""What rounding may change of the deviations of an MTF, for kinds that show two directions."""


def edge(method: str, orientation: ac.targets.Orientation = "across") -> ac.Measurement:
    rng = np.random.default_rng(1)
    image, _ = ac.simulate.edge(SENSOR, angle_deg=6, orientation=orientation, snr=100, rng=rng)
    return ac.measure_edge(image, method=method, gsd_m=0.7)


def pulse(method: str) -> ac.Measurement:
    rng = np.random.default_rng(2)
    image, _ = ac.simulate.pulse(SENSOR, width_px=3, angle_deg=6, snr=100, rng=rng)
    return ac.measure_pulse(image, width_px=3, method=method, gsd_m=0.7)


def points(method: str) -> ac.Measurement:
    image, truth = ac.simulate.points(SENSOR, snr=80, rng=np.random.default_rng(3))
    return ac.measure_points(image, method=method, surveyed=truth.positions, gsd_m=0.7)


def biresolution(method: str) -> ac.Measurement:
    low, high, _ = ac.simulate.pair(
        SENSOR, SENSOR, ratio=3, shape=(80, 80), snr=80, rng=np.random.default_rng(4)
    )
    return ac.measure_biresolution(low, high, ratio=3, method=method)


def bars(method: str) -> ac.Measurement:
    image, _ = ac.simulate.bars(SENSOR, snr=80, rng=np.random.default_rng(5))
    return ac.measure_bars(image, method=method, gsd_m=0.7)


def star(method: str) -> ac.Measurement:
    image, _ = ac.simulate.star(
        SENSOR, snr=80, shape=(96, 96), radius_px=40, rng=np.random.default_rng(6)
    )
    return ac.measure_star(image, method=method, gsd_m=0.7)


@cache
def combined(method: str) -> ac.Measurement:
    found = ac.combine([edge("spline"), edge("spline", "along")])
    assert found.method == method
    return found


MEASURE = {
    "edge": edge, "pulse": pulse, "points": points, "biresolution": biresolution, "bars": bars,
    "star": star, "combined": combined,
}  # fmt: skip


@pytest.fixture(scope="module", params=METHODS, ids=" ".join)
def halves(request: pytest.FixtureRequest) -> tuple[ac.Measurement, bytes]:
    kind, method = request.param
    whole = MEASURE[kind](method)
    return whole, pickle.dumps(whole.without_details())


def test_it_is_small(halves):
    assert len(halves[1]) <= 60_000


def test_it_states_the_same_numbers(halves):
    whole, stored = halves
    light = pickle.loads(stored)
    assert light == whole
    assert light.details is None
    for name, response in whole.directions.items():
        stated = light.directions[name].metrics()
        for metric, number in response.metrics().items():
            assert stated[metric].value == pytest.approx(number.value, rel=RTOL, nan_ok=True)
            assert stated[metric].std == pytest.approx(number.std, rel=RTOL, nan_ok=True)
    assert light.without_details() == light


def test_curves_keep_their_deviations(halves):
    whole, stored = halves
    light = pickle.loads(stored)
    rtol = ROUNDED.get(whole.kind, RTOL)
    for name, one in whole.directions.items():
        other = light.directions[name]
        assert other.esf.value == pytest.approx(one.esf.value, abs=1e-9)
        assert other.lsf.value == pytest.approx(one.lsf.value, abs=1e-9)
        assert other.mtf.otf == pytest.approx(one.mtf.otf, abs=1e-9)
        assert other.mtf.std[5:] == pytest.approx(one.mtf.std[5:], rel=rtol)
        if rtol == RTOL:
            assert other.mtf.value == pytest.approx(one.mtf.value, rel=rtol)
            assert other.esf.std == pytest.approx(one.esf.std, rel=rtol, abs=1e-15)
            assert other.lsf.std == pytest.approx(one.lsf.std, rel=rtol, abs=1e-15)
        # Between the places of the grid, and of numbers that are read again, correlations count.
        freq = np.arange(3, 50) * 0.0197
        assert other.mtf(freq).std == pytest.approx(one.mtf(freq).std, rel=max(rtol, 1e-3))
        anew = replace(other).metrics()
        for metric, number in one.metrics().items():
            known = pytest.approx(number.std, rel=max(rtol, 3e-3), nan_ok=True)
            assert anew[metric].std == known, metric


def test_parameters_of_a_combination_are_the_same():
    whole = combined("least-squares")
    light = pickle.loads(pickle.dumps(whole.without_details()))
    assert whole.parameters.keys() == light.parameters.keys()
    for name, number in whole.parameters.items():
        assert light.parameters[name].std == pytest.approx(number.std, rel=RTOL, nan_ok=True)
