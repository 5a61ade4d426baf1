"""Which tiles of a large pair are read."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.raster import Image
from acutance.targets.pair.grid import pair_grid
from acutance.targets.pair.tiles import PairTiles


@pytest.mark.parametrize("shape", [(5184, 5184), (5000, 700), (700, 5000), (2600, 2600)])
def test_tiles_of_a_large_scene_are_distributed_evenly(shape: tuple[int, int]) -> None:
    """Of 54 by 54 tiles every 54th lies in the same column."""
    low, high = (Image.of(np.broadcast_to(np.float32(1), [k * n for n in shape])) for k in (1, 2))
    tiles = PairTiles(low, high, pair_grid(low, high, 2), None, 4.5, 500_000)
    assert len(set(tiles.boxes)) == 54
    place = np.array([(box.row, box.col) for box in tiles.boxes]) / shape
    shares, *_ = np.histogram2d(*place.T, bins=2, range=[[0, 1], [0, 1]])
    assert shares.min() >= 10
    some = np.array([tile.place for tile in tiles.some(4)]) / shape
    assert np.all(some.max(axis=0) - some.min(axis=0) > 0.3)


def test_few_tiles_of_some_columns_are_not_all_in_one() -> None:
    low, high = (Image.of(np.broadcast_to(np.float32(1), (k * 870, k * 290))) for k in (1, 2))
    tiles = PairTiles(low, high, pair_grid(low, high, 2), None, 4.5, 500_000)
    assert len({tile.place[1] for tile in tiles.some(9)}) == 3
