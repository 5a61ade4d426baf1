"""The prior of the LSF: its layout, its tail, and the covariance its processes stand for."""

import numpy as np
import pytest

from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.lorentz_tail import tail_esf, tail_lsf, tail_otf
from acutance.targets.straight.lsf_prior import directions, tail_spline
from acutance.targets.straight.spline import (
    CELLS,
    CENTRES,
    combine,
    edge_and_line_weights,
    edge_weights,
)
from acutance.targets.straight.tuned import (
    DETAIL,
    FAMILY_LOG_AMPLITUDES,
    LOG_AMPLITUDE,
    TAIL_WIDTH,
)

BLURS = [GaussianPixel(0.4), GaussianPixel(1.3, 0.6)]


@pytest.mark.parametrize("blur", BLURS)
def test_layout(blur):
    found = directions(blur)
    assert found.esf.shape == (CELLS + 3, found.block.size)
    assert np.isfinite(found.esf).all()
    assert found.block.tolist() == sorted(found.block.tolist())
    count = np.bincount(found.block)
    assert count.size == 2 + LOG_AMPLITUDE.size
    assert count[[0, 1, -1]].tolist() == [3, 1, 1]
    assert count[2:-1].min() >= 2


@pytest.mark.parametrize("blur", BLURS)
def test_mean_directions_are_the_blur_and_its_slopes(blur):
    found = directions(blur)
    u = np.linspace(-3, 3, 61)
    s = u * blur.width_px
    _, by_place, by_sigma, by_aperture = blur.lsf_slopes(s)
    for column, shape in enumerate((blur.lsf(s), by_sigma, -by_place, by_aperture)):
        lsf = combine(*edge_and_line_weights(u)[::2], found.esf[:, column]) / blur.width_px
        assert np.max(np.abs(lsf - shape)) < 0.02 * np.max(np.abs(shape))


def test_the_detail_has_the_covariance_it_promises():
    found = directions(GaussianPixel(0.4))
    own = found.esf[:, found.block == found.block.max() - 1]
    root = np.diff(own[2:-2], axis=0) / (CENTRES[1] - CENTRES[0])
    u = CENTRES
    expected = np.exp(-0.5 * (u**2 + u[:, None] ** 2) / DETAIL[0] ** 2)
    expected *= np.exp(-0.5 * ((u - u[:, None]) / DETAIL[1]) ** 2)
    assert np.max(np.abs(root @ root.T - expected)) < 2e-4


def test_tail_curves_belong_together():
    u = np.linspace(-9, 9, 181)
    slope = (tail_esf(u + 1e-5, TAIL_WIDTH) - tail_esf(u - 1e-5, TAIL_WIDTH)) / 2e-5
    assert np.max(np.abs(slope - tail_lsf(u, TAIL_WIDTH))) < 1e-8
    grid = (np.arange(400000) + 0.5) * 0.005 - 1000
    freq = np.array([0.0, 0.1, 0.3, 0.7])
    numerical = np.cos(2 * np.pi * np.outer(freq, grid)) @ tail_lsf(grid, TAIL_WIDTH) * 0.005
    # The grid's ends leave 2 * TAIL_WIDTH / (1000 pi) out.
    assert np.max(np.abs(tail_otf(freq, TAIL_WIDTH) - numerical)) < 1e-3


def test_tail_direction_is_the_tail_within_the_support():
    u = np.linspace(-7, 7, 141)
    spline = combine(*edge_weights(u), tail_spline())
    assert np.max(np.abs(spline - tail_esf(u, TAIL_WIDTH))) < 2e-3


def test_the_tail_of_a_direction_is_kept_apart_from_its_spline():
    found = directions(GaussianPixel(0.4))
    assert found.tail[-1] == 1
    assert not found.esf[:, -1].any()
    # Of the families only those with an aperture have light beyond the spline.
    apertures = {"telescope", "restored", "resampled", "shifted", "processed"}
    for number, family in enumerate(FAMILY_LOG_AMPLITUDES):
        own = np.abs(found.tail[found.block == 2 + number]).max()
        assert own > 0.01 if family in apertures else own < 1e-9
