"""The amplitude of halos is integrated over, the others enter to first order."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.numerics.marginal_likelihood import Prior, regress
from acutance.numerics.normal_equations import Normal
from acutance.targets.points.amplitudes import averaged_posterior
from acutance.targets.points.tuned import (
    FAMILY_LOG_AMPLITUDES,
    HALO_GRID,
    LOG_AMPLITUDE,
    LOG_AMPLITUDE_STD,
)

HALO = list(FAMILY_LOG_AMPLITUDES).index("halo")
TELESCOPE = list(FAMILY_LOG_AMPLITUDES).index("telescope")
OTHERS = [number for number in range(LOG_AMPLITUDE.size) if number != HALO]


def posterior(seen, noise=1e-3):
    """One coefficient a block, measured as `seen` independently of the others."""
    size = LOG_AMPLITUDE.size
    prior = Prior(
        np.arange(size, dtype=float), np.ones(size), np.zeros(size), LOG_AMPLITUDE,
        LOG_AMPLITUDE_STD, 1.0, noise,
    )  # fmt: skip
    known = np.isfinite(seen).astype(float)
    data = np.nan_to_num(seen)
    normal = Normal(np.diag(known), known * data, float(data @ data), 1000)
    likeliest = regress(normal, prior, noise**2)
    return averaged_posterior(normal, prior, 1.0, likeliest)


def test_the_share_of_the_others_leaves_halos_to_the_grid():
    """Nothing of theirs is counted by the grid and again to first order."""
    found = posterior(np.full(LOG_AMPLITUDE.size, 0.02))
    share = found.factor[:, LOG_AMPLITUDE.size :]
    assert share.shape[1] == len(OTHERS)
    assert np.abs(share[HALO]).max() == 0
    assert (np.linalg.norm(share[OTHERS], axis=1) > 0).all()


def test_what_is_not_seen_may_be_as_large_as_the_grid_and_the_prior_allow():
    seen = np.full(LOG_AMPLITUDE.size, 0.02)
    seen[HALO] = np.nan
    found = posterior(seen)
    std = np.linalg.norm(found.factor, axis=1)
    assert found.beta[HALO] == pytest.approx(0, abs=1e-12)
    assert np.exp(LOG_AMPLITUDE[HALO]) < std[HALO] < np.exp(max(HALO_GRID))
    assert found.beta[TELESCOPE] == pytest.approx(0.02, abs=2e-3)
    assert std[TELESCOPE] == pytest.approx(1e-3, rel=0.2)
