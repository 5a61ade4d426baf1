"""The fitted LSF: its curves belong together, and its designs are their derivatives."""

from dataclasses import replace

import numpy as np
import pytest

from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.targets.straight.lsf import LsfModel
from acutance.targets.straight.spline import CELLS, CENTRES, esf_from_lsf

RNG = np.random.default_rng(19)
BUMPS = np.exp(-0.5 * (CENTRES / 1.5) ** 2)
MODEL = LsfModel(
    blur=GaussianPixel(0.5, 0.9),
    level=1000.0,
    spline=esf_from_lsf(40 * BUMPS * np.sin(2 * CENTRES + 0.4)),
    tail=60.0,
    latent=np.vstack([esf_from_lsf(BUMPS[:, None] * RNG.standard_normal((CENTRES.size, 3))),
                      RNG.standard_normal(3)]),
)  # fmt: skip


def shifted(z):
    """The model whose latent variables are z."""
    change = MODEL.latent @ z
    return replace(MODEL, spline=MODEL.spline + change[:-1], tail=MODEL.tail + change[-1])


def test_curves_are_normalised_and_belong_together():
    middle = MODEL.half_point()
    response = MODEL.response(middle)
    esf, lsf, mtf = response.esf, response.lsf, response.mtf
    step = esf.distance_px[1] - esf.distance_px[0]
    slope = (esf.value[2:] - esf.value[:-2]) / (2 * step)
    assert np.max(np.abs(slope - lsf.value[1:-1])) < 5e-3
    assert esf(0.0).value == pytest.approx(0.5, abs=1e-6)
    assert MODEL.height == pytest.approx(1000 + MODEL.spline[-1] + 60)
    assert mtf.otf[0] == pytest.approx(1.0)
    # The tail beyond the grid holds 60 / (pi * 10.25 / width) of the height, and no more.
    missing = 1 - lsf.value.sum() * step
    assert 0 < missing < 0.02
    far = np.arange(-400000, 400001) * 0.005
    whole = np.gradient(MODEL.esf(far), 0.005)
    for k in (5, 20, 50):
        numerical = abs(np.sum(whole * np.exp(-2j * np.pi * mtf.freq_cpp[k] * far)) * 0.005)
        assert abs(mtf.otf[k]) == pytest.approx(numerical, abs=1e-3)


@pytest.mark.parametrize("axis", range(3))
def test_designs_are_the_derivatives_of_the_curves(axis):
    h = 1e-3
    z = h * np.eye(3)[axis]
    low, plain, high = (shifted(k * z).response(0.0) for k in (-1, 0, 1))
    for name in ("esf", "lsf"):
        change = (getattr(high, name).value - getattr(low, name).value) / (2 * h)
        factor = getattr(plain, name).covariance_factor[:, axis]
        assert np.max(np.abs(change - factor)) < 1e-4 * np.max(np.abs(change))
    change = (np.abs(high.mtf.otf) - np.abs(low.mtf.otf)) / (2 * h)
    factor = plain.mtf.covariance_factor[:, axis]
    assert np.max(np.abs(change - factor)) < 1e-4 * np.max(np.abs(change))


def test_standard_deviation_of_the_half_point_is_that_of_its_moves():
    h = 1e-2
    moves = [
        (shifted(h * z).half_point() - shifted(-h * z).half_point()) / (2 * h) for z in np.eye(3)
    ]
    middle = MODEL.half_point()
    found = MODEL.half_point_std(MODEL.response(middle))
    assert found == pytest.approx(np.linalg.norm(moves), rel=1e-2)


def test_curves_reach_the_support():
    wide = replace(MODEL, blur=GaussianPixel(2.0)).response(0.0)
    assert wide.esf.distance_px[-1] >= 8 * GaussianPixel(2.0).width_px
    assert wide.lsf.factor.shape == (wide.lsf.value.size, CELLS + 4)
