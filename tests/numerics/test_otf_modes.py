"""States of the harmonic oscillator in two dimensions, at frequencies."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import eval_genlaguerre

from acutance.numerics.otf_modes import PROCESSES, ProcessModes
from acutance.numerics.process_modes import mehler

WIDTH_PX = 1.3


def _state(process, order, nodes, freq):
    """A radial part by its definition, in units of the width."""
    ratio, scale = mehler(process.extent, process.smoothness)
    x = 2 * math.pi * scale * freq
    norm = math.sqrt(2 * math.factorial(nodes) / math.factorial(nodes + order))
    angular = 1 / math.sqrt(2 * math.pi if order == 0 else math.pi)
    value = norm * angular * x**order * eval_genlaguerre(nodes, order, x * x) * np.exp(-0.5 * x * x)
    long2, short2 = process.extent**2, process.smoothness**2
    first = math.pi * long2 * (1 - ratio) ** 2
    first /= 2 * math.pi * long2 / math.sqrt(1 + 2 * long2 / short2)
    return 2 * math.pi * scale * math.sqrt(first * ratio ** (order + 2 * nodes)) * value


def test_states_are_those_of_their_definition():
    rng = np.random.default_rng(7)
    u, v = np.append(rng.uniform(-1.5, 1.5, (2, 40)), np.zeros((2, 1)), axis=1)
    states = ProcessModes(WIDTH_PX)
    radius, angle = np.hypot(u, v), np.arctan2(v, u)
    wanted = []
    for order in range(states.orders + 1):
        radial = [
            _state(process, order, nodes, radius * WIDTH_PX)
            for process in PROCESSES
            for nodes in range((process.orders - order) // 2 + 1)
        ]
        if order == 0:
            radial.append(np.exp(-2 * math.pi * WIDTH_PX * radius))
        assert states.radial(radius)[order] == pytest.approx(np.transpose(radial), abs=1e-12)
        assert states.sizes()[order] == len(radial)
        unit = 1j if order % 2 else 1
        wanted += [unit * one * np.cos(order * angle) for one in radial]
        wanted += [unit * one * np.sin(order * angle) for one in radial] if order else []
    assert states.otf_modes(u, v) == pytest.approx(np.transpose(wanted), abs=1e-12)
