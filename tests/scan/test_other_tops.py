"""Sensors that are nearly as likely as the likeliest move it, and open its interval."""

import numpy as np
import pytest

from acutance.scan.blur_modes import COMMON_MODES, changed, edge_modes
from acutance.scan.other_tops import blur_of_tops
from acutance.targets.slices import SLICE_FREQ_CPP as FREQ

NORMAL_DEG = np.array([-60.0, -10.0, 35.0, 80.0])
MODES = edge_modes(NORMAL_DEG, FREQ)[:, :, :COMMON_MODES]
OTF = np.tile(np.concatenate([np.exp(-2 * (np.pi * 0.4 * FREQ) ** 2), 0 * FREQ]), (4, 1))


def test_without_another_top_nothing_changes():
    found = blur_of_tops(OTF, (), np.zeros(1), MODES, FREQ)
    assert not found.mean_px2.any()
    assert not found.errors_px2.any()


@pytest.mark.parametrize("lead", [-1.0, 0.0, 2.0])
def test_mean_and_scatter_are_those_of_two_tops(lead):
    """Of weights 1 and exp(-lead), at 0 and d: mean w d, variance w (1 - w) d^2."""
    blur_px2 = np.array([0.02, -0.01, 0.005])
    other = changed(OTF, MODES @ blur_px2)
    found = blur_of_tops(OTF, (other,), np.array([-80.0, -80.0 - lead]), MODES, FREQ)
    weight = np.exp(-lead) / (1 + np.exp(-lead))
    # Amounts are those of the change of the MTF to first order.
    assert found.mean_px2 == pytest.approx(weight * blur_px2, rel=0.08, abs=5e-4)
    own = found.mean_px2 / weight
    covariance = found.errors_px2.T @ found.errors_px2
    assert covariance == pytest.approx(weight * (1 - weight) * np.outer(own, own), abs=1e-12)
