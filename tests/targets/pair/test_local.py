"""Regions of a pair: their blur, and how far it scatters."""

from __future__ import annotations

import numpy as np
import pytest
from pair_scenes import REFERENCE, SYSTEMS
from scipy.ndimage import gaussian_filter

import acutance as ac
from acutance.raster import Box
from acutance.simulate import Noise
from acutance.targets.pair.local import LocalFit, fit_regions
from acutance.targets.pair.residual_slopes import TileSlopes
from acutance.targets.pair.tile import PAD_PX


def test_noise_of_the_reference_does_not_blur_regions() -> None:
    """Their blur is the common one: noise makes the slopes of a regression too small."""
    low, high, _ = ac.simulate.pair(
        SYSTEMS["gaussian"], REFERENCE, ratio=3, shape=(64, 64),
        noise_low=Noise(5.0), noise_high=Noise(150.0), rng=np.random.default_rng(3),
    )  # fmt: skip
    options = ac.BiresolutionOptions(noise_high=150.0)
    m = ac.measure_biresolution(low, high, ratio=3, reference_mtf=REFERENCE, options=options)
    blur = np.stack([m.local.variance_down_px2, m.local.variance_across_px2])
    std = float(np.mean(m.local.variance_std_px2)) / np.sqrt(0.5 * blur.size)
    assert np.all(np.abs(blur.mean(axis=(1, 2))) < 3 * std)


def regions_of(width_px: float, drift: float = 0.0) -> LocalFit:
    """Of 8 by 8 regions of 48 pixels, in two tiles, that differ in nothing but the residuals.

    The level drifts down the columns, which no region's gain explains.
    """
    rng = np.random.default_rng(5)
    side, regions = 384, np.arange(384) // 48
    smooth = [gaussian_filter(rng.standard_normal((side, side)), 1.5) for _ in range(5)]
    columns = np.stack([one / one.std() for one in smooth], axis=-1)
    columns[..., 0] += drift * np.arange(side)[:, None]
    rest = gaussian_filter(rng.standard_normal((side, side)), width_px)
    rest = rest / rest.std() + 0.2 * columns[..., 0]
    tiles = []
    for rows in (slice(0, 204), slice(204, side)):
        shown = np.pad(rest[rows], PAD_PX, constant_values=np.nan)[:-PAD_PX]
        usable = np.ones(rest[rows].shape, bool)
        labels = (8 * regions[rows, None] + regions).ravel()
        tiles.append(
            TileSlopes((rows.start, 0), shown, usable, columns[rows].reshape(-1, 5), labels)
        )
    return fit_regions(tiles, (8, 8), Box(0, 0, side, side), np.zeros((6, 6)))[0]


@pytest.mark.parametrize("width_px", [0.0, 1.0])
def test_regions_scatter_as_stated_whether_residuals_are_white_or_not(width_px: float) -> None:
    """Those of real pairs correlate: by a Gaussian of 1 px the scatter is twice as large."""
    local = regions_of(width_px)
    shifts = np.stack([local.shift_row_px, local.shift_col_px])
    assert 0.8 < shifts.std() / local.shift_std_px.mean() < 1.2
    blurs = np.stack([local.variance_down_px2, local.variance_across_px2])
    assert 0.8 < blurs.std() / local.variance_std_px2.mean() < 1.2


def test_regions_in_two_tiles_have_one_level() -> None:
    """A gain is that of the whole region, about one level: tiles have levels of their own."""
    gain = regions_of(0.0, drift=0.05).gain
    assert np.all(np.abs(gain - 1.2) < 0.25)
