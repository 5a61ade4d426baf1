"""Turns of the sensor of a scene: of many edges some choose the start, and starts that differ."""

from types import SimpleNamespace

import numpy as np

from acutance import optics
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.first_guesses import BIN_DEG, sensor_guesses
from acutance.scan.first_sensor import first_sensor, some_of_each
from acutance.targets.slices import SLICE_FREQ_CPP as FREQ

TAPS = (-0.25, 1.5, -0.25)
SHARPENED = optics.Sensor([
    optics.Diffraction(0.9, 0.3), optics.Gaussian(0.3), optics.Detector(),
    optics.Sharpening(tuple(map(tuple, np.outer(TAPS, TAPS).tolist()))),
])  # fmt: skip
"""Kernels of rows and columns: .25 at Nyquist along both, and .43 along the diagonals."""


RESTORED = optics.Sensor([
    optics.Diffraction(1.37, 0.26), optics.Gaussian(0.22), optics.Smear(0.87, "across"),
    optics.ChargeDiffusion(0.45), optics.Detector(0.85), optics.Sharpening.both_axes(0.685),
])  # fmt: skip
"""A kernel that lifts the MTF at .25 c/px above one."""


def true_modulus(sensor, normal_deg):
    """MTF of a sensor along directions, (n, k)."""
    turn = np.radians(np.asarray(normal_deg))[:, None]
    along = (np.cos(turn) * FREQ, np.sin(turn) * FREQ)
    return np.abs(sensor.otf(*(one.ravel() for one in along))).reshape(along[0].shape)


def half_soft(sensor, seed, count, std):
    """Edges of all directions, half of them soft, their directions, and first guesses."""
    rng = np.random.default_rng(seed)
    normal_deg = rng.uniform(-90, 90, count)
    soft = np.where(rng.random(count) < 0.5, rng.uniform(0.2, 1.2, count), 0.0)
    own = true_modulus(sensor, normal_deg) * np.exp(-2 * (np.pi * np.outer(soft, FREQ)) ** 2)
    stds = std * rng.uniform(0.5, 2.0, count)[:, None]
    seen = np.hstack([own, np.zeros_like(own)])
    seen += stds * rng.standard_normal(seen.shape)
    _, number = np.unique(np.floor((normal_deg + 90) / BIN_DEG), return_inverse=True)
    middle = np.array([normal_deg[number == b].mean() for b in range(number.max() + 1)])
    edges = EdgeLikelihoods.of_roots(
        FREQ, np.eye(2 * FREQ.size) / stds[:, :, None], seen / stds,
        np.full(count, 2.0 * FREQ.size), number, normal_deg,
    )  # fmt: skip
    used = [
        SimpleNamespace(otf=one[: FREQ.size] + 1j * one[FREQ.size :], axis_deg=axis)
        for one, axis in zip(seen, normal_deg.tolist(), strict=True)
    ]
    return edges, middle, sensor_guesses(used, middle)


def test_few_edges_all_choose_the_start():
    bins = np.random.default_rng(1).integers(0, 24, 1100)
    assert some_of_each(bins).tolist() == list(range(1100))


def test_of_many_edges_some_of_every_direction_choose_the_start():
    rng = np.random.default_rng(2)
    bins = np.concatenate([rng.integers(0, 23, 9000), [23]])
    some = some_of_each(bins)
    assert 600 <= some.size <= 1200
    assert np.all(np.diff(some) > 0)
    count, chosen = np.bincount(bins), np.bincount(bins[some])
    # Every fifteenth of each, the first one always.
    assert chosen.tolist() == np.ceil(count / 15).tolist()


def rms_at_nyquist(sensor, normal_deg, otf):
    """Root mean square error of OTFs (b, 2 k) at Nyquist."""
    nyquist = np.flatnonzero(np.isclose(FREQ, 0.5)).item()
    modulus = np.hypot(otf[:, nyquist], otf[:, FREQ.size + nyquist])
    return np.sqrt(np.mean((modulus - true_modulus(sensor, normal_deg)[:, nyquist]) ** 2))


def test_a_sensor_that_is_sharper_along_the_diagonals_is_found():
    """A round sensor, as sharp as the diagonals, under edges that are soft along rows and columns.

    Where no kernel is among the forms three of eight starts end at another sensor, .05 away.
    """
    edges, normal_deg, guesses = half_soft(SHARPENED, 5, 64, 0.08)
    state, _, rivals = first_sensor(edges, normal_deg, guesses)
    assert rms_at_nyquist(SHARPENED, normal_deg, state.otf) < 0.03
    assert all(one.apart < 0.02 for one in rivals)


def test_several_processes_lead_to_the_same_sensor(monkeypatch):
    """The second start leads to a likelier end, beside which the third is followed again."""
    monkeypatch.setattr("acutance.scan.first_sensor._MOST_FOLLOWED", 3)
    monkeypatch.setattr("acutance.scan.first_sensor._LIKELIER", -1e6)
    monkeypatch.setattr("acutance.scan.first_sensor._WORTHWHILE_S", 0.0)
    edges, normal_deg, guesses = half_soft(SHARPENED, 5, 64, 0.08)
    one, tops, _ = first_sensor(edges, normal_deg, guesses)
    other, same, _ = first_sensor(edges, normal_deg, guesses, workers=2)
    assert len(tops) == len(same) > 0
    for here, there in zip([one, *tops], [other, *same], strict=True):
        np.testing.assert_array_equal(here.otf, there.otf)


def test_turns_of_few_edges_reach_the_likeliest_sensor(monkeypatch):
    """Two or three edges of a direction are soft or ideal together.

    Turns of expectation and maximisation creep, and end off by .46 at Nyquist. One start is
    followed, which no other can help.
    """
    monkeypatch.setattr("acutance.scan.first_sensor._MOST_FOLLOWED", 1)
    std = 0.015
    edges, normal_deg, guesses = half_soft(RESTORED, 2, 30, std)
    state, _, _ = first_sensor(edges, normal_deg, guesses)
    assert state.settled
    assert rms_at_nyquist(RESTORED, normal_deg, state.otf) < std
