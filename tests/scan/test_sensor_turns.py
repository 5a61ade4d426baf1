"""Turns of the sensor of a scene: of many edges some choose the start."""

import numpy as np

from acutance.scan.sensor_turns import some_of_each


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
