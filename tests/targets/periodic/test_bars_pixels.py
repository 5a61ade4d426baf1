"""Images of modes across a group of bars."""

from __future__ import annotations

import numpy as np
import pytest

from acutance.geometry.bar_group import Bars
from acutance.numerics.otf_modes import MeanOtf, ProcessModes
from acutance.targets.periodic.bars_pixels import GroupPixels, group_columns
from acutance.targets.periodic.otf_model import all_modes, level_row, mode_count


def test_columns_are_sums_over_all_frequencies():
    """Of what every mode transfers; the table holds the places of these pixels."""
    bars, blur = Bars(20.0, 20.0, 12.0, 4.3, 3, 24.0), MeanOtf(0.3, 0.05, 0.2)
    across = 0.05 * np.array([-200.0, -131, -16, -1, 0, 1, 15, 16, 17, 140, 260])
    nothing = np.zeros(across.size, np.intp)
    pixels = GroupPixels(bars, nothing, nothing, np.zeros(across.size), across, across * 0.3)
    states = ProcessModes(blur.width_px)
    found, own = group_columns(pixels, blur, states, 1.0)
    step = 1 / (2 * (across.max() + 1) + bars.width_px + 30)
    freq = step * (np.arange(np.ceil(2.5 / step)) + 0.5)
    turns = np.exp(2j * np.pi * np.outer(across, freq)) * bars.spectrum(freq) * 2 * step
    normal = np.radians(bars.normal_deg)
    u, v = freq * np.cos(normal), freq * np.sin(normal)
    wanted = (turns @ all_modes(blur, mode_count(states), u, v)).real
    assert found == pytest.approx(wanted, abs=1e-11)
    slope = (turns @ (2j * np.pi * freq * blur.otf(u, v))).real
    assert own[:, 2] == pytest.approx(-slope, abs=1e-11)


def test_all_means_have_the_same_modes_at_zero_frequency():
    wide = MeanOtf(3.0, -0.4, 2.0)
    size = mode_count(ProcessModes(wide.width_px))
    nowhere = np.zeros(1)
    assert level_row(size) == pytest.approx(all_modes(wide, size, nowhere, nowhere)[0], abs=1e-14)
